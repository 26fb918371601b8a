"""
List similar submissions for an instructor to compare; similarity is never a verdict.

Comments, docstrings, spacing, names that the file defines and lines of the release are ignored.
Rapidfuzz compares the rest twice: token by token in order, and line by line in any order.  So
neither renaming nor moving code hides a copy.  If a lesson asks for nodes of the course's finished
package, submissions are also compared with this package.  The score of a typical pair shows how
similar all answers to the exercise are.  No submitted code runs.
"""

import ast
from collections.abc import Iterator, Mapping, Sequence
from copy import copy
from dataclasses import dataclass
from itertools import chain, combinations
from pathlib import Path
import re
import statistics

from autograder.errors import GraderError
from autograder.grading.pipeline import Lesson, load_lesson, open_one
from autograder.layout import Layout
from autograder.submission.code.program import NotPythonError, parsed
from autograder.submission.inbox import discover
from autograder.submission.notebook import Notebook
from autograder.submission.submission import Opened

MOST = 50
"""Maximum number of pairs that are shown with their common lines."""
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
WARNING = (
    'Similarity proves nothing. Small exercises have few good answers, and students may have been '
    'allowed to work together. Read both files before you speak to a student.'
)


@dataclass(frozen=True)
class Line:
    """
    One statement without its nested statements, or one line of a file that is not Python.

    :param number: number of its first line in the file, from 1
    :param raw: its tokens
    :param tokens: its tokens, with one placeholder for all names that the file defines
    """

    path: str
    number: int
    text: str
    raw: tuple[str, ...]
    tokens: tuple[str, ...]


@dataclass(frozen=True)
class Common:
    """Consecutive lines that two submissions have in common, as written in each of them."""

    path: str
    first: tuple[str, ...]
    second: tuple[str, ...]
    first_line: int
    second_line: int


@dataclass(frozen=True)
class Pair:
    """
    Two similar submissions, or two groups of equal submissions.

    :param first: students whose own code is the same
    :param second: students of the other group; empty for a single group of equal submissions
    :param score: 0 to 1
    :param renamed: share of the common lines in which only names differ
    """

    first: tuple[str, ...]
    second: tuple[str, ...]
    score: float
    renamed: float
    common: tuple[Common, ...]


@dataclass(frozen=True)
class Similar:
    """
    The result of comparing one assignment.

    :param compared: number of submissions with enough code of their own
    :param short: students with too little code of their own
    :param typical: median score of all pairs, None if there is no pair
    :param pairs: pairs with a score of at least ``at_least``, the most similar first
    :param more: number of further such pairs, which are left out
    """

    assignment: str
    compared: int
    short: tuple[str, ...]
    at_least: float
    typical: float | None
    pairs: tuple[Pair, ...]
    more: int = 0
    warning: str = WARNING


# -- from submissions to lines ------------------------------------------------------------------


