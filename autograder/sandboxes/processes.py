"""
What a program does, seen from outside through ``/proc``: threads, memory, processor, ports.

Everything is asked of the kernel; the program itself is no witness.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
import os
from pathlib import Path
import select
import time

from autograder.errors import TooBusy

# Ports of RTPS: 7400 + 250 x domain, and 10 + 2 x number above that for each participant.
FIRST_PORT, PORTS_A_DOMAIN, OWN_PORTS, MOST_DOMAIN = 7400, 250, range(10, 240), 232
AT_RANDOM = 32768  # from here on, Linux gives ports to who asks for none: ip(7)
CPU_TICKS = os.sysconf('SC_CLK_TCK')
PAGE = os.sysconf('SC_PAGESIZE')
BUSY_S = 0.05  # processor time after which a program is taken for one that always computes
STILL_TRIES = 40
STARVED_S = 5.0  # wall time without so much of it: the machine is too busy to say


class Threads:
    """
    The threads of a program, seen from outside through open files of /proc.

    :param pid: host pid of the first process
    """

    def __init__(self, pid: int) -> None:
        """Look for the threads that there are."""
        self.pid = pid
        self.processes: tuple[int, ...] = ()
        # Opening a file is ten times slower than reading it again, and listing a folder than
        # asking how many entries it has.
        self.files: dict[tuple[int, str], int] = {}
        self.folders: dict[int, int] = {}
        self.counts: list[int] = []
        self.look()

    def look(self) -> None:
        """Notice new processes, and their threads."""
        self.processes = tuple(_family(self.pid))
        for gone in set(self.folders) - set(self.processes):
            os.close(self.folders.pop(gone))
        for process in set(self.processes) - set(self.folders):
            with suppress(OSError):
                self.folders[process] = os.open(f'/proc/{process}/task', os.O_RDONLY)
        self.counts.clear()
        self.look_at_threads()

    def look_at_threads(self) -> None:
        """Notice new threads of the known processes and forget ended ones."""
        # As many as before are the same ones, or :meth:`run` finds one that has ended.
        counts = [os.fstat(folder).st_nlink for folder in self.folders.values()]
        if counts == self.counts:
            return
        self.counts = counts
        there = set()
        for process in self.folders:
            with suppress(OSError):
                there |= {(process, task) for task in os.listdir(f'/proc/{process}/task')}
        for gone in set(self.files) - there:
            os.close(self.files.pop(gone))
        for process, task in there - set(self.files):
            with suppress(OSError):
                path = f'/proc/{process}/task/{task}/stat'
                self.files[process, task] = os.open(path, os.O_RDONLY)

    def run(self) -> bool:
        """Tell whether a thread runs, waits for a processor or a disk, or has ended: proc(5)."""
        for file in self.files.values():
            try:
                if os.pread(file, 64, 0).rpartition(b')')[2][1:2] in (b'R', b'D'):
                    return True
            except OSError:  # it has ended, and another one may have come in its place
                self.counts.clear()
                return True
        return False

    def used_ns(self) -> tuple[int, ...]:
        """Return the processor time of each process, exact to the moment [ns]."""
        return tuple(_used_ns(process) for process in self.processes)

    def used_s(self) -> float:
        """Return the processor time of all processes that there are [s]."""
        return sum(self.used_ns()) / 1e9

    def close(self) -> None:
        """Close the files."""
        for files in (self.files, self.folders):
            while files:
                os.close(files.popitem()[1])


def wait_until_quiet(*programs: Threads) -> bool:
    """
    Wait for a moment at which no thread of any of these programs runs.

    A thread in a callback runs, or waits for another thread that runs; so when all of them sleep,
    every callback is over or sleeps too, and whatever one sent another has arrived.  A program
    that always computes is left alone when it has computed for long enough; how long it waits for
    a processor does not count.

    :returns: whether all were quiet
    :raises TooBusy: if one wants a processor and hardly gets one
    """
    deadline, began_s, left = time.monotonic() + STARVED_S, None, list(programs)
    while True:
        for program in left:
            program.look_at_threads()
        if _rest(left):
            return len(left) == len(programs)
        used_s = {program: program.used_s() for program in left}
        began_s = began_s or used_s
        left = [one for one in left if used_s[one] < began_s[one] + BUSY_S]
        if left and time.monotonic() > deadline:
            raise TooBusy(f'The machine was too busy: a program got no turn for {STARVED_S} s.')
        # There is no event for it; a tenth of a millisecond is short beside a round trip.
        select.select((), (), (), 0.0001)


def wait_until_still(seconds: float, *programs: Threads) -> bool:
    """
    Wait until no thread of any of these programs has run for some time.

    Nothing is on its way then that a timer shorter than this would send again.  A program that
    wakes more often on its own is left alone after some tries.

    :param seconds: how long [s]
    :returns: whether it was so
    :raises TooBusy: as :func:`wait_until_quiet`
    """
    for _ in range(STILL_TRIES):
        if not wait_until_quiet(*programs):
            return False
        if _rest(programs, seconds):
            return True
    return False


def _rest(programs: Sequence[Threads], seconds: float = 0.0) -> bool:
    """
    Tell whether all threads sleep at one and the same moment, and have done so for some time.

    They are looked at one after the other, and of two that take turns each may sleep just then.
    But then one of them has used the processor meanwhile, and the clocks of the processes tell.
    """
    before = [program.used_ns() for program in programs]
    if seconds:
        select.select((), (), (), seconds)
    # First the question that costs least: who computes has a clock that moves.
    if before != [program.used_ns() for program in programs]:
        return False
    if any(program.run() for program in programs):
        return False
    return before == [program.used_ns() for program in programs]


def _used_ns(pid: int) -> int:
    """Return the processor time of a process, or none of one that has ended."""
    try:
        # The clock of another process's processor time: clock_getcpuclockid(3), in Linux.
        return time.clock_gettime_ns((~pid << 3) | 2)
    except OSError:
        return 0


def ports(pid: int) -> set[int]:
    """
    Return the UDP ports that are in use in the network of a process.

    :param pid: host pid
    """
    found = set()
    for name in ('udp', 'udp6'):
        with suppress(OSError, ValueError, IndexError):  # it has ended
            lines = Path(f'/proc/{pid}/net/{name}').read_text('ascii').splitlines()[1:]
            found |= {int(line.split()[1].rpartition(':')[2], 16) for line in lines}
    return found


def first_port(domain: int) -> int:
    """Return the port on which the first participant of a ROS domain hears the others."""
    return FIRST_PORT + PORTS_A_DOMAIN * domain + OWN_PORTS[0]


def other_domains(used: set[int]) -> list[int]:
    """
    Return the ROS domains besides 0 in which somebody takes part, by the ports in use.

    A participant has the domain's first port, for discovery, and two neighbours of its own.  Of
    ports that Linux gives at random two may fit by chance, in one run of some thousands.

    :param used: UDP ports
    """
    found = []
    for domain in range(1, MOST_DOMAIN + 1):
        first = FIRST_PORT + PORTS_A_DOMAIN * domain
        own = [first + port for port in OWN_PORTS[::2]]
        if first >= AT_RANDOM:
            own = [port for port in own if port + 1 in used]
        if first in used and any(port in used for port in own):
            found.append(domain)
    return found


def oom_kills() -> int:
    """Return how many processes the kernel has ended since it started, for want of memory."""
    for line in _read('/proc/vmstat').splitlines():
        name, _, count = line.partition(b' ')
        if name == b'oom_kill':
            return int(count)
    return 0


def proportional(pid: int) -> int:
    """
    Return the memory of a process and its descendants, with shared pages counted once [bytes].

    Slower than :func:`usage`, so it is asked only when that sum is over a limit.
    """
    total = 0
    for current in _family(pid):
        try:
            text = Path(f'/proc/{current}/smaps_rollup').read_text('ascii', 'replace')
            total += int(text.partition('\nPss:')[2].split()[0]) * 1024
        except (OSError, ValueError, IndexError):
            continue  # it ended while we looked
    return total


def _family(pid: int) -> Iterator[int]:
    pids = [pid]
    while pids:
        current = pids.pop()
        yield current
        try:
            for task in os.listdir(f'/proc/{current}/task'):
                pids += map(int, _read(f'/proc/{current}/task/{task}/children').split())
        except (OSError, ValueError):
            continue


def _read(path: str) -> bytes:
    """Read a small file of /proc; some twenty a look, and a text file takes five times as long."""
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
    for current in _family(pid):
        try:
            stat = _read(f'/proc/{current}/stat')
        except OSError:
            continue  # it ended while we looked
        fields = stat.rpartition(b')')[2].split()
        # utime, stime and those of waited-for children, then the resident pages: proc(5)
        ticks += sum(int(fields[number]) for number in (11, 12, 13, 14))
        resident += int(fields[21]) * PAGE
    return resident, ticks / CPU_TICKS
