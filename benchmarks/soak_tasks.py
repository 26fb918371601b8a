"""
Collect the tasks of the soak test: a fixed panel, or all submissions and attacks.

A task is one exam on one set of files.  The panel is listed in ``panel.yaml``; ``everything``
contains each exam of each submission in ``tests/submissions`` and each program in
``tests/attacks``.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from pathlib import Path

import yaml

from autograder.authoring.sample_class import compose, samples
from autograder.exam import catalog
from autograder.exam.exam import Exam
from autograder.grading.pipeline import load_lesson, SandboxEngine
from autograder.layout import Layout
from autograder.sandboxes.choose import strongest
from autograder.submission.extract import extract
from autograder.submission.submission import open_submission
from tests.attacks.corpus import files_of, programs

PANEL = Path(__file__).with_name('panel.yaml')
ENDED = ('limit', 'ended', 'busy')


@dataclass(frozen=True)
class Task:
    """
    One exam applied to one set of files.

    :param bound: maximum points for a result that is only compared with a bound, else None
    :param slow: whether it takes much longer than others
    """

    name: str
    exam: Exam
    files: tuple[tuple[str, str], ...]
    bound: float | None = None
    slow: bool = False


def panel() -> list[Task]:
    """
    Return the tasks of the panel, in the order of the file.

    :raises SystemExit: if the panel contains an unknown task
    """
    names = [
        name
        for group in yaml.safe_load(PANEL.read_text(encoding='utf-8')).values()
        for name in group
    ]
    found = {task.name: task for task in everything(names)}
    missing = [name for name in names if name not in found]
    if missing:
        raise SystemExit(
            f'{PANEL.name}: no such task: {", ".join(missing)}.\n'
            'Try: python -m benchmarks.soak --everything --list'
        )
    return [found[name] for name in names]


def everything(names: Collection[str] = ()) -> list[Task]:
    """
    Return all tasks.

    :param names: restrict the search to folders that can contain these tasks; empty for all
    """
    layout = Layout.here()
    folders = {name.split('/')[0] for name in names}
    tasks: list[Task] = []
    for folder in (*layout.assignments(), 'attack'):
        if not names or folder in folders:
            tasks += _attacks() if folder == 'attack' else _submissions(layout, folder, names)
    return tasks


def _submissions(layout: Layout, assignment: str, names: Collection[str]) -> Iterator[Task]:
    """Yield every exam on the files of every submission; equal files give one task."""
    lesson = load_lesson(layout, assignment, SandboxEngine(strongest()))
    wanted = {tuple(name.split('/')[:2]) for name in names}
    known = set()
    for sample in samples(layout, assignment, everything=True):
        if wanted and (assignment, sample.name) not in wanted:
            continue
        opened = open_submission(compose(layout, assignment, sample), lesson.release, 'it')
        found = extract(opened, lesson.exams, lesson.release, lesson.notebook)
        for exam in lesson.exams:
            files = tuple(sorted(found[exam.name].files.items()))
            if (exam.name, files) not in known:
                known.add((exam.name, files))
                name = f'{assignment}/{sample.name}/{exam.name}'
                yield Task(name, exam, files, slow=exam.scenario.program == 'build')


def _attacks() -> Iterator[Task]:
    """Yield a task for every program in ``tests/attacks``."""
    for attack in programs():
        files = tuple(sorted(files_of(attack).items()))
        bound = attack.points if attack.at_most else None
        name, exam = f'attack/{attack.kind}/{attack.name}', catalog.load(attack.kind)
        # A flag about a limit, or a bound, means that the program runs until the grader ends it.
        slow = bound is not None or any(word in str(attack.flags) for word in ENDED)
        yield Task(name, exam, files, bound, slow or exam.scenario.program == 'build')
