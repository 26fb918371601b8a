"""
Lesson 06, part 3: a pressure monitor that refuses a senseless limit.

The specification, as the lesson gives it: lifecycle node ``pressure_monitor`` with the parameter
``limit`` (a float, in bar, -1.0 at first); ``on_configure`` refuses with FAILURE and one ERROR
line unless the limit is above zero; active, it logs exactly one WARN for each
``std_msgs/msg/Float64`` on ``pressure`` strictly above the limit; otherwise it warns of nothing.
The limit that counts is the one of the last configuration, whatever the parameter is since.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import zip_longest
import math
import operator
import re
from typing import Any

from autograder.exam.exam import Cause, Exam, Failed, Run
from autograder.exam.scenario import (
    Advance,
    Call,
    Feed,
    FeedTopic,
    Mark,
    Qos,
    Scenario,
    set_parameter,
    state,
    Step,
    transition,
)
from autograder.exam.slips import above_limit, Compare, with_memory
from autograder.exam.specification import each, Rule, Slip, Specification
from autograder.judging.causes.ended import why_no_endpoint, why_silent
from autograder.judging.causes.lifecycle import (
    died_in_vain,
    ERROR_NOT_FAILURE,
    NO_PARAMETER,
    READ_ONCE,
    SILENT_REFUSAL,
    why_accepted,
    why_ended,
    why_refused,
    without_its_end,
    WRONG_DEFAULT,
)
from autograder.judging.causes.missing_logs import why_not_logged
from autograder.judging.checks import field_of, own_logs, require_answers
from autograder.judging.claims import node
from autograder.judging.rows import require_warnings, warnings_after
from autograder.recording import ERROR, Event, Recording, WARN

NODE, TOPIC = '/pressure_monitor', '/pressure'
TYPE = 'std_msgs/msg/Float64'
EXERCISE = 'Exercise 2: a monitor that refuses nonsense'
EVENTS = f'{NODE}/transition_event'
EVENT_TYPE = 'lifecycle_msgs/msg/TransitionEvent'
CHANGE = f'{NODE}/change_state'
ANSWER_S = 3.0  # after each input: a thread may look every two seconds for what has come
NUMBER = re.compile(r'[-+]?\d+(?:[.,]\d+)?(?:[eE][-+]?\d+)?')


@dataclass(frozen=True)
class Inputs:
    """
    The numbers of one exam.

    :param refused: limits that make no sense, the first one the parameter's default [bar]
    :param limits: of the first and of the second configuration [bar]
    :param highest: one more limit that makes sense, at the end [bar]
    :param pressures: by phase: ``accepted`` and ``paused``, in which the node is not active,
        ``active`` under the first limit, ``still`` after the parameter was set, and ``again``
        under the second limit [bar]
    """

    refused: Sequence[float]
    limits: tuple[float, float]
    highest: float
    pressures: Mapping[str, Sequence[float]]


@dataclass(frozen=True)
class Pressure:
    """
    One pressure that is sent.

    :param limit: the one that counts; ``parameter`` is what the parameter says then, and ``first``
        the limit of the first configuration
    """

    value: float
    phase: str
    limit: float
    parameter: float
    first: float

    @property
    def active(self) -> bool:
        """Return whether the node is active then."""
        return self.phase not in INACTIVE

    @property
    def kind(self) -> str:
        """Return what it tries, in words that may be shown."""
        if self.value == self.limit:
            return 'a pressure of exactly the limit'
        return f'a pressure {"above" if self.value > self.limit else "below"} the limit'


INACTIVE = ('accepted', 'paused')


def pressures_of(numbers: Inputs) -> list[Pressure]:
    """Return all pressures in the order in which they are sent."""
    first, second = numbers.limits
    return [
        Pressure(
            value,
            phase,
            second if phase == 'again' else first,
            second if phase in ('still', 'again') else first,
            first,
        )
        for phase, values in numbers.pressures.items()
        for value in values
    ]


def warns(
    hot: Compare = operator.gt,
    limit: Callable[[Pressure], float] = lambda one: one.limit,
    active: Callable[[Pressure], bool] = lambda one: one.active,
    times: Callable[[Pressure], int] = lambda one: 1,
) -> Rule:
    """Return the warnings of a monitor with these parts, by default the right ones."""
    return each(lambda one: times(one) if active(one) and hot(one.value, limit(one)) else 0)


NOT_MANAGED = Cause(
    'subscription_not_managed',
    'A subscription hears messages in every state; rclpy manages publishers only.',
    'Remember in on_activate() and on_deactivate() whether you are active, and look at it in the '
    'callback.',
)
STILL_REFUSES = Cause(
    'still_refuses',
    'on_configure() returns FAILURE for a limit above zero as well.',
    "FAILURE only unless self.get_parameter('limit').value > 0.0, and no except around it that "
    'hides another mistake.',
)
SLIPS = (
    Slip(
        'never_warns',
        'The pressure arrives while the node is active, and no warning follows.',
        'Does on_activate() remember it, with self. in front? Is it value > self.limit?',
        warns(active=lambda one: False),
    ),
    Slip(
        'early_limit',
        'A new value of the parameter counts before the node is configured again.',
        'Compare with self.limit, and set that in on_configure() alone: neither judge() nor '
        'on_activate() reads the parameter.',
        warns(limit=lambda one: one.parameter),
    ),
    Slip(
        'stale_limit',
        'The limit of the first configuration is still in use.',
        'Read the parameter in on_configure(), each time.',
        warns(limit=lambda one: one.first),
    ),
    Slip(
        'subscribed_twice',
        'After the second configuration each warning comes twice.',
        'Create the subscription once, or destroy it in on_cleanup().',
        warns(times=lambda one: 2 if one.phase == 'again' else 1),
    ),
    Slip.of(NOT_MANAGED, warns(active=lambda one: True)),
    Slip(
        'active_too_early',
        'It warns as soon as it is configured, before it is activated.',
        'Set the flag in on_activate(), and not in on_configure().',
        warns(active=lambda one: one.phase != 'paused'),
    ),
    Slip(
        'stays_active',
        'It goes on warning after it was deactivated.',
        'In on_deactivate(), set the flag to False.',
        warns(active=lambda one: one.phase != 'accepted'),
    ),
    *(
        Slip(
            'limit_cut',
            'The limit in use is not the one that was set: its decimals are cut off or rounded.',
            "Take it as it is: self.limit = self.get_parameter('limit').value.",
            warns(limit=lambda one, cut=cut: cut(one.limit)),  # type: ignore[misc]
        )
        for cut in (math.trunc, round)
    ),
    *above_limit(warns, 'self.limit'),
    *with_memory(warns()),
)


def inputs(run: Run) -> Inputs:
    """Return the numbers of this exam."""
    found: Inputs = run.facts['inputs']
    return found


def refuses_a_senseless_limit(run: Run) -> None:
    """Configuring fails, with FAILURE, while the limit is not above zero."""
    part = run.recording.phase('refused')
    tries = len(inputs(run).refused)
    what = 'configure with a limit that is not above zero'
    try:
        _require(run, 'refused', CHANGE, [{'success': False}] * tries, what)
    except Failed as failed:
        answers = [one['data'] for one in part.answers(CHANGE) if 'data' in one]
        failed.why = why_accepted(run, any(one['success'] for one in answers)) or failed.why
        raise
    for event in part.messages(EVENTS):
        if field_of(event, 'goal_state.label') == 'errorprocessing':
            raise Failed(
                expected='FAILURE: back to unconfigured, ready for another try',
                observed='an error: the node went to errorprocessing',
                why=ERROR_NOT_FAILURE,
            )
    states = [{'current_state.label': 'unconfigured'}]
    _require(run, 'refused', f'{NODE}/get_state', states, 'the question for its state')


def _require(
    run: Run, phase: str, service: str, wanted: Sequence[Mapping[str, Any]], what: str
) -> None:
    """Fail unless the calls of one phase were answered as wanted; the whole run says why not."""
    part = run.during(phase)
    try:
        require_answers(part, service, wanted, what)
    except Failed as failed:
        failed.why = why_ended(run) or (None if died_in_vain(run) else failed.why)
        raise


def tells_why(run: Run) -> None:
    """Each refusal is one ERROR line with the limit in it."""
    refused = inputs(run).refused
    found = own_logs(run.during('refused'), NODE, ERROR)
    if len(found) == len(refused) and all(map(_shows, found, refused)):
        return
    raise Failed(
        expected=f'{len(refused)} refused, each with one ERROR line that shows the limit',
        observed=f'{len(found) or "no"} ERROR line{"" if len(found) == 1 else "s"}',
        why=_why_untold(run, found, refused),
    )


def _why_untold(run: Run, found: Sequence[Event], refused: Sequence[float]) -> Cause | None:
    answers = run.recording.phase('refused').answers(f'{NODE}/set_parameters')
    results = [result for one in answers if 'data' in one for result in one['data']['results']]
    if not all(result['successful'] for result in results):
        return NO_PARAMETER
    if not found:
        logs = run.recording.phase('refused').logs()
        return why_not_logged(without_its_end(run), logs, ERROR) or SILENT_REFUSAL
    if len(found) > len(refused):
        return Cause(
            'repeated_log',
            'One refusal gives more than one ERROR line.',
            'Say it once, in one line with the limit in it.',
        )
    if len(found) < len(refused):
        return SILENT_REFUSAL
    if all(_shows(entry, refused[0]) for entry in found):
        return READ_ONCE
    if all(map(_shows, found[1:], refused[1:])) and NUMBER.search(found[0]['text']):
        return WRONG_DEFAULT
    return Cause(
        'no_value',
        'There is an ERROR line, but the limit is not in it.',
        "Put it into the text: f'limit {limit} is not above zero'.",
    )


def _shows(entry: Event, limit: float) -> bool:
    return any(
        abs(float(text.replace(',', '.')) - limit) <= 0.051
        for text in NUMBER.findall(entry['text'])
    )


def recovers(run: Run) -> None:
    """With a sensible limit it configures and activates after all."""
    part = run.recording.phase('accepted')
    setting = f'{NODE}/set_parameters'
    wanted = [{'results': [{'successful': True, 'reason': ''}]}]
    try:
        _require(run, 'accepted', setting, wanted, 'setting the parameter limit')
    except Failed as failed:
        if any('data' in answer for answer in part.answers(setting)):
            failed.observed, failed.why = 'the node refuses', NO_PARAMETER
        raise
    try:
        _require(run, 'accepted', CHANGE, [{'success': True}], 'configure')
    except Failed as failed:
        if any('data' in answer for answer in part.answers(CHANGE)):
            failed.why = _why_still_refused(run, part)
        raise
    _require(run, 'active', CHANGE, [{'success': True}], 'activate')


def _why_still_refused(run: Run, part: Recording) -> Cause:
    """Explain that a limit above zero is refused, too."""
    states = [field_of(event, 'goal_state.label') for event in part.messages(EVENTS)]
    if 'errorprocessing' in states:
        return why_refused(run, 'configure')
    told = own_logs(run.during('accepted'), NODE, ERROR)
    if any(_shows(entry, limit) for entry in told for limit in inputs(run).refused):
        return READ_ONCE
    return STILL_REFUSES


def warns_above_the_limit(run: Run) -> None:
    """Active, it logs exactly one WARN for each pressure strictly above the limit."""
    _require_warnings(run, 'active')


def ignores_while_not_active(run: Run) -> None:
    """Inactive, it warns of nothing, however high the pressure."""
    for phase in ('accepted', 'paused'):
        found = own_logs(run.during(phase), NODE, WARN)
        if found:
            asked: Specification = run.facts['warnings']
            came = warnings_after(_followed(run))
            quiet = [place for place, one in enumerate(asked.inputs) if not one.active]
            place = next(iter(asked.wrong(came, quiet)), quiet[0])
            raise Failed(
                expected='no WARN line while it is inactive',
                observed=f'{len(found)}',
                why=asked.cause(came, place, quiet) or NOT_MANAGED,
            )


def takes_the_new_limit(run: Run) -> None:
    """Configured again, it watches the new limit, and not before."""
    _require(run, 'still', CHANGE, [{'success': True}] * 2, 'activate and deactivate')
    _require_warnings(run, 'still')
    wanted = [{'success': True}] * 3
    _require(run, 'again', CHANGE, wanted, 'cleanup, configure and activate')
    _require_warnings(run, 'again')
    wanted = [{'success': True}] * 3
    try:
        _require(run, 'highest', CHANGE, wanted, 'deactivate, cleanup and configure')
    except Failed as failed:
        failed.why = failed.why or STILL_REFUSES
        raise


def _require_warnings(run: Run, phase: str) -> None:
    """Fail unless each pressure of a phase has as many warnings as it should have."""
    part = run.recording.phase(phase)
    if part.of('not_connected') or not part.of('input'):
        raise Failed(
            expected=f'a subscription on {TOPIC} of type {TYPE} while it is active',
            observed='nobody listens',
            why=why_silent(run) or why_no_endpoint(run, 'subscription', TOPIC, TYPE),
        )
    asked: Specification = run.facts['warnings']
    places = [place for place, one in enumerate(asked.inputs) if one.phase == phase]
    found = _followed(run)
    require_warnings(
        run,
        asked,
        found,
        places,
        lambda place: why_not_logged(run, found[place] or [], WARN),
        places,
    )


def _followed(run: Run) -> list[list[Event] | None]:
    """Return the node's lines after each pressure, None where it was not sent."""
    found: list[list[Event] | None] = []
    for phase, pressures in inputs(run).pressures.items():
        part = run.recording.phase(phase)
        lines = own_logs(Run(run.files, part, run.facts), NODE)
        for _, sent in zip_longest(pressures, part.of('input')):
            after = [one for one in lines if sent and one['after_input'] == sent['index']]
            found.append(after if sent else None)
    return found


