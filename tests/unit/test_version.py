"""The readable versions in a recording; unknown versions are left out."""

import json
from pathlib import Path
import platform
import shutil
import subprocess

import pytest

from autograder.layout import Layout
from autograder.runs.version import (
    commit,
    difference,
    environment_digest,
    HERE,
    made_with,
    RUNS_PROGRAMS,
    version,
)
from environment.ros import FILE_NAME, MESSAGES_NAME

GIT = pytest.mark.skipif(shutil.which('git') is None, reason='git is not installed')


def git(folder, *arguments):
    who = ('-c', 'user.name=a', '-c', 'user.email=a@example.org', '-c', 'commit.gpgsign=false')
    subprocess.run(['git', *who, '-C', str(folder), *arguments], check=True, capture_output=True)


@pytest.fixture
def repository(tmp_path):
    """Return a repository with one commit that has a tag."""
    root = tmp_path / 'course'
    root.mkdir()
    (root / 'file').write_text('1', encoding='utf-8')
    git(root, 'init')
    git(root, 'add', 'file')
    git(root, 'commit', '-m', 'first')
    git(root, 'tag', 'v1')
    return root


@GIT
def test_a_commit_is_named_and_whether_files_were_changed_since(repository, monkeypatch):
    monkeypatch.setenv('GIT_DIR', '/nowhere')
    clean = commit(repository)
    (repository / 'file').write_text('2', encoding='utf-8')

    assert len(clean) >= 12
    assert int(clean, 16) >= 0
    assert commit(repository) == f'{clean}-dirty'


@GIT
def test_a_copy_inside_another_repository_has_no_commit(repository):
    (repository / 'copy').mkdir()

    assert commit(repository / 'copy') == ''


@GIT
def test_a_repository_without_commits_or_damaged_has_none(tmp_path):
    (tmp_path / '.git').write_text('gitdir: /nowhere', encoding='utf-8')

    assert commit(tmp_path) == ''


def test_without_git_it_is_left_out(tmp_path, monkeypatch):
    (tmp_path / '.git').mkdir()
    monkeypatch.setenv('PATH', str(tmp_path))

    assert commit(tmp_path) == ''


def test_what_is_known_is_named():
    found = made_with()

    assert found['python'] == platform.python_version()
    assert found['rclpy']
    assert found.get('grader', '') == commit(Layout.here().root)
    assert all(found.values())


def an_environment(folder: Path, *, toys: str = '', lock: str = '1.0') -> str:
    """Return the Python of an environment with one locked package, and perhaps two others."""
    site = folder / 'lib' / 'python3.11' / 'site-packages'
    names = [f'ros_std_msgs-{lock}']
    if toys:
        names += ['ros_toy_msgs-1.0', f'ros_base_msgs-{toys}']
        base = f'ros-base-msgs=={toys}'
        note = {'toy_msgs': [base, 'ros-toy-msgs==1.0'], 'base_msgs': [base]}
        folder.mkdir()
        (folder / MESSAGES_NAME).write_text(json.dumps(note), encoding='utf-8')
    for name in names:
        (site / f'{name}.dist-info').mkdir(parents=True)
    text = json.dumps({'workspace': str(folder / 'workspace')})
    (folder / FILE_NAME).write_text(text, encoding='utf-8')
    return str(folder / 'bin' / 'python')


USES, DOES_NOT = 'from toy_msgs.msg import Toy', 'from std_msgs.msg import String'


def test_added_message_package_counts_only_where_it_is_named(tmp_path):
    without, added = an_environment(tmp_path / 'a'), an_environment(tmp_path / 'b', toys='1.0')

    assert environment_digest(without, [DOES_NOT]) == environment_digest(added, [DOES_NOT])
    assert environment_digest(without, [USES]) != environment_digest(added, [USES])
    assert environment_digest(without, [DOES_NOT, '{"type": "toy_msgs/msg/Toy"}']) != (
        environment_digest(added, [DOES_NOT, '{"type": "toy_msgs/msg/Toy"}'])
    )


def test_message_package_counts_with_those_that_it_uses(tmp_path):
    old, new = (an_environment(tmp_path / one, toys=one) for one in ('1.0', '1.1'))

    assert environment_digest(old, [USES]) != environment_digest(new, [USES])
    assert environment_digest(old, [DOES_NOT]) == environment_digest(new, [DOES_NOT])


def test_package_of_the_lock_counts_for_every_run(tmp_path):
    old, new = (an_environment(tmp_path / one, lock=one) for one in ('1.0', '1.1'))

    assert environment_digest(old, ['']) != environment_digest(new, [''])


def test_worker_without_a_message_package_differs(tmp_path):
    without, added = an_environment(tmp_path / 'a'), an_environment(tmp_path / 'b', toys='1.0')

    assert difference(version(added), version(without)) == (
        'packages of environment/messages.txt: expected ros-base-msgs==1.0, ros-toy-msgs==1.0, '
        'got nothing'
    )


@pytest.mark.parametrize('pattern', RUNS_PROGRAMS)
def test_each_pattern_of_the_digest_names_a_file(pattern):
    """A renamed file must not drop out of the digest unnoticed."""
    assert list(HERE.glob(pattern))
