"""
Execute and measure the lessons: the sources in solutions/ and the releases in notebooks/.

Each notebook runs once, in a copy, because its cells write a ROS workspace next to it.  A release
whose code is that of its solved lesson is not run again.
"""

import asyncio
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import ExitStack
from dataclasses import dataclass
from functools import cache
import os
from pathlib import Path
import re
from statistics import median
import tempfile
import time
from typing import Any

from nbclient import NotebookClient
import nbformat
import pytest
import yaml

from autograder.exam import catalog
from autograder.layout import lesson_files
from autograder.submission.cells import UNSOLVED
from autograder.submission.outline import read_outline
from roslab import gallery
from tests.claims import coverage
from tests.notebooks.portions import portions
from tests.own_domain import own_domain

ROOT = Path(__file__).resolve().parents[2]
LESSONS = lesson_files(ROOT / 'solutions')
START_HERE = ROOT / 'notebooks' / 'START_HERE.ipynb'
RELEASES = [START_HERE, *lesson_files(ROOT / 'notebooks')]

GALLERY_LESSON = next(path for path in LESSONS if path.parent.name == gallery.LESSON)
GALLERY_ROWS = {row['key']: row for row in yaml.safe_load(gallery.FILE.read_text('utf-8'))}
TERMINAL_COLOURS = re.compile(r'\x1b\[[0-9;]*m')

TAUGHT = coverage.cells()
SHOWS = {claim: entry['shows'] for claim, entry in coverage.claims().items() if 'shows' in entry}
"""A pattern for what a learner sees, by claim; ``tests/claims/points.yaml`` explains it."""

KERNEL = 'ros2_jazzy'
MOST_SECONDS = 60
MOST_SECONDS_FOR_A_CELL = 400  # beyond the limit of a message build, 300 s
BUSY = 1.5
"""Processes per core; above this load, a wall-clock time says nothing about the lesson."""

lessons = pytest.mark.parametrize('path', LESSONS, ids=lambda path: path.stem)
releases = pytest.mark.parametrize('path', RELEASES, ids=lambda path: path.stem)


def executed(test: Callable[..., None]) -> Callable[..., None]:
    """Mark a test that runs a notebook in the course's kernel."""
    return pytest.mark.ros(pytest.mark.notebooks(pytest.mark.slow(test)))


@dataclass(frozen=True)
class Run:
    """
    The result of executing a notebook.

    :param cells: the code cells, with their outputs
    :param seconds: wall-clock time, kernel start and end included [s]
    :param load: processes per core when the execution ended
    """

    cells: list[nbformat.NotebookNode]
    seconds: float
    load: float

    def outputs(self, kind: str) -> list[tuple[str, nbformat.NotebookNode]]:
        """Return all outputs of one type, each with the id of its cell."""
        return [
            (cell.id, output)
            for cell in self.cells
            for output in cell.outputs
            if output.output_type == kind
        ]


AT_ONCE = 2
"""Notebooks that run side by side; most of the time they wait for something."""


@pytest.fixture(scope='module', autouse=True)
def executions(request: pytest.FixtureRequest) -> Iterator[None]:
    """Start all notebooks that the chosen tests need; ``run`` waits for one of them."""
    wanted = [
        path
        for item in request.session.items
        if item.path == Path(__file__) and item.get_closest_marker('notebooks')
        for path in lessons_of(item.callspec.params)
    ]
    with ThreadPoolExecutor(AT_ONCE) as pool:
        for path in wanted:
            if code_of(path) not in _begun:
                _begun[code_of(path)] = pool.submit(execute, path)
        yield
        pool.shutdown(cancel_futures=True)


def lessons_of(params: dict[str, Any]) -> list[Path]:
    """Return the notebooks that a test with these parameters needs."""
    if 'claim' in params:
        return [place_of(where)[0] for where in TAUGHT[params['claim']]]
    return [params.get('path', GALLERY_LESSON)]


def place_of(where: str) -> tuple[Path, str]:
    """Return the lesson and the id of a cell that is named as ``lesson#cell-id``."""
    lesson, cell = where.split('#')
    return next(path for path in LESSONS if path.parent.name == lesson), cell


_begun: dict[tuple[str, ...], Future[Run]] = {}


def run(path: Path) -> Run:
    """Return the result of a notebook's code, which is executed once."""
    return _begun[code_of(path)].result()


@cache
def code_of(path: Path) -> tuple[str, ...]:
    """Return the code of a notebook that a kernel executes."""
    return tuple(cell.source for cell in read(path) if cell.cell_type == 'code')


