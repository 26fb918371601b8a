"""Each kernel has a separate ROS domain, as long as one is free."""

import os
import random
import subprocess
import sys

import pytest

from environment import ros_domain
from environment.ros_domain import claim, DOMAINS
from roslab import own_kernel as kernel_domain

CLAIM = """
import sys
from environment import ros_domain
ros_domain.NAME = sys.argv[1]
held = ros_domain.claim([7])
print(held.domain if held else 'claimed', flush=True)
sys.stdin.read()
"""


class Shell:
    """An IPython shell that calls registered functions before a cell."""

    def __init__(self):
        self.events = self
        self.callbacks = []

    def register(self, event, callback):
        assert event == 'pre_run_cell'
        self.callbacks.append(callback)

    def unregister(self, event, callback):
        self.callbacks.remove(callback)

    def run_cell(self):
        """Call the registered functions, as IPython does before a cell."""
        for callback in list(self.callbacks):
            callback(None)


@pytest.fixture
def name(monkeypatch):
    """Use names that no other process claims, and begin without a claim."""
    name = f'test-{os.getpid()}-{random.SystemRandom().getrandbits(64)}-'
    monkeypatch.setattr(ros_domain, 'NAME', name)
    monkeypatch.setattr(kernel_domain, '_claimed', None)
    monkeypatch.setenv('JPY_SESSION_NAME', '/home/ann/lesson.ipynb')
    monkeypatch.delenv('ROS_DOMAIN_ID', raising=False)
    return name


@pytest.fixture
def claiming(name):
    """Return a function that starts a process, which claims domain 7 and prints the result."""
    processes = []

    def start():
        pipes = {'stdin': subprocess.PIPE, 'stdout': subprocess.PIPE, 'text': True}
        process = subprocess.Popen([sys.executable, '-c', CLAIM, name], **pipes)
        processes.append(process)
        return process, process.stdout.readline().strip()

    yield start
    for process in processes:
        process.kill()
        process.communicate()


def kernel(monkeypatch):
    """Claim a domain as a starting kernel does, and return its shell and its claim."""
    monkeypatch.setattr(kernel_domain, '_claimed', None)
    monkeypatch.delenv('ROS_DOMAIN_ID', raising=False)
    shell = Shell()
    kernel_domain.claim_domain(shell)
    return shell, kernel_domain._claimed


def test_claimed_domain_is_not_given_twice(name):
    first, second = claim([3, 4]), claim([3, 4])
    assert (first.domain, second.domain) == (3, 4)
    assert claim([3, 4]) is None

    first.holder.close()
    third = claim([3, 4])
    assert third.domain == 3
    for held in (second, third):
        held.holder.close()


def test_claim_ends_with_a_killed_process(claiming):
    holder, got = claiming()
    assert (got, claiming()[1]) == ('7', 'claimed')

    holder.kill()
    holder.wait()

    assert claiming()[1] == '7'


def test_claim_is_not_inherited_by_child_processes(name):
    """A program that a cell has started does not keep the domain of an ended kernel."""
    held = claim([7])
    with subprocess.Popen(['cat'], stdin=subprocess.PIPE) as child:
        held.holder.close()
        again = claim([7])
        child.stdin.close()
    assert again is not None
    again.holder.close()


def test_kernels_of_one_notebook_have_different_domains(name, monkeypatch):
    _, first = kernel(monkeypatch)
    assert os.environ['ROS_DOMAIN_ID'] == str(first.domain)
    _, second = kernel(monkeypatch)
    assert os.environ['ROS_DOMAIN_ID'] == str(second.domain)

    assert first.domain != second.domain
    assert {first.domain, second.domain} <= set(DOMAINS)
    for held in (first, second):
        held.holder.close()


def test_restarted_kernel_has_the_domain_of_before(name, monkeypatch):
    """A terminal can continue to use the notebook's domain."""
    _, before = kernel(monkeypatch)
    before.holder.close()
    _, after = kernel(monkeypatch)

    assert after.domain == before.domain
    after.holder.close()


def test_kernel_without_a_free_domain_says_so_in_its_first_cell(name, monkeypatch, capsys):
    held = [claim([number]) for number in DOMAINS]
    shell, claimed = kernel(monkeypatch)
    assert (claimed, os.environ['ROS_DOMAIN_ID'], capsys.readouterr().out) == (None, '0', '')

    shell.run_cell()
    said = capsys.readouterr().out
    assert said.startswith('Note: all 101 ROS domains on this machine are in use.')
    assert 'domain 0' in said

    shell.run_cell()
    assert capsys.readouterr().out == ''
    for one in held:
        one.holder.close()


def test_domain_set_by_the_user_is_kept(name, monkeypatch, capsys):
    monkeypatch.setenv('ROS_DOMAIN_ID', '42')
    shell = Shell()
    kernel_domain.claim_domain(shell)
    first = kernel_domain._claimed
    monkeypatch.setattr(kernel_domain, '_claimed', None)
    kernel_domain.claim_domain(shell)

    assert os.environ['ROS_DOMAIN_ID'] == '42'
    assert (first.domain, kernel_domain._claimed) == (42, None)
    shell.run_cell()
    assert capsys.readouterr().out == ''
    first.holder.close()


def test_system_without_abstract_sockets_is_named(name, monkeypatch, capsys):
    def refuse(domains):
        raise OSError(2, 'No such file or directory')

    monkeypatch.setattr(kernel_domain, 'claim', refuse)
    shell, _ = kernel(monkeypatch)
    shell.run_cell()

    assert os.environ['ROS_DOMAIN_ID'] == '0'
    assert 'cannot claim a ROS domain (No such file or directory)' in capsys.readouterr().out
