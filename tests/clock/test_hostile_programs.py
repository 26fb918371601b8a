"""
Test programs that attack the clock, each next to an honest program that records its times.

Time continues, or it stands still until the hostile program is killed. The honest program's times
are exact in both cases.
"""

from contextlib import suppress
import json
import os
from pathlib import Path
import select
import signal
import subprocess
import sys

import pytest

from autograder.clock.virtual_clock import virtual_clock, VirtualClock

LIMIT_S = 60.0  # of real time, for programs that take a fraction of a second
STILL_S = 0.4  # of real time; the honest program needs a hundredth of it when time moves

HONEST = """
import json, time
began = time.monotonic()
for _ in range(5):
    time.sleep(0.02)
    print(json.dumps(round(time.monotonic() - began, 6)), flush=True)
"""
EXACT_TIMES = [0.02, 0.04, 0.06, 0.08, 0.1]

BEGIN = """
import array, ctypes, itertools, mmap, os, socket, subprocess, sys, threading, time

libc = ctypes.CDLL('libc.so.6', use_errno=True)  # its own functions, not those of the library
place = int(os.environ['VIRTUAL_CLOCK'])
BUSY, IDLE, NEVER = 0, 1, 2**63 - 1
CLOSE, NANOSLEEP, FORK = 3, 35, 57  # system calls of x86_64

def attacks():
    print('attacks', flush=True)

def address(name):
    with open('/proc/self/maps') as maps:
        return next(int(line.split('-')[0], 16) for line in maps if f'memfd:{name} ' in line)

def own(kind):
    '''Return the library's descriptors of a kind: IS_IDLE is the last eventfd.'''
    links = []
    for fd in range(100, 200):
        try:
            links.append((fd, os.readlink(f'/proc/self/fd/{fd}')))
        except OSError:
            pass
    return [fd for fd, link in links if kind in link]

def rewrite_page(state, deadline):
    ctypes.c_int64.from_address(page + 8).value = deadline
    word = ctypes.c_uint32.from_address(page)
    word.value = (word.value + 4) & ~3 | state

def report():
    os.eventfd_write(idle, 1)

def compute():
    while True:
        pass

def sleep_unseen(seconds):
    libc.syscall(NANOSLEEP, (ctypes.c_int64 * 2)(seconds, 0), None)

def order(number):
    '''Order places as for children, which never begin.'''
    ours, ends = socket.socket(fileno=os.dup(place)), []
    for _ in range(number):
        here, there = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        socket.send_fds(ours, [b'a'], [there.fileno()])
        there.close()
        ends.append(here)
    return ends

page, idle = address('process'), own('eventfd')[-1]
"""

GOES_ON, STILL, EITHER = 'goes on', 'stands still', 'either'

PROGRAMS = {
    'nothing': ('attacks(); time.sleep(0.05)', GOES_ON),
    '500 threads that sleep': (
        """
def doze():
    while True:
        time.sleep(0.01)
try:
    for _ in range(500):
        threading.Thread(target=doze, daemon=True).start()
except RuntimeError:  # the clock has fewer
    pass
attacks()
time.sleep(10)
""",
        GOES_ON,
    ),
    # The time page.
    'writes of the time': (
        """
here = address('time')
before = ctypes.c_int64.from_address(here).value
for entry in os.listdir('/proc/self/map_files'):
    if 'memfd:time' in os.readlink('/proc/self/map_files/' + entry):
        for flags in (os.O_RDWR, os.O_WRONLY):
            try:
                fd = os.open('/proc/self/map_files/' + entry, flags)
                os.pwrite(fd, bytes(8), 0)
                sys.exit('written')
            except OSError:
                pass
            try:
                mmap.mmap(fd, 24)
                sys.exit('mapped')
            except OSError:
                pass
libc.mprotect.argtypes = ctypes.c_void_p, ctypes.c_size_t, ctypes.c_int
assert libc.mprotect(here, 24, mmap.PROT_READ | mmap.PROT_WRITE) == -1
with open('/proc/self/mem', 'r+b', buffering=0) as memory:
    memory.seek(here)
    try:
        memory.write(bytes(8))
    except OSError:
        pass
assert ctypes.c_int64.from_address(here).value == before
attacks()
""",
        GOES_ON,
    ),
    # Its own page.
    'IDLE while it computes': (
        'rewrite_page(IDLE, NEVER); attacks(); report(); compute()',
        GOES_ON,
    ),
    'a far deadline': ('rewrite_page(IDLE, NEVER - 1); attacks(); report(); compute()', GOES_ON),
    'a deadline before all time': (
        'rewrite_page(IDLE, -NEVER); attacks(); report(); compute()',
        STILL,
    ),
    'a deadline of 0, again and again': (
        'attacks()\nwhile True: rewrite_page(IDLE, 0); report()',
        EITHER,
    ),
    'an unknown state': ('rewrite_page(3, 0); attacks(); report(); compute()', STILL),
    'BUSY while it sleeps': (
        """
if libc.syscall(FORK) == 0:
    while True:
        rewrite_page(BUSY, 0)
attacks()
time.sleep(10)
""",
        EITHER,
    ),
    # Reports and sockets.
    'a flood of reports': ('attacks()\nwhile True: report()', STILL),
    'a flood of reports as IDLE': (
        'rewrite_page(IDLE, NEVER); attacks()\nwhile True: report()',
        EITHER,
    ),
    # Its own reports are lost, but the next report of the other program has the same effect.
    'an eventfd that is full': (
        'os.eventfd_write(idle, 2**64 - 2); attacks(); time.sleep(1)',
        EITHER,
    ),
    'a flood of messages': (
        """
ours = socket.socket(fileno=os.dup(place))
rewrite_page(IDLE, NEVER)
attacks()
while True:
    ours.send(b'?')
""",
        EITHER,
    ),
    '300 places': ('ends = order(300); attacks(); time.sleep(10)', STILL),
    '300 places, given back': ('ends = order(300); del ends; attacks(); time.sleep(10)', GOES_ON),
    'places that are no sockets': (
        """
ours = socket.socket(fileno=os.dup(place))
for path in ('/dev/null', '/dev/zero', '/'):
    socket.send_fds(ours, [b'a'], [os.open(path, os.O_RDONLY)])
socket.send_fds(ours, [b'a'], [*own('eventfd'), *own('eventpoll')] * 40)
attacks()
time.sleep(10)
""",
        GOES_ON,
    ),
    'its socket closed': ('libc.syscall(CLOSE, place); attacks(); time.sleep(10)', GOES_ON),
    'all closed': (
        'for fd in range(3, 1024): libc.syscall(CLOSE, fd)\nattacks(); time.sleep(10)',
        EITHER,
    ),
    # Waits that the library does not see.
    'a raw sleep': ('attacks(); sleep_unseen(10)', STILL),
    'a raw sleep in a thread': (
        'threading.Thread(target=sleep_unseen, args=(10,)).start(); attacks(); time.sleep(10)',
        STILL,
    ),
    'libc.sleep': ('attacks(); libc.sleep(10)', STILL),
    'a child without the library': (
        "subprocess.Popen(['env', '-i', 'sleep', '10']); attacks(); time.sleep(10)",
        STILL,
    ),
    'a static child': ('subprocess.Popen([SLEEPER]); attacks(); time.sleep(10)', STILL),
    'a child by a raw fork': (
        """
if libc.syscall(FORK) == 0:
    sleep_unseen(10)
    os._exit(0)
attacks()
time.sleep(10)
""",
        GOES_ON,
    ),
}


