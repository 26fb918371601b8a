"""Notebooks do not receive each other's messages; one line connects a terminal to one of them."""

import os
from pathlib import Path
import re
import shutil
import subprocess
import sys
import tempfile

import pytest

from tests.ros import live_kernels
from tests.ros.live_kernels import AS_USER, TALKER

pytestmark = [pytest.mark.ros, pytest.mark.notebooks]

OTHER_USER = 1_234_567_890


def may_start(user):
    """Return whether another user can run the course's Python from this checkout."""
    command = [*AS_USER, str(user), os.devnull, sys.executable, '-c', 'import roslab']
    command[2] = command[2].replace('chown "$user" "$2"; ', '')
    env = {**os.environ, 'HOME': tempfile.gettempdir(), 'ROS_LOG_DIR': tempfile.gettempdir()}
    return subprocess.run(command, cwd='/', env=env, stderr=subprocess.DEVNULL).returncode == 0


@pytest.fixture
def kernels():
    """Return a function that starts a user's kernel, which chooses its own domain."""
    started, folders = [], []

    def start(user=None):
        folder = Path(tempfile.mkdtemp(prefix='domains-'))
        folders.append(folder)
        if user is not None:
            os.chown(folder, user, user)
        kernel = live_kernels.Kernel(folder, domain='', user=user)
        started.append(kernel)
        kernel.run(TALKER)
        return kernel

    yield start
    for kernel in started:
        kernel.shut_down()
    for folder in folders:
        shutil.rmtree(folder)


def test_nothing_crosses_between_kernels_of_two_users(kernels):
    """Two kernels of one user and one kernel of another use the same topic."""
    users = [None, None]
    if os.geteuid() == 0:
        if not may_start(OTHER_USER):
            pytest.skip('other users may not read this checkout')
        users += [OTHER_USER]
    found = [kernels(user) for user in users]
    names = [f'/talker_{number}_of_{os.getpid()}' for number in range(len(users))]
    for number, kernel in enumerate(found):
        kernel.run(
            f'mine = start(Talker, name="{names[number][1:]}"); mine.count = {number}000000'
        )
    for number, kernel in enumerate(found):
        kernel.run("heard = listen('chatter', String); heard.wait(20, timeout=60)")
        heard = f'{{int(m.data) // 1000000 for m in heard.messages}} == {{{number}}}'
        assert kernel.run(heard).value == 'True'
        # On a busy machine, a first node may be discovered later than the command usually waits.
        ros2 = 'ros2 node list --spin-time 20'
        for look in ('print(*graph().nodes)', f'!{ros2}', f'%%bash\n{ros2}'):
            assert [name for name in names if name in kernel.run(look).text] == [names[number]]

    numbers = [kernel.run('import os; os.environ["ROS_DOMAIN_ID"]').value for kernel in found]
    assert len(set(numbers)) == len(users)


def test_terminal_joins_a_notebook_with_the_line_that_it_prints(kernels):
    """Without the line, the terminal does not see the notebook's nodes."""
    kernel = kernels()
    name = f'joined_by_{os.getpid()}'
    kernel.run(f'mine = start(Talker, name="{name}")')
    line = kernel.run('domain()').text.splitlines()[-1]
    assert re.fullmatch(r'export ROS_DOMAIN_ID=\d+', line)

    env = {**os.environ, 'ROS_DOMAIN_ID': ''}
    ros2 = Path(sys.executable).with_name('ros2')
    lists = [
        subprocess.run(
            ['sh', '-c', f'{before}{ros2} node list'], env=env, capture_output=True, text=True
        ).stdout.split()
        for before in ('', f'{line}\n')
    ]

    assert [f'/{name}' in seen for seen in lists] == [False, True]


def test_domain_follows_what_ros_was_started_with(kernels):
    """Changing the variable later does not affect running nodes."""
    kernel = kernels()
    before = kernel.run('mine = start(Talker); domain()').text
    after = kernel.run('import os; os.environ["ROS_DOMAIN_ID"] = "77"; domain()').text

    assert before == after


def test_graph_calls_only_its_own_listener_this_notebook(kernels, tmp_path):
    """Two kernels in the same domain see each other's hidden nodes."""
    kernel = kernels()
    number = kernel.run('import os; os.environ["ROS_DOMAIN_ID"]').value.strip("'")
    other = live_kernels.Kernel(tmp_path, domain=number)
    try:
        kernel.run('mine = start(Talker)')
        other.run(f'{TALKER}\nheard = listen("chatter", String); heard.wait(2)')
        # The subscription is discovered before the name of its node.
        known = '{i.node_name for i in mine.get_subscriptions_info_by_topic("/chatter")}'
        unknown = '{"_NODE_NAME_UNKNOWN_"}'
        kernel.run(f'wait_until(lambda: {known} - {unknown}, timeout=60)')
        seen = kernel.run('print(graph("chatter"))').text
        theirs = other.run('print(graph("chatter"))').text
    finally:
        other.shut_down()

    assert 'another notebook listens' in seen
    assert 'this notebook listens' in theirs
