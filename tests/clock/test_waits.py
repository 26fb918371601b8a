"""Waits, sleeps and polls of plain Python programs take exactly the time that they request."""

import pytest

BEGIN = """
import asyncio, concurrent.futures, json, multiprocessing, os, queue, sched, select, signal
import socket, subprocess, sys, threading, time

began = time.monotonic()

def tell(*more):
    print(json.dumps([round(time.monotonic() - began, 6), *more]), flush=True)
"""

PROGRAMS = {
    'sleep': ('time.sleep(1.5); tell(); time.sleep(86400); tell()', [1.5, 86401.5]),
    'system time': ('w = time.time(); time.sleep(2); tell(time.time() - w)', [[2, 2]]),
    'threading.Timer': (
        """
def tick(left):
    tell()
    if left:
        threading.Timer(1, tick, [left - 1]).start()
threading.Timer(1, tick, [2]).start()
time.sleep(4)  # Python 3.12 starts no thread when the main one has ended
""",
        [1, 2, 3],
    ),
    'Event': (
        """
event = threading.Event()
tell(event.wait(2.5))
threading.Timer(1, event.set).start()
tell(event.wait(5))
""",
        [[2.5, False], [3.5, True]],
    ),
    'Condition': (
        """
condition = threading.Condition()
with condition:
    condition.wait(0.75)
tell()
""",
        [0.75],
    ),
    'Queue': (
        """
numbers = queue.Queue()
threading.Thread(target=lambda: (time.sleep(1.25), numbers.put(7))).start()
tell(numbers.get(timeout=3))
try:
    numbers.get(timeout=0.75)
except queue.Empty:
    tell('empty')
""",
        [[1.25, 7], [2, 'empty']],
    ),
    'asyncio': (
        """
async def main():
    for _ in range(3):
        await asyncio.sleep(1)
        tell()
asyncio.run(main())
""",
        [1, 2, 3],
    ),
    'select': (
        """
reading, writing = os.pipe()
threading.Thread(target=lambda: (time.sleep(0.4), os.write(writing, b'x'))).start()
tell(len(select.select([reading], [], [], 5)[0]))
os.read(reading, 1)
tell(len(select.select([reading], [], [], 0.6)[0]))
""",
        [[0.4, 1], [1, 0]],
    ),
    'socket': (
        """
ours, theirs = socket.socketpair()
threading.Thread(target=lambda: (time.sleep(1), theirs.send(b'x'))).start()
ours.recv(1)
tell()
ours.settimeout(0.5)
try:
    ours.recv(1)
except TimeoutError:
    tell('nothing')
""",
        [1, [1.5, 'nothing']],
    ),
    'sched': (
        """
plan = sched.scheduler()
for delay in (0.75, 1.5):
    plan.enter(delay, 1, tell)
plan.run()
""",
        [0.75, 1.5],
    ),
    'futures': (
        """
with concurrent.futures.ThreadPoolExecutor(3) as pool:
    for future in [pool.submit(time.sleep, length) for length in (0.5, 1, 1.5)]:
        future.result()
        tell()
""",
        [0.5, 1, 1.5],
    ),
    'setitimer': (
        """
signal.signal(signal.SIGALRM, lambda *_: tell())
signal.setitimer(signal.ITIMER_REAL, 0.5, 0.5)
time.sleep(1.2)
signal.setitimer(signal.ITIMER_REAL, 0)
tell('slept')
""",
        [0.5, 1, [1.2, 'slept']],
    ),
    'sigwait': (
        """
signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGALRM])
signal.alarm(3)
tell(signal.sigwait([signal.SIGALRM]) == signal.SIGALRM)
""",
        [[3, True]],
    ),
    'subprocess': ("subprocess.run(['sleep', '1']); tell()", [1]),
    'os.system': ("os.system('sleep 2'); tell()", [2]),
    'subprocess that times out': (
        """
try:
    subprocess.run(['sleep', '10'], timeout=4)
except subprocess.TimeoutExpired:  # Python 3.10 rounds each sleep up to a microsecond
    print(json.dumps([round(time.monotonic() - began, 5)]))
""",
        [4],
    ),
    'polling the clock': (
        """
for second in (0.5, 1):
    while time.monotonic() < began + second:
        pass
    tell()
""",
        [0.5, 1],
    ),
    'polling the clock and taking a lock': (
        """
lock = threading.Lock()
while time.monotonic() < began + 1:
    with lock:
        pass
tell()
""",
        [1],
    ),
    'a thread that polls beside one that sleeps': (
        """
def poll():
    while time.monotonic() < began + 5:
        pass
threading.Thread(target=poll).start()
for _ in range(3):
    time.sleep(0.3335)
    tell()
""",
        [0.3335, 0.667, 1.0005],
    ),
    'a thread that computes': (
        """
def compute():
    sum(range(5_000_000))
    tell('computed')
thread = threading.Thread(target=compute)
thread.start()
time.sleep(0.001)
tell('slept')
thread.join()
""",
        [[0, 'computed'], [0.001, 'slept']],
    ),
    'sleeps of a microsecond, as long as in Linux': (
        'for _ in range(100): time.sleep(1e-6)\ntell()\n'
        'for _ in range(100): select.select([], [], [], 1e-6)\ntell()',
        [0.005, 0.01],
    ),
}


