"""The command line: clear errors, stable exit codes."""

import argparse
from contextlib import nullcontext
import json
import os
from pathlib import Path
import signal
import subprocess
import sys
from types import SimpleNamespace
from unittest.mock import Mock

from collect_sources import laid
import pytest
from rich.console import Console

from autograder import __main__ as command
from autograder.commands import grade as grading
from autograder.commands import OK
from autograder.commands.grade import submitted_folder
from autograder.commands.run import exams_named
from autograder.errors import SandboxUnavailable
from autograder.exam import catalog, inputs
from autograder.layout import Layout
from autograder.sandboxes import choose
from autograder.sandboxes.sandbox import Sandbox


@pytest.fixture(autouse=True)
def undisturbed(monkeypatch):
    """Disable the course's lock, so that other grading runs cannot disturb these tests."""
    monkeypatch.setattr(grading, 'lock_course', lambda *_: nullcontext())


@pytest.mark.parametrize(
    ('options', 'said'),
    [
        (['--submitted', 'nowhere'], 'nowhere: there is no such folder.'),
        (['--assignment', '07_temprature_monitor'], 'Did you mean 07_temperature_monitor?'),
        # A cluster would ignore the options of one machine.
        (['--cluster', 'tcp://127.0.0.1:1', '--jobs', '3'], '--jobs 3'),
        (['--cluster', 'tcp://127.0.0.1:1', '--allow-weak', 'none'], '--allow-weak'),
    ],
)
def test_options_of_grade_that_cannot_be_used_are_named(options, said, tmp_path, capsys):
    assert command.main(['grade', '--submitted', str(tmp_path), *options]) == command.USAGE
    assert said in capsys.readouterr().err


