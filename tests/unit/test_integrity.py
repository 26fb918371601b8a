"""
Changes to locked cells are reported, and ordinary work is not.

The real releases are also saved again as editors save them: an honest copy gives no flag, whatever
program wrote it. A notebook that is damaged in any place never stops the grader.
"""

import copy
import json
from pathlib import Path

from hypothesis import given, settings
from hypothesis import strategies as st
import nbformat
import pytest

from autograder.layout import Layout
from autograder.submission.notebook import marks_of, read_release, small_number
from autograder.submission.submission import MOST_LINES, open_submission

LAYOUT = Layout.here()


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


def release():
    """Return the release as it is read, with the parts that every code cell has."""
    made = copy.deepcopy(RELEASE)
    for one in made['cells']:
        one.update({'outputs': [], 'execution_count': None} if one['cell_type'] == 'code' else {})
    return made


@pytest.fixture
def student():
    return copy.deepcopy(RELEASE)


def flags(notebook):
    text = notebook if isinstance(notebook, str) else json.dumps(notebook)
    return open_submission(text.encode(), release(), 'x.ipynb').flags


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


def as_jupyterlab(path: Path) -> str:
    """Return the notebook as nbformat, and therefore Jupyter's server, writes it."""
    return nbformat.writes(nbformat.read(path, as_version=4)) + '\n'


def as_compact_json(path: Path) -> str:
    """Return the notebook in one line, with reversed keys, and strings with Windows line ends."""
    notebook = json.loads(path.read_text(encoding='utf-8'))
    for cell in notebook['cells']:
        cell['source'] = ''.join(cell['source']).replace('\n', '\r\n')
        cell['metadata'] = dict(reversed(cell['metadata'].items()))
    return json.dumps(dict(reversed(notebook.items())))


def after_running(path: Path) -> str:
    """Return the notebook as after a run: outputs, counts, new ids, hidden cells, and a BOM."""
    notebook = json.loads(path.read_text(encoding='utf-8'))
    for number, cell in enumerate(notebook['cells']):
        cell['id'] = f'new-{number}'
        cell['metadata'].update({'scrolled': True, 'execution': {'iopub.status.busy': 'x'}})
        cell['metadata']['jupyter'] = {'source_hidden': True}
        if cell['cell_type'] == 'code':
            cell['execution_count'] = number
            cell['outputs'] = [{'output_type': 'stream', 'name': 'stdout', 'text': ['x']}]
    notebook['metadata']['kernelspec'] = {'name': 'python3', 'display_name': 'Python 3'}
    return '\ufeff' + json.dumps(notebook, indent=4)


def without_ids(path: Path) -> str:
    """Return the notebook in an older minor format, as an old Jupyter saves it."""
    notebook = json.loads(path.read_text(encoding='utf-8'))
    for cell in notebook['cells']:
        cell.pop('id', None)
    return json.dumps({**notebook, 'nbformat_minor': 4}, indent=1)


@pytest.mark.parametrize('lesson', LAYOUT.assignments())
@pytest.mark.parametrize('saved', [as_jupyterlab, as_compact_json, after_running, without_ids])
def test_saving_again_is_no_change(lesson, saved):
    path = LAYOUT.release(lesson)
    original = read_release(path)
    opened = open_submission(saved(path).encode(), original, path.name)
    untouched = open_submission(path.read_bytes(), original, path.name)

    assert opened.flags == ()
    assert opened.problems == ()
    assert opened.notebook == untouched.notebook


ODD = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(),
    st.floats(),
    st.text(max_size=20),
    st.lists(st.text(max_size=5), max_size=3),
    st.dictionaries(st.text(max_size=5), st.text(max_size=5), max_size=2),
)


def places(value, path=()):
    if not isinstance(value, (dict, list)):
        return
    for key, part in value.items() if isinstance(value, dict) else enumerate(value):
        yield (*path, key)
        yield from places(part, (*path, key))


SMALL = release()
SMALL['cells'][CHECK]['metadata']['tags'] = ['t']
PLACES = list(places(SMALL))


@pytest.mark.slow
@settings(max_examples=300, deadline=None)
@given(st.lists(st.tuples(st.sampled_from(PLACES), ODD), min_size=1, max_size=4))
def test_no_damage_stops_the_grader_or_changes_a_locked_cell(damages):
    student = copy.deepcopy(SMALL)
    for one in student['cells']:
        one['source'] = [one['source']]
    for path, value in damages:
        place = student
        try:
            for key in path[:-1]:
                place = place[key]
            place[path[-1]] = value
        except (TypeError, KeyError, IndexError, AttributeError):
            continue  # earlier damage has removed this place
    opened = open_submission(json.dumps(student).encode(), copy.deepcopy(SMALL), 'x.ipynb')

    for wanted, found in zip(SMALL['cells'], opened.notebook['cells'], strict=True):
        if marks_of(wanted).get('solution'):
            wanted = {**wanted, 'source': found['source']}
        assert found == wanted
    assert all(isinstance(line, str) and len(line) < 300 for line in opened.flags)
