"""The paths of saved cells, refused names, and child processes."""

from contextlib import suppress
import os
import sys

import psutil
import pytest

from autograder.submission.cells import CellFile
from roslab import package_files, run_command
from roslab.errors import NameRefusedError, NotHereError
from roslab.messages import build_messages
from roslab.package_files import learner_package, LearnerPackage, package


@pytest.fixture
def learner(tmp_path):
    """Return an empty package below an empty folder."""
    return LearnerPackage('temp_monitor_pkg', tmp_path)


def test_files_lie_where_a_ros_package_has_them(learner):
    paths = [
        learner.path_of(CellFile(kind, name, ''))
        for kind, name in [('node', 'a'), ('rosmsg', 'A'), ('rospkg', 'package.xml')]
    ]

    assert [str(path.relative_to(learner.folder)) for path in paths] == [
        'temp_monitor_pkg/a.py',
        'msg/A.msg',
        'package.xml',
    ]


def test_saved_file_replaces_the_older_one_at_once(learner):
    path = learner.save(CellFile('node', 'a', 'old\n'))
    with path.open() as older:
        learner.save(CellFile('node', 'a', 'new\n'))

        assert older.read() == 'old\n'
    assert path.read_text() == 'new\n'
    assert os.listdir(path.parent) == ['a.py']


def test_link_out_of_the_package_is_refused(learner, tmp_path):
    learner.folder.mkdir(parents=True)
    (learner.folder / 'msg').symlink_to(tmp_path)
    with pytest.raises(NameRefusedError, match='link'):
        learner.save(CellFile('rosmsg', 'A', 'int64 x\n'))

    assert not (tmp_path / 'A.msg').exists()


def test_texts_are_keyed_as_the_grader_keys_them(learner):
    learner.save(CellFile('node', 'a', 'pass\n'))
    learner.save(CellFile('rosmsg', 'A', 'int64 x\n'))
    (learner.folder / 'temp_monitor_pkg' / '__pycache__').mkdir()
    (learner.folder / 'temp_monitor_pkg' / '__pycache__' / 'a.pyc').write_bytes(b'\x00')
    (learner.folder / '.hidden').write_text('x')

    assert learner.files() == {'a.py': 'pass\n', 'msg/A.msg': 'int64 x\n'}


@pytest.mark.parametrize('name', ['', 'Temp', '../x', 'a b', 'a__b', '1a', 'a_', 'a-b', 3])
def test_package_name_that_ros_would_refuse_is_refused(name):
    with pytest.raises(NameRefusedError, match='my_robot_pkg'):
        package(name)


def test_package_name_can_be_chosen(monkeypatch, tmp_path):
    monkeypatch.setattr(package_files, '_name', 'temp_monitor_pkg')
    monkeypatch.chdir(tmp_path)

    assert package() == 'temp_monitor_pkg'
    assert package('num_pkg') == 'num_pkg'
    assert learner_package().folder == tmp_path / 'ros_ws/src/num_pkg'


def run(code, tmp_path, deadline_s=20.0, **options):
    facts = {'cwd': tmp_path, 'env': os.environ, 'tick_s': 0.05, **options}
    return run_command.run([sys.executable, '-c', code], deadline_s=deadline_s, **facts)


def test_child_returns_its_output_and_code(tmp_path):
    outcome = run('import sys; print(1); print(2, file=sys.stderr); sys.exit(3)', tmp_path)

    assert outcome.returncode == 3
    assert sorted(outcome.output.split()) == ['1', '2']


@pytest.mark.slow
def test_child_past_its_deadline_is_ended_with_its_family(tmp_path):
    family = (
        'import subprocess, sys, time\n'
        'p = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(600)"])\n'
        'print(p.pid, flush=True)\n'
        'time.sleep(600)\n'
    )
    outcome = run(family, tmp_path, deadline_s=10.0)

    assert outcome.returncode is None
    with suppress(psutil.NoSuchProcess):  # the process was killed, but may still exist
        psutil.Process(int(outcome.output)).wait(60)


def test_long_output_is_cut_at_its_beginning(tmp_path):
    outcome = run('print("x" * 5_000_000); print("end")', tmp_path)

    assert len(outcome.output) <= 2_000_000
    assert outcome.output.endswith('end\n')


def test_output_of_a_running_command_is_seen_and_stays_whole(tmp_path):
    seen = []

    def on_tick(seconds, output):
        seen.append(output)
        if '[1/2]' in output:
            (tmp_path / 'go').touch()

    waits = 'while not os.path.exists("go"): time.sleep(0.01)'
    code = f'import os, time\nprint("[1/2]", flush=True)\n{waits}\nprint(2)'
    outcome = run(code, tmp_path, deadline_s=60.0, on_tick=on_tick, tick_s=0.01)

    assert '[1/2]\n' in seen
    assert (outcome.returncode, outcome.output) == (0, '[1/2]\n2\n')


@pytest.mark.parametrize('folder', ['/', '/tmp', '/nowhere/a/b/c'])
def test_a_folder_in_no_workspace_is_not_built(folder):
    with pytest.raises(NotHereError, match='expected a package inside a workspace'):
        build_messages(folder)
