"""Hidden exam of lesson 04, part 1: identical to the visible one, because a type has no inputs."""

from exams.visible.station_message import build

exam = build()
