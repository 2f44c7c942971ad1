"""Runs many episodes in processes of their own, each into its run folder.

A run that fails, or whose process dies, is told as a failure and harms no other. One process a run
keeps the peak memory in ``result.json`` that of the run.
"""

import shutil
import signal
import sys
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing import get_context
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import Any, Literal, cast

from evaluation.episode import Episode, EpisodeConfig, run_episode
from evaluation.episode_folder import write_run
from evaluation.failure import FAILURE_FILE, RunError, details_of, reason_of, write_failure
from evaluation.run_folder import describe, start_run, write_json
from mapping.errors import TestbedError

Job = tuple[EpisodeConfig, Path]
"""What to run, and the folder to write."""

START_METHOD: Literal["forkserver"] = "forkserver"
"""A process starts as a copy of one that has imported everything and run nothing."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Failure:
    """Why a run has no result."""

    reason: str
    """One line."""
    details: str = ""
    """The traceback of a defect."""


Outcome = dict[str, Any] | Failure
"""The content of ``result.json``, or why there is none."""


def run_episodes(
    jobs: Sequence[Job],
    *,
    processes: int = 1,
    on_done: Callable[[int, Outcome], None] | None = None,
) -> list[Outcome]:
    """Run every job, a few at a time, in order.

    Kernels that are not compiled are compiled by each process that starts before they are: compile
    them first (``evaluation.kernels.warm_up.kernels_of_mapper``).

    Args:
        jobs: What to run, and where to write it.
        processes: How many run at the same time.
        on_done: Called in this process with the index and the outcome of each job that ends, in
            the order in which they end.

    Returns:
        The outcomes, in the order of the jobs.

    Raises:
        TestbedError: If ``processes`` is not positive.
        KeyboardInterrupt: On Ctrl-C, when the runs under way have been ended; they write nothing.
            What had ended before was told to ``on_done``.
    """
    if processes < 1:
        raise TestbedError(f"jobs: {processes}; must be 1 or more")
    outcomes: dict[int, Outcome] = {}
    waiting = list(enumerate(jobs))[::-1]
    running: dict[Connection, tuple[int, BaseProcess]] = {}
    try:
        while waiting or running:
            while waiting and len(running) < processes:
                index, job = waiting.pop()
                receiver, process = _start(job)
                running[receiver] = (index, process)
            ready = wait(list(running))
            for receiver in [each for each in running if each in ready]:
                index, process = running.pop(receiver)
                outcomes[index] = _receive(receiver, process)
                _keep_failure(jobs[index], outcomes[index])
                if on_done is not None:
                    on_done(index, outcomes[index])
    finally:
        for _, process in running.values():
            process.terminate()
            process.join()
    return [outcomes[index] for index in range(len(jobs))]


def _start(job: Job) -> tuple[Connection, BaseProcess]:
    """Start a process for a job; its outcome comes through the connection."""
    context = get_context(START_METHOD)
    context.set_forkserver_preload([__name__])
    receiver, sender = context.Pipe(duplex=False)
    process = context.Process(target=_run, args=(*job, sender), daemon=True)
    process.start()
    sender.close()  # so that only the process holds it, and its death is an end of file
    return receiver, process


def _receive(receiver: Connection, process: BaseProcess) -> Outcome:
    """What a process sent before it ended, or how it ended."""
    try:
        outcome: Outcome = receiver.recv()
    except EOFError:
        process.join()
        return Failure(reason=f"the process died ({_exit_of(process)})")
    finally:
        receiver.close()
    process.join()
    return outcome


def _exit_of(process: BaseProcess) -> str:
    status = process.exitcode or 0
    return signal.Signals(-status).name if status < 0 else f"exit status {status}"


def _keep_failure(job: Job, outcome: Outcome) -> None:
    """Write what was to be run and why there is no result, where that can be written."""
    if not isinstance(outcome, Failure):
        return
    config, folder = job
    text = f"{outcome.reason}\n\n{outcome.details}".strip() + "\n"
    with suppress(TestbedError):  # the folder may be what failed
        start_run(folder)
        write_json(folder / "config.json", describe(config))
        write_failure(folder, text)


def _run(config: EpisodeConfig, folder: Path, sender: Connection) -> None:
    """Run one job in this process and send its outcome."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the parent's to handle
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # so that what is begun is taken away
    sender.send(_outcome_of(config, folder))
    sender.close()


def _outcome_of(config: EpisodeConfig, folder: Path) -> Outcome:
    """Run and write; a run that is ended from outside leaves no folder that was not there."""
    is_new = not folder.exists()
    try:
        return _run_and_write(config, folder)
    except SystemExit:
        if is_new:
            shutil.rmtree(folder, ignore_errors=True)
        raise


def _run_and_write(config: EpisodeConfig, folder: Path) -> Outcome:
    for earlier in ("result.json", FAILURE_FILE):  # it would vouch for this run
        (folder / earlier).unlink(missing_ok=True)
    try:
        return write_run(run_episode(config), folder)
    except RunError as error:
        write_run(cast(Episode, error.left), folder)  # its map, for who looks for the defect
        return Failure(reason=reason_of(error), details=details_of(error))
    except TestbedError as error:
        return Failure(reason=" ".join(str(error).split()))
    except Exception as error:  # a defect in one run must not end the others
        return Failure(reason=reason_of(error), details=details_of(error))
