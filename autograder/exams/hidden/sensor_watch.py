"""Hidden exam of lesson 05, part 5: secret distances."""

from autograder.exam.inputs import generator
from autograder.exams.visible.sensor_watch import build

_draw = generator('sensor_watch', 'distances')
_near = _draw.choice((0.12, 0.15))
# A log line with only three significant digits does not show the last of these distances.
_whole = (*_draw.sample(range(1, 10), k=2), _draw.randint(10, 19))
_far = [whole + _draw.choice((0.25, 0.75)) for whole in _whole]
# A repeated distance, zero, a short and a negative distance are ordinary inputs.
exam = build([_far[0], _far[1], _far[1], 0.0, _near, -_far[0], _far[1], _far[2]])
