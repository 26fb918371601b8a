"""Test descriptors that threads or processes share, and attempts to hide messages in flight."""

from collections.abc import Iterator
from contextlib import contextmanager
import os
from pathlib import Path
import signal
import subprocess
import sys

import pytest

from autograder.clock.virtual_clock import virtual_clock, VirtualClock
from tests.clock import test_hostile_programs as hostile
from tests.clock.test_hostile_programs import end, Pair
from tests.clock.test_waits import BEGIN

CASES = {
    'locks do not count as polling': (
        'lock = threading.Lock()\nfor _ in range(20000):\n    with lock: pass\ntell()',
        [[0]],
    ),
    'looks at processor time do not count as polling': (
        'while time.process_time() < 0.3: pass\ntell()',
        [[0]],
    ),
    'prints do not count as polling': (
        "out = open('/dev/null', 'w')\n"
        'for number in range(5000): print(number, file=out, flush=True)\ntell()',
        [[0]],
    ),
    'reads of files do not count as polling': (
        "for _ in range(2000): open('/etc/hostname').read()\ntell()",
        [[0]],
    ),
    'one thread reads and one writes a descriptor': (
        """
ours, theirs = socket.socketpair()
ours.setblocking(False); theirs.setblocking(False)
try:
    while True: theirs.send(b'x' * 4096)
except BlockingIOError:
    threading.Thread(target=select.select, args=([], [theirs], [])).start()
def drain():
    time.sleep(1)
    try:
        while True: ours.recv(10**6)
    except BlockingIOError:
        time.sleep(1); ours.send(b'z')
threading.Thread(target=drain).start()
select.select([theirs], [], []); tell()
""",
        [[2]],
    ),
    'two threads read one socket': (
        """
bad = []
ours, theirs = socket.socketpair()
def read():
    try:
        while theirs.recv(1) == b'x': pass
    except OSError as error:
        bad.append(repr(error))
for _ in range(2): threading.Thread(target=read, daemon=True).start()
for _ in range(300):
    time.sleep(0.1); ours.send(b'x')
tell(bad); os._exit(0)
""",
        [[30, []]],
    ),
    'a receive ends when its socket is shut down': (
        """
datagrams = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
datagrams.bind(('127.0.0.1', 0))
def read():
    datagrams.recv(10); tell()
threading.Thread(target=read).start()
time.sleep(1)
try: datagrams.shutdown(socket.SHUT_RD)
except OSError: pass  # not connected, and it works
""",
        [[1]],
    ),
    'a waiter is killed and its pipe lives on': (
        """
reading, writing = os.pipe()
child = os.fork()
if child == 0:
    select.select([reading], [], []); os._exit(0)
time.sleep(0.6)
os.kill(child, 9); os.waitpid(child, 0)
os.write(writing, b'x')
time.sleep(5); tell()
""",
        [[5.6]],
    ),
    'the number of a closed timerfd is that of another file': (
        """
import ctypes
libc = ctypes.CDLL(None)
timer = libc.timerfd_create(time.CLOCK_MONOTONIC, 0)
libc.timerfd_settime(timer, 0, (ctypes.c_int64 * 4)(1, 0, 1, 0), None)
os.read(timer, 8); os.close(timer)
ours, theirs = socket.socketpair()
tell(ours.fileno() == timer, len(select.select([theirs], [], [], 5)[0]))
""",
        [[6, True, 0]],
    ),
    'posix_spawn with closefrom': (
        """
import ctypes
libc = ctypes.CDLL(None)
actions = ctypes.create_string_buffer(256)
libc.posix_spawn_file_actions_init(actions)
libc.posix_spawn_file_actions_addclosefrom_np(actions, 3)
pid = ctypes.c_int()
words = (ctypes.c_char_p * 3)(b'/bin/sleep', b'1', None)
environ = ctypes.POINTER(ctypes.c_char_p).in_dll(libc, 'environ')
libc.posix_spawn(ctypes.byref(pid), b'/bin/sleep', actions, None, words, environ)
tell(os.waitpid(pid.value, 0)[1])
""",
        [[1, 0]],
    ),
}


