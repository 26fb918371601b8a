"""The JSON export follows docs/results.schema.json."""

import copy
import json
from pathlib import Path

from export_world import ABSENT, CLASS, marked, REVIEW, VISIBLE
from jsonschema import Draft202012Validator
import pytest

from autograder.classroom.results_of_class import ClassResults
from autograder.exports.as_json import FORMAT, results_json, VERSION

SCHEMA = json.loads(
    (Path(__file__).resolve().parents[2] / 'docs' / 'results.schema.json').read_text('utf-8')
)
VALID = Draft202012Validator(SCHEMA)


@pytest.fixture
def document():
    return json.loads(results_json(marked(CLASS, ABSENT)))


def test_the_schema_is_one_of_the_draft_that_it_names():
    Draft202012Validator.check_schema(SCHEMA)

    assert SCHEMA['properties']['format']['const'] == FORMAT
    assert SCHEMA['properties']['version']['const'] == VERSION


def test_a_class_follows_the_schema(document):
    VALID.validate(document)

    assert [one['status'] for one in document['submissions']] == [
        'graded',
        'graded',
        'for review',
        'graded',
    ]
    assert document['submissions'][0]['points'] == 2.0
    assert document['missing'] == [
        {'assignment': CLASS.assignment, 'student': 'zoe', 'status': 'nothing handed in'}
    ]


@pytest.mark.parametrize(
    ('result', 'status'),
    [(REVIEW, 'for review'), (VISIBLE, 'only visible checks were run')],
)
def test_submission_without_a_mark_has_no_points_anywhere(result, status):
    data = json.loads(results_json(marked(ClassResults(result.assignment, (result,)))))
    VALID.validate(data)
    (one,) = data['submissions']

    assert (one['status'], one['points']) == (status, None)
    assert {check['points'] for exam in one['exams'] for check in exam['checks']} == {None}
    assert {exam['points'] for exam in one['exams']} == {None}


@pytest.mark.parametrize(
    ('number', 'change'),
    [
        (0, {'points': None}),
        (0, {'points': -1}),
        (0, {'fault': 'The probe broke off.'}),
        (2, {'points': 0}),
        (2, {'fault': ''}),
        (0, {'status': 'passed'}),
        (0, {'secret': 1}),
    ],
)
def test_the_schema_refuses_what_contradicts_itself(document, number, change):
    wrong = copy.deepcopy(document)
    wrong['submissions'][number].update(change)

    assert VALID.is_valid(document)
    assert not VALID.is_valid(wrong)


def test_every_field_is_required(document):
    parts = [
        (document, '$'),
        (document['submissions'][0], 'submission'),
        (document['submissions'][0]['exams'][0], 'exam'),
        (document['submissions'][0]['exams'][0]['checks'][0], 'check'),
        (document['submissions'][3]['problems'][0], 'problem'),
    ]
    for part, kind in parts:
        for name in list(part):
            value = part.pop(name)
            assert not VALID.is_valid(document), f'{kind} without {name}'
            part[name] = value
    assert VALID.is_valid(document)
