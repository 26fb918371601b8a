"""Hidden exam of lesson 07, part 2: a ROS clock with a secret start and rate."""

from autograder.exam.inputs import generator
from exams.visible.temperature_publisher import build

_draw = generator('temperature_publisher', 'clock')
exam = build(
    seconds=300,  # a temperature that grows by 0.4 °C per second leaves the range by then
    begins_s=round(_draw.uniform(0.01, 0.09), 9),
    rate=round(_draw.choice((_draw.uniform(0.7, 0.85), _draw.uniform(1.15, 1.4))), 3),
)
