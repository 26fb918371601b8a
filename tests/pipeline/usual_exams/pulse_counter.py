"""A counter that publishes five numbers a second while a service has switched it on."""

from autograder.exam.exam import Cause, Exam
from autograder.exam.scenario import Scenario
from autograder.exam.specification import each, Slip, Specification
from autograder.exam.steps import Advance, Call, Mark, read_parameters
from autograder.judging.claims import answers, beats, declares, node, offers, quiet, serves

COUNT, ENABLE = 'std_msgs/msg/Int32', 'std_srvs/srv/SetBool'
NODE, PARAMETERS = '/pulse_counter', {'first': 1, 'period_s': 0.2}
CALLS = (True, False, True, False)


def answered(success=lambda on: True):
    """Return the rule of the service; by default it always succeeds."""
    return each(lambda on: {'success': success(on)})


SLIPS = (
    Slip('echoes', 'success is what was requested.', 'Always set it.', answered(lambda on: on)),
    Slip(
        'no_success', 'success stays false.', 'Set response.success.', answered(lambda on: False)
    ),
)
STEPS = [
    step
    for on in CALLS
    for step in (
        Call(NODE, '/enable', ENABLE, {'data': on}),
        Mark('on' if on else 'off'),
        Advance(3.0),
        Mark(''),
    )
]
exam = Exam(
    'pulse_counter',
    title='A pulse counter',
    assignment='20_robots',
    part=4,
    read='A pulse counter',
    asks={'calls': Specification(CALLS, answered(), SLIPS)},
    scenario=Scenario(
        file='pulse_counter.py',
        watch={'/count': COUNT},
        steps=[Mark('off'), Advance(1.0), *read_parameters(NODE, PARAMETERS), Mark(''), *STEPS],
    ),
)
exam.check(points=1)(node(NODE))
exam.check(points=1)(offers('/count', COUNT))
exam.check(points=1, needs=['starts_its_node'])(declares(NODE, PARAMETERS))
exam.check(points=1)(serves('/enable', ENABLE))
exam.check(points=2, needs=['serves_enable'])(answers('calls', '/enable'))
exam.check(points=2, needs=['offers_count', 'serves_enable'])(beats('/count', 0.2, 'on'))
exam.check(points=2, needs=['keeps_its_rhythm'])(
    quiet('/count', 'off', why=Cause('stays_on', 'It publishes while it is off.', 'Use an if.'))
)
