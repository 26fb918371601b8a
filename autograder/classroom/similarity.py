"""
List similar submissions for an instructor to compare; similarity is never a verdict.

Comments, docstrings, spacing, names that the file defines and lines of the release are ignored.
Rapidfuzz compares the tokens of the rest, with the lines sorted.  So neither renaming nor moving
code hides a copy.  If a lesson asks for nodes of the course's finished package, submissions are
also compared with this package.  The score of a typical pair shows how similar all answers to the
exercise are.  No submitted code runs.
"""

import ast
from collections import Counter
from collections.abc import Iterator, Mapping
from copy import copy
from itertools import chain, combinations
from pathlib import Path
import re
import statistics
from typing import NamedTuple

from autograder.errors import GraderError
from autograder.grading.pipeline import Lesson, load_lesson, open_one
from autograder.layout import Layout
from autograder.submission.code.program import NotPythonError, parsed
from autograder.submission.inbox import discover
from autograder.submission.notebook import Notebook
from autograder.submission.submission import Opened

MOST = 50
"""Maximum number of listed pairs."""
SHORTEST = 40
"""Minimum number of tokens of the student's own code; shorter answers are often equal."""
NOT_COMPARED = ('answers/', 'msg/', 'package.xml', 'CMakeLists.txt')
"""Prefixes of paths that are not compared, because all correct versions are equal."""
NAME = re.compile(r'\w+')
TOKEN = re.compile(r"""[bf]?(?P<quote>['"]).*?(?<!\\)(?P=quote)|\w+|[^\w\s]=?""")
"""A string literal is one token, as in Python's own tokenizer."""
STORE = ast.Store()
BELOW = ('body', 'orelse', 'handlers', 'finalbody', 'cases')
"""Fields of syntax nodes that contain nested statements."""
Tokens = tuple[str, ...]
"""The tokens of one statement without its nested statements, or of one line of any other file."""


class Pair(NamedTuple):
    """
    Two similar submissions.

    :param score: 0 to 1
    :param common: number of lines that both have, apart from names
    """

    score: float
    first: str
    second: str
    common: int


class Similar(NamedTuple):
    """
    The result of comparing one assignment.

    :param compared: number of submissions with enough code of their own
    :param typical: median score of all pairs, None if there is no pair
    :param pairs: at most :data:`MOST` pairs, the most similar first
    :param more: number of further pairs that are similar enough
    """

    compared: int
    short: list[str]
    typical: float | None
    pairs: list[Pair]
    more: int


# -- from submissions to lines ------------------------------------------------------------------


def similar(layout: Layout, assignment: str, submitted: Path, at_least: float) -> Similar:
    """
    Compare all submissions of an assignment, which are named by their student.

    :param at_least: minimum score of a listed pair, 0 to 1
    :raises GraderError: if there is no submission, or the folder cannot be read
    """
    lesson = load_lesson(layout, assignment)
    try:
        there = discover(submitted, assignment, lesson.notebook, layout.assignments())
    except OSError as error:
        raise GraderError(f'{submitted}: the folder cannot be read: {error.strerror}.') from error
    if not there:
        raise GraderError(f'{submitted}: there are no submissions for {assignment}.')
    answers = {}
    for one in there:
        answers[one.student] = _answers(open_one(one, lesson), lesson)
    package = finished_package(layout, lesson)
    return compare(answers, given_lines(lesson.release), at_least, package)


def finished_package(layout: Layout, lesson: Lesson) -> dict[str, dict[str, str]]:
    """Return the nodes of the course's package that the lesson asks for, and all modules in it."""
    package = layout.facts.package
    modules = {
        path.name: path.read_text(encoding='utf-8')
        for path in sorted((layout.root / package / package).glob('*.py'))
    }
    asked = {name for exam in lesson.exams for name in exam.requires if name in modules}
    if not asked or not package:
        return {}
    nodes = {name: modules[name] for name in sorted(asked)}
    return {f'{package} (nodes)': nodes, f'{package} (all)': modules}


def _answers(opened: Opened, lesson: Lesson) -> dict[str, str]:
    """Return the files of a submission that are compared."""
    files: dict[str, str] = {}
    for found in lesson.files(opened).values():
        files.update(found.files)
    return {
        path: text for path, text in sorted(files.items()) if not path.startswith(NOT_COMPARED)
    }


