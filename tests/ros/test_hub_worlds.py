"""A kernel's network on a hub: whatever ROS settings a program has, no message crosses."""

from contextlib import ExitStack
import os
import subprocess
import sys
import tempfile

import pytest

from deploy.hub.settings import HERE
from tests.own_domain import own_domain

pytestmark = pytest.mark.ros

USERS = (1_234_567_891, 1_234_567_892)
HOSTILE = {
    'FASTDDS_BUILTIN_TRANSPORTS': 'UDPv4',
    'ROS_AUTOMATIC_DISCOVERY_RANGE': 'SUBNET',
    'ROS_LOG_DIR': tempfile.gettempdir(),
    'SHELL': '/bin/sh',
}
"""With these, programs of two users in one domain receive each other's messages."""
SPEAKER = """
import queue, sys, threading
import rclpy
from std_msgs.msg import String

word, expected = sys.argv[1], int(sys.argv[2])
received = queue.SimpleQueue()
rclpy.init()
node = rclpy.create_node('speaker')
publisher = node.create_publisher(String, 'crossing', 10)
node.create_timer(0.05, lambda: publisher.publish(String(data=word)))
node.create_subscription(String, 'crossing', lambda message: received.put(message.data), 10)
threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
print('ready', flush=True)
sys.stdin.readline()
received, words = queue.SimpleQueue(), []
while words.count(word) < 40 or len(set(words)) < expected:
    words.append(received.get())
print(*sorted(set(words)), flush=True)
sys.stdin.readline()
"""


def as_user(user: int) -> list[str]:
    """Return the prefix that makes a command run as another user, empty if that is not allowed."""
    options = (f'--reuid={user}', f'--regid={user}', '--clear-groups')
    return ['setpriv', *options] if os.geteuid() == 0 else []


def test_no_message_crosses_but_a_terminal_can_join() -> None:
    """Two kernels have the settings that reach furthest; a terminal enters one of the networks."""
    start, join = ((HERE / name).read_text() for name in ('own_world.sh', 'join_world.sh'))
    ann, bob = map(as_user, USERS)
    trial = [*ann, 'sh', '-c', start, 'sh', sys.executable, '-c', '']
    if refused := subprocess.run(trial, capture_output=True, text=True, cwd='/').stderr:
        pytest.skip(refused)
    with ExitStack() as until:
        domain = {'ROS_DOMAIN_ID': str(own_domain(until)), 'SPEAKER': SPEAKER}
        environ = {**os.environ, **HOSTILE, **domain}
        environ.pop('FASTRTPS_DEFAULT_PROFILES_FILE', None)

        def started(*command: str, typed: str = '') -> subprocess.Popen[str]:
            process = subprocess.Popen(
                command,
                env=environ,
                cwd='/',
                text=True,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
            )
            until.enter_context(process)
            until.callback(process.kill)
            process.stdin.write(typed)
            process.stdin.flush()
            assert process.stdout.readline() == 'ready\n'
            return process

        kernel = ('sh', '-c', start, 'sh', sys.executable, '-c', SPEAKER)
        of_ann = started(*ann, *kernel, 'ann', '2')
        of_bob = started(*bob, *kernel, 'bob', '1')
        shell = (*ann, 'sh', '-c', join, 'sh', str(of_ann.pid))
        terminal = started(*shell, typed=f'exec {sys.executable} -c "$SPEAKER" terminal 2\n')
        for process in (of_ann, of_bob, terminal):
            process.stdin.write('\n')
            process.stdin.flush()
        received = [process.stdout.readline().split() for process in (of_ann, of_bob, terminal)]
    assert received == [['ann', 'terminal'], ['bob'], ['ann', 'terminal']]
