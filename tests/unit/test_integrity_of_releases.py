"""
The real releases, saved again as editors save them, and damaged in every place.

An honest copy gives no flag, whatever program wrote it.  A damaged copy never stops the grader or
changes a cell that is not an answer.
"""

import copy
import json
from pathlib import Path

from hypothesis import given, settings
from hypothesis import strategies as st
import nbformat
import pytest

from autograder.layout import Layout
from autograder.submission.notebook import marks_of, read_release
from autograder.submission.submission import open_submission

LAYOUT = Layout.here()
LESSONS = LAYOUT.assignments()


def release_of(lesson: str) -> tuple[Path, dict]:
    """Return the path and the content of a release."""
    path = LAYOUT.release(lesson)
    return path, read_release(path)


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


@pytest.mark.parametrize('lesson', LESSONS)
@pytest.mark.parametrize('saved', [as_jupyterlab, as_compact_json, after_running, without_ids])
def test_saving_again_is_no_change(lesson, saved):
    path, release = release_of(lesson)
    opened = open_submission(saved(path).encode(), release, path.name)
    untouched = open_submission(path.read_bytes(), release, path.name)

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
    """Yield the path to every part of a notebook."""
    if not isinstance(value, (dict, list)):
        return
    for key, part in value.items() if isinstance(value, dict) else enumerate(value):
        yield (*path, key)
        yield from places(part, (*path, key))


SMALL = {
    'cells': [
        {'cell_type': 'markdown', 'metadata': {}, 'source': ['# T']},
        {
            'cell_type': 'code',
            'metadata': {
                'nbgrader': {'grade_id': 'a', 'grade': False, 'solution': True, 'locked': False}
            },
            'source': ['%%node talker\n', 'pass'],
            'outputs': [],
            'execution_count': None,
        },
        {
            'cell_type': 'code',
            'metadata': {
                'tags': ['t'],
                'nbgrader': {
                    'grade_id': 'c',
                    'grade': True,
                    'solution': False,
                    'locked': True,
                    'points': 3,
                },
            },
            'source': ["check('talker')"],
            'outputs': [],
            'execution_count': None,
        },
    ],
    'metadata': {},
    'nbformat': 4,
    'nbformat_minor': 5,
}
PLACES = list(places(SMALL))


@pytest.mark.slow
@settings(max_examples=300, deadline=None)
@given(st.lists(st.tuples(st.sampled_from(PLACES), ODD), min_size=1, max_size=4))
def test_no_damage_stops_the_grader_or_changes_a_locked_cell(damages):
    release = copy.deepcopy(SMALL)
    for cell in release['cells']:
        cell['source'] = ''.join(cell['source'])
    student = copy.deepcopy(SMALL)
    for path, value in damages:
        place = student
        try:
            for key in path[:-1]:
                place = place[key]
            place[path[-1]] = value
        except (TypeError, KeyError, IndexError, AttributeError):
            continue  # earlier damage has removed this place
    opened = open_submission(json.dumps(student).encode(), release, 'x.ipynb')

    for wanted, found in zip(release['cells'], opened.notebook['cells'], strict=True):
        if marks_of(wanted).get('solution'):
            wanted = {**wanted, 'source': found['source']}
        assert found == wanted
    assert all(isinstance(line, str) and len(line) < 300 for line in opened.flags)