def build(numbers: Inputs) -> Exam:
    """
    Return the exam for some numbers.

    :param numbers: what is sent and set
    """
    configure = transition(NODE, 'configure')
    activate, deactivate = transition(NODE, 'activate'), transition(NODE, 'deactivate')
    first, second = numbers.limits
    feeds = {phase: _feed(values) for phase, values in numbers.pressures.items()}
    steps: list[Step] = [Mark('refused')]
    for number, limit in enumerate(numbers.refused):
        if number:
            steps.append(_limit(limit))
        steps += [configure, Advance(ANSWER_S)]
    steps += [state(NODE), Mark('accepted'), _limit(first), configure]
    steps += [feeds['accepted']]
    steps += [Mark('active'), activate, feeds['active']]
    steps += [Mark('paused'), deactivate, feeds['paused']]
    # A node may refuse to be set before the cleanup; then it is set after it.
    steps += [Mark('still'), _limit(second), activate, feeds['still'], deactivate]
    steps += [Mark('again'), transition(NODE, 'cleanup'), _limit(second), configure, activate]
    steps += [feeds['again'], Mark('highest'), deactivate, transition(NODE, 'cleanup')]
    steps += [_limit(numbers.highest), configure]
    exam = Exam(
        'managed_pressure',
        title='The managed pressure monitor',
        assignment='06_managed_lifecycle',
        part=3,
        cells=('pressure_monitor',),
        scenario=Scenario(
            file='pressure_monitor.py',
            watch={EVENTS: EVENT_TYPE},
            feed={TOPIC: FeedTopic(TYPE, Qos())},
            steps=steps,
        ),
        read='Part 3: When a transition goes wrong',
        facts={'inputs': numbers},
        asks={'warnings': Specification(pressures_of(numbers), warns(), SLIPS)},
    )
    exam.check(points=1, read=EXERCISE)(node(NODE))
    exam.check(points=2, needs=['starts_its_node'])(refuses_a_senseless_limit)
    exam.check(points=1, needs=['refuses_a_senseless_limit'])(tells_why)
    exam.check(points=2, needs=['refuses_a_senseless_limit'])(recovers)
    exam.check(points=2, needs=['recovers'], read=EXERCISE)(warns_above_the_limit)
    for judge in (ignores_while_not_active, takes_the_new_limit):
        exam.check(points=1, needs=['warns_above_the_limit'], read=EXERCISE)(judge)
    return exam


def _limit(value: float) -> Call:
    return set_parameter(NODE, 'limit', value)


def _feed(pressures: Sequence[float]) -> Feed:
    messages = [{'data': value} for value in pressures]
    return Feed(TOPIC, messages, optional=True, every_s=ANSWER_S, rest_s=0.0)


exam = build(
    Inputs(
        refused=(-1.0,),
        limits=(2.5, 6.0),
        highest=30.0,
        pressures={
            'accepted': (3.0,),
            'active': (2.4, 2.5, 2.6, 9.0, 1.0),
            'paused': (8.0,),
            'still': (4.0, 9.0),
            'again': (5.0, 7.0),
        },
    )
)
