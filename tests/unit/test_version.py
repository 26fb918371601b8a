"""What a recording says it was made with: versions for people, left out where they are unknown."""

from __future__ import annotations

import platform
import shutil
import subprocess

import pytest

from autograder.layout import Layout
from autograder.runs.version import commit, made_with

GIT = pytest.mark.skipif(shutil.which('git') is None, reason='git is not installed')


def git(folder, *arguments):
    """Call git as nobody in particular."""
    who = ('-c', 'user.name=a', '-c', 'user.email=a@example.org', '-c', 'commit.gpgsign=false')
    subprocess.run(['git', *who, '-C', str(folder), *arguments], check=True, capture_output=True)


@pytest.fixture
def repository(tmp_path):
    """Return a repository with one commit, which has a tag."""
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
    """Also where a hook of another repository runs us."""
    monkeypatch.setenv('GIT_DIR', '/nowhere')
    clean = commit(repository)
    (repository / 'file').write_text('2', encoding='utf-8')

    assert len(clean) >= 12
    assert int(clean, 16) >= 0
    assert commit(repository) == f'{clean}-dirty'


@GIT
def test_a_copy_inside_another_repository_has_no_commit(repository):
    """That of the other one would be a lie."""
    (repository / 'copy').mkdir()

    assert commit(repository / 'copy') == ''


@GIT
def test_a_repository_without_commits_or_damaged_has_none(tmp_path):
    """It is no reason not to grade."""
    (tmp_path / '.git').write_text('gitdir: /nowhere', encoding='utf-8')

    assert commit(tmp_path) == ''


def test_without_git_it_is_left_out(tmp_path, monkeypatch):
    """As in a container."""
    (tmp_path / '.git').mkdir()
    monkeypatch.setenv('PATH', str(tmp_path))

    assert commit(tmp_path) == ''


def test_what_is_known_is_named():
    """Here at least Python and rclpy."""
    found = made_with()

    assert found['python'] == platform.python_version()
    assert found['rclpy']
    assert found.get('grader', '') == commit(Layout.here().root)
    assert all(found.values())
