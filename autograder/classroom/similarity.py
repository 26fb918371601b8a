"""
List similar submissions: a list to look at, never a verdict.

Of each submission the code that is the student's own is compared: comments, docstrings, spacing
and names that the file itself gives are taken away, and so are lines that the release has.  What
is left is compared by rapidfuzz, twice: token by token in order, and line by line in any order, so
that neither renaming nor moving hides a copy.  The course's finished package is compared with the
students where a lesson asks for its nodes.  The score of a typical pair says how much of it is
the exercise.  Nothing of a submission is run.
"""

from __future__ import annotations

import ast
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
import io
import keyword
from pathlib import Path
import re
import statistics
import tokenize
from typing import Any

from autograder.errors import GraderError
from autograder.grading.again import NothingRuns
from autograder.grading.pipeline import Lesson, load_lesson, open_one
from autograder.layout import Layout
from autograder.submission.code.python_text import parsed
from autograder.submission.extract import extract
from autograder.submission.inbox import discover
from autograder.submission.notebook import Notebook
from autograder.submission.submission import Opened

MOST = 50
"""Pairs that are shown with what they have in common."""
SHORTEST = 40
"""If fewer tokens than this are the student's own, equal answers are not a surprise."""
NOT_COMPARED = ('answers/', 'msg/', 'package.xml', 'CMakeLists.txt')
"""Letters of a quiz and files with one right form are equal by nature."""
NO_CODES = range(0xD800, 0xE000)
"""Tokens and lines become characters, which rapidfuzz compares fastest; these are not valid."""
WORD = re.compile(r'\w+|[^\w\s]')
IN_BRACES, NAME = re.compile(r'\{[^{}]*\}'), re.compile(r'\b[^\W\d]\w*')
SKIPPED = {
    tokenize.COMMENT,
    tokenize.NL,
    tokenize.INDENT,
    tokenize.DEDENT,
    tokenize.ENCODING,
    tokenize.ENDMARKER,
}
WARNING = (
    'Similar is no proof. Small exercises have few good answers, and students may have been '
    'allowed to work together. Read both files before you talk to anybody.'
)


@dataclass(frozen=True)
class Line:
    """
    One logical line of an answer.

    :param number: of its first physical line in the file, from 1
    :param raw: its tokens as written, without comments and spacing
    :param tokens: the same without the names that the file gives
    """

    path: str
    number: int
    text: str
    raw: tuple[str, ...]
    tokens: tuple[str, ...]


@dataclass(frozen=True)
class Common:
    """Lines that two submissions have in common, as each of them wrote them."""

    path: str
    first: tuple[str, ...]
    second: tuple[str, ...]
    first_line: int
    second_line: int


@dataclass(frozen=True)
class Pair:
    """
    Two submissions, or two groups of equal ones.

    :param first: students whose own code is the same
    :param second: likewise; empty if ``first`` are equal to one another
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
    What comparing one assignment came to.

    :param compared: how many submissions had enough of their own
    :param short: who had not
    :param typical: median of all pairs' scores, None below two submissions
    :param pairs: from ``at_least`` on, the most alike first
    :param more: how many pairs are left out, because there are too many to look at
    """

    assignment: str
    compared: int
    short: tuple[str, ...]
    at_least: float
    typical: float | None
    pairs: tuple[Pair, ...]
    more: int = 0
    warning: str = WARNING

    def to_json(self) -> dict[str, Any]:
        """Return JSON types only."""
        return asdict(self)


# -- from submissions to lines ------------------------------------------------------------------


def similar(layout: Layout, assignment: str, submitted: Path, at_least: float) -> Similar:
    """
    Compare all submissions of an assignment.

    :param assignment: full name
    :param submitted: the folder of the class
    :param at_least: score from which a pair is listed, 0 to 1
    :raises GraderError: if nobody handed in anything for it
    """
    lesson = load_lesson(layout, assignment, NothingRuns())
    try:
        there = discover(submitted, assignment, lesson.notebook, layout.assignments())
    except OSError as error:
        raise GraderError(f'{submitted}: expected a folder, got: {error.strerror}.') from error
    if not there:
        raise GraderError(f'{submitted}: expected submissions of {assignment}, got none.')
    own = {one.student: _answers(open_one(one, lesson), lesson) for one in there}
    return compare(
        assignment, own, given_lines(lesson.release), at_least, finished(layout, lesson)
    )


