"""
Read the descriptions of the attacks, and grade those that are programs.

A folder named like an exam contains programs that are submitted for it.  Each begins with a
docstring that has these fields, one per line or paragraph::

    Tries: what it tries to do.
    Stopped by: what prevents this
    Deserves: 15            the points of its honest part; "15 at most" if they vary
    Flag: same name         words that the instructor must see; several lines, or none
    Ends: cpu_limit         the reason why its run must end, or none

A program may import and modify ``honest``, the honest solution in ``honest/``, and import
``participants`` from that folder.
"""

import ast
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
import re
from typing import Any
from unittest import mock

from autograder.exam import catalog
from autograder.grading.examine import Engine
from autograder.layout import Layout
from autograder.recording import Recording
from autograder.results import ExamResult
from autograder.runs import observe, watchdog
from autograder.runs.program import program_for
from autograder.sandboxes.confinement import Limits, Program
from autograder.sandboxes.sandbox import Sandbox
from autograder.submission.notebook import read_release
from autograder.submission.submission import answer_files
from environment.ros import RosEnvironment

FOLDER = Path(__file__).parent
CANARY = 'CANARY-7f3a9c'
"""A string placed wherever a program must not be able to read."""

NOTEBOOKS = 'notebooks'
_FIELD = re.compile(r'^(Tries|Stopped by|Deserves|Flag|Ends): (.+(?:\n[ ]+.+)*)', re.MULTILINE)
POINTS = re.compile(r'(\d+)( at most)?')


@dataclass(frozen=True)
class Attack:
    """
    A malicious submission.

    :param kind: an exam, or ``notebooks``
    :param points: the points that its honest part deserves and gets
    :param at_most: whether the points are an upper bound
    :param flags: words that the instructor must see
    :param ends: the reason why its run must end, empty if the file states none
    :param path: file of a program
    """

    name: str
    kind: str
    tries: str
    stopped_by: str
    points: float
    at_most: bool = False
    flags: tuple[str, ...] = ()
    ends: str = ''
    path: Path = FOLDER


def read(path: Path) -> Attack:
    """
    Read the description of an attack from its file.

    :raises ValueError: if a field is missing
    """
    text = path.read_text(encoding='utf-8')
    if path.suffix == '.py':
        about = ast.get_docstring(ast.parse(text)) or ''
    else:
        about = '\n'.join(line[2:] for line in text.splitlines() if line.startswith('# '))
    fields: dict[str, list[str]] = {}
    for name, value in _FIELD.findall(about):
        fields.setdefault(name, []).append(' '.join(value.split()))
    missing = {'Tries', 'Stopped by', 'Deserves'} - set(fields)
    points = POINTS.fullmatch(fields.get('Deserves', [''])[0])
    if missing or not points:
        raise ValueError(f'{path}: expected Tries, Stopped by and Deserves, lacks {missing}')
    return Attack(
        path.stem,
        path.parent.name,
        fields['Tries'][0],
        fields['Stopped by'][0],
        float(points[1]),
        bool(points[2]),
        tuple(fields.get('Flag', ())),
        fields.get('Ends', [''])[0],
        path,
    )


def programs() -> list[Attack]:
    """Return all attacks that are programs, in the order of their folders and names."""
    paths = [path for path in sorted(FOLDER.glob('*/*')) if path.suffix in ('.py', '.cmake')]
    return [read(path) for path in paths if path.parent.name != 'honest']


@dataclass(frozen=True)
class Outcome:
    """
    The outcome of grading a program.

    :param result: None if the grader declined to judge, which is a fault of the grader
    :param recording: None if there is none
    :param fault: why there is no result
    :param took_s: real time from start to end, while other runs compete [s]
    """

    result: ExamResult | None
    recording: Recording | None
    fault: str = ''
    took_s: float = 0.0


def grade(attack: Attack, sandbox: Sandbox, kept: Path) -> Outcome:
    """
    Grade a program with the hidden exam that it attacks, in a separate sandbox.

    :param kept: folder for recordings
    """
    exam = catalog.load(attack.kind)
    # Put the canary into the exam's facts, which a program must never see.
    exam.facts['canary'] = CANARY
    folder = kept / attack.kind / attack.name
    result = Engine(sandbox, folder).run(exam, files_of(attack))
    found = list(folder.rglob('*.jsonl'))
    return Outcome(result, Recording.load(found[0]) if found else None)


def files_of(attack: Attack) -> dict[str, str]:
    """Return the submitted files: the attack and the honest modules that it imports."""
    text = attack.path.read_text(encoding='utf-8')
    if attack.path.suffix == '.cmake':
        assignment = catalog.load(attack.kind).assignment
        return {**reference(assignment), 'CMakeLists.txt': text}
    files = {catalog.load(attack.kind).requires[0]: text}
    for module, name in (('honest', attack.kind), ('participants', 'participants')):
        if f'import {module}\n' in text:
            files[f'{module}.py'] = (FOLDER / 'honest' / f'{name}.py').read_text(encoding='utf-8')
    return files


def reference(assignment: str) -> dict[str, str]:
    """Return the files of the reference solution."""
    course = Layout.here()
    path = course.solutions / assignment / course.release(assignment).name
    return {file.path: file.body for file in answer_files(read_release(path)).values()}


@contextmanager
def early_limits() -> Iterator[None]:
    """Lower only the limits of CPU time, so that runs reach them sooner."""

    def limited(
        scenario: Mapping[str, Any], submission: Path, ros: RosEnvironment
    ) -> tuple[Program, Limits]:
        program, limits = program_for(scenario, submission, ros)
        if scenario['program'] == 'build':
            return program, limits
        return program, replace(limits, cpu_s=4)

    sooner = mock.patch.multiple(watchdog, PROBE_S=3.0, BUSY_SHARE=0.0)
    with mock.patch.object(observe, 'program_for', limited), sooner:
        yield
