"""
Read a program's use of threads, memory, processor time and ports from ``/proc``.

All facts come from the kernel, because the program itself is not trusted.
"""

from collections.abc import Mapping
from contextlib import suppress
import os
from pathlib import Path
import time
from typing import NamedTuple

from autograder.inside.confine import family, read_small

# RTPS ports: 7400 + 250 x domain for discovery; 10 + 2 x N above that for participant N.
FIRST_PORT, PORTS_A_DOMAIN, OWN_PORTS = 7400, 250, 10
CPU_TICKS = os.sysconf('SC_CLK_TCK')
PAGE = os.sysconf('SC_PAGESIZE')


def _states(process: int) -> bytes:
    """Return one letter for each thread of a process."""
    found = b''
    with suppress(OSError):  # the process has ended
        for task in os.listdir(f'/proc/{process}/task'):
            stat = read_small(f'/proc/{process}/task/{task}/stat')
            found += stat.rpartition(b')')[2][1:2]
    return found


def running(*pids: int) -> list[int]:
    """
    Return the pids of processes and their descendants that have not ended.

    A process that has ended keeps its pid, as a zombie, until its parent reads the exit code.
    """
    return [one for one in family(*pids) if _states(one).strip(b'ZX')]


def _used_ns(process: int) -> int:
    # Linux's clock id for the processor time of another process: clock_getcpuclockid(3).
    return time.clock_gettime_ns((~process << 3) | 2)


def ports() -> set[int]:
    """Return the UDP ports that are in use in the network of this process."""
    found = set()
    for name in ('udp', 'udp6'):
        with suppress(OSError):  # a system without IPv6
            lines = Path(f'/proc/self/net/{name}').read_text('ascii').splitlines()[1:]
            found |= {int(line.split()[1].rpartition(':')[2], 16) for line in lines}
    return found


def first_port(domain: int) -> int:
    """Return the port on which the first participant of a ROS domain listens."""
    return FIRST_PORT + PORTS_A_DOMAIN * domain + OWN_PORTS


def oom_kills() -> int:
    """Return how many processes the kernel has killed since boot because memory ran out."""
    return _count('/proc/vmstat', b'oom_kill')


def ready_to_run() -> int:
    """Return how many threads on the machine are running or ready to run."""
    return _count('/proc/stat', b'procs_running')


def disk_is_busy() -> bool:
    """Return whether a thread on the machine waits for a disk: procs_blocked in proc_stat(5)."""
    return _count('/proc/stat', b'procs_blocked') > 0


def _count(path: str, wanted: bytes) -> int:
    # Read the whole file: with hundreds of processors, /proc/stat is longer than 64 KiB.
    for line in Path(path).read_bytes().splitlines():
        name, _, count = line.partition(b' ')
        if name == wanted:
            return int(count)
    return 0


def pss_bytes(*pids: int) -> int:
    """
    Return the memory of processes and their descendants; shared pages count once [bytes].

    This is slower than :func:`usage`, so call it only if :func:`usage` exceeds a limit.
    """
    total = 0
    for current in family(*pids):
        try:
            text = Path(f'/proc/{current}/smaps_rollup').read_text('ascii', 'replace')
            total += int(text.partition('\nPss:')[2].split()[0]) * 1024
        except (OSError, ValueError, IndexError):
            continue  # the process has ended
    return total


class Running(NamedTuple):
    """
    A process that has not ended.

    :param used_s: its processor time [s]
    :param age_s: real time since its start, to a hundredth of a second [s]
    :param states: one letter for each thread: R computes or waits for a processor, S sleeps, D
        cannot be interrupted (it waits for a disk or a child after vfork), T is stopped: proc(5)
    """

    used_s: float
    age_s: float
    states: bytes


class Usage(NamedTuple):
    """
    What processes and their descendants use.

    :param resident: memory [bytes]
    :param cpu_s: processor time [s], also of ended children whose exit code a parent has read
    :param each: the processes, by their host pids
    """

    resident: int
    cpu_s: float
    each: Mapping[int, Running]


def usage(*pids: int) -> Usage:
    """Return what processes and their descendants use."""
    resident, ticks, each = 0, 0, {}
    for current in family(*pids):
        try:
            stat = read_small(f'/proc/{current}/stat')
            used_s = _used_ns(current) / 1e9
        except OSError:
            continue  # the process has ended
        fields = stat.rpartition(b')')[2].split()
        # Fields of proc(5): utime, stime, the same two for reaped children, and resident pages.
        ticks += sum(int(fields[number]) for number in (11, 12, 13, 14))
        resident += int(fields[21]) * PAGE
        age_s = time.clock_gettime(time.CLOCK_BOOTTIME) - int(fields[19]) / CPU_TICKS
        each[current] = Running(used_s, age_s, _states(current))
    return Usage(resident, ticks / CPU_TICKS, each)