def execute(path: Path) -> Run:
    """Execute a copy of a notebook to its end, even if cells raise exceptions."""
    notebook = nbformat.read(path, as_version=4)
    environment = dict(os.environ)
    environment.pop('PYTEST_CURRENT_TEST', None)  # with it, the output of C code is missing
    with tempfile.TemporaryDirectory() as folder, ExitStack() as until:
        # Messages of other kernels on this machine must not arrive.
        environment['ROS_DOMAIN_ID'] = str(own_domain(until))
        client = NotebookClient(
            notebook,
            kernel_name=KERNEL,
            timeout=MOST_SECONDS_FOR_A_CELL,
            allow_errors=True,
            resources={'metadata': {'path': folder}},
        )
        began = time.monotonic()
        asyncio.run(client.async_execute(env=environment))
        seconds = time.monotonic() - began
    load = os.getloadavg()[0] / (os.cpu_count() or 1)
    return Run([cell for cell in notebook.cells if cell.cell_type == 'code'], seconds, load)


def read(path: Path) -> list[nbformat.NotebookNode]:
    notebook = nbformat.read(path, as_version=4)
    nbformat.validate(notebook)
    return notebook.cells


def grader_data(cell: nbformat.NotebookNode) -> dict:
    """Return nbgrader's metadata of a cell, empty for a plain cell."""
    return cell.metadata.get('nbgrader', {})


@lessons
@executed
def test_lesson_executed_raises_nothing(path: Path) -> None:
    raised = [(where, error.ename, error.evalue) for where, error in run(path).outputs('error')]

    assert raised == []


@lessons
@executed
def test_lesson_executed_leaves_stderr_empty(path: Path) -> None:
    """A solved lesson writes nothing to stderr, which nbgrader would read as a failed cell."""
    written = [
        (where, output.text)
        for where, output in run(path).outputs('stream')
        if output.name == 'stderr'
    ]

    assert written == []


@lessons
@executed
def test_lesson_executed_passes_its_own_checks(path: Path) -> None:
    result = run(path)
    said = {where: output.text for where, output in result.outputs('stream')}
    checked = [cell.id for cell in result.cells if cell.source.startswith('check(')]

    for where in checked:
        points = re.search(r'(\d+) of (\d+) points', said.get(where, ''))

        assert points is not None, (where, said.get(where))
        assert points[1] == points[2], said[where]


def shown(where: str) -> str:
    """Return what a learner sees below a cell: text without terminal colours."""
    path, cell = place_of(where)
    said = ''
    for output in next(one.outputs for one in run(path).cells if one.id == cell):
        if output.output_type == 'stream':
            said += output.text
        elif output.output_type == 'error':
            said += f'{output.ename}: {output.evalue}\n'
        else:
            said += output.data.get('text/plain', '') + '\n'
    # The output of `!` has the line ends of a terminal.
    return TERMINAL_COLOURS.sub('', said).replace('\r\n', '\n')


@executed
@pytest.mark.parametrize('claim', SHOWS)
def test_claim_is_shown_where_it_is_taught(claim: str) -> None:
    said = ''.join(shown(where) for where in TAUGHT[claim])

    assert re.search(SHOWS[claim], said), said


@lessons
@executed
def test_lesson_executed_is_quick(path: Path) -> None:
    """A lesson takes less than a minute on an idle machine."""
    done = run(path)
    seconds = done.seconds
    if seconds >= MOST_SECONDS and done.load > BUSY:
        pytest.skip(
            f'{seconds:.0f} s on a machine with {done.load:.1f} processes per core says nothing'
        )

    assert seconds < MOST_SECONDS


@releases
@executed
def test_release_executed_raises_only_not_implemented(path: Path) -> None:
    code = [cell for cell in read(path) if cell.cell_type == 'code']
    to_be_written = any(UNSOLVED in cell.source for cell in code)
    result = run(path)
    raised = [(where, error.ename) for where, error in result.outputs('error')]
    stderr = [item for item in result.outputs('stream') if item[1].name == 'stderr']

    assert {name for _, name in raised} == ({'NotImplementedError'} if to_be_written else set()), (
        raised
    )
    assert stderr == []


