"""
A right and a wrong program for each style of keeping time, and the exam that judges both.

Most styles are a talker, which is wrong if its period is a tenth of a second too long.  The others
have an exam with a single check.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

from autograder.exam import catalog
from autograder.exam.exam import Exam, Run
from autograder.exam.specification import each, Specification
from autograder.judging.checks import require_messages
from autograder.judging.claims import claim, one_for_one
from autograder.judging.rhythm import require_period
from tests.clock.time_styles import ANSWERING, ASKED, BURST, INPUTS, program, STYLES, WATCHED

NAMES = (*STYLES, *ANSWERING)
TALKS = {
    "'numbers'": "'talker'",
    "Int32, 'n', 10": "String, 'chatter', 10",
    'self.publisher.publish(Int32(data=self.number))': (
        "self.publisher.publish(String(data=f'hello {self.number}'))"
    ),
    'import Float64, Int32': 'import Float64, Int32, String',
}
SLOWER = {'P = 1.0': 'P = 1.1'}
LATE = {'publisher.publish(Float64': 'time.sleep(0.6); publisher.publish(Float64'}
"""The program answers more slowly than the inputs arrive."""
SHORTER = {'time.sleep(2.2)': 'time.sleep(1.7)'}
"""With this sleep, a lifespan causes an even rhythm."""


@dataclass(frozen=True)
class Rhythm:
    """
    A rhythm that an exam requires, and the two programs.

    :param wrong: changes to the code of the style that make the wrong program
    :param right: changes that make the right program
    :param during_s: time during which the program publishes [s]
    """

    wrong: Mapping[str, str]
    right: Mapping[str, str] = field(default_factory=dict)
    period_s: float = 1.0
    during_s: float = 19.8


RHYTHMS = {
    'alarm': Rhythm({'alarm(1)': 'alarm(2)'}),  # it accepts only whole seconds
    # A talker would have to begin within half a second.
    'sleep in a callback': Rhythm(SLOWER),
    'sleep before the timer': Rhythm(SLOWER, during_s=16.8),
    'sleep in __init__': Rhythm(SLOWER, during_s=16.8),
    'sleep longer than the period': Rhythm({'sleep(2.0)': 'sleep(2.2)'}, period_s=2.0),
    'thread that never waits': Rhythm({}, {'while True: pass': 'for _ in range(10**6): pass'}),
    'node that ends by itself': Rhythm({'number < 7': 'number < 5'}, during_s=7.0),
    'lifespan': Rhythm({**SHORTER, 'lifespan=Duration(seconds=0.5)': ''}, SHORTER, period_s=2.0),
}


def judged(style: str, right: bool) -> tuple[Exam, dict[str, str]]:
    """Return the exam for a style, and the files of its right or wrong program."""
    body = ANSWERING[style] if style in ANSWERING else STYLES[style][0]
    changes: Mapping[str, str]
    if rhythm := RHYTHMS.get(style):
        exam, changes = _beater(rhythm), rhythm.right if right else rhythm.wrong
    elif style in ANSWERING:
        exam, changes = _doubler(), {} if right else LATE
    else:
        exam = catalog.load('talker', hidden=False)
        changes = {**TALKS, 'P = 1.0': f'P = {0.5 if right else 0.6}'}
    text = program(body)
    for before, after in changes.items():
        if before not in text:
            raise ValueError(f'{style}: the program does not contain {before!r}')
        text = text.replace(before, after)
    return exam, {exam.scenario.file: text}


def _beater(rhythm: Rhythm) -> Exam:
    exam = Exam('numbers', title='Numbers', assignment='styles', part=1, scenario=WATCHED)

    def keeps_its_rhythm(run: Run) -> None:
        found = require_messages(run, topic='/n')
        require_period(run, found, rhythm.period_s, rhythm.during_s)

    exam.check(points=1)(claim('keeps_its_rhythm', 'It keeps its rhythm.', keeps_its_rhythm))
    return exam


def _doubler() -> Exam:
    asked = {'doubled': Specification(INPUTS, each(lambda one: (2 * one,)), burst=BURST)}
    exam = Exam(
        'doubler', title='Doubles', assignment='styles', part=2, scenario=ASKED, asks=asked
    )
    exam.check(points=1)(one_for_one('doubled', '/answer'))
    return exam
