"""
Enforce the limits of a run: processor time, memory, files, output, and idle time.

A busy machine makes a run longer, but does not change its result.  A run that takes more than ten
minutes of real time is aborted, and the submission is for review.
"""

from collections.abc import Mapping, Sequence
import math
import time

from autograder.errors import TooBusy
from autograder.sandboxes.confinement import ConfinedProgram, Limits
from autograder.sandboxes.processes import disk_is_busy, pss_bytes, Running, Usage, usage

WATCH_EVERY_S = 0.05
# Processor time allowed before the first node: imports take 0.3 s, or 1 s on a slow machine.
BUSY_S = 3.0
# Processor time allowed per virtual second, in addition to Limits.cpu_s.  A program that looks for
# messages every millisecond uses 0.1 s on a usual machine, and a run may take many minutes.
BUSY_SHARE = 0.25
MOST_CPU_S = 120.0  # processor time of the longest runs
# If the probe and the driver use this much more processor time than the program, a flood of
# packets keeps them busy.
PROBE_S = 10.0
# Budgets of real time in one run. A wait on the virtual clock takes no real time, so a correct
# program uses little: with 20 to 30 busy processes on two processors, 0.2 s of IDLE_S at most, and
# nothing of STILL_S.
SLOW_S = 20.0  # the program has not begun, its package is being built, or it waits for a disk
IDLE_S = 2.5  # otherwise, no process computes
STILL_S = 0.3  # nothing can happen any more on the virtual clock: all threads sleep
TICK_S = 0.01  # the kernel's precision of a process's start
MOST_WALL_S = 600.0  # real time after which the machine is too busy for a verdict


class Watchdog:
    """
    Check the limits of a run from outside the sandbox, every 50 ms.

    :param others: host pids of the probe and of the clock's driver
    :param builds: whether a package is built before the program runs
    """

    def __init__(
        self,
        student: ConfinedProgram,
        others: Sequence[int],
        limits: Limits,
        builds: bool,
    ) -> None:
        self.student, self.others = student, others
        self.limits = limits
        self.builds = builds
        self.cpu_s = self.sampled_s = 0.0
        self.each: Mapping[int, Running] = {}
        self.everything: Mapping[int, Running] = {}  # with the probe and the driver
        self.began = self.looked = time.monotonic()
        self.left_s = {'slow': SLOW_S, 'idle': IDLE_S, 'still': STILL_S}

    def due_in_s(self) -> float:
        """Return the real time until the next check."""
        return max(0.0, self.looked + WATCH_EVERY_S - time.monotonic())

    def look(self, printed: int, begun: bool, virtual_s: float) -> str:
        """
        Return the name of the limit that was exceeded, or an empty string.

        :param printed: bytes printed by the program so far
        :param begun: whether a node has been seen
        :param virtual_s: virtual time since the start of the run [s]
        :raises TooBusy: if the run has taken more than ten minutes of real time
        """
        before, self.looked = self.looked, time.monotonic()
        if self.looked - self.began > MOST_WALL_S:
            raise TooBusy(f'The machine was too busy: a run took {MOST_WALL_S:.0f} s.')
        runs = self.student.process.poll() is None
        used = usage(*self.student.pids) if runs else Usage(0, 0.0, {})
        others = usage(*self.others).each
        # If the grader's own process was delayed, do not count the delay.
        gap_s = min(self.looked - before, WATCH_EVERY_S)
        self._sample(used.each, gap_s)
        self._charge_idle_time(others, gap_s, begun)
        self.cpu_s = max(self.cpu_s, self.sampled_s, used.cpu_s)
        return (
            self._too_long(begun, sum(one.used_s for one in others.values()), virtual_s)
            or ('output_limit' if printed > self.limits.output else '')
            or (self._too_large(used.resident) if runs else '')
        )

    def _sample(self, each: Mapping[int, Running], gap_s: float) -> None:
        """
        Estimate the processor time of all processes, even those whose exit code no process reads.

        Such a process leaves no trace of its processor time, and may live for less than the gap
        between two checks.  If it lives for a tenth of a gap, one of ten checks finds it.  So a
        process that is found for the first time while it computes counts as if it computed as
        much in the whole gap as in its life so far.
        """
        for pid, (used_s, age_s, states) in each.items():
            earlier_s = self.each[pid].used_s if pid in self.each else math.inf
            if used_s >= earlier_s:
                self.sampled_s += used_s - earlier_s
            elif b'R' in states:  # a new process, perhaps with the pid of an ended one
                self.sampled_s += gap_s * used_s / max(age_s - TICK_S / 2, used_s, TICK_S / 2)
        self.each = each

    def _charge_idle_time(self, others: Mapping[int, Running], gap_s: float, begun: bool) -> None:
        """
        Charge the time in which no process computed to its budgets.

        Progress does not renew a budget; otherwise, a program could alternate waits outside the
        virtual clock with short waits on it.  A thread in state D can continue by itself, and a
        stopped probe (T or t) when somebody continues it.
        """
        earlier, self.everything = self.everything, {**self.each, **others}
        before, used = (
            {pid: one.used_s for pid, one in processes.items()}
            for processes in (earlier, self.everything)
        )
        idle_s = gap_s - max(0.0, sum(used.values()) - sum(before.values()))
        states = b''.join(one.states for one in self.everything.values())
        if idle_s <= 0 or b'R' in states:
            return
        preparing = not self.student.released or (self.builds and not begun)
        if preparing or (b'D' in states and disk_is_busy()):
            self.left_s['slow'] -= idle_s
            return
        self.left_s['idle'] -= idle_s
        stopped = any(one.states.strip(b'SZX') for one in others.values())
        if used == before and not states.strip(b'STZX') and not stopped:
            self.left_s['still'] -= gap_s

    def _too_long(self, begun: bool, others_s: float, virtual_s: float) -> str:
        most_s = min(self.limits.cpu_s + BUSY_SHARE * virtual_s, MOST_CPU_S)
        if self.cpu_s + others_s > most_s:
            return 'cpu_limit'
        if others_s > self.cpu_s + PROBE_S:
            return 'probe_broken'
        if min(self.left_s.values()) < 0:
            return 'waits_outside'
        if not begun and not self.builds and self.cpu_s > BUSY_S:
            return 'busy_before_node'
        return ''

    def _too_large(self, resident: int) -> str:
        if resident > self.limits.memory and pss_bytes(*self.student.pids) > self.limits.memory:
            return 'memory_limit'
        count, size = self.student.files()
        if count > self.limits.inodes:
            return 'inode_limit'
        # The folders of a sandbox with namespaces are limited by their file system.
        return 'disk_limit' if self.student.home and size > self.limits.folder else ''
