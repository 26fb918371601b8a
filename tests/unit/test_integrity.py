"""Changes to locked cells are reported, and ordinary work is not."""

import copy
import json

import pytest

from autograder.submission.notebook import small_number
from autograder.submission.submission import MOST_LINES, open_submission


def cell(grade_id, source, kind='code', **marks):
    marks = {'grade_id': grade_id, 'grade': False, 'solution': False, 'locked': True, **marks}
    return {'cell_type': kind, 'metadata': {'nbgrader': marks}, 'source': source}


RELEASE = {
    'cells': [
        {'cell_type': 'markdown', 'metadata': {}, 'source': '# Title'},
        cell('spec', 'What to do', 'markdown'),
        cell('talker', '%%node talker\n# YOUR CODE HERE', solution=True, locked=False),
        cell('check_talker', "check('talker')", grade=True, points=3),
    ],
    'metadata': {},
    'nbformat': 4,
    'nbformat_minor': 5,
}
TITLE, SPEC, ANSWER, CHECK = range(4)


@pytest.fixture
def student():
    return copy.deepcopy(RELEASE)


def flags(notebook):
    text = notebook if isinstance(notebook, str) else json.dumps(notebook)
    release = copy.deepcopy(RELEASE)
    for one in release['cells']:
        one.update({'outputs': [], 'execution_count': None} if one['cell_type'] == 'code' else {})
    return open_submission(text.encode(), release, 'x.ipynb').flags


def test_work_in_a_notebook_is_no_change(student):
    student['cells'][ANSWER]['source'] = '%%node talker\nprint(1)'
    student['cells'][ANSWER]['metadata']['tags'] = ['mine']
    student['cells'][CHECK].update(outputs=[{'output_type': 'stream'}], execution_count=7, id='x')
    student['cells'][CHECK]['metadata'].update(scrolled=True, collapsed=False, trusted=True)
    student['cells'][CHECK]['metadata']['nbgrader'].update(checksum='0', schema_version=3)
    student['cells'][SPEC]['source'] = 'What to do\r\n'
    student['cells'].insert(1, {'cell_type': 'code', 'metadata': {}, 'source': '1 + 1'})
    student['cells'].insert(1, {'cell_type': 'code', 'metadata': {'tags': ['x']}, 'source': ''})

    assert flags(student) == ()


def test_points_with_a_fraction_of_nothing_are_the_same_points(student):
    """Some editors save 3 as 3.0."""
    assert flags(json.dumps(student).replace('"points": 3', '"points": 3.0')) == ()


def test_points_of_a_fraction_are_points(student, monkeypatch):
    monkeypatch.setitem(RELEASE['cells'][CHECK]['metadata']['nbgrader'], 'points', 2.5)
    student['cells'][CHECK]['metadata']['nbgrader']['points'] = 2.5

    assert flags(student) == ()


@pytest.mark.parametrize(
    ('change', 'line'),
    [
        (lambda cells: cells.pop(CHECK), 'locked cell check_talker is missing'),
        (lambda cells: cells.pop(ANSWER), 'answer cell talker is missing'),
        (lambda cells: cells.append(cells[SPEC]), 'locked cell spec occurs 2 times'),
        (lambda cells: cells.append(cells[ANSWER]), 'answer cell talker occurs 2 times'),
        (
            lambda cells: cells[CHECK].update(source='3.0'),
            'locked cell check_talker has different text',
        ),
        (
            lambda cells: cells[CHECK]['metadata']['nbgrader'].update(points=1000.5),
            'locked cell check_talker has a different value of points',
        ),
        (
            lambda cells: cells[CHECK]['metadata']['nbgrader'].update(locked=False),
            'locked cell check_talker has a different value of locked',
        ),
        (
            lambda cells: cells[CHECK]['metadata'].update(tags=['skip-execution']),
            "locked cell check_talker has the tags 'skip-execution'",
        ),
        (
            lambda cells: cells[CHECK].update(cell_type='markdown'),
            "locked cell check_talker is a 'markdown' cell",
        ),
        (
            lambda cells: cells.append(cell('bonus', '1')),
            "the release has no cell with the grade id 'bonus'",
        ),
    ],
)
def test_change_is_one_line(student, change, line):
    change(student['cells'])

    assert flags(student) == (line,)


def test_lines_are_bounded(student):
    student['cells'] += [cell(f'x{number}', '') for number in range(1000)]
    found = flags(student)

    assert len(found) == MOST_LINES + 1
    assert found[-1] == '980 more differences from the release'


@pytest.mark.parametrize(
    ('text', 'number'),
    [
        ('10', 10),
        ('2.0', 2),
        ('2.5', 2.5),
        ('0.1', 0.1),
        ('2.51', True),
        ('1e3', 1000),
        ('-1', True),
        ('9' * 10**6, True),
    ],
)
def test_numbers_are_small_or_just_numbers(text, number):
    """A huge number in the file is never converted."""
    assert small_number(text) is number or small_number(text) == number
