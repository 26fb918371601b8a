"""
Check ``results.json`` and the zip against Gradescope's autograder specification.

The schemas below encode its rules (gradescope-autograders.readthedocs.io, "Autograder
Specifications"): fields, types, values, and a score at the top level or in every test.
"""

import io
import json
import os
import stat
import subprocess
import zipfile

from export_world import CLASS, FULL, REVIEW, submission, VISIBLE
from jsonschema import Draft202012Validator
import pytest

from autograder import __main__ as command
from autograder.errors import GraderError
from autograder.exam.inputs import course_secret
from autograder.exports import gradescope
from autograder.exports.gradescope import autograder_zip, results_of, SETTINGS, VISIBILITIES
from autograder.files import json_bytes
from autograder.grading.examine import Engine
from autograder.layout import Layout
from autograder.results import ExamResult, Problem, SubmissionResult
from autograder.sandboxes.sandbox import Sandbox

FORMATS = {'enum': ['text', 'html', 'simple_format', 'md', 'ansi']}
VISIBILITY = {'enum': ['hidden', 'after_due_date', 'after_published', 'visible']}
TEST = {
    'type': 'object',
    'properties': {
        'score': {'type': 'number'},
        'max_score': {'type': 'number'},
        'status': {'enum': ['passed', 'failed']},
        'name': {'type': 'string'},
        'name_format': FORMATS,
        'number': {'type': 'string'},
        'output': {'type': 'string'},
        'output_format': FORMATS,
        'tags': {'type': 'array', 'items': {'type': 'string'}},
        'visibility': VISIBILITY,
        'extra_data': {'type': 'object'},
    },
    'additionalProperties': False,
}
RULES = Draft202012Validator(
    {
        'type': 'object',
        'properties': {
            'score': {'type': 'number'},
            'execution_time': {'type': 'number', 'minimum': 0},
            'output': {'type': 'string'},
            'output_format': FORMATS,
            'test_output_format': FORMATS,
            'test_name_format': FORMATS,
            'visibility': VISIBILITY,
            'stdout_visibility': VISIBILITY,
            'extra_data': {'type': 'object'},
            'tests': {'type': 'array', 'items': TEST},
            'leaderboard': {'type': 'array'},
        },
        'additionalProperties': False,
        'anyOf': [
            {'required': ['score']},
            {'properties': {'tests': {'items': {'required': ['score']}}}, 'required': ['tests']},
        ],
    }
)
LAYOUT = Layout.here()
ASSIGNMENT = LAYOUT.assignments()[0]


UNREAD = Problem('a.ipynb', 'a notebook', 'a picture', 'upload again', unusable=True)


@pytest.fixture(scope='module')
def archive():
    """Return the autograder of this course."""
    with zipfile.ZipFile(io.BytesIO(autograder_zip(LAYOUT, ASSIGNMENT))) as opened:
        yield opened


class TestResults:
    def test_every_graded_submission_keeps_the_rules(self):
        for result in (one for one in CLASS.results if not one.review):
            data = json.loads(json_bytes(results_of(result)))
            RULES.validate(data)
            assert {test['output_format'] for test in data['tests']} == {'text'}
            assert '\x1b' not in data['output']

    def test_the_score_is_the_sum_of_the_tests(self):
        data = results_of(submission())

        assert data['score'] == sum(test['score'] for test in data['tests']) == 2.0
        assert sum(test['max_score'] for test in data['tests']) == 6.5
        assert [test['status'] for test in data['tests']] == ['passed', 'failed', 'failed']
        assert data['execution_time'] == 1.25

    def test_a_failed_check_says_why_and_a_waiting_one_for_what(self):
        _, warns, stops = results_of(submission())['tests']

        assert warns['output'].splitlines() == [
            'Expected: one',
            'Observed: none',
            'Likely cause: a typo',
        ]
        assert stops['output'] == 'Not checked, because it depends on: It warns.'

    @pytest.mark.parametrize(
        ('result', 'why'),
        [
            (REVIEW, 'eve: for review'),
            (submission('eve', problems=(UNREAD,)), 'eve: for review'),
            (VISIBLE, 'only visible checks were run'),
        ],
    )
    def test_submission_without_a_mark_has_no_file(self, result, why):
        """A zero would be wrong."""
        with pytest.raises(GraderError, match=why):
            results_of(result)

    @pytest.mark.parametrize('visibility', VISIBILITIES)
    def test_students_see_tests_when_it_was_chosen(self, visibility):
        data = results_of(FULL, visibility)

        assert {data['visibility'], *(test['visibility'] for test in data['tests'])} == {
            visibility
        }
        assert data['stdout_visibility'] == 'hidden'

    def test_weak_isolation_is_said(self):
        weak = ExamResult(
            'talker', (), mode='landlock-uid', not_protected=('the network is shared',)
        )
        data = results_of(SubmissionResult('ann', '01_talker', (weak,)))

        assert 'weak isolation: the network is shared.' in data['output']
        assert data['extra_data']['isolation'] == ['landlock-uid']