class Pair:
    """A hostile program and an honest one, which the clock serves first."""

    def __init__(self, clock: VirtualClock, folder: Path, text: str) -> None:
        self.clock = clock
        self.honest = self._start(0, folder / 'honest.py', HONEST)
        self.hostile = self._start(1, folder / 'hostile.py', BEGIN + text)
        clock.begin()

    def _start(self, place: int, file: Path, text: str) -> subprocess.Popen[str]:
        file.write_text(text, encoding='utf-8')
        return subprocess.Popen(
            [sys.executable, '-I', str(file)],
            env={**os.environ, **self.clock.variables(place)},
            pass_fds=[self.clock.places[place].fileno()],
            stdout=subprocess.PIPE,
            start_new_session=True,
            text=True,
        )

    def wait_for_attack(self) -> bool:
        """Return whether the hostile program has announced its attack."""
        stream = self.hostile.stdout
        assert stream is not None
        return bool(select.select([stream], [], [], LIMIT_S)[0]) and bool(stream.readline())

    def times(self, limit_s: float) -> list[float] | None:
        """Return the honest program's times, None if it is still running after a limit."""
        try:
            said, _ = self.honest.communicate(timeout=limit_s)
        except subprocess.TimeoutExpired:
            return None
        return [json.loads(line) for line in said.splitlines()]


def end(process: subprocess.Popen[str]) -> None:
    """Kill a program and its children, if any are still running."""
    with suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    if process.stdout:
        process.stdout.close()


@pytest.fixture(scope='module')
def sleeper(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a static program that sleeps, into which no library can be loaded."""
    folder = tmp_path_factory.mktemp('sleeper')
    source = folder / 'sleeper.c'
    source.write_text('#include <unistd.h>\nint main(void) { sleep(10); }\n', encoding='utf-8')
    command = ['gcc', '-static', str(source), '-o', str(folder / 'sleeper')]
    if subprocess.run(command, capture_output=True).returncode:
        pytest.skip('gcc finds no static C library')
    return folder / 'sleeper'


@pytest.mark.parametrize('name', PROGRAMS)
def test_honest_program_keeps_exact_times_beside(name, tmp_path, request):
    """At worst, a hostile program stops time; it never makes the honest program's times wrong."""
    text, outcome = PROGRAMS[name]
    if 'SLEEPER' in text:
        text = f'SLEEPER = {str(request.getfixturevalue("sleeper"))!r}\n{text}'

    with virtual_clock(2) as clock:
        pair = Pair(clock, tmp_path, text)
        try:
            assert pair.wait_for_attack()
            times = pair.times(LIMIT_S if outcome == GOES_ON else STILL_S)
            assert times is None or outcome != STILL
            if outcome == STILL:
                assert clock.elapsed_ns == 0
            end(pair.hostile)
            assert (times or pair.times(LIMIT_S)) == EXACT_TIMES
            assert pair.honest.returncode == 0
        finally:
            end(pair.hostile)
            end(pair.honest)
