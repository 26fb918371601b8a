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
from autograder.sandboxes.processes import pss_bytes, Running, states, Usage, usage, used_ns

WATCH_EVERY_S = 0.05
# Processor time allowed before the first node: imports take 0.3 s, or 1 s on a slow machine.
BUSY_S = 3.0
# If the probe and the driver use this much more processor time than the program, a flood of
# packets keeps them busy.
PROBE_S = 10.0
# Budgets of real time in which no process of the run computes: one until the program begins or its
# package is built, one afterwards. A wait on the virtual clock takes no real time: at a load of 20
# to 30 on two processors, correct programs used at most 0.1 s of their 5 s, and a program that
# printed 7 MB used 0.2 s. Slow disks use more, and so does a person who pauses the probe.
PREPARING_S, IDLE_S = 20.0, 5.0
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
        """Start with all counts at zero."""
        self.student, self.others = student, others
        self.limits = limits
        self.builds = builds
        self.cpu_s = self.sampled_s = 0.0
        self.each: Mapping[int, Running] = {}
        self.began = self.looked = time.monotonic()
        self.idle_s = {True: 0.0, False: 0.0}  # while preparing, and afterwards
        self.used_s = 0.0

    def due_in_s(self) -> float:
        """Return the real time until the next check."""
        return max(0.0, self.looked + WATCH_EVERY_S - time.monotonic())

    def look(self, printed: int, begun: bool) -> str:
        """
        Return the name of the limit that was exceeded, or an empty string.

        :param printed: bytes printed by the program so far
        :param begun: whether a node has been seen
        :raises TooBusy: if the run has taken more than ten minutes of real time
        """
        before, self.looked = self.looked, time.monotonic()
        if self.looked - self.began > MOST_WALL_S:
            raise TooBusy(f'The machine was too busy: a run took {MOST_WALL_S:.0f} s.')
        runs = self.student.process.poll() is None
        used = usage(*self.student.pids) if runs else Usage(0, 0.0, {})
        # If the grader's own process was delayed, do not count the delay.
        gap_s = min(self.looked - before, WATCH_EVERY_S)
        self._sample(used.each, gap_s)
        self.cpu_s = max(self.cpu_s, self.sampled_s, used.cpu_s)
        others_s = sum(map(used_ns, self.others)) / 1e9
        all_s = others_s + sum(one.used_s for one in used.each.values())
        earlier_s, self.used_s = self.used_s, all_s
        idle_s = gap_s - max(0.0, all_s - earlier_s)
        return (
            self._too_long(begun, others_s, idle_s)
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

        :param gap_s: real time since the last check [s]; a delay of the grader does not count
        """
        for pid, (used_s, age_s, computes) in each.items():
            earlier_s = self.each[pid].used_s if pid in self.each else math.inf
            if used_s >= earlier_s:
                self.sampled_s += used_s - earlier_s
            elif computes:  # a new process, perhaps with the pid of an ended one
                self.sampled_s += gap_s * used_s / max(age_s - TICK_S / 2, used_s, TICK_S / 2)
        self.each = each

    def _too_long(self, begun: bool, others_s: float, idle_s: float) -> str:
        if self.cpu_s + others_s > self.limits.cpu_s:
            return 'cpu_limit'
        if others_s > self.cpu_s + PROBE_S:
            return 'probe_broken'
        if self._too_idle(begun, idle_s):
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

    def _too_idle(self, begun: bool, idle_s: float) -> bool:
        """
        Return whether the total time in which no process computed exceeds its budget.

        Progress does not renew a budget; otherwise, a program could alternate waits outside the
        virtual clock with short waits on it.

        :param begun: whether a node has been seen
        :param idle_s: real time since the last check, minus the processor time of all processes
        """
        computes = any(one.computes for one in self.each.values())
        if idle_s <= 0 or computes or any(b'R' in states(pid) for pid in self.others):
            return False
        preparing = not self.student.released or (self.builds and not begun)
        self.idle_s[preparing] += idle_s
        return self.idle_s[preparing] > (PREPARING_S if preparing else IDLE_S)
