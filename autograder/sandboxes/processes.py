"""
Read in ``/proc`` what a program uses: threads, memory, processor time, ports.

All facts come from the kernel; the program itself is not trusted.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
import os
from pathlib import Path
import time

# Ports of RTPS: 7400 + 250 x domain, and 10 + 2 x number above that for each participant.
FIRST_PORT, PORTS_A_DOMAIN, OWN_PORTS, MOST_DOMAIN = 7400, 250, range(10, 240), 232
AT_RANDOM = 32768  # from here on, Linux gives ports to who asks for none: ip(7)
CPU_TICKS = os.sysconf('SC_CLK_TCK')
PAGE = os.sysconf('SC_PAGESIZE')


def states(pid: int) -> bytes:
    """
    Return the state of each thread of a process and its descendants, one letter each: proc(5).

    R means running or waiting for a processor, D waiting for a disk, T stopped.

    :param pid: host pid of the first process
    """
    found = b''
    for process in family(pid):
        with suppress(OSError):  # it has ended
            for task in os.listdir(f'/proc/{process}/task'):
                stat = _read(f'/proc/{process}/task/{task}/stat')
                found += stat.rpartition(b')')[2][1:2]
    return found


def used_ns(pid: int) -> int:
    """Return the processor time of a process and its descendants until now [ns]."""
    total = 0
    for process in family(pid):
        with suppress(OSError):  # it has ended
            # The clock of another process's processor time: clock_getcpuclockid(3), in Linux.
            total += time.clock_gettime_ns((~process << 3) | 2)
    return total


def ports(pid: int) -> set[int]:
    """
    Return the UDP ports that the network of a process uses.

    :param pid: host pid
    """
    found = set()
    for name in ('udp', 'udp6'):
        with suppress(OSError, ValueError, IndexError):  # it has ended
            lines = Path(f'/proc/{pid}/net/{name}').read_text('ascii').splitlines()[1:]
            found |= {int(line.split()[1].rpartition(':')[2], 16) for line in lines}
    return found


def first_port(domain: int) -> int:
    """Return the port on which the first participant of a ROS domain listens."""
    return FIRST_PORT + PORTS_A_DOMAIN * domain + OWN_PORTS[0]


def other_domains(used: set[int]) -> list[int]:
    """
    Return the ROS domains other than 0 that have a participant, by the ports in use.

    A participant uses the domain's first port, for discovery, and two ports next to it. By chance,
    random ports of Linux can look the same, in one of several thousand runs.

    :param used: UDP ports
    """
    found = []
    for domain in range(1, MOST_DOMAIN + 1):
        first = FIRST_PORT + PORTS_A_DOMAIN * domain
        if first not in used:
            continue
        own = [first + port for port in OWN_PORTS[::2]]
        if first >= AT_RANDOM:
            own = [port for port in own if port + 1 in used]
        if any(port in used for port in own):
            found.append(domain)
    return found


def oom_kills() -> int:
    """Return how many processes the kernel has killed since its start to free memory."""
    for line in _read('/proc/vmstat').splitlines():
        name, _, count = line.partition(b' ')
        if name == b'oom_kill':
            return int(count)
    return 0


def proportional(pid: int) -> int:
    """
    Return the memory of a process and its descendants, with shared pages counted once [bytes].

    This is slower than :func:`usage`, so it is called only if that sum is over a limit.
    """
    total = 0
    for current in family(pid):
        try:
            text = Path(f'/proc/{current}/smaps_rollup').read_text('ascii', 'replace')
            total += int(text.partition('\nPss:')[2].split()[0]) * 1024
        except (OSError, ValueError, IndexError):
            continue  # it ended while we looked
    return total


def family(pid: int) -> Iterator[int]:
    """Yield a process and its descendants, if it exists."""
    pids = [pid]
    while pids:
        current = pids.pop()
        try:
            tasks = os.listdir(f'/proc/{current}/task')
        except OSError:
            continue  # it has ended
        yield current
        for task in tasks:
            with suppress(OSError):
                pids += map(int, _read(f'/proc/{current}/task/{task}/children').split())


def _read(path: str) -> bytes:
    """Read a small file of /proc, quickly, because each check reads about twenty."""
    file = os.open(path, os.O_RDONLY)
    try:
        return os.read(file, 1 << 16)
    finally:
        os.close(file)


def usage(pid: int) -> tuple[int, float]:
    """
    Return what a process and all its descendants use.

    In a sandbox every process descends from the first one, daemons too.

    :param pid: host pid of the first process
    :returns: resident memory [bytes], processor time [s]
    """
    resident, ticks = 0, 0
    for current in family(pid):
        try:
            stat = _read(f'/proc/{current}/stat')
        except OSError:
            continue  # it ended while we looked
        fields = stat.rpartition(b')')[2].split()
        # utime, stime and those of waited-for children, then the resident pages: proc(5)
        ticks += sum(int(fields[number]) for number in (11, 12, 13, 14))
        resident += int(fields[21]) * PAGE
    return resident, ticks / CPU_TICKS
