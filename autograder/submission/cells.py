"""
Parse the magic line that makes a notebook cell a file of a ROS package.

Both the notebook's magics (:mod:`roslab.magics`) and the grader (:mod:`.submission`) call
:func:`parse_cell`, so the grader judges the same file that the student runs.
"""

import ast
from dataclasses import dataclass
from pathlib import PurePosixPath
import re

from autograder.submission.code.program import parsed

UNSOLVED = 'YOUR CODE HERE'
"""Text of every stub that ``nbgrader generate_assignment`` writes to a release."""

PACKAGE_FILES = (
    *('package.xml', 'CMakeLists.txt', 'setup.py', 'setup.cfg'),
    *('config/NAME.yaml', 'launch/NAME.launch.xml', 'test/test_NAME.py'),
)
"""Package files that a ``%%rospkg`` cell may contain."""

LETTERS = 'abcd'
"""The possible answers to a multiple-choice question."""

ANSWER_MAX = 2000
"""Maximum length of an answer with its comments [characters]; Python may crash on longer ones."""

MAGIC_LINE_MAX = 200
"""Maximum length of a magic line [characters]; file names have at most 255 bytes."""

_EMPTIED = ('', '### BEGIN SOLUTION', '### END SOLUTION')
_SOMETHING = re.compile(r'\S')
_ODD = re.compile(r'[\\0-9]')
_RULES = {
    'node': (
        re.compile(r'[A-Za-z][A-Za-z0-9_]*'),
        'expected letters, digits and underscores, as in %%node temp_publisher',
        '{}.py',
    ),
    'rosmsg': (
        re.compile(r'[A-Z][A-Za-z0-9]*'),
        'expected a capital letter, then letters and digits, as in %%rosmsg Speed',
        'msg/{}.msg',
    ),
    'rospkg': (
        re.compile('|'.join(map(re.escape, PACKAGE_FILES)).replace('NAME', r'[a-z][a-z0-9_]*')),
        f'expected one of {", ".join(PACKAGE_FILES)}',
        '{}',
    ),
    'answer': (
        re.compile(r'[a-z][a-z0-9_]*'),
        'expected the name of a question, as in %%answer q01',
        'answers/{}.txt',
    ),
}
"""The rule for names of each kind of cell, as a pattern and as a text; the path of its file."""


class CellSyntaxError(ValueError):
    """Report that a cell's magic line does not name a valid file."""


class NotALetterError(ValueError):
    """Report an answer that is no letter; ``reason`` is a stable name, ``text`` for a message."""

    def __init__(self, reason: str, text: str) -> None:
        super().__init__(f"expected 'a', 'b', 'c' or 'd', got {text}")
        self.reason = reason
        self.text = text


@dataclass(frozen=True)
class CellFile:
    """
    A cell as a file of the student's package.

    :param kind: ``'node'``, ``'rosmsg'``, ``'rospkg'`` or ``'answer'``
    :param name: the name on the magic line
    :param body: text of the file; solution markers are replaced with empty lines, so line n of the
        body is line n + ``first_line`` of the cell
    :param first_line: number of cell lines before the body
    """

    kind: str
    name: str
    body: str
    first_line: int = 1

    @property
    def path(self) -> str:
        """Return the path of the file in the package, as the grader writes it."""
        return _RULES[self.kind][2].format(self.name)

    @property
    def unsolved(self) -> bool:
        """Return whether the cell still contains the text of the stub."""
        return UNSOLVED in self.body


def parse_cell(source: str) -> CellFile | None:
    """Parse a cell as a file, None without a magic line of the course; raise CellSyntaxError."""
    source = source.replace('\r\n', '\n')
    line, start = first_line(source)
    word, _, name = line.replace('\t', ' ').partition(' ')
    kind = word.removeprefix('%%')
    if kind == word or kind not in _RULES:
        return None
    if len(line) > MAGIC_LINE_MAX:
        raise CellSyntaxError(
            f'{word}: expected a first line of at most {MAGIC_LINE_MAX} characters, got '
            f'{len(line)}. Write {word} and a name, and the file in the lines below.'
        )
    name = name.strip(' ')
    wanted, rule, _ = _RULES[kind]
    if not wanted.fullmatch(name):
        raise CellSyntaxError(f'{word} {name}: {rule}, got {name!r}.')
    below = source[start + len(line) + 1 :]
    return CellFile(kind, name, body_of(below), source.count('\n', 0, start) + 1)


def magic_line(path: str) -> str:
    """Return the magic line that saves :attr:`CellFile.path`, empty if no cell can save it."""
    # Try node last: setup.py is a package file, although a node may have any name.
    for kind, (rule, *_) in reversed(_RULES.items()):
        for name in (path, PurePosixPath(path).stem):
            if rule.fullmatch(name) and CellFile(kind, name, '').path == path:
                return f'%%{kind} {name}'
    return ''


def first_line(source: str) -> tuple[str, int]:
    """Return the first line that is not blank, and its offset; copy no other, maybe long, line."""
    found = _SOMETHING.search(source)
    if found is None:
        return '', 0
    start = source.rfind('\n', 0, found.start()) + 1
    end = source.find('\n', start)
    return source[start : end if end >= 0 else None], start


def body_of(text: str) -> str:
    """
    Replace solution markers and blank lines with empty lines, and end with exactly one newline.

    IPython also removes the spaces of blank lines before it passes a cell to a magic function.
    """
    kept = ['' if line.strip() in _EMPTIED else line for line in text.split('\n')]
    return '\n'.join(kept).rstrip() + '\n'


def chosen_letter(body: str) -> str | None:
    """
    Parse the answer to a multiple-choice question as a Python literal, without executing it.

    Capital letters, blanks around the letter and comments are accepted.

    :returns: a lower-case letter, or None if the answer is empty or None
    :raises NotALetterError: for any other answer
    """
    if len(body) > ANSWER_MAX:
        raise NotALetterError('too_long', f'{len(body)} characters')
    lines = [line.partition('#')[0].strip() for line in body.splitlines()]
    written = '\n'.join(filter(None, lines))
    if not written:
        return None
    try:
        value = ast.literal_eval(parsed(written, 'eval')) if not _ODD.search(written) else ()
    except (ValueError, TypeError, RecursionError, MemoryError):
        bare = len(written) == 1 and written.lower() in LETTERS
        raise NotALetterError('no_quotes' if bare else 'no_literal', _shown(written)) from None
    if value is None:
        return None
    letter = value.strip().lower() if isinstance(value, str) else ''
    if len(letter) != 1 or letter not in LETTERS:
        raise NotALetterError('no_letter', _shown(written))
    return letter


def _shown(text: str) -> str:
    """Return up to 40 characters of a text's first line, without control characters."""
    line = text.partition('\n')[0]
    shown = ''.join(char if char.isprintable() else '?' for char in line[:40])
    return shown if line[:40] == text else f'{shown} ...'
