"""
Lesson 06, part 3: a pressure monitor that refuses a senseless limit.

The specification, as the lesson gives it: lifecycle node ``pressure_monitor`` with the parameter
``limit`` (a float, in bar, -1.0 at first); ``on_configure`` refuses with FAILURE and one ERROR
line unless the limit is above zero; active, it logs exactly one WARN for each
``std_msgs/msg/Float64`` on ``pressure`` strictly above the limit; otherwise it warns of nothing.
The limit that counts is the one of the last configuration.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
import re

from autograder.causes import why_no_endpoint, why_no_verdict, why_silent
from autograder.checks import own_logs, require_answers, require_node, why_not_logged
from autograder.exam import Cause, Exam, Failed, Run
from autograder.recording import ERROR, Event, Recording, WARN
from autograder.scenario import (
    Await,
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

NODE, TOPIC = '/pressure_monitor', '/pressure'
TYPE = 'std_msgs/msg/Float64'
EVENTS = f'{NODE}/transition_event'
EVENT_TYPE = 'lifecycle_msgs/msg/TransitionEvent'
CHANGE = f'{NODE}/change_state'
READ_ONCE = Cause(
    'read_once',
    'The parameter was changed, and on_configure() still goes by an earlier value.',
    "Read it in on_configure(), each time: self.get_parameter('limit').value.",
)
NUMBER = re.compile(r'[-+]?\d+(?:[.,]\d+)?(?:[eE][-+]?\d+)?')


@dataclass(frozen=True)
class Inputs:
    """
    The numbers of one exam.

    :param refused: limits that make no sense, the first from the command line [bar]
    :param limits: of the first and of the second configuration [bar]
    :param inactive: pressures before activation, above the first limit
    :param active: pressures under the first limit's watch
    :param paused: pressures after deactivation, above both limits
    :param again: pressures under the second limit's watch
    """

    refused: Sequence[float]
    limits: tuple[float, float]
    inactive: Sequence[float]
    active: Sequence[float]
    paused: Sequence[float]
    again: Sequence[float]


def inputs(run: Run) -> Inputs:
    """Return the numbers of this exam."""
    found: Inputs = run.facts['inputs']
    return found


def starts_its_node(run: Run) -> None:
    """Your program starts a node called pressure_monitor."""
    require_node(run, NODE)


def refuses_a_senseless_limit(run: Run) -> None:
    """Configuring fails, with FAILURE, while the limit is not above zero."""
    part = run.recording.phase('refused')
    tries = len(inputs(run).refused)
    phase = Run(run.files, part, run.facts)
    what = 'configure with a limit that is not above zero'
    try:
        require_answers(phase, f'{NODE}/change_state', [{'success': False}] * tries, what)
    except Failed as failed:
        why = _why_let_through(run, part) or failed.why
        raise Failed(expected=failed.expected, observed=failed.observed, why=why) from None
    for event in part.messages(EVENTS):
        if event['data']['goal_state']['label'] == 'errorprocessing':
            raise Failed(
                expected='FAILURE: back to unconfigured, ready for another try',
                observed='an error: the node went to errorprocessing',
                why=Cause(
                    'error_not_failure',
                    'on_configure() returns ERROR, or it raises an exception, which rclpy '
                    'swallows without a word.',
                    'Return TransitionCallbackReturn.FAILURE. If you do: put the lines before it '
                    'into try/except Exception as error, and log error.',
                ),
            )
    states = [{'current_state.label': 'unconfigured'}]
    require_answers(phase, f'{NODE}/get_state', states, 'the question for its state')


def _why_let_through(run: Run, part: Recording) -> Cause | None:
    if why := why_no_verdict(run):
        return why
    accepted = [answer for answer in part.answers(f'{NODE}/change_state') if 'data' in answer]
    if any(answer['data']['success'] for answer in accepted):
        return Cause(
            'let_through',
            'A limit that is not above zero is accepted.',
            "In on_configure(): unless self.get_parameter('limit').value > 0.0, return FAILURE.",
        )
    return None


def _why_ended(run: Run) -> Cause | None:
    return why_no_verdict(run) or why_silent(run)


def tells_why(run: Run) -> None:
    """Each refusal is one ERROR line with the limit in it."""
    refused = inputs(run).refused
    found = own_logs(Run(run.files, run.recording.phase('refused'), run.facts), NODE, ERROR)
    if len(found) == len(refused) and all(map(_shows, found, refused)):
        return
    raise Failed(
        expected=f'{len(refused)} refused, each with one ERROR line that shows the limit',
        observed=f'{len(found) or "no"} ERROR line{"" if len(found) == 1 else "s"}',
        why=_why_untold(run, found, refused),
    )


def _why_untold(run: Run, found: Sequence[Event], refused: Sequence[float]) -> Cause | None:
    if not found:
        return why_not_logged(run, run.recording.phase('refused').logs(), ERROR)
    if len(found) > len(refused):
        return Cause(
            'repeated_log',
            'One refusal gives more than one ERROR line.',
            'Say it once, in one line with the limit in it.',
        )
    if len(found) < len(refused):
        return None
    if all(_shows(entry, refused[0]) for entry in found):
        return READ_ONCE
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
    part = Run(run.files, run.recording.phase('mended'), run.facts)
    wanted = [{'results': [{'successful': True, 'reason': ''}]}]
    require_answers(part, f'{NODE}/set_parameters', wanted, 'setting the parameter limit')
    try:
        require_answers(part, f'{NODE}/change_state', [{'success': True}], 'configure')
    except Failed as failed:
        refused = any(answer.get('data') for answer in part.recording.answers(CHANGE))
        why = READ_ONCE if refused else _why_ended(run) or failed.why
        raise Failed(expected=failed.expected, observed=failed.observed, why=why) from None
    later = Run(run.files, run.recording.phase('active'), run.facts)
    require_answers(later, f'{NODE}/change_state', [{'success': True}], 'activate')


def warns_above_the_limit(run: Run) -> None:
    """Active, it logs exactly one WARN for each pressure strictly above the limit."""
    first, _ = inputs(run).limits
    _warns(run, 'active', inputs(run).active, first)


def _warns(run: Run, phase: str, pressures: Sequence[float], limit: float) -> None:
    part = run.recording.phase(phase)
    sent = part.of('input')
    if part.of('not_connected') or not sent:
        raise Failed(
            expected=f'a subscription on {TOPIC} of type {TYPE} while it is active',
            observed='nobody listens',
            why=why_silent(run) or why_no_endpoint(run, 'subscription', TOPIC, TYPE),
        )
    for number, pressure in enumerate(pressures):
        index = sent[number]['index'] if number < len(sent) else -1
        found = [log for log in own_logs(run, NODE, WARN) if log['after_input'] == index]
        due = int(pressure > limit)
        if len(found) != due:
            logs = [log for log in part.logs() if log['after_input'] == index]
            raise Failed(
                expected=f'{due or "no"} WARN line after {_what(pressure, limit)}',
                observed=f'{len(found) or "none"}',
                why=_why_wrong(run, pressure, limit, len(found), logs),
            )


def _what(pressure: float, limit: float) -> str:
    if pressure == limit:
        return 'a pressure of exactly the limit'
    return f'a pressure {"above" if pressure > limit else "below"} the limit'


def _why_wrong(
    run: Run, pressure: float, limit: float, found: int, logs: Sequence[Event]
) -> Cause | None:
    if why := why_silent(run):
        return why
    if pressure == limit:
        return Cause(
            'warns_at_limit',
            'The comparison includes the limit itself.',
            'Above means strictly greater: value > limit, not >=.',
        )
    if found > 1:
        return Cause(
            'repeated_warning',
            'The same pressure is warned about more than once: it has several subscriptions.',
            'Create the subscription once, or destroy it in on_cleanup().',
        )
    if pressure > limit:
        return why_not_logged(run, logs, WARN) or Cause(
            'never_warns',
            'The pressure arrives while the node is active, and no warning follows.',
            'Does on_activate() remember it, with self. in front? Is it value > self.limit?',
        )
    return Cause(
        'warns_below',
        'It warns although the pressure is below the limit.',
        'Compare with the limit of the last configuration: value > self.limit.',
    )


def ignores_while_not_active(run: Run) -> None:
    """Inactive, it warns of nothing, however high the pressure."""
    for phase in ('mended', 'paused'):
        found = own_logs(Run(run.files, run.recording.phase(phase), run.facts), NODE, WARN)
        if found:
            raise Failed(
                expected='no WARN line while it is inactive',
                observed=f'{len(found)}',
                why=Cause(
                    'subscription_not_managed',
                    'A subscription hears messages in every state; rclpy manages publishers only.',
                    'Remember in on_activate() and on_deactivate() whether you are active, '
                    'and look at it in the callback.',
                ),
            )


def takes_the_new_limit(run: Run) -> None:
    """Configured again, it watches the new limit."""
    part = Run(run.files, run.recording.phase('again'), run.facts)
    wanted = [{'success': True}] * 3
    try:
        require_answers(part, CHANGE, wanted, 'cleanup, configure and activate')
    except Failed as failed:
        why = failed.why or _why_ended(run)
        raise Failed(expected=failed.expected, observed=failed.observed, why=why) from None
    _, second = inputs(run).limits
    try:
        _warns(run, 'again', inputs(run).again, second)
    except Failed as failed:
        stale = Cause(
            'stale_limit',
            'The limit of the first configuration is still in use.',
            'Read the parameter in on_configure(), each time.',
        )
        old = [value for value in inputs(run).again if value > inputs(run).limits[0]]
        found = own_logs(Run(run.files, run.recording.phase('again'), run.facts), NODE, WARN)
        why = stale if len(found) == len(old) else failed.why
        raise Failed(expected=failed.expected, observed=failed.observed, why=why) from None


def build(numbers: Inputs) -> Exam:
    """
    Return the exam for some numbers.

    :param numbers: what is sent and set
    """
    configure = transition(NODE, 'configure')
    activate, deactivate = transition(NODE, 'activate'), transition(NODE, 'deactivate')
    first, second = numbers.limits
    steps: list[Step] = [Mark('refused')]
    for number, limit in enumerate(numbers.refused):
        if number:
            steps.append(_limit(limit))
        steps += [configure, Await(logs=1)]
    steps += [state(NODE), Mark('mended'), _limit(first), configure]
    steps += [_feed(numbers.inactive, optional=True)]
    steps += [Mark('active'), activate, _feed(numbers.active)]
    steps += [Mark('paused'), deactivate, _feed(numbers.paused, optional=True)]
    steps += [Mark('again'), transition(NODE, 'cleanup'), _limit(second), configure, activate]
    steps += [_feed(numbers.again)]
    exam = Exam(
        'managed_pressure',
        title='The managed pressure monitor',
        assignment='06_managed_lifecycle',
        part=3,
        cells=('pressure_monitor',),
        requires=('pressure_monitor.py',),
        scenario=Scenario(
            file='pressure_monitor.py',
            arguments=('-p', f'limit:={numbers.refused[0]}'),
            watch={EVENTS: EVENT_TYPE},
            feed={TOPIC: FeedTopic(TYPE, Qos())},
            steps=steps,
            first_log_s=0,
        ),
        read='Part 3: When a transition goes wrong',
        facts={'inputs': numbers, 'secret': True},
    )
    exam.check(points=1)(starts_its_node)
    exam.check(points=2, needs=['starts_its_node'])(refuses_a_senseless_limit)
    exam.check(points=1, needs=['refuses_a_senseless_limit'])(tells_why)
    exam.check(points=2, needs=['refuses_a_senseless_limit'])(recovers)
    exam.check(points=2, needs=['recovers'])(warns_above_the_limit)
    exam.check(points=1, needs=['warns_above_the_limit'])(ignores_while_not_active)
    exam.check(points=1, needs=['warns_above_the_limit'])(takes_the_new_limit)
    return exam


def _limit(value: float) -> Call:
    return set_parameter(NODE, 'limit', value)


def _feed(pressures: Sequence[float], optional: bool = False) -> Feed:
    return Feed(TOPIC, [{'data': value} for value in pressures], optional=optional)


exam = build(
    Inputs(
        refused=(-1.0,),
        limits=(2.5, 6.0),
        inactive=(3.0,),
        active=(2.4, 2.5, 2.6, 9.0, 1.0),
        paused=(8.0,),
        again=(5.0, 7.0),
    )
)