def given_lines(release: Notebook) -> frozenset[Tokens]:
    """Return every line of code that students received with the notebook."""
    return frozenset(
        line
        for cell in release['cells']
        if cell['cell_type'] == 'code'
        for line, _ in lines_of('given.py', re.sub(r'^[%!].*$', '', cell['source'], flags=re.M))
    )


def lines_of(path: str, text: str) -> list[tuple[Tokens, Tokens]]:
    """
    Return the statements of a Python file except docstrings, or the lines of any other file.

    :returns: pairs of a line as written, and with one placeholder for all names that the file
        defines
    """
    if path.endswith('.py'):
        try:
            return list(_python_lines(text))
        except (NotPythonError, RecursionError):
            pass  # Compare the lines as plain text, without replacing names.
    lines = (_tokens(line.partition('#')[0]) for line in text.splitlines())
    return [(line, line) for line in lines if line]


def _tokens(code: str) -> Tokens:
    return tuple(found[0] for found in TOKEN.finditer(code))


def _python_lines(text: str) -> Iterator[tuple[Tokens, Tokens]]:
    tree = parsed(text)
    own = {name for node in ast.walk(tree) for name in _given_names(node)}
    for statement in _statements(tree):
        head = copy(statement)
        for field in BELOW:
            if hasattr(head, field):
                setattr(head, field, [])
        code = ast.unparse(head)
        renamed = NAME.sub(lambda found: 'name' if found[0] in own else found[0], code)
        yield _tokens(code), _tokens(renamed)


def _statements(node: ast.AST) -> Iterator[ast.stmt]:
    """Yield the statements below a syntax node in order, without docstrings."""
    for child in (child for field in BELOW for child in getattr(node, field, ())):
        lone = child.value if isinstance(child, ast.Expr) else None
        if isinstance(child, ast.stmt) and not isinstance(getattr(lone, 'value', None), str):
            yield child
        yield from _statements(child)


def _given_names(node: ast.AST) -> Iterator[str]:
    """Yield the names that a syntax node assigns or defines; for imports, only names after as."""
    if isinstance(node, ast.keyword) or not isinstance(getattr(node, 'ctx', STORE), ast.Store):
        return
    for field in ('asname',) if isinstance(node, ast.alias) else ('id', 'attr', 'name', 'arg'):
        if isinstance(name := getattr(node, field, None), str):
            yield name


# -- comparing ----------------------------------------------------------------------------------


def compare(
    answers: Mapping[str, Mapping[str, str]],
    given: frozenset[Tokens],
    at_least: float,
    references: Mapping[str, Mapping[str, str]],
) -> Similar:
    """
    Compare the files of all students.

    :param answers: submission -> path -> text
    :param references: name -> path -> text of the course's own code, which is compared with the
        students' files but not with itself
    """
    from rapidfuzz.distance import Indel
    from rapidfuzz.process import cdist

    own = {
        name: sorted(
            renamed
            for path, text in files.items()
            for line, renamed in lines_of(path, text)
            if line not in given
        )
        for name, files in {**answers, **references}.items()
    }
    texts = {name: [*chain(*lines)] for name, lines in own.items()}
    short = [name for name in own if len(texts[name]) < SHORTEST]
    names = [name for name in own if name not in short]
    every = [texts[name] for name in names]
    scores = cdist(every, every, scorer=Indel.normalized_similarity).tolist()
    found = [
        (scores[one][two], first, second)
        for (one, first), (two, second) in combinations(enumerate(names), 2)
        if not {first, second} <= references.keys()
    ]
    # List each copy once, beside the first submission with the same text.
    firsts: dict[Tokens, str] = {}
    first_of = {name: firsts.setdefault(tuple(texts[name]), name) for name in names}
    alike = [
        (score, first, second)
        for score, first, second in found
        if score >= at_least and first_of[first] == first and first_of[second] in (first, second)
    ]
    alike.sort(key=lambda one: -one[0])
    return Similar(
        compared=len(answers.keys() - set(short)),
        short=short,
        typical=statistics.median(score for score, *_ in found) if found else None,
        pairs=[
            Pair(score, first, second, (Counter(own[first]) & Counter(own[second])).total())
            for score, first, second in alike[:MOST]
        ],
        more=len(alike[MOST:]),
    )
