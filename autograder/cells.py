"""
The magic line that turns a notebook cell into a file of a ROS package.

One parser for both sides: the notebook's magics (:mod:`roslab.magics`) and the grader
(:mod:`autograder.extract`) call :func:`parse_cell`, so what a learner runs is what is graded.
"""

from __future__ import annotations

from dataclasses import dataclass
import re

UNSOLVED = 'YOUR CODE HERE'
"""Text of every stub that ``nbgrader generate_assignment`` leaves in a release."""

PACKAGE_FILES = ('package.xml', 'CMakeLists.txt')

MAGIC_LINE_MAX = 200
"""Characters of a magic line; file names are at most 255 bytes long."""

_KINDS = {'%%node': 'node', '%%rosmsg': 'rosmsg', '%%rospkg': 'rospkg'}
_SOLUTION_MARKS = ('### BEGIN SOLUTION', '### END SOLUTION')
_SOMETHING = re.compile(r'\S')
_NODE_NAME = re.compile(r'^[A-Za-z][A-Za-z0-9_]*$')
_MESSAGE_NAME = re.compile(r'^[A-Z][A-Za-z0-9]*$')


class CellSyntaxError(ValueError):
    """A cell's magic line does not say which file the cell is."""


@dataclass(frozen=True)
class CellFile:
    """
    A cell seen as a file of the learner's package.

    :param kind: ``'node'``, ``'rosmsg'`` or ``'rospkg'``
    :param name: as written on the magic line
    :param body: text of the file; solution marks are blanked, so line n of the body is line
        n + ``first_line`` of the cell
    :param first_line: number of cell lines before the body
    """

    kind: str
    name: str
    body: str
    first_line: int = 1

    @property
    def path(self) -> str:
        """Return where the grader puts the file, relative to the package."""
        return {
            'node': f'{self.name}.py',
            'rosmsg': f'msg/{self.name}.msg',
            'rospkg': self.name,
        }[self.kind]

    @property
    def unsolved(self) -> bool:
        """Tell whether the stub's own text is still there."""
        return UNSOLVED in self.body


def check_name(kind: str, name: str) -> None:
    """
    Refuse a name that is no safe file name for its kind.

    :param kind: ``'node'``, ``'rosmsg'`` or ``'rospkg'``
    :raises CellSyntaxError: with the rule and an example
    """
    if kind == 'node' and not _NODE_NAME.match(name):
        raise CellSyntaxError(
            f'%%node {name}: expected letters, digits and underscores, as in '
            f'%%node temp_publisher, got {name!r}.'
        )
    if kind == 'rosmsg' and not _MESSAGE_NAME.match(name):
        raise CellSyntaxError(
            f'%%rosmsg {name}: a message name starts with a capital letter and has only letters '
            f'and digits, as in %%rosmsg Temperature, got {name!r}.'
        )
    if kind == 'rospkg' and name not in PACKAGE_FILES:
        raise CellSyntaxError(
            f'%%rospkg {name}: expected one of {", ".join(PACKAGE_FILES)}, got {name!r}.'
        )


def parse_cell(source: str) -> CellFile | None:
    """
    Read a cell as a file, or return None if it has no magic line of ours.

    :param source: the whole text of a code cell
    :raises CellSyntaxError: if the magic line names no valid file
    """
    source = source.replace('\r\n', '\n')
    line, start = first_line(source)
    word, _, name = line.replace('\t', ' ').partition(' ')
    if word not in _KINDS:
        return None
    if len(line) > MAGIC_LINE_MAX:
        raise CellSyntaxError(
            f'{word}: expected a first line of at most {MAGIC_LINE_MAX} characters, got '
            f'{len(line)}. Write {word} and a name, and the file below it.'
        )
    kind, name = _KINDS[word], name.strip(' ')
    check_name(kind, name)
    below = source[start + len(line) + 1 :]
    return CellFile(kind, name, body_of(below), source.count('\n', 0, start) + 1)


def first_line(source: str) -> tuple[str, int]:
    """
    Return the first line that is not blank, and where in the text it begins.

    :param source: the whole text of a cell; however long it is, no other line is copied
    """
    found = _SOMETHING.search(source)
    if found is None:
        return '', 0
    start = source.rfind('\n', 0, found.start()) + 1
    end = source.find('\n', start)
    return source[start : end if end >= 0 else None], start


def body_of(text: str) -> str:
    """
    Blank the solution marks, keeping line numbers, and end the text with one newline.

    :param text: the cell's text below its magic line
    """
    kept = ['' if line.strip() in _SOLUTION_MARKS else line for line in text.split('\n')]
    return '\n'.join(kept).rstrip() + '\n'
