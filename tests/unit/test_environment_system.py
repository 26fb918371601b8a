"""Missing system packages are installed if this is allowed, or else named."""

import os

import pytest

from environment import system
from environment.steps import Job, StepError

FAKE_APT = """#!/bin/sh
echo "$@" >> {log}
[ "$1" = install ] || exit {update_code}
for package; do
  case $package in
    g++|make) : > {folder}/$package; chmod +x {folder}/$package;;
    bubblewrap) : > {folder}/bwrap; chmod +x {folder}/bwrap;;
  esac
done
"""


@pytest.fixture
def machine(tmp_path, monkeypatch):
    """Return a folder that is the whole PATH, and that may get a fake apt-get."""
    folder = tmp_path / 'bin'
    folder.mkdir()
    monkeypatch.setenv('PATH', str(folder))
    (folder / 'sh').symlink_to('/bin/sh')
    (folder / 'chmod').symlink_to('/bin/chmod')
    return folder


def add_apt(folder, update_code=0):
    """Add a fake apt-get to the PATH; return the file in which it notes its arguments."""
    log = folder.parent / 'apt.log'
    program = folder / 'apt-get'
    program.write_text(FAKE_APT.format(log=log, folder=folder, update_code=update_code))
    program.chmod(0o755)
    return log


def install(python=None):
    with open(os.devnull, 'w') as log:
        system.install_missing(Job(log), os.environ, python)


@pytest.fixture
def root(monkeypatch):
    monkeypatch.setattr(os, 'geteuid', lambda: 0)


@pytest.fixture
def user(monkeypatch):
    monkeypatch.setattr(os, 'geteuid', lambda: 1000)


def test_install_missing_as_root_uses_apt(machine, root):
    log = add_apt(machine)

    install()

    update, installed = log.read_text().splitlines()
    assert update.startswith('update')
    assert installed.endswith(' g++ make bubblewrap python3 python3-venv python3-dev')
    assert system.missing_tools() == []


def test_install_missing_update_fails_installs_from_old_lists(machine, root):
    add_apt(machine, update_code=100)

    install()

    assert system.missing_tools() == []


def test_install_missing_without_root_names_the_command(machine, user):
    log = add_apt(machine)

    with pytest.raises(StepError, match=r'C\+\+ compiler, make') as caught:
        install()

    assert 'sudo apt-get install -y g++ make bubblewrap' in caught.value.try_this
    assert not log.exists()


def test_install_missing_only_bubblewrap_goes_on(machine, user):
    for name in ('g++', 'make'):
        (machine / name).write_text('')
        (machine / name).chmod(0o755)
    python = type('Python', (), {'path': '/opt/python3', 'has_venv': True, 'has_headers': True})

    install(python)

    assert [tool.command for tool in system.missing_tools()] == ['bwrap']


def test_apt_get_with_password_is_not_used(machine, user):
    """A sudo that asks for a password would block a set-up without a keyboard."""
    add_apt(machine)
    sudo = machine / 'sudo'
    sudo.write_text('#!/bin/sh\nexit 1\n')
    sudo.chmod(0o755)

    assert system.apt_get(os.environ) is None

    sudo.write_text('#!/bin/sh\nexit 0\n')
    assert system.apt_get(os.environ)[:2] == [str(sudo), '-n']
