"""Hidden exam of lesson 07, part 2: a ROS clock with a secret start and rate."""

from autograder.exam.inputs import generator, WATCH_S
from exams.visible.temperature_publisher import build

_draw = generator('temperature_publisher', 'clock')
exam = build(
    seconds=WATCH_S,
    begins_s=round(_draw.uniform(0.01, 0.09), 9),
    rate=round(_draw.choice((_draw.uniform(0.7, 0.85), _draw.uniform(1.15, 1.4))), 3),
    warming_s=300.0,  # a temperature that grows by 0.4 °C per second leaves the range by then
)
