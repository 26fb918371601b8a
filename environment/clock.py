"""Build the virtual clock for the grader's runs: the library for programs, and its driver."""

from pathlib import Path
import tempfile

from environment.places import CLOCK_SOURCES
from environment.plan import Plan
from environment.stamps import clock_sources
from environment.steps import Job

COMPILER = ('gcc', '-std=gnu17', '-O2', '-g', '-Wall', '-Wextra')
DRIVER, LIBRARY = 'driver', 'clock.so'


def commands(folder: Path, *options: str) -> list[list[str]]:
    """
    Return the two compiler commands, for the driver and the library.

    :param folder: folder for the compiled files
    :param options: additional compiler options
    """
    driver = CLOCK_SOURCES / 'driver.c'
    library = [str(path) for path in clock_sources() if path.suffix == '.c' and path != driver]
    shared = ['-fPIC', '-shared', '-fvisibility=hidden', '-pthread']
    return [
        [*COMPILER, *options, str(driver), '-o', str(folder / DRIVER)],
        [*COMPILER, *options, *shared, *library, '-o', str(folder / LIBRARY), '-ldl'],
    ]


def build(plan: Plan, job: Job) -> None:
    """Compile to temporary files and rename them, so that a run never sees an incomplete file."""
    places = plan.places
    places.clock.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=places.notes) as aside:
        for command in commands(Path(aside)):
            job.run(command, plan.clean_environ(), 'gcc')
        for name in (DRIVER, LIBRARY):
            Path(aside, name).replace(places.clock / name)
