"""Imports in the grader go one way: a folder imports only from the folders below it."""

import ast
from collections import Counter
from collections.abc import Iterator
from functools import cache
from graphlib import TopologicalSorter
from pathlib import Path
import re

import pytest

from autograder.layout import Layout

ROOT = Path(__file__).resolve().parents[2]
GRADER = ROOT / 'autograder'
MOST_MODULES = 12


@cache
def modules() -> dict[str, Path]:
    """Return the file of each module of the grader, by its dotted name."""
    found = {}
    for path in GRADER.rglob('*.py'):
        name = '.'.join(path.relative_to(ROOT).with_suffix('').parts)
        found[name.removesuffix('.__init__')] = path
    return found


def imported(path: Path) -> Iterator[str]:
    """Yield the modules of the grader that a file imports, even inside functions."""
    for node in ast.walk(ast.parse(path.read_text(encoding='utf-8'))):
        if isinstance(node, ast.ImportFrom) and node.module:
            inner = [f'{node.module}.{one.name}' for one in node.names]
            names = [one for one in inner if one in modules()] or [node.module]
        elif isinstance(node, ast.Import):
            names = [one.name for one in node.names]
        else:
            continue
        yield from (name for name in names if name in modules())


def floor_of(module: str) -> str:
    """Return the folder or module directly below ``autograder`` that a module belongs to."""
    return module.split('.')[1] if '.' in module else ''


def imported_by(floor: str) -> set[tuple[str, str]]:
    """Return the modules of a folder with the other modules of the grader that they import."""
    return {
        (name, other)
        for name, path in modules().items()
        if floor_of(name) == floor
        for other in imported(path)
    }


def order() -> list[str]:
    """Return the folders and modules from the top, as ARCHITECTURE.md draws them."""
    text = (ROOT / 'ARCHITECTURE.md').read_text(encoding='utf-8')
    block = text.partition('```\nautograder/\n')[2].partition('```')[0]
    return re.findall(r'^  (\w+) ', block, re.MULTILINE)


def test_the_drawing_has_every_folder_and_module():
    there = {floor_of(name) for name in modules()} - {''}

    assert sorted(order()) == sorted(there)


@pytest.mark.parametrize('floor', order())
def test_a_folder_imports_only_what_stands_below_it(floor):
    allowed = {'', *order()[order().index(floor) :]}

    assert {pair for pair in imported_by(floor) if floor_of(pair[1]) not in allowed} == set()


def test_no_file_imports_itself_through_others():
    """Modules that import each other are, in effect, one module in several files."""
    TopologicalSorter(
        {name: set(imported(path)) - {name} for name, path in modules().items()}
    ).prepare()


@pytest.mark.parametrize('floor', ['probe', 'inside'])
def test_what_enters_a_sandbox_imports_nothing_of_the_project(floor):
    """The sandbox contains only the source text of these modules."""
    assert imported_by(floor) == set()


def test_no_folder_has_more_modules_than_can_be_seen_at_once():
    paths = [path for path in modules().values() if path.name != '__init__.py']
    counts = Counter(path.parent.relative_to(GRADER).as_posix() for path in paths)
    too_many = {name: count for name, count in counts.items() if count > MOST_MODULES}

    assert too_many == {}


def test_the_grader_knows_no_course():
    """The names of this course are in course.toml and in its exams."""
    texts = {path: path.read_text('utf-8') for path in GRADER.rglob('*.py')}
    package = Layout(ROOT).facts.package

    assert [str(path) for path, text in texts.items() if package in text] == []
    assert [str(path) for path, text in texts.items() if 'from exams' in text] == []


def test_exams_import_only_what_judges_and_explains():
    """An exam cannot start a run, and knows no gradebook or class."""
    allowed = {*order()[order().index('explaining') :]}
    used = {
        (path.name, other)
        for path in (ROOT / 'exams').rglob('*.py')
        for other in imported(path)
        if floor_of(other) not in allowed
    }

    assert used == set()
