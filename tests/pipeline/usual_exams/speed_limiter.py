"""A node that reduces speeds to the parameter limit, which is 0.5 m/s at first."""

from autograder.exam.exam import Exam
from autograder.exam.scenario import Scenario
from autograder.exam.specification import each, Slip, Specification
from autograder.exam.steps import Feed, set_parameters
from autograder.judging.claims import node, one_for_one, passes, publishes

TWIST = 'geometry_msgs/msg/Twist'
FIRST, THEN = (0.2, 0.5, 0.9, -0.7, 0.0, -0.3), (0.4, -0.4, 0.1)
SPEEDS = [(speed, 0.5, 0.5) for speed in FIRST] + [(speed, 0.25, 0.5) for speed in THEN]


def limited(cut=lambda speed, limit, first: max(-limit, min(speed, limit))):
    """Return the published speed for a speed, the current limit and the first limit."""
    return each(lambda one: (cut(*one),))


SLIPS = (
    Slip(
        'not_limited',
        'Each speed is passed on as it came.',
        'Use min() and max().',
        limited(lambda v, m, first: v),
    ),
    Slip(
        'one_side',
        'Backwards, nothing is limited.',
        'Use max(-limit, ...), too.',
        limited(lambda v, m, first: min(v, m)),
    ),
    Slip(
        'read_once',
        'The new limit is ignored.',
        'Read it in the callback.',
        limited(lambda v, m, first: max(-first, min(v, first))),
    ),
)
exam = Exam(
    'speed_limiter',
    title='A speed limiter',
    assignment='20_robots',
    part=1,
    read='A speed limiter',
    asks={'speeds': Specification(SPEEDS, limited(), SLIPS)},
    scenario=Scenario(
        file='speed_limiter.py',
        feed={'/wanted': TWIST},
        watch={'/cmd_vel': TWIST},
        steps=(
            *(
                Feed('/wanted', [{'linear': {'x': speed}} for speed in FIRST]),
                set_parameters('/speed_limiter', {'limit': 0.25}),
            ),
            Feed('/wanted', [{'linear': {'x': speed}} for speed in THEN]),
        ),
    ),
)
exam.check(points=1)(node('/speed_limiter'))
exam.check(points=1)(passes(('/wanted', TWIST), ('/cmd_vel', TWIST)))
exam.check(points=2, needs=['reads_and_writes'])(one_for_one('speeds', '/cmd_vel'))
exam.check(points=3, needs=['one_for_one'])(publishes('speeds', '/cmd_vel', 'linear.x'))