@executed
@pytest.mark.parametrize('path', [START_HERE], ids=['START_HERE'])
def test_start_here_shows_a_row_for_each_lesson(path: Path) -> None:
    """A line above the rows shows the maximum points of all visible checks."""
    (text,) = (output.text for _, output in run(path).outputs('stream'))
    lessons = [read_outline(lesson) for lesson in RELEASES[1:]]
    first, _, _, *rows = text.splitlines()
    visible = (catalog.load(name, hidden=False) for name in catalog.names(hidden=False))

    assert f' of {sum(exam.max_points for exam in visible):g} points; ' in first
    assert len(rows) == len(lessons)
    for row, lesson in zip(rows, lessons):
        assert row.startswith(f'{lesson.number} {lesson.title}  ')


def shown_in_gallery(key: str) -> str:
    """Return the output of a cell of the executed gallery of errors, as one line."""
    outputs = next(cell.outputs for cell in run(GALLERY_LESSON).cells if cell.id == key)
    said = [
        output.text if output.output_type == 'stream' else output.data.get('text/plain', '')
        for output in outputs
        if output.output_type != 'display_data'
    ]
    return TERMINAL_COLOURS.sub('', ' '.join(' '.join(said).split()))


@executed
@pytest.mark.parametrize('entry', gallery.entries(), ids=lambda entry: entry.key)
def test_cell_of_the_gallery_prints_what_its_entry_says(entry: gallery.Entry) -> None:
    """The cell prints the message of its entry, and no other entry matches it better."""
    text = shown_in_gallery(entry.key)

    if 'shows' in GALLERY_ROWS[entry.key]:
        assert re.search(GALLERY_ROWS[entry.key]['shows'], text), text
    else:
        assert gallery.nearest(text)[:1] == [entry], text


@lessons
def test_lesson_has_its_release(path: Path) -> None:
    assert (ROOT / 'notebooks' / path.parent.name / path.name).is_file()


@lessons
def test_lesson_is_stored_clean(path: Path) -> None:
    """A source has the course's kernel, readable cell ids and no outputs."""
    notebook = nbformat.read(path, as_version=4)
    code = [cell for cell in notebook.cells if cell.cell_type == 'code']

    assert (notebook.nbformat, notebook.nbformat_minor) == (4, 5)
    assert notebook.metadata.kernelspec == {
        'display_name': 'ROS 2 Jazzy',
        'language': 'python',
        'name': KERNEL,
    }
    assert [cell.id for cell in code if cell.outputs or cell.execution_count] == []
    assert [cell.id for cell in notebook.cells if not re.fullmatch(r'[a-z0-9-]+', cell.id)] == []
    assert len({cell.id for cell in notebook.cells}) == len(notebook.cells)


@lessons
def test_lesson_comes_in_small_portions(path: Path) -> None:
    assert list(portions(nbformat.read(path, as_version=4)).problems()) == []


def test_course_comes_in_small_portions() -> None:
    """The median text cell of all lessons has at most 40 words, the median code cell 4 lines."""
    found = [portions(nbformat.read(path, as_version=4)) for path in LESSONS]

    assert median(words for one in found for words in one.words) <= 40
    assert median(lines for one in found for lines in one.lines) <= 4


def test_grade_ids_are_unique_in_the_course() -> None:
    ids = [
        grader_data(cell)['grade_id']
        for path in LESSONS
        for cell in read(path)
        if grader_data(cell)
    ]

    assert {name: ids.count(name) for name in ids if ids.count(name) > 1} == {}
    assert [name for name in ids if not re.fullmatch(r'[a-z][a-z0-9_]*', name)] == []


@lessons
def test_grade_cell_holds_one_readable_line(path: Path) -> None:
    """The notebook names the exam but does not contain its checks."""
    for cell in read(path):
        data = grader_data(cell)
        if cell.cell_type == 'code' and data.get('grade'):
            exam = data['grade_id'].removeprefix('check_')

            assert cell.source == f"check('{exam}')"
            assert data['locked']
            assert data['points'] > 0
            assert not data['solution']


@lessons
def test_solution_marks_are_in_solution_cells_only(path: Path) -> None:
    """Code that a learner has to write is in a cell that nbgrader clears."""
    for cell in read(path):
        marked = 'BEGIN SOLUTION' in cell.source

        assert not marked or grader_data(cell).get('solution'), cell.id
        assert UNSOLVED not in cell.source or cell.cell_type == 'markdown', cell.id


@releases
def test_release_shows_no_solution(path: Path) -> None:
    for cell in read(path):
        data = grader_data(cell)

        assert 'SOLUTION' not in cell.source, cell.id
        if data.get('solution'):
            assert UNSOLVED in cell.source or 'YOUR ANSWER HERE' in cell.source, cell.id
