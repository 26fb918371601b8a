"""Datagrams leave when everything waits: none is lost, and no two programs race."""

import socket

import pytest

from tests.clock.test_waits import BEGIN

READER = """
reader = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
reader.bind(('127.0.0.1', {port}))
reader.settimeout(10)
def heard():
    try:
        return reader.recv(70000).decode()
    except TimeoutError:
        return ''
"""
WRITER = """
writer = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
def say(text):
    writer.sendto(text.encode(), ('127.0.0.1', {port}))
time.sleep(1)  # until the reader waits
"""
NUMBERS = """
numbers = []
while text := heard(): numbers.append(int(text.split()[0]))
tell(len(numbers), numbers == sorted(numbers))
"""


@pytest.fixture
def port() -> int:
    """Return an unused port."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as found:
        found.bind(('127.0.0.1', 0))
        return int(found.getsockname()[1])


another_port = port


def reader(port: int, body: str) -> str:
    """Return a program that may call ``heard``."""
    return BEGIN + READER.format(port=port) + body


def writer(port: int, body: str) -> str:
    """Return a program that may call ``say``."""
    return BEGIN + WRITER.format(port=port) + body


def test_none_of_more_than_a_buffer_holds_is_lost(on_clock, port):
    """In real time, a reader that is a little late would lose most of them."""
    body = 'for number in range(5000): say(f"{number} " + "x" * 1000)'
    _, received = on_clock(writer(port, body), reader(port, NUMBERS))

    assert received == [[11, 5000, True]]


@pytest.mark.parametrize(
    'end',
    [
        'os._exit(0)',
        'sys.exit(0)',
        'writer.close(); time.sleep(1)',
        "os.execv('/bin/true', ['true'])",
        'os.abort() if os.fork() == 0 else os.wait()',
    ],
)
def test_what_was_sent_before_an_end_arrives(on_clock, end, port):
    """The end of a process or of its socket neither loses nor duplicates a datagram."""
    _, received = on_clock(writer(port, f'say("1"); {end}'), reader(port, NUMBERS))

    assert received == [[11, 1, True]]


def test_sender_is_over_before_its_readers_begin(on_clock, port, another_port):
    """An answer that a reader sends at once arrives only when the sender waits."""
    sender = (
        READER.format(port=port)
        + 'reader.setblocking(False)\n'
        + WRITER.format(port=another_port)
        + """
early = 0
for number in range(200):
    say(str(number))
    sum(range(20000))  # time enough for the other on a machine with two cores
    try:
        reader.recv(10); early += 1
    except BlockingIOError:
        pass
time.sleep(1)
tell(early, len(reader.recv(10)))
"""
    )
    echo = f'while text := heard(): reader.sendto(text.encode(), ("127.0.0.1", {port}))'
    received, _ = on_clock(BEGIN + sender, reader(another_port, echo))

    assert received == [[2, 0, 1]]


def test_reader_of_a_portion_finds_all_of_it(on_clock, port):
    """Even on a busy machine, a reader wakes only after the last datagram has arrived."""
    drain = """
counts = []
while heard():
    counts.append(1)
    reader.setblocking(False)
    try:
        while reader.recv(100): counts[-1] += 1
    except BlockingIOError:
        reader.settimeout(10)
tell(len(counts), set(counts) == {20})
"""
    body = """
for _ in range(100):
    for number in range(20): say(str(number))
    time.sleep(1)
"""
    received = on_clock(writer(port, body), reader(port, drain))[1]

    assert received == [[110, 100, True]]