def similar(layout: Layout, assignment: str, submitted: Path, at_least: float) -> Similar:
    """
    Compare all submissions of an assignment.

    :param assignment: full name of the assignment
    :param submitted: the folder of the class
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
    own = {one.student: _answers(open_one(one, lesson), lesson) for one in there}
    return compare(
        assignment, own, given_lines(lesson.release), at_least, finished_package(layout, lesson)
    )


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


def given_lines(release: Notebook) -> frozenset[tuple[str, ...]]:
    """Return every line of code that students received with the notebook."""
    return frozenset(
        line.raw
        for cell in release['cells']
        if cell['cell_type'] == 'code'
        for line in lines_of('given.py', re.sub(r'^[%!].*$', '', cell['source'], flags=re.M))
    )


def lines_of(path: str, text: str) -> list[Line]:
    """Return the statements of a Python file except docstrings, or the lines of any other file."""
    if path.endswith('.py'):
        try:
            return list(_python_lines(path, text))
        except (NotPythonError, RecursionError):
            pass  # Compare the lines as plain text, without replacing names.
    found = []
    for number, line in enumerate(text.splitlines(), start=1):
        words = tokens_of(line.partition('#')[0])
        if words:
            found.append(Line(path, number, line.strip(), words, words))
    return found


def tokens_of(code: str) -> tuple[str, ...]:
    """Return the tokens of some code."""
    return tuple(found[0] for found in TOKEN.finditer(code))


def _python_lines(path: str, text: str) -> Iterator[Line]:
    physical, tree = text.splitlines(), parsed(text)
    own = {name for node in ast.walk(tree) for name in _given_names(node)}
    for statement in _statements(tree):
        head = copy(statement)
        for field in BELOW:
            if hasattr(head, field):
                setattr(head, field, [])
        code = ast.unparse(head)
        renamed = NAME.sub(lambda found: 'name' if found[0] in own else found[0], code)
        shown = physical[head.lineno - 1].strip()
        yield Line(path, head.lineno, shown, tokens_of(code), tokens_of(renamed))


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
    assignment: str,
    answers: Mapping[str, Mapping[str, str]],
    given: frozenset[tuple[str, ...]],
    at_least: float,
    references: Mapping[str, Mapping[str, str]] | None = None,
) -> Similar:
    """
    Compare the files of all students.

    :param answers: student -> path -> text
    :param given: lines that all students received, see :func:`given_lines`
    :param references: name -> path -> text of the course's own code, which is compared with the
        students' files but not with itself
    """
    references = references or {}
    own = {
        student: [
            line
            for path, text in files.items()
            for line in lines_of(path, text)
            if line.raw not in given
        ]
        for student, files in {**answers, **references}.items()
    }
    short = tuple(
        who for who, found in own.items() if sum(len(one.tokens) for one in found) < SHORTEST
    )
    groups: dict[tuple[tuple[str, ...], ...], list[str]] = {}
    for student, found in own.items():
        if student not in short:
            groups.setdefault(tuple(line.tokens for line in found), []).append(student)
    alike: list[tuple[float, Sequence[str], Sequence[str]]] = [
        (1.0, students, ()) for students in groups.values() if len(students) > 1
    ]
    scores = []
    for score, first, second in _scores(groups):
        if not set(first) | set(second) <= references.keys():
            scores.append(score)
            alike += [(score, first, second)] if score >= at_least else []
    alike.sort(key=lambda found: (-found[0], found[1]))
    pairs = tuple(
        _pair(first, second, score, own[first[0]], own[(second or first[1:])[0]])
        for score, first, second in alike[:MOST]
    )
    compared = len(own.keys() - references.keys() - set(short))
    typical = statistics.median(scores) if scores else None
    more = max(0, len(alike) - MOST)
    return Similar(assignment, compared, short, at_least, typical, pairs, more)


def _scores(
    groups: Mapping[tuple[tuple[str, ...], ...], Sequence[str]],
) -> Iterator[tuple[float, Sequence[str], Sequence[str]]]:
    """Yield the score of each pair of groups, with the students of both."""
    from rapidfuzz.distance import Indel
    from rapidfuzz.process import cdist

    if len(groups) > 1:
        in_order, any_order = (
            cdist(texts, texts, scorer=Indel.normalized_similarity).tolist()
            for texts in ([[*chain(*lines)] for lines in groups], [sorted(one) for one in groups])
        )
        for (one, first), (two, second) in combinations(enumerate(groups.values()), 2):
            yield max(in_order[one][two], any_order[one][two]), first, second


def _pair(
    first: Sequence[str],
    second: Sequence[str],
    score: float,
    one: Sequence[Line],
    two: Sequence[Line],
) -> Pair:
    """Return a pair with its blocks of common lines, longest blocks first."""
    from rapidfuzz.distance import LCSseq

    common, same, renamed = [], 0, 0
    found = LCSseq.opcodes([line.tokens for line in one], [line.tokens for line in two])
    *blocks, _ = found.as_matching_blocks()  # The last block is empty.
    for begin, begin_of_other, size in blocks:
        left, right = one[begin : begin + size], two[begin_of_other : begin_of_other + size]
        same += size
        renamed += sum(line.raw != theirs.raw for line, theirs in zip(left, right))
        mine, other = (tuple(line.text for line in lines) for lines in (left, right))
        common.append(Common(left[0].path, mine, other, left[0].number, right[0].number))
    common.sort(key=lambda found: -len(found.first))
    return Pair(tuple(first), tuple(second), score, renamed / max(1, same), tuple(common))
