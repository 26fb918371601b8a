"""
Run the exams of the course on a single submission, for an instructor.

The submission is a script, a package folder, a zip of such a folder, or a notebook.  Exams,
sandbox and messages are the same as for a class, but nothing is entered in the gradebook.  A
package with build files is built, and its executables run.  In any other folder, the node file
runs with the other files next to it.
"""

import argparse
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
import sys
from typing import Any

from autograder.commands import flag, FRESH, JSON, OK, option, show, takes, VISIBLE
from autograder.commands.check import sandbox_for
from autograder.errors import GraderError
from autograder.exam import catalog
from autograder.exam.exam import Exam
from autograder.explaining.feedback import exam_text, number, printable
from autograder.explaining.live import live_line
from autograder.grading.built_package import as_package, explained, package_name
from autograder.grading.examine import Engine
from autograder.grading.pipeline import THREADS
from autograder.layout import Layout
from autograder.recording import Recording
from autograder.results import ExamResult, Problem
from autograder.submission.notebook import read_release
from autograder.submission.package import (
    describe_files,
    name_missing,
    read_upload,
    with_node_files,
)
from autograder.submission.reading import UnusableUploadError
from autograder.submission.submission import files_in_notebook


@takes(
    option('path', 'script, package folder, zip file or notebook', type=Path, metavar='PATH'),
    option(
        '--exam',
        'exam (such as talker) or assignment (such as topics)',
        required=True,
        metavar='NAME',
    ),
    VISIBLE,
    flag('--live', 'print events as they happen'),
    FRESH,
    JSON,
)
def run(chosen: argparse.Namespace) -> int:
    """Run the chosen exams on one submission and print the results."""
    layout = Layout.here()
    found = exams_named(chosen.exam, layout, hidden=not chosen.visible)
    tasks = find_tasks(chosen.path, found, layout)
    engine = Engine(
        sandbox_for(chosen.visible),
        layout.recordings,
        fresh=chosen.fresh or chosen.live,
        on_event=_show if chosen.live else None,
    )
    results = []
    for task, result in run_tasks(tasks, engine):
        results.append(result)
        if not chosen.json:
            head = printable(f'{task.exam.title} ({task.exam.name}): ')
            print(head + exam_text(result, task.problems))
    as_json = [result.to_json() for result in results]
    show(chosen.json, as_json, summary(results, chosen.visible))
    return OK


def _show(event: Any) -> None:
    """Print an event to stderr as it happens; stdout may be reserved for JSON."""
    line = live_line(event)
    if line:
        print(line, file=sys.stderr, flush=True)


@dataclass(frozen=True)
class ExamTask:
    """An exam, the files on which it runs (by path), and the problems of a notebook's cells."""

    exam: Exam
    files: Mapping[str, str]
    problems: tuple[Problem, ...] = ()
    notebook: bool = False


def short_name(assignment: str) -> str:
    """Return the name of an assignment without its number: ``topics`` for ``03_topics``."""
    return assignment.partition('_')[2] if assignment[:1].isdigit() else assignment


def exams_named(name: str, layout: Layout, hidden: bool) -> tuple[Exam, ...]:
    """
    Return one exam, or all exams of an assignment.

    :param name: name of an exam, or of an assignment with or without its number
    :raises GraderError: if no exam or assignment has this name; the error suggests a similar one
    """
    lessons = {one: catalog.for_assignment(one, hidden) for one in layout.assignments()}
    # Of two assignments with one short name, the first one counts.
    known = {short_name(one): exams for one, exams in reversed(lessons.items()) if exams}
    known |= {exam.name: (exam,) for exams in lessons.values() for exam in exams}
    if found := known.get(name) or lessons.get(name):
        return found
    close = get_close_matches(name, known, n=1, cutoff=0.4)
    hint = f'Did you mean {close[0]}?' if close else f'Known: {", ".join(sorted(known))}.'
    raise GraderError(f'--exam {name}: there is no such exam or assignment.', hint)


def find_tasks(path: Path, chosen: Sequence[Exam], layout: Layout) -> list[ExamTask]:
    """
    Return the exams that can run on a submission, each with its files.

    :raises UnusableUploadError: if the submission has no file for any of these exams
    """
    if not path.exists():
        raise UnusableUploadError(f'{path}: there is no such file or folder.')
    if path.suffix == '.ipynb':
        release = read_release(layout.release(chosen[0].assignment))
        return [
            ExamTask(exam, found.files, found.problems, notebook=True)
            for exam, found in files_in_notebook(path, release, chosen)
        ]
    files = read_upload(path)
    script = path.suffix == '.py' and not path.is_dir()
    package = '' if script else package_name(files)
    found = []
    for exam in chosen:
        wanted = [name for name in {exam.scenario.file, *exam.requires} if name]
        theirs = with_node_files(files, wanted)
        nodes = [name for name in wanted if name.endswith('.py')]
        if len(chosen) == 1 and script and len(nodes) == 1:
            theirs = {nodes[0]: files[path.name]}  # A script may have any name.
        # Any file of a package may define the executable.
        runs = bool(package) and exam.scenario.program == 'node'
        if len(chosen) == 1 or runs or any(name in theirs for name in exam.requires):
            found.append(ExamTask(as_package(exam, package) if package else exam, theirs))
    if not found:
        wanted = sorted({name for exam in chosen for name in exam.requires})
        raise UnusableUploadError(
            f'{path}: expected one of {", ".join(wanted)}, got {describe_files(files)}.',
            'Try: --exam with the name of one exam; then the script may have any name.',
        )
    return found


def run_tasks(found: Sequence[ExamTask], engine: Engine) -> Iterator[tuple[ExamTask, ExamResult]]:
    """Run the exams in parallel, or one after another if their events are shown."""

    def run(task: ExamTask) -> ExamResult:
        if engine.on_event and task.exam.scenario.program in ('build', 'package'):
            engine.on_event({'event': 'mark', 'clock_ns': None, 'name': 'building with colcon'})
        result = engine.run(task.exam, task.files)
        if task.notebook:
            return result if task.problems else name_missing(result, task.files)
        recording = None
        if engine.recordings and result.recording:
            recording = Recording.load(engine.recordings / task.exam.name / result.recording)
        return explained(task.exam, name_missing(result, task.files), recording, task.files)

    workers = 1 if engine.on_event else len(found)
    pool = ThreadPoolExecutor(max_workers=workers, thread_name_prefix=THREADS)
    try:
        yield from zip(found, pool.map(run, found))
    finally:
        pool.shutdown(wait=False, cancel_futures=True)  # After Ctrl-C, main() ends the runs.


def summary(results: Sequence[ExamResult], visible: bool) -> str:
    """Return the total of all exams as text, which is the last line of the output."""
    points = number(sum(one.points for one in results))
    most = number(sum(one.max_points for one in results))
    modes = ', '.join(sorted({one.mode for one in results if one.mode})) or 'nothing was run'
    kind = 'visible checks' if visible else 'full exams'
    return f'Total: {points} of {most} points; {kind}; isolation: {modes}.'
