"""The magic line of a cell, as the notebook and the grader both read it."""

from __future__ import annotations

import pytest

from autograder.cells import CellSyntaxError, parse_cell


@pytest.mark.parametrize(
    ('line', 'path'),
    [
        ('%%node temp_publisher', 'temp_publisher.py'),
        ('%%node\ttalker  ', 'talker.py'),
        ('%%rosmsg Temperature', 'msg/Temperature.msg'),
        ('%%rospkg package.xml', 'package.xml'),
        ('%%rospkg CMakeLists.txt', 'CMakeLists.txt'),
    ],
)
def test_the_magic_line_names_the_file(line, path):
    """Each kind has its place in the package."""
    assert parse_cell(f'{line}\nx').path == path


@pytest.mark.parametrize(
    'source', ['', 'x = 1', '# %%node a', '%%nodes a', '%node a', ' %%node a']
)
def test_other_cells_are_no_files(source):
    """They are left alone."""
    assert parse_cell(source) is None


@pytest.mark.parametrize(
    'line',
    [
        '%%node',
        '%%node a/b',
        '%%node ../x',
        '%%node a.py',
        '%%node 1a',
        '%%node a b',
        '%%node a\x00',
        '%%rosmsg temperature',
        '%%rosmsg A_b',
        '%%rospkg setup.py',
        '%%rospkg ../package.xml',
    ],
)
def test_a_name_that_is_no_file_name_is_refused(line):
    """No name leads out of the package."""
    with pytest.raises(CellSyntaxError, match='got'):
        parse_cell(f'{line}\nx')


def test_solution_marks_are_blanked_so_line_numbers_stay():
    """A traceback's line n is line n of the file."""
    cell = parse_cell('%%node a\n    ### BEGIN SOLUTION\nx = 1\n### END SOLUTION\ny = 2')

    assert cell.body == '\nx = 1\n\ny = 2\n'
    assert cell.first_line == 1


def test_windows_line_ends_and_leading_blank_lines_are_fine():
    """The body is the same."""
    cell = parse_cell('\r\n%%node a\r\nx = 1\r\n')

    assert (cell.body, cell.first_line) == ('x = 1\n', 2)


def test_a_stub_is_recognised():
    """Its text is still there."""
    assert parse_cell('%%rosmsg A\n# YOUR CODE HERE').unsolved
    assert not parse_cell('%%rosmsg A\nint64 a').unsolved