def test_grading_refuses_to_run_without_a_sandbox(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(
        choose, 'strongest', Mock(side_effect=SandboxUnavailable('No bubblewrap.', 'Install it.'))
    )

    assert command.main(['grade', '--submitted', str(tmp_path)]) == command.USAGE
    assert 'No bubblewrap. Install it.' in capsys.readouterr().err


def test_a_check_that_cannot_run_says_so_as_data(tmp_path, capsys):
    """The notebook shows the error as a problem of the checker, not of the student's code."""
    arguments = ['check', 'nonsense', '--files', str(tmp_path), '--visible', '--json']

    assert command.main(arguments) == command.USAGE
    answer = json.loads(capsys.readouterr().out.splitlines()[-1])
    assert answer['error']['where'] == 'the checker itself, not your code'
    assert 'nonsense' in answer['error']['got']


def one_line(captured):
    (line,) = captured.err.splitlines()
    return line


@pytest.fixture
def no_place_to_write(tmp_path, monkeypatch):
    """Put the secret where even root cannot create a folder."""
    (tmp_path / 'file').write_text('x')
    monkeypatch.delenv('COURSE_SECRET', raising=False)
    monkeypatch.setattr(Layout, 'secret', tmp_path / 'file' / 'course_secret')
    inputs.course_secret.cache_clear()
    yield tmp_path / 'file'
    inputs.course_secret.cache_clear()


@pytest.mark.parametrize('how', ['grade', 'check'])
def test_a_folder_that_cannot_be_written_is_one_line(
    how, no_place_to_write, tmp_path, capsys, monkeypatch
):
    monkeypatch.setattr(choose, 'strongest', lambda: Sandbox('bwrap-root'))
    monkeypatch.setattr(catalog, 'for_assignment', lambda *_, **__: inputs.course_secret())
    monkeypatch.setattr(catalog, 'load', lambda *_, **__: inputs.course_secret())
    option = ['grade', '--submitted'] if how == 'grade' else ['check', 'a', '--files']

    assert command.main([*option, str(tmp_path)]) == command.USAGE

    line = one_line(capsys.readouterr())
    assert line.startswith(f'autograder: {no_place_to_write}')
    assert 'cannot be read or written' in line
    assert line.count('Try: ') == 1


def test_a_system_error_without_a_file_still_says_what_happened(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(catalog, 'load', Mock(side_effect=OSError(28, 'No space left on device')))

    assert command.main(['check', 'a', '--files', str(tmp_path)]) == command.USAGE
    assert one_line(capsys.readouterr()).startswith(
        'autograder: the system: the disk is full. Try: free space on it'
    )


def test_the_first_of_two_assignments_with_one_short_name_counts(tmp_path, monkeypatch):
    places = [f'notebooks/{name}/topics.ipynb' for name in ('01_topics', '02_topics')]
    laid(tmp_path, dict.fromkeys(places, b''))
    exams = {'01_topics': (SimpleNamespace(name='a'),), '02_topics': (SimpleNamespace(name='b'),)}
    monkeypatch.setattr(catalog, 'for_assignment', lambda name, hidden: exams[name])

    for name, found in {'topics': '01_topics', **{one: one for one in exams}}.items():
        assert exams_named(name, Layout(tmp_path), hidden=False) == exams[found]


@pytest.mark.parametrize('options', [[], ['--visible', '--json']])
def test_a_python_that_was_not_prepared_is_one_line(options, tmp_path, capsys, monkeypatch):
    from environment.ros import ros_environment

    (tmp_path / 'temp_publisher.py').write_text('x = 1')
    monkeypatch.setattr(choose, 'strongest', lambda: ros_environment(tmp_path))
    arguments = ['check', 'temperature_publisher', '--files', str(tmp_path), *options]

    assert command.main(arguments) == command.USAGE

    captured = capsys.readouterr()
    line = one_line(captured)
    assert f'{tmp_path}/ros_environment.json: the description' in line
    assert line.endswith('Try: make doctor')
    if '--json' in options:
        assert json.loads(captured.out)['error']['try_this'] == 'make doctor'


def test_a_python_without_the_packages_is_one_line(tmp_path):
    argv = [sys.executable, '-S', '-E', '-m', 'autograder', 'grade', '--submitted', str(tmp_path)]
    root = Path(command.__file__).parents[1]
    done = subprocess.run(argv, cwd=root, capture_output=True, text=True)

    assert done.returncode == command.USAGE
    (line,) = done.stderr.splitlines()
    assert line.startswith(f'autograder: {sys.executable}: this Python has no module ')
    assert 'Try: make grade, or .venv/bin/autograder' in line


def test_a_module_of_ours_that_is_missing_stays_a_defect(tmp_path, monkeypatch):
    """A missing module of the grader keeps its traceback: a different Python would not help."""
    monkeypatch.setattr(
        catalog,
        'load',
        Mock(
            side_effect=ModuleNotFoundError("No module named 'autograder.x'", name='autograder.x')
        ),
    )

    with pytest.raises(ModuleNotFoundError):
        command.main(['check', 'a', '--files', str(tmp_path)])


class TestCheckWithoutTheFile:
    """If ``check`` reads a folder, its messages name files, not cells."""

    def check(self, folder, *options):
        options = ('--visible', *options)
        return command.main(['check', 'temperature_publisher', '--files', str(folder), *options])

    def test_the_line_names_the_folder_the_file_and_what_is_there(self, tmp_path, capsys):
        """The line names the folder, which is often the wrong one."""
        laid(tmp_path, {'package.xml': b'x', 'temp_publsher.py': b'x'})

        assert self.check(tmp_path) == command.USAGE

        captured = capsys.readouterr()
        there = 'only package.xml, temp_publsher.py'
        line = f'autograder: {tmp_path}: expected temp_publisher.py, got {there}.'
        assert one_line(captured) == line
        assert captured.out == ''

    @pytest.mark.parametrize(
        ('files', 'said'),
        [(0, 'expected temp_publisher.py, got no package files.'), (20, 'a07.py and 12 more.')],
    )
    def test_the_line_names_at_most_a_few_files(self, files, said, tmp_path, capsys):
        laid(tmp_path, {f'a{number:02}.py': b'x' for number in range(files)})

        assert self.check(tmp_path) == command.USAGE
        assert one_line(capsys.readouterr()).endswith(said)

    def test_as_data_it_is_a_failed_check_about_a_file(self, tmp_path, capsys, monkeypatch):
        monkeypatch.setattr(choose, 'strongest', lambda: Sandbox('bwrap-root'))

        assert self.check(tmp_path, '--json') == OK

        first, *others = json.loads(capsys.readouterr().out)['checks']
        assert first['cause_id'] == 'missing_file'
        assert first['expected'] == 'the file temp_publisher.py'
        assert first['observed'] == 'no package files'
        assert first['title'] == 'All files of the exercise exist.'
        assert 'cell' not in f'{first["cause"]} {first["try_this"]}'
        assert {check['verdict'] for check in others} == {'NOT_RUN'}


@pytest.mark.parametrize('jobs', ['0', '-1', 'many', '1.5'])
def test_jobs_are_a_positive_number(jobs, capsys):
    with pytest.raises(SystemExit) as stopped:
        command.main(['grade', '--jobs', jobs])

    assert stopped.value.code == command.USAGE
    assert 'at least 1' in capsys.readouterr().err


def test_the_sample_class_can_be_written_anywhere(tmp_path, capsys):
    assert command.main(['sample-class', '--to', str(tmp_path / 'class')]) == OK

    names = {path.name for path in (tmp_path / 'class').iterdir()}
    notebooks = list((tmp_path / 'class').glob('*/*/*.ipynb'))
    assert {'pass__reference', 'zero__untouched_stub'} <= names
    assert f'{len(notebooks)} example submissions' in capsys.readouterr().out

    notebooks[-1].write_bytes(b'my own')
    notebooks[0].unlink()
    arguments = ['sample-class', '--to', str(tmp_path / 'class')]
    assert command.main(arguments) == command.USAGE
    assert f'{notebooks[-1]}: this file already exists. Try: --force' in capsys.readouterr().err
    assert (notebooks[-1].read_bytes(), notebooks[0].exists()) == (b'my own', False)

    assert command.main([*arguments, '--force']) == OK
    assert notebooks[-1].read_bytes() != b'my own'


def test_sample_class_is_not_written_among_real_students(monkeypatch, tmp_path, capsys):
    """The sample class is refused in a real class, whose gradebook would get its marks."""
    laid(tmp_path / 'ann' / Layout.here().assignments()[0], {'mine.ipynb': b'{}'})
    monkeypatch.setattr(Layout, 'submitted', tmp_path)

    assert command.main(['sample-class']) == command.USAGE
    assert 'this folder contains other students: ann. Try: --to' in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ['ann']


@pytest.fixture
def elsewhere(tmp_path, monkeypatch):
    """Return this course, with empty folders for submissions and reports."""
    monkeypatch.setattr(Layout, 'submitted', tmp_path / 'submitted')
    monkeypatch.setattr(Layout, 'reports', tmp_path / 'reports')
    return Layout.here()


def test_an_empty_class_folder_gets_the_sample_class_and_a_full_one_stays(elsewhere, capsys):
    submitted_folder(elsewhere, None, Console())
    assert 'example submissions' in capsys.readouterr().out

    submitted_folder(elsewhere, None, Console())
    assert capsys.readouterr().out == ''


def test_sample_students_never_follow_a_class(elsewhere):
    elsewhere.reports.mkdir()
    with pytest.raises(grading.UsageError, match=r'nothing to grade\. Try: .* collect SOURCE'):
        submitted_folder(elsewhere, None, Console())

    assert not elsewhere.submitted.exists()


@pytest.mark.parametrize(
    ('argv', 'said'),
    [
        (['grade', '--fresh'], 'With --fresh, the same command repeats every run'),
        (['stats'], 'Run the same command again; it starts from the beginning.'),
    ],
)
def test_what_is_not_kept_is_not_promised(argv, said, capsys, monkeypatch):
    monkeypatch.setattr(Layout, 'here', Mock(side_effect=KeyboardInterrupt))

    assert command.main(argv) == command.STOPPED
    assert said in capsys.readouterr().err


@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGTERM])
def test_a_grading_that_is_stopped_says_how_to_go_on(number, tmp_path, capsys, monkeypatch):
    def stopped(*_):
        signal.raise_signal(number)
        while True:
            pass  # Python handles the signal between two instructions, not necessarily at once

    monkeypatch.setattr(grading, '_assignments', stopped)
    before = {one: signal.getsignal(one) for one in (signal.SIGINT, signal.SIGTERM)}
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a background job ignores SIGINT

    try:
        assert command.main(['grade', '--submitted', str(tmp_path)]) == command.STOPPED
    finally:
        for one, handler in before.items():
            signal.signal(one, handler)

    assert capsys.readouterr().err == (
        '\nStopped. Finished runs are kept; run the same command again to continue.\n'
    )


