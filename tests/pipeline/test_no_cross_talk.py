"""
Other programs on the machine, such as a second grader, do not change verdicts.

Four submissions with the same node names and topics are judged one at a time, then by two graders
at once, four at a time each.  Meanwhile, a program publishes on those topics in most ROS domains.
"""

from collections.abc import Iterable, Iterator
from contextlib import contextmanager, ExitStack
import json
import os
from pathlib import Path
import subprocess
import sys

import pytest

from environment.ros2_command import PROFILES
from tests.own_domain import other_domains

pytestmark = [pytest.mark.pipeline, pytest.mark.slow, pytest.mark.ros]

ROOT = Path(__file__).resolve().parents[2]
ASSIGNMENT = '03_topics'
NAMES = (
    *('pass__own_executors', 'fail__counts_to_four'),
    *('fail__exception_in_a_thread', 'fail__loop_with_sleep'),
)
TOGETHER = 4
GRADER = f"""
import json, sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from autograder.exam import catalog
from autograder.sandboxes import choose
from autograder.grading.examine import Engine

exam, box = catalog.load('talker'), choose.strongest()


def judged(name):
    path = Path('tests/submissions/{ASSIGNMENT}', name, 'talker.py')
    result = Engine(box).run(exam, {{'talker.py': path.read_text('utf-8')}}).to_json()
    return {{**result, 'timing': None}}


with ThreadPoolExecutor(int(sys.argv[1])) as pool:
    print(json.dumps(list(pool.map(judged, sys.argv[2:]))))
"""


def begin(together: int) -> subprocess.Popen[str]:
    """Start a grader that judges the submissions, a given number at a time."""
    argv = [sys.executable, '-c', GRADER, str(together), *NAMES]
    return subprocess.Popen(argv, cwd=ROOT, stdout=subprocess.PIPE, text=True)


def end(grader: subprocess.Popen[str]) -> list[dict]:
    """Return the results of a grader."""
    said, _ = grader.communicate(timeout=300)
    assert grader.returncode == 0
    return json.loads(said)


@contextmanager
def somebody_talks(domains: Iterable[int]) -> Iterator[None]:
    """Run a program that publishes in these domains and announces itself continuously."""
    variables = {**os.environ, 'FASTRTPS_DEFAULT_PROFILES_FILE': str(PROFILES)}
    script = Path(__file__).with_name('foreign_talker.py')
    pipes = {'stdin': subprocess.PIPE, 'stdout': subprocess.PIPE}
    argv = [sys.executable, str(script), *map(str, domains)]
    with subprocess.Popen(argv, env=variables, **pipes) as talker:
        assert talker.stdout.readline() == b'talking\n'
        yield
        assert talker.poll() is None, 'the talker must run until the end'
        talker.stdin.close()


@pytest.fixture(scope='module')
def alone() -> list[dict]:
    """Return the results of one submission after the other, without other programs."""
    return end(begin(1))


def test_two_graders_and_a_talker_in_every_domain_change_nothing(alone):
    with ExitStack() as until:
        # Isolated sandboxes use domain 0; above 101, Linux may assign the ports to other programs.
        until.enter_context(somebody_talks((0, *other_domains(until), 101)))
        graders = [begin(TOGETHER), begin(TOGETHER)]
        found = [end(grader) for grader in graders]

    assert found == [alone, alone]


def test_the_submissions_differ_among_themselves(alone):
    """If two submissions were mixed up, their results would show it."""
    points = [sum(check['points'] for check in one['checks']) for one in alone]

    assert len(set(points)) >= 3


def test_the_foreign_talker_is_heard_outside_a_sandbox():
    """A program in the same domain receives its messages."""
    code = (
        'import rclpy\nfrom std_msgs.msg import String\n'
        'rclpy.init()\nnode = rclpy.create_node("listener")\nheard = []\n'
        'node.create_subscription(String, "/chatter", heard.append, 10)\n'
        'while not heard:\n    rclpy.spin_once(node, timeout_sec=0.1)\nprint(heard[0].data)\n'
    )
    variables = {
        **os.environ,
        'FASTRTPS_DEFAULT_PROFILES_FILE': str(PROFILES),
        'ROS_DOMAIN_ID': os.environ.get('ROS_DOMAIN_ID', '0'),
    }
    variables.pop('ROS_AUTOMATIC_DISCOVERY_RANGE', None)
    # Use only one domain: participants in a hundred domains would starve each other while other
    # tests run.
    with somebody_talks([int(variables['ROS_DOMAIN_ID'])]):
        done = subprocess.run(
            [sys.executable, '-c', code],
            env=variables,
            capture_output=True,
            text=True,
            timeout=60,
            check=False,
        )

    assert 'foreign' in done.stdout, done.stderr
