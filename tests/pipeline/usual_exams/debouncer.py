"""A button that bounces: a state that arrives twice in a row is published, once per change."""

from autograder.exam.exam import Exam
from autograder.exam.scenario import Scenario
from autograder.exam.specification import each, Slip, Specification
from autograder.exam.steps import Feed
from autograder.judging.claims import hears, node, offers, one_for_one, publishes

BOOL = 'std_msgs/msg/Bool'
PRESSED = (False, True, False, True, True, True, False, False, True, False, True, True)


def debounced(pressed, needs=2, again=False):
    """Return the states published after each state; the button is up at first."""
    found, last = [], False
    for end in range(1, len(pressed) + 1):
        same = end >= needs and len(set(pressed[end - needs : end])) == 1
        found.append((pressed[end - 1],) if same and (again or pressed[end - 1] != last) else ())
        last = pressed[end - 1] if same else last
    return found


SLIPS = (
    Slip(
        'passes_all',
        'Each state is passed on.',
        'Compare with the last two.',
        each(lambda one: (one,)),
    ),
    Slip(
        'no_wait',
        'A change is published at once.',
        'Wait for the second one.',
        lambda pressed: debounced(pressed, needs=1),
    ),
    Slip(
        'repeats',
        'The same state is published again.',
        'Remember the last.',
        lambda pressed: debounced(pressed, again=True),
    ),
)
exam = Exam(
    'debouncer',
    title='A button',
    assignment='20_robots',
    part=3,
    read='A button',
    asks={'states': Specification(PRESSED, debounced, SLIPS)},
    scenario=Scenario(
        file='debouncer.py',
        feed={'/button': BOOL},
        watch={'/pressed': BOOL},
        steps=(Feed('/button', [{'data': one} for one in PRESSED]),),
    ),
)
exam.check(points=1)(node('/debouncer'))
exam.check(points=1)(hears('/button', BOOL))
exam.check(points=1)(offers('/pressed', BOOL))
exam.check(points=2, needs=['hears_button', 'offers_pressed'])(one_for_one('states', '/pressed'))
exam.check(points=2, needs=['one_for_one'])(publishes('states', '/pressed'))
