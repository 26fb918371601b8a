"""A lamp with a service, which refuses a request for the current state."""

from autograder.exam.exam import Exam
from autograder.exam.scenario import Scenario
from autograder.exam.specification import each, Slip, Specification
from autograder.exam.steps import Call
from autograder.judging.claims import answers, node

CALLS = (True, True, False, False, True)


def switched(calls):
    """Return the answers of a lamp that is off at first."""
    return [{'success': one != before} for before, one in zip((False, *calls), calls)]


SLIPS = (
    Slip(
        'never_refuses',
        'The lamp is on, and on is taken again.',
        'Remember the state.',
        each(lambda one: {'success': True}),
    ),
    Slip(
        'echoes',
        'success is what was asked for.',
        'It tells whether it was switched.',
        each(lambda one: {'success': one}),
    ),
    Slip(
        'begins_on',
        'The lamp is on at first.',
        'Begin with False.',
        lambda calls: [{'success': one != was} for was, one in zip((True, *calls), calls)],
    ),
)
exam = Exam(
    'lamp',
    title='A lamp',
    assignment='20_robots',
    part=2,
    read='A lamp',
    asks={'lamp': Specification(CALLS, switched, SLIPS)},
    scenario=Scenario(
        file='lamp.py',
        steps=[Call('/lamp', '/switch', 'std_srvs/srv/SetBool', {'data': one}) for one in CALLS],
    ),
)
exam.check(points=1)(node('/lamp'))
exam.check(points=3, needs=['starts_its_node'])(answers('lamp', '/switch'))
