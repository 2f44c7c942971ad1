"""The ``burger`` command: finds the verb, runs it, turns bad input into one line and status 2."""

import os
import sys
from importlib import import_module

VERBS = {
    "explore": "one autonomous episode: drive, map, score, write a run folder",
    "replay": "map a recorded log, score what can be scored, write a run folder",
    "optimize": "the poses of a g2o file that agree best with its measurements",
    "compare": "score a map file against a floor plan or another map",
    "localize": "find the robot on a given map by particles, a histogram or an EKF",
    "world": "list, show and convert floor plans",
    "scenario": "list scenarios; run them, judge them by their criteria, write junit.xml",
    "sweep": "explore every combination of worlds, mappers, navigators and seeds, table them",
    "report": "one HTML page of tables, plots and worst maps from run folders",
    "calibrate": "the thesis's two sensor experiments: how often is the lidar right?",
    "drive": "drive by hand in a terminal, the map growing beside it",
    "thesis": "the thesis's figures 5.1 to 5.11 and Table 5.3, regenerated, on one page",
    "bench": "how fast each stage and the whole loop run on this machine",
}
"""Verb -> one line about it; each verb is the module of that name in this folder."""

BAD_INPUT = 2

READER_GONE = 141
"""What shells tell of a program that wrote to a pipe which nobody reads (128 + SIGPIPE)."""


def main() -> None:
    """Run the command line of this process and exit with its status.

    ``burger ... | head`` ends without a word when head has seen enough.
    """
    try:
        try:
            status = run(sys.argv[1:])
        finally:
            sys.stdout.flush()
    except BrokenPipeError:
        status = READER_GONE
        # what is left in the buffer goes nowhere, or Python would complain about it at exit
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    sys.exit(status)


def run(arguments: list[str]) -> int:
    """Run one command line; returns the exit status.

    0 = done and within criteria, 1 = ran and failed its criteria, 2 = bad input, 130 = Ctrl-C
    before there was anything to save.
    """
    if not arguments or arguments[0] in ("-h", "--help"):
        print(_help())
        return 0 if arguments else BAD_INPUT
    verb, *rest = arguments
    if verb not in VERBS:
        print(f"burger: {verb!r} is no verb; must be one of {', '.join(VERBS)}", file=sys.stderr)
        return BAD_INPUT
    from mapping.errors import TestbedError

    try:
        return int(import_module(f"scripts.{verb}").run(rest))
    except TestbedError as error:
        print(f"burger {verb}: {' '.join(str(error).split())}", file=sys.stderr)
        return BAD_INPUT
    except KeyboardInterrupt:
        print(f"burger {verb}: interrupted", file=sys.stderr)
        return 130


def _help() -> str:
    verbs = "\n".join(f"  {verb:<9} {about}" for verb, about in VERBS.items())
    return (
        "usage: burger VERB [options]\n\n"
        "A simulated TurtleBot3 Burger explores a floor plan, maps it and is scored.\n\n"
        f"{verbs}\n\nburger VERB --help tells the options of a verb."
    )


if __name__ == "__main__":
    main()