@pytest.mark.parametrize('name', PROGRAMS)
def test_wait_takes_exactly_its_time(on_clock, name):
    """The time is exact to the microsecond."""
    text, expected = PROGRAMS[name]

    [said] = on_clock(BEGIN + text)

    assert said == [one if isinstance(one, list) else [one] for one in expected]


def test_processes_of_multiprocessing_share_the_time(on_clock):
    """A child process uses its parent's clock."""
    text = """
def work(numbers, length):
    time.sleep(length)
    numbers.put(length)

if __name__ == '__main__':
    numbers = multiprocessing.Queue()
    process = multiprocessing.Process(target=work, args=(numbers, 1.5))
    process.start()
    tell(numbers.get())
    process.join()
    tell()
"""
    assert on_clock(BEGIN + text) == [[[1.5, 1.5], [1.5]]]


def test_two_processes_hear_each_other_in_order(on_clock, tmp_path):
    """A datagram is handled at the instant at which it was sent."""
    speaker = f"""
channel = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
time.sleep(0.5)  # the other one is there
for number in range(50):
    time.sleep(1)
    channel.sendto(b'%d' % number, {str(tmp_path / 'here')!r})
"""
    listener = f"""
channel = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
channel.bind({str(tmp_path / 'here')!r})
for number in range(50):
    tell(int(channel.recv(10)))
"""
    said = on_clock(BEGIN + speaker, BEGIN + listener)[1]
    assert said == [[1.5 + number, number] for number in range(50)]


def test_read_that_the_library_does_not_see_holds_the_time(on_clock):
    """The probe waits like this for the grader, which is not on the clock."""
    text = """
reading, writing = os.pipe()
subprocess.Popen(['env', '-i', 'sh', '-c', 'echo x >&%d' % writing], pass_fds=[writing])
threading.Thread(target=time.sleep, args=(5,), daemon=True).start()
os.readv(reading, [bytearray(1)])
tell()
os._exit(0)
"""
    assert on_clock(BEGIN + text) == [[[0]]]


def test_time_page_refuses_to_be_written(on_clock):
    """Not even the file behind a mapping can be opened for writing."""
    text = """
import mmap
tried, refused = 0, 0
for entry in os.listdir('/proc/self/map_files'):
    path = '/proc/self/map_files/' + entry
    if 'memfd:time' in os.readlink(path):
        tried += 1
        try:
            mmap.mmap(os.open(path, os.O_RDWR), 24)
        except OSError:
            refused += 1
tell(tried, tried - refused)
"""
    assert on_clock(BEGIN + text) == [[[0, 1, 0]]]


def test_closing_every_descriptor_keeps_the_clock(on_clock):
    """A program that becomes a daemon closes all descriptors."""
    assert on_clock(BEGIN + 'os.closerange(3, 1000); time.sleep(2); tell()') == [[[2]]]