@pytest.mark.parametrize('name', CASES)
def test_time_is_right_although(on_clock, name):
    """Each case once gave a wrong time."""
    text, expected = CASES[name]
    assert on_clock(BEGIN + text) == [expected]


@contextmanager
def started(file: Path, clock: VirtualClock) -> Iterator[subprocess.Popen[str]]:
    """Start a Python program in the only place of a clock."""
    with subprocess.Popen(
        [sys.executable, '-I', str(file)],
        env={**os.environ, **clock.variables(0)},
        pass_fds=[clock.places[0].fileno()],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    ) as program:
        clock.begin()
        yield program


def test_children_of_a_parent_that_ends_at_once_have_places(tmp_path):
    """The driver reads the last messages of a process before it removes the process."""
    file = tmp_path / 'parent.py'
    file.write_text(
        'import os, sys, time\n'
        'print("ready", flush=True)\n'
        'sys.stdin.readline()\n'
        'for number in range(3):\n'
        '    if os.fork() == 0: time.sleep(1 + number); print(number, flush=True); os._exit(0)\n'
        'os._exit(0)\n'
    )
    with virtual_clock(1) as clock, started(file, clock) as parent:
        assert parent.stdout.readline() == 'ready\n'
        os.kill(clock.driver.pid, signal.SIGSTOP)
        parent.stdin.write('go\n')
        parent.stdin.close()
        parent.wait()
        os.kill(clock.driver.pid, signal.SIGCONT)

        assert parent.stdout.read().split() == ['0', '1', '2']


CHILD_THAT_LEAVES = """
import os, socket, sys, threading, time
print('ready', flush=True)
sys.stdin.readline()
child = os.fork()
if child == 0:  # from here on, it has a place
    for name in os.listdir('/proc/self/fd'):
        try:
            found = socket.socket(fileno=int(name))
        except OSError:
            continue
        if found.type == socket.SOCK_SEQPACKET:
            found.shutdown(socket.SHUT_RDWR)
    sum(range(5_000_000))
    os._exit(0)
print(child, flush=True)
threading.Thread(target=time.sleep, args=[5], daemon=True).start()
began = time.monotonic()
os.wait()
print(time.monotonic() - began, flush=True)
os._exit(0)
"""


def test_time_waits_for_a_child_that_was_quicker_than_the_driver(tmp_path):
    """The child runs before the driver has created its place, and closes its socket early."""
    file = tmp_path / 'parent.py'
    file.write_text(CHILD_THAT_LEAVES)
    with virtual_clock(1) as clock, started(file, clock) as parent:
        assert parent.stdout.readline() == 'ready\n'
        os.kill(clock.driver.pid, signal.SIGSTOP)
        parent.stdin.write('go\n')
        parent.stdin.close()
        child = int(parent.stdout.readline())
        while b') S ' not in Path(f'/proc/{child}/stat').read_bytes():
            pass  # it waits for the driver's answer
        os.kill(clock.driver.pid, signal.SIGCONT)

        assert parent.stdout.read() == '0.0\n'


def test_program_cannot_hide_the_messages_of_another(tmp_path, monkeypatch):
    """Hundreds of epoll sets that watch a program's set make only its own registrations fail."""
    monkeypatch.setattr(
        hostile,
        'HONEST',
        """
import socket, threading, time
time.sleep(0.5); began = time.monotonic()
ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_DGRAM)
late = []
def hear():
    for number in range(1, 501):
        theirs.recv(1); late.append(round(time.monotonic() - began - 0.1 * number, 6))
thread = threading.Thread(target=hear); thread.start()
for _ in range(500):
    time.sleep(0.1); ours.send(b'x')
thread.join()
print(len([one for one in late if one]))
""",
    )
    attack = """
import select
low = own('eventpoll')[0]
keep = [select.epoll() for _ in range(600)]
for one in keep: one.register(low, select.EPOLLIN)
attacks(); time.sleep(1000)
"""
    with virtual_clock(2) as clock:
        pair = Pair(clock, tmp_path, attack)
        try:
            assert pair.wait_for_attack()
            assert pair.times(hostile.LIMIT_S) == [0]
        finally:
            end(pair.hostile)
            end(pair.honest)
