"""The command line: clear errors, stable exit codes."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest

from autograder import __main__ as command
from autograder.errors import SandboxUnavailable
from autograder.layout import Layout


def test_a_missing_folder_is_named(tmp_path, capsys):
    """Exit code 2, one line."""
    code = command.main(['grade', '--submitted', str(tmp_path / 'nowhere')])

    assert code == command.USAGE
    assert 'nowhere: expected a folder, got none.' in capsys.readouterr().err


def test_an_unknown_assignment_is_answered_with_a_near_one(tmp_path, capsys):
    """A typo is quickly mended."""
    arguments = ['grade', '--submitted', str(tmp_path), '--assignment', '07_temprature_monitor']

    assert command.main(arguments) == command.USAGE
    assert 'Did you mean 07_temperature_monitor?' in capsys.readouterr().err


def test_grading_refuses_to_run_without_a_sandbox(tmp_path, capsys, monkeypatch):
    """It never falls back to a plain process."""
    from autograder import sandbox

    def refuse():
        raise SandboxUnavailable('No bubblewrap.', 'Install it.')

    monkeypatch.setattr(sandbox, 'strongest', refuse)

    assert command.main(['grade', '--submitted', str(tmp_path)]) == command.USAGE
    assert 'No bubblewrap. Install it.' in capsys.readouterr().err


def test_a_check_that_cannot_run_says_so_as_data(tmp_path, capsys):
    """The notebook shows it as a problem of the checker, not of the code."""
    arguments = ['check', 'nonsense', '--files', str(tmp_path), '--visible', '--json']

    assert command.main(arguments) == command.USAGE
    answer = json.loads(capsys.readouterr().out.splitlines()[-1])
    assert answer['error']['where'] == 'the checker itself, not your code'
    assert 'nonsense' in answer['error']['got']


@pytest.mark.parametrize('jobs', ['0', '-1', 'many', '1.5'])
def test_jobs_are_a_positive_number(jobs, capsys):
    """The message says what was expected."""
    with pytest.raises(SystemExit) as stopped:
        command.main(['grade', '--jobs', jobs])

    assert stopped.value.code == command.USAGE
    assert 'at least 1' in capsys.readouterr().err


def test_the_sample_class_can_be_written_anywhere(tmp_path, capsys):
    """One folder a student."""
    assert command.main(['sample-class', '--to', str(tmp_path / 'class')]) == command.OK

    names = {path.name for path in (tmp_path / 'class').iterdir()}
    assert {'pass__reference', 'zero__untouched_stub'} <= names
    assert f'{len(names)} submissions' in capsys.readouterr().out


def test_an_empty_class_folder_gets_the_sample_class_and_a_full_one_stays(tmp_path, capsys):
    """A fresh clone has something to grade; nobody's class is touched."""
    from rich.console import Console

    layout = Layout.here()

    class Elsewhere(Layout):
        submitted = tmp_path / 'submitted'

    console = Console()
    elsewhere = Elsewhere(layout.root)
    command._submitted_folder(elsewhere, None, console)
    assert 'example submissions' in capsys.readouterr().out

    command._submitted_folder(elsewhere, None, console)
    assert capsys.readouterr().out == ''


def test_starting_imports_neither_nbgrader_nor_ros():
    """Help and errors come at once."""
    code = (
        'import sys; import autograder.__main__, autograder.pipeline, autograder.inbox; '
        'print([name for name in ("nbgrader", "nbformat", "rclpy", "rich", "jinja2") '
        'if name in sys.modules])'
    )
    done = subprocess.run([sys.executable, '-c', code], capture_output=True, text=True, check=True)

    assert done.stdout.strip() == '[]'
