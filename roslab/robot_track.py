"""
Compute the track of a two-wheeled robot from the commands that arrived and their times.

The same commands at the same times give the same track.  This module does not use ROS.
"""

import math
from typing import NamedTuple

LEFT_M, RIGHT_M = -1.0, 5.0
BOTTOM_M, TOP_M = -1.5, 1.5
RADIUS_M = 0.15
_STEP_S = 0.02  # between two checks for a wall: 1 cm at 0.5 m/s

COMMAND, DEADLINE, WALL = 'command', 'deadline missed', 'wall'
NOT_FINITE = 'not a finite number: stops'


class Pose(NamedTuple):
    """Position ahead and to the left of the start [m]; heading, anticlockwise from x [rad]."""

    x: float
    y: float
    heading: float


class Happened(NamedTuple):
    """
    An event that changed the robot's motion.

    :param time_s: time since the start [s]
    :param what: :data:`COMMAND`, :data:`DEADLINE`, :data:`WALL` or :data:`NOT_FINITE`
    :param speed: of the robot from then on [m/s]
    :param turn: of the robot from then on [rad/s]
    """

    time_s: float
    what: str
    speed: float
    turn: float
    pose: Pose


class Track:
    """A robot in a room, which obeys the last command until another one arrives."""

    def __init__(self) -> None:
        self.pose = Pose(0.0, 0.0, 0.0)
        self.time_s = 0.0
        self.speed = self.turn = 0.0
        self.at_wall = False
        self._last_wall: tuple[float, float] | None = None
        self.path = [self.pose]
        self.happened: list[Happened] = []

    @property
    def moving(self) -> bool:
        """Return whether the robot is changing its position or heading."""
        return bool(self.turn or (self.speed and not self.at_wall))

    @property
    def arrived(self) -> list[Happened]:
        """The commands that arrived, oldest first."""
        return [one for one in self.happened if one.what in (COMMAND, NOT_FINITE)]

    def obey(self, time_s: float, speed: float, turn: float, what: str = COMMAND) -> None:
        """
        Change the motion.

        :param time_s: time of the change, not earlier than in previous calls [s]
        :param speed: [m/s]
        :param turn: [rad/s]; if one of the two is not finite, the robot stops
        :param what: the cause, see :class:`Happened`
        """
        self.advance(time_s)
        if not (math.isfinite(speed) and math.isfinite(turn)):
            speed, turn, what = 0.0, 0.0, NOT_FINITE
        self.speed, self.turn, self.at_wall = speed, turn, False
        self._note(what)

    def advance(self, time_s: float) -> None:
        """Continue the motion until a time [s]; an earlier time has no effect."""
        while self.moving and self.time_s < time_s:
            self._step(min(_STEP_S, time_s - self.time_s))
        self.time_s = max(self.time_s, time_s)

    def _step(self, seconds: float) -> None:
        there = moved(self.pose, self.speed, self.turn, seconds)
        self.time_s += seconds
        blocked = not (
            LEFT_M + RADIUS_M <= there.x <= RIGHT_M - RADIUS_M
            and BOTTOM_M + RADIUS_M <= there.y <= TOP_M - RADIUS_M
        )
        # At a wall the wheels slip: the robot can still turn, and then drive away.
        self.pose = Pose(self.pose.x, self.pose.y, there.heading) if blocked else there
        if blocked and self._last_wall != self.pose[:2]:
            self._last_wall = self.pose[:2]
            self._note(WALL)
        self.at_wall = blocked
        if self.pose[:2] != self.path[-1][:2]:
            self.path.append(self.pose)

    def _note(self, what: str) -> None:
        self.happened.append(Happened(self.time_s, what, self.speed, self.turn, self.pose))


def moved(pose: Pose, speed: float, turn: float, seconds: float) -> Pose:
    """Return the pose after driving along one arc, with a speed [m/s] and a turn [rad/s]."""
    angle = turn * seconds
    # The chord of the arc; sin(a)/a is 1 for a straight line.
    half = angle / 2
    chord = speed * seconds * (math.sin(half) / half if half else 1.0)
    return Pose(
        pose.x + chord * math.cos(pose.heading + half),
        pose.y + chord * math.sin(pose.heading + half),
        pose.heading + angle,
    )
