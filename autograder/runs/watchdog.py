"""
Enforce the limits of a run: processor time, memory, files, output, and stalled virtual time.

A busy machine makes a run longer, but does not change its result.  A run that takes more than ten
minutes of real time is aborted, and the submission is for review.
"""

from collections.abc import Sequence
import os
import time

from autograder.clock.virtual_clock import VirtualClock
from autograder.errors import TooBusy
from autograder.sandboxes.confinement import ConfinedProgram, Limits
from autograder.sandboxes.processes import (
    pss_bytes,
    ready_to_run,
    states,
    usage,
    used_ns,
)

WATCH_EVERY_S = 0.05
# Limit of processor time before the first node: imports take 0.3 s, and 1 s on a slow machine.
BUSY_S = 3.0
# If the probe and the driver use this much more processor time than the program, a flood of
# packets keeps them busy.
PROBE_S = 10.0
# Limits of real time in which virtual time stands still and no process computes. HELD_S is longer
# because a thread that waits for a disk looks like one that waits for a child of vfork, because a
# person may stop the probe and continue it, and because on a busy machine a part of the system
# that must answer first, such as a file system, may itself wait for a processor.
OUTSIDE_S, HELD_S, BUILD_S = 0.3, 3.0, 20.0
# A program that prints waits until the grader reads. Printed output shows progress only if it is
# longer than the capacity of a pipe [bytes].
PIPE = 1 << 16
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
        clock: VirtualClock,
        builds: bool,
    ) -> None:
        """Start with all counts at zero."""
        self.student, self.others = student, others
        self.limits = limits
        self.clock = clock
        self.builds = builds
        self.cpu_s = 0.0
        self.began = self.looked = time.monotonic()
        self.still_s: dict[float, float] = {}
        self.used_ns = 0
        self.progress: tuple[int, ...] = ()

    def is_due(self) -> bool:
        """Return whether the next check is due."""
        return time.monotonic() > self.looked + WATCH_EVERY_S

    def look(self, recorded: int, printed: int, begun: bool) -> str:
        """
        Return the name of the limit that was exceeded, or an empty string.

        :param recorded: bytes received from the probe so far
        :param printed: bytes printed by the program so far
        :param begun: whether a node has been seen
        :raises TooBusy: if the run has taken more than ten minutes of real time
        """
        before, self.looked = self.looked, time.monotonic()
        if self.looked - self.began > MOST_WALL_S:
            raise TooBusy(f'The machine was too busy: a run took {MOST_WALL_S:.0f} s.')
        runs = self.student.process.poll() is None
        resident, seconds = usage(*self.student.pids) if runs else (0, self.cpu_s)
        self.cpu_s = max(self.cpu_s, seconds)
        student_ns, others_ns = used_ns(*self.student.pids), sum(map(used_ns, self.others))
        used_s = max(0, student_ns + others_ns - self.used_ns) / 1e9
        self.used_ns = student_ns + others_ns
        stands_still = self._stands_still(recorded, printed, begun, self.looked - before, used_s)
        return (
            self._too_long(begun, others_ns / 1e9, stands_still)
            or ('output_limit' if printed > self.limits.output else '')
            or (self._too_large(resident) if runs else '')
        )

    def _too_long(self, begun: bool, others_s: float, stands_still: bool) -> str:
        if self.cpu_s + others_s > self.limits.cpu_s:
            return 'cpu_limit'
        if others_s > self.cpu_s + PROBE_S:
            return 'probe_broken'
        if stands_still:
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

    def _stands_still(
        self, recorded: int, printed: int, begun: bool, passed_s: float, used_s: float
    ) -> bool:
        """
        Return whether virtual time has stood still for too long while no process computed.

        Each cause of waiting has a separate timeout: a probe that was stopped for a second does
        not use up the 0.3 s of the program.

        :param recorded: bytes received from the probe so far
        :param printed: bytes printed by the program so far
        :param begun: whether a node has been seen
        :param passed_s: real time since the last check
        :param used_s: processor time since the last check, of program, probe and driver
        """
        everyone = (*self.student.pids, *self.others)
        progress = (self.clock.jumps, recorded, printed // PIPE)
        if progress != self.progress:
            self.progress, self.still_s = progress, {}
        elif not any(b'R' in states(pid) for pid in everyone):
            # If the grader's own process was delayed, do not charge the program for the delay.
            passed_s = min(passed_s, 2 * WATCH_EVERY_S)
            patience_s = self._patience_s(begun)
            still_s = self.still_s.get(patience_s, 0.0) + max(0.0, passed_s - used_s)
            self.still_s[patience_s] = still_s
            return still_s > patience_s
        return False

    def _patience_s(self, begun: bool) -> float:
        if not self.student.released or (self.builds and not begun):
            return BUILD_S
        busy = ready_to_run() > (os.cpu_count() or 1)
        held = b'D' in states(*self.student.pids) or any(
            set(states(pid)) & set(b'DT') for pid in self.others
        )
        return HELD_S if busy or held else OUTSIDE_S