def finished(layout: Layout, lesson: Lesson) -> dict[str, dict[str, str]]:
    """
    Return the course's own package as if it had been handed in, if the lesson asks for its nodes.

    The two forms find copies of the nodes, and copies of the nodes with the modules they import.
    """
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
    for found in extract(opened, lesson.exams, lesson.release, lesson.notebook).values():
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
        for line in lines_of('given.py', without_magic(cell['source']))
    )


def without_magic(source: str) -> str:
    """Return a cell's text with lines of notebook commands blanked."""
    return '\n'.join('' if line.startswith(('%', '!')) else line for line in source.split('\n'))


def lines_of(path: str, text: str) -> list[Line]:
    """Return the logical lines of a file; of Python, docstrings are left out."""
    if path.endswith('.py'):
        try:
            return list(_python_lines(path, text))
        except (SyntaxError, tokenize.TokenError, ValueError, RecursionError, MemoryError):
            pass  # not Python: words are compared, names as they are
    found = []
    for number, line in enumerate(text.splitlines(), start=1):
        words = tuple(WORD.findall(line.partition('#')[0]))
        if words:
            found.append(Line(path, number, line.strip(), words, words))
    return found


def _python_lines(path: str, text: str) -> Iterator[Line]:
    own, physical = given_names(text), text.splitlines()
    held: list[tokenize.TokenInfo] = []
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.NEWLINE:
            # A line of one string says nothing: it is a docstring.
            if held and not (len(held) == 1 and held[0].type == tokenize.STRING):
                number = held[0].start[0]
                shown = physical[number - 1].strip()
                raw = tuple(one.string for one in held)
                yield Line(path, number, shown, raw, tuple(_normal(one, own) for one in held))
            held = []
        elif token.type not in SKIPPED:
            held.append(token)


def _without_names(expression: str, own: frozenset[str]) -> str:
    """Return an expression of an f-string, which is not a separate token before Python 3.12."""
    return NAME.sub(lambda one: 'name' if one[0] in own else one[0], expression)


def _normal(token: tokenize.TokenInfo, own: frozenset[str]) -> str:
    """Return a token as it is compared: names of the file's own are all one."""
    if token.type == tokenize.NAME and not keyword.iskeyword(token.string):
        return 'name' if token.string in own else token.string
    if token.type == tokenize.STRING:
        quoted = token.string.lstrip('rbuRBUfF')
        text, prefix = quoted.strip('\'"'), token.string.removesuffix(quoted)
        if 'f' in prefix.lower():
            text = IN_BRACES.sub(lambda one: _without_names(one[0], own), text)
        return text
    return token.string


def given_names(text: str) -> frozenset[str]:
    """
    Return the names that a Python file itself gives to something; what it imports keeps its name.

    :raises NotPythonError: if it is none
    """
    tree = parsed(text)
    found: set[str] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            found.add(node.id)
        elif isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store):
            found.add(node.attr)
        elif isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            found.add(node.name)
        elif isinstance(node, ast.arg):
            found.add(node.arg)
        elif isinstance(node, ast.alias) and node.asname:
            found.add(node.asname)
        elif isinstance(node, ast.ExceptHandler) and node.name:
            found.add(node.name)
    return frozenset(found)


# -- comparing ----------------------------------------------------------------------------------


