"""The magic line of a cell: the notebook and the grader read it in the same way."""

import time

import pytest

from autograder.submission.cells import (
    CellSyntaxError,
    first_line,
    magic_line,
    MAGIC_LINE_MAX,
    parse_cell,
)


@pytest.mark.parametrize(
    ('line', 'path'),
    [
        ('%%node temp_publisher', 'temp_publisher.py'),
        ('%%node\ttalker  ', 'talker.py'),
        ('%%rosmsg Temperature', 'msg/Temperature.msg'),
        ('%%rospkg package.xml', 'package.xml'),
        ('%%rospkg setup.py', 'setup.py'),
        ('%%rospkg CMakeLists.txt', 'CMakeLists.txt'),
        ('%%rospkg config/limiter.yaml', 'config/limiter.yaml'),
        ('%%rospkg launch/both.launch.xml', 'launch/both.launch.xml'),
        ('%%rospkg test/test_limiter.py', 'test/test_limiter.py'),
        ('%%answer q01', 'answers/q01.txt'),
    ],
)
def test_the_magic_line_names_the_file(line, path):
    assert parse_cell(f'{line}\nx').path == path
    assert magic_line(path).split() == line.split()


@pytest.mark.parametrize(
    'source', ['', 'x = 1', '# %%node a', '%%nodes a', '%node a', ' %%node a']
)
def test_other_cells_are_no_files(source):
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
        '%%rospkg make.py',
        '%%rospkg config/../x.yaml',
        '%%rospkg config/NAME.yaml',
        '%%rospkg ../package.xml',
        '%%answer',
        '%%answer ../q01',
        '%%answer q01.txt',
        '%%answer Q01',
    ],
)
def test_a_name_that_is_no_file_name_is_refused(line):
    """No name may lead out of the package."""
    with pytest.raises(CellSyntaxError, match='got'):
        parse_cell(f'{line}\nx')


def test_solution_marks_are_blanked_so_line_numbers_stay():
    cell = parse_cell('%%node a\n    ### BEGIN SOLUTION\nx = 1\n### END SOLUTION\ny = 2')

    assert cell.body == '\nx = 1\n\ny = 2\n'
    assert cell.first_line == 1


def test_windows_line_ends_and_leading_blank_lines_are_fine():
    cell = parse_cell('\r\n%%node a\r\nx = 1\r\n')

    assert (cell.body, cell.first_line) == ('x = 1\n', 2)


def test_a_stub_is_recognised():
    assert parse_cell('%%rosmsg A\n# YOUR CODE HERE').unsolved
    assert not parse_cell('%%rosmsg A\nint64 a').unsolved


@pytest.fixture
def in_a_second():
    """Fail if a test takes more than a second of processor time."""
    began = time.thread_time()
    yield
    assert time.thread_time() - began < 1


@pytest.mark.usefixtures('in_a_second')
class TestLongLines:
    """The time to read a line does not grow with the square of its length."""

    @pytest.mark.parametrize('word', ['%%node', '%%rosmsg', '%%rospkg', '%%answer'])
    @pytest.mark.parametrize('rest', [' \t' * 100_000 + '!', ' a' * 100_000, ' ' * 200_000])
    def test_magic_line_is_refused(self, word, rest):
        with pytest.raises(CellSyntaxError, match='at most 200 characters, got 2000') as caught:
            parse_cell(f'{word} a{rest}\nx')

        assert len(str(caught.value)) < 200

    @pytest.mark.parametrize(
        'source',
        [
            'x' * 200_000,
            '%%node' + 'x' * 200_000,
            ' ' * 200_000,
            ' \n' * 100_000,
            '#' + ' \t' * 100_000 + '!',
        ],
    )
    def test_cell_without_a_magic_is_left_alone(self, source):
        assert parse_cell(source) is None

    @pytest.mark.parametrize(
        'line', [' \t' * 100_000 + '!', '### END SOLUTION' + ' ' * 200_000 + '!']
    )
    def test_line_that_is_no_solution_mark_is_kept(self, line):
        assert parse_cell(f'%%node a\n{line}').body == f'{line}\n'


def test_a_magic_line_of_the_longest_length_is_read():
    name = 'a' * (MAGIC_LINE_MAX - len('%%node '))

    assert parse_cell(f'%%node {name}\nx').name == name


@pytest.mark.parametrize(
    ('source', 'found'),
    [
        ('', ('', 0)),
        (' \n\t\n', ('', 0)),
        ('a', ('a', 0)),
        ('a\nb', ('a', 0)),
        ('\n  \n  a \nb', ('  a ', 4)),
    ],
)
def test_the_first_line_is_the_first_with_something_on_it(source, found):
    assert first_line(source) == found