class TestZip:
    def test_the_two_files_of_the_specification_are_scripts_at_the_root(self, archive, tmp_path):
        for name in ('setup.sh', 'run_autograder'):
            assert stat.S_IMODE(archive.getinfo(name).external_attr >> 16) == 0o755
            assert archive.read(name).startswith(b'#!/usr/bin/env bash\n')
            (tmp_path / name).write_bytes(archive.read(name))
            subprocess.run(['bash', '-n', tmp_path / name], check=True)

    def test_it_holds_what_grading_needs(self, archive):
        names = archive.namelist()

        for name in (
            'autograder/__main__.py',
            'autograder/exports/gradescope.py',
            'autograder/sandboxes/seccomp/x86_64.bpf',
            'environment/prepare.sh',
            'environment/requirements.lock',
            'nbgrader_config.py',
            f'notebooks/{ASSIGNMENT}/{LAYOUT.release(ASSIGNMENT).name}',
            f'solutions/{ASSIGNMENT}/{LAYOUT.release(ASSIGNMENT).name}',
            'temp_monitor_pkg/package.xml',
        ):
            assert name in names, name
        assert any(name.startswith('exams/hidden/') for name in names)
        imported = {'autograder', 'drawing', 'environment', 'roslab'}
        assert imported <= {name.partition('/')[0] for name in names}

    def test_it_has_the_same_hidden_inputs(self, archive):
        work = [name for name in archive.namelist() if name.startswith('autograder/_work')]

        assert work == ['autograder/_work/course_secret']
        assert archive.read(work[0]) == course_secret()
        assert stat.S_IMODE(archive.getinfo(work[0]).external_attr >> 16) == 0o600

    def test_it_is_small_enough_and_of_plain_names(self, archive):
        for entry in archive.infolist():
            assert not os.path.isabs(entry.filename)
            assert not {'..', '__pycache__', 'ros_ws', '.git'} & set(entry.filename.split('/'))
            assert stat.S_ISREG(entry.external_attr >> 16)
        assert sum(entry.file_size for entry in archive.infolist()) < 100 * 1024 * 1024

    def test_the_same_course_gives_the_same_bytes(self):
        """The time of packing does not change the zip."""
        assert autograder_zip(LAYOUT, ASSIGNMENT) == autograder_zip(LAYOUT, ASSIGNMENT)

    def test_the_choices_go_along(self):
        """Options are stored as data, and not put into a script."""
        made = autograder_zip(LAYOUT, ASSIGNMENT, 'visible', 'landlock-uid')
        with zipfile.ZipFile(io.BytesIO(made)) as opened:
            assert json.loads(opened.read(SETTINGS)) == {
                'assignment': ASSIGNMENT,
                'visibility': 'visible',
                'allow_weak': 'landlock-uid',
            }

    def test_no_isolation_at_all_is_refused(self, capsys):
        """Hidden exams never run without isolation, so there would be no grades."""
        with pytest.raises(SystemExit):
            command.main(['export', 'gradescope-autograder', ASSIGNMENT, '--allow-weak', 'none'])
        assert "invalid choice: 'none'" in capsys.readouterr().err
        with pytest.raises(GraderError, match='hidden exams never run with this isolation'):
            autograder_zip(LAYOUT, ASSIGNMENT, allow_weak='none')

    def test_visible_exams_refuse_before_any_program_runs(self, tmp_path, monkeypatch, capsys):
        engine = Engine(Sandbox('none'), hidden=False)
        monkeypatch.setattr(Layout, 'here', lambda: Layout(tmp_path))
        monkeypatch.setattr(gradescope, 'grading_engine', lambda *_, **__: engine)
        settings = {'assignment': ASSIGNMENT, 'visibility': 'visible', 'allow_weak': ''}
        (tmp_path / SETTINGS).write_bytes(json_bytes(settings))

        assert gradescope.main([str(tmp_path)]) == 1
        said = 'No verdict, so no score: Only visible checks can run here, so there is no grade.\n'
        assert capsys.readouterr().out == said

    def test_the_students_copy_cannot_make_one(self, tmp_path):
        with pytest.raises(GraderError, match='copy of the course has no hidden'):
            autograder_zip(Layout(tmp_path), ASSIGNMENT)