def test_starting_imports_neither_nbgrader_nor_ros():
    """Starting a command imports neither nbgrader nor ROS: help and errors appear at once."""
    code = (
        'import sys, autograder.__main__; from autograder.grading import pipeline; '
        'from autograder.submission import inbox; '
        'print([name for name in ("nbgrader", "nbformat", "rclpy", "rich", "jinja2", "psutil") '
        'if name in sys.modules])'
    )
    done = subprocess.run([sys.executable, '-c', code], capture_output=True, text=True, check=True)

    assert done.stdout.strip() == '[]'


def test_what_the_gradebook_refuses_is_reported_of_every_assignment(monkeypatch):
    def refuses(_, assignment):
        return [], 'no server.' if assignment == '09' else f'{assignment}: cells.'

    monkeypatch.setattr(grading.Grading, 'one', refuses)
    class_ = grading.Grading(None, None, None, 1, None, grading.Guard(None))
    done, trouble = class_.all(['03', '07', '09', '09'])

    assert done == []
    assert trouble == '03: cells. 07: cells. no server.'


def test_a_reader_that_leaves_is_no_trouble(monkeypatch, capfd):
    """If the reader of a pipe leaves, as in ``... | head``, nothing is written to stderr."""
    reading, writing = os.pipe()
    os.close(reading)

    def run(chosen):
        print('a line')
        return 0

    with os.fdopen(writing, 'w') as closed:
        monkeypatch.setattr(sys, 'stdout', closed)
        parser = argparse.Namespace(parse_args=lambda *_: argparse.Namespace(run=run, course=None))
        monkeypatch.setattr(command, '_parser', lambda _: parser)
        assert command.main([]) == 141
        print('lost', file=closed, flush=True)
    assert capfd.readouterr().err == ''
