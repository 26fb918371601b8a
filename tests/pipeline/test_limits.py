"""
Test the limits of the kernel, of a folder and of the probe.

Programs in ``tests/attacks`` exceed the limits that the grader watches: see ``Ends`` in their
docstrings.
"""

from dataclasses import replace

import pytest

from autograder.exam.scenario import Scenario
from autograder.exam.steps import Advance
from autograder.runs import observe
from autograder.runs.observe import observe as run
from autograder.sandboxes.choose import strongest, usable
from autograder.sandboxes.confinement import Limits
from autograder.sandboxes.sandbox import Sandbox

pytestmark = [pytest.mark.pipeline, pytest.mark.ros]

LIMITS = Limits()


def recorded(monkeypatch, text: str, limits: Limits, sandbox: Sandbox | None = None):
    whole = observe.program_for
    monkeypatch.setattr(observe, 'program_for', lambda *facts: (whole(*facts)[0], limits))
    scenario = Scenario(file='x.py', appear_s=30.0, steps=(Advance(60.0),))
    return run('limits', scenario.to_json(), {'x.py': text}, sandbox or strongest())[0]


WRITES = """
import itertools, os
for number in itertools.count():
    with open(f'{os.environ["TMPDIR"]}/{number}', 'wb') as file:
        file.write(bytes(1 << 20))
"""


def test_files_of_a_program_without_its_own_file_system_are_summed(monkeypatch):
    """In other modes, the file systems of the folders limit the size."""
    recording = recorded(monkeypatch, WRITES, replace(LIMITS, folder=32 << 20), usable('none'))

    assert recording.end_reason == 'disk_limit'


FORKS = """
import os, time
count = 0
try:
    while count < 500:
        if os.fork() == 0:
            time.sleep(1000)
        count += 1
except BlockingIOError:
    print('count', count, flush=True)
"""
OPENS = """
held = []
try:
    while len(held) < 5000:
        held.append(open('/dev/null'))
except OSError:
    print('count', len(held), flush=True)
"""
FILLS = """
import signal
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
written = 0
try:
    with open('/tmp/big', 'wb', buffering=0) as file:
        while written < 10 ** 9:
            written += file.write(bytes(1 << 20))
except OSError:
    print('count', written, flush=True)
"""
TWO_FOLDERS = """
written = 0
for name in ('/tmp/a', '/tmp/b', '/tmp/c'):
    try:
        with open(name, 'wb', buffering=0) as file:
            for _ in range(40):
                written += file.write(bytes(1 << 20))
    except OSError:
        pass
print('count', written, flush=True)
"""
GRABS = """
import mmap
held = []
try:
    while len(held) < 100:
        held.append(mmap.mmap(-1, 100 << 20))
except OSError:
    print('count', len(held), flush=True)
"""


@pytest.mark.parametrize(
    ('text', 'least', 'most'),
    [
        (FORKS, 30, 64),
        (OPENS, 100, 256),
        (FILLS, 32 << 20, 64 << 20),
        (TWO_FOLDERS, 40 << 20, 64 << 20),
        (GRABS, 10, 20),
    ],
    ids=['processes', 'open_files', 'size_of_a_file', 'size_of_a_folder', 'address_space'],
)
def test_a_limit_of_the_kernel_stops_the_program_itself(text, least, most, monkeypatch):
    """The program gets an error, and can report how far it got."""
    recording = recorded(monkeypatch, text, LIMITS)
    said = str(recording.process['stdout'])

    assert said.startswith('count '), recording.process
    assert least <= int(said.split()[1]) <= most


NODE = """
import rclpy
from std_msgs.msg import String
rclpy.init()
node = rclpy.create_node('n')
publisher = node.create_publisher(String, '/chatter', 10)
def send():
    for _ in range({count}):
        publisher.publish(String(data='x' * {size}))
node.create_timer(0.1, send)
rclpy.spin(node)
"""


@pytest.mark.parametrize(
    ('size', 'count', 'reason'), [(200_000, 1, 'complete'), (1, 60, 'too_many_events')]
)
def test_the_probe_bounds_the_size_and_the_number_of_messages(size, count, reason, monkeypatch):
    """Only the size of a message that is too large is recorded; too many end the run."""
    scenario = Scenario(
        file='x.py',
        watch={'/chatter': 'std_msgs/msg/String'},
        steps=(Advance(90.0),),
    )
    files = {'x.py': NODE.format(size=size, count=count)}
    recording, _ = run('limits', scenario.to_json(), files, strongest())
    messages = recording.of('message')

    assert recording.end_reason == reason
    assert messages
    if size > 65536:
        assert all(message['too_large'] > size and 'data' not in message for message in messages)
    else:
        assert 10_000 < len(messages) <= 20_000
