"""``burger thesis``: the thesis's figures and Table 5.3, regenerated in simulation, as one page."""

from dataclasses import dataclass
from pathlib import Path

from tqdm import tqdm

from evaluation.kernels.warm_up import kernels_of_mapper
from evaluation.run_folder import run_folder
from evaluation.thesis.config import DRIVING_MAPPER, ThesisConfig
from evaluation.thesis.regenerate import SPECS, STEPS, regenerate
from evaluation.thesis.thesis_folder import PAGE, VERDICTS, figures_of, write_thesis
from mapping.errors import TestbedError
from scripts.arguments import is_terminal, parse
from scripts.first_run import compile_if_needed


@dataclass(frozen=True, kw_only=True)
class Thesis:
    """Regenerate the thesis's figures 5.1 to 5.11 and Table 5.3 as one HTML page."""

    out: Path = Path("runs/thesis")
    """Folder to write: thesis.html and thesis.json."""
    seed: int = 0
    """Seed of every random number."""
    jobs: int = 2
    """How many drives and maps at the same time."""


def run(arguments: list[str]) -> int:
    """Run the verb; 0 when the page is there, whatever its verdicts are."""
    options = parse(Thesis, "thesis", arguments)
    config = ThesisConfig.of_seed(options.seed)
    if options.jobs < 1:
        raise TestbedError(f"--jobs: {options.jobs}; must be 1 or more")
    with run_folder(options.out):
        compile_if_needed(kernels_of_mapper(DRIVING_MAPPER, simulates=True))
        for mapper in dict.fromkeys(spec.mapper for spec in SPECS.values()):
            compile_if_needed(kernels_of_mapper(mapper, simulates=False))
        with tqdm(total=STEPS + 1, unit="step", disable=not is_terminal(), leave=False) as bar:

            def tell(name: str) -> None:
                bar.set_postfix_str(name.replace("_", " "))
                bar.update()

            runs = regenerate(config, processes=options.jobs, on_done=tell)
            bar.set_postfix_str("figures")
            figures = figures_of(runs)
            write_thesis(config, runs, figures, options.out)
            bar.update()
    for figure in figures:
        print(f"{figure.number:<10} {figure.verdict:<13} {figure.title}")
    print(f"{PAGE} and {VERDICTS} are in {options.out}/")
    return 0