def compare(
    assignment: str,
    answers: Mapping[str, Mapping[str, str]],
    given: frozenset[tuple[str, ...]],
    at_least: float,
    references: Mapping[str, Mapping[str, str]] | None = None,
) -> Similar:
    """
    Compare texts, student by student.

    :param answers: student -> path -> text
    :param given: lines that everybody received, see :func:`given_lines`
    :param at_least: score from which a pair is listed, 0 to 1
    :param references: texts of the course, compared with the students' and not with each other
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
    short = tuple(student for student, found in own.items() if sum(map(_length, found)) < SHORTEST)
    groups: dict[tuple[tuple[str, ...], ...], list[str]] = {}
    for student, found in own.items():
        if student not in short:
            groups.setdefault(tuple(line.tokens for line in found), []).append(student)
    alike, scores = _alike(list(groups.values()), own, at_least, references)
    pairs = tuple(
        _pair(first, second, score, own[first[0]], own[(second or first[1:])[0]])
        for score, first, second in alike[:MOST]
    )
    return Similar(
        assignment,
        len(own.keys() - references.keys() - set(short)),
        short,
        at_least,
        statistics.median(scores) if scores else None,
        pairs,
        max(0, len(alike) - MOST),
    )


def _length(line: Line) -> int:
    return len(line.tokens)


def _alike(
    groups: Sequence[Sequence[str]],
    own: Mapping[str, Sequence[Line]],
    at_least: float,
    references: Collection[str] = (),
) -> tuple[list[tuple[float, Sequence[str], Sequence[str]]], list[float]]:
    """
    Return who is alike enough, the most alike first, and the scores of all pairs.

    :param groups: students whose own code is the same
    :param references: names of texts that are not students'
    """
    from rapidfuzz.distance import Indel
    from rapidfuzz.process import cdist

    alike: list[tuple[float, Sequence[str], Sequence[str]]] = [
        (1.0, students, ()) for students in groups if len(students) > 1
    ]
    scores = []
    if len(groups) > 1:
        tokens, lines = _coded([own[students[0]] for students in groups])
        in_order = cdist(tokens, tokens, scorer=Indel.normalized_similarity).tolist()
        any_order = cdist(lines, lines, scorer=Indel.normalized_similarity).tolist()
        for one, first in enumerate(groups):
            for two, second in enumerate(groups[:one]):
                if set(first) | set(second) <= set(references):
                    continue
                score = max(in_order[one][two], any_order[one][two])
                scores.append(score)
                if score >= at_least:
                    alike.append((score, second, first))
    return sorted(alike, key=lambda found: (-found[0], found[1])), scores


def _coded(texts: Sequence[Sequence[Line]]) -> tuple[list[str], list[str]]:
    """Return each text as a string of one character a token, and one a line, lines sorted."""
    codes: dict[Any, str] = {}

    def code(what: Any) -> str:
        if what not in codes:
            place = len(codes)
            codes[what] = chr(place if place < NO_CODES.start else place + len(NO_CODES))
        return codes[what]

    tokens = [''.join(code(token) for line in text for token in line.tokens) for text in texts]
    lines = [''.join(sorted(code(line.tokens) for line in text)) for text in texts]
    return tokens, lines


def _pair(
    first: Sequence[str],
    second: Sequence[str],
    score: float,
    one: Sequence[Line],
    two: Sequence[Line],
) -> Pair:
    """Return a pair with the lines that are the same in both, longest stretches first."""
    from rapidfuzz.distance import LCSseq

    matched = [
        (one[block.src_start : block.src_end], two[block.dest_start : block.dest_end])
        for block in LCSseq.opcodes([line.tokens for line in one], [line.tokens for line in two])
        if block.tag == 'equal'
    ]
    same = [both for block in matched for both in zip(*block)]
    renamed = sum(left.raw != right.raw for left, right in same) / max(1, len(same))
    matched.sort(key=lambda block: -len(block[0]))
    common = tuple(
        Common(
            left[0].path,
            tuple(line.text for line in left),
            tuple(line.text for line in right),
            left[0].number,
            right[0].number,
        )
        for left, right in matched
    )
    return Pair(tuple(first), tuple(second), score, renamed, common)
