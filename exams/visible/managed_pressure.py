"""
Lesson 06, part 3: a pressure monitor that refuses an invalid limit.

Specification from the lesson: lifecycle node ``pressure_monitor`` with the parameter ``limit`` (a
float, in bar, -1.0 by default); ``on_configure`` refuses with FAILURE and one ERROR line unless
the limit is above zero, and NaN is not; while active, the node logs exactly one WARN for each
``std_msgs/msg/Float64`` on ``pressure`` strictly above the limit, otherwise none.  The limit in
force is the one at the last configuration, even if the parameter has changed since.
"""

import ast
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import groupby, zip_longest
import math
import operator

from autograder.exam.exam import Cause, Exam, Failed, Run
from autograder.exam.scenario import FeedTopic, Scenario
from autograder.exam.slips import Compare, CUTS, warning_slips
from autograder.exam.specification import each, Rule, Specification
from autograder.exam.steps import (
    Advance,
    BURST,
    feeds,
    Mark,
    Qos,
    set_parameters,
    state,
    transition,
)
from autograder.exam.words import Causes
from autograder.judging.causes.ended import (
    why_no_endpoint,
    why_no_verdict,
    why_refused,
    why_silent,
)
from autograder.judging.causes.missing_logs import why_not_logged
from autograder.judging.checks import field_of, lines, own_logs, require_answers
from autograder.judging.claims import node
from autograder.judging.log_rows import require_warnings, warnings_after
from autograder.judging.numbers import numbers_in, shown, shows
from autograder.judging.rows import Row
from autograder.recording import ERROR, WARN
from autograder.submission.code.source_code import Code

NODE, TOPIC = '/pressure_monitor', '/pressure'
TYPE = 'std_msgs/msg/Float64'
EXERCISE = 'Exercise 2: a monitor that refuses nonsense'
EVENTS = f'{NODE}/transition_event'
EVENT_TYPE = 'lifecycle_msgs/msg/TransitionEvent'
CHANGE, SETTING = f'{NODE}/change_state', f'{NODE}/set_parameters'
ANSWER_S = 3.0  # after each input: enough for a thread that polls every two seconds [s]

INACTIVE = ('accepted', 'paused')
"""The phases in which the probe sends pressures while the node is not active."""
SET_AGAIN = ('still', 'again')
"""The phases in which the probe sends pressures while the parameter has its second value."""

WHY = Causes(__file__)


@dataclass(frozen=True)
class Pressure:
    """One pressure that the probe sends, with the limits of the first and second configuration."""

    value: float
    phase: str
    limits: tuple[float, float]

    @property
    def limit(self) -> float:
        """Return the limit in force."""
        return self.limits[self.phase == 'again']

    @property
    def active(self) -> bool:
        """Return whether the node is active in this phase."""
        return self.phase not in INACTIVE

    @property
    def kind(self) -> str:
        """Return a description that feedback may show."""
        if math.isnan(self.value):
            return 'a pressure of NaN'
        if self.value == self.limit:
            return 'a pressure equal to the limit'
        return f'a pressure {"above" if self.value > self.limit else "below"} the limit'


def warns(
    hot: Compare = operator.gt,
    limit: Callable[[Pressure], float] = lambda one: one.limit,
    active: Callable[[Pressure], bool] = lambda one: one.active,
    times: Callable[[Pressure], int] = lambda one: 1,
) -> Rule:
    """Return the rule of a monitor with the given parts, by default the correct ones."""
    return each(lambda one: times(one) if active(one) and hot(one.value, limit(one)) else 0)


def cutting(cut: Callable[[float], float]) -> Rule:
    """Return the rule of a monitor that changes the decimals of its limit."""
    return warns(limit=lambda one: cut(one.limit))


def _without_limit(other: float, one: Pressure) -> float:
    return other if one.phase == 'still' else one.limit


SLIPS = (
    WHY.slip('never_warns', warns(active=lambda one: False)),
    WHY.slip('early_limit', warns(limit=lambda one: one.limits[one.phase in SET_AGAIN])),
    WHY.slip(
        'limit_lost',
        *(warns(limit=partial(_without_limit, other)) for other in (0.0, -1.0, math.inf)),
    ),
    WHY.slip('stale_limit', warns(limit=lambda one: one.limits[0])),
    WHY.slip('subscribed_twice', warns(times=lambda one: 2 if one.phase == 'again' else 1)),
    WHY.slip('subscription_not_managed', warns(active=lambda one: True)),
    WHY.slip('active_too_early', warns(active=lambda one: one.phase != 'paused')),
    WHY.slip('stays_active', warns(active=lambda one: one.phase != 'accepted')),
    WHY.slip('limit_cut', *map(cutting, CUTS[:3])),
    *warning_slips(warns, 'self.limit', BURST),
)


def refuses_a_senseless_limit(run: Run) -> None:
    """Configuring fails, with FAILURE, while the limit is not above zero."""
    wanted = [{'success': False}] * len(run.facts['refused'])
    what = 'configure with a limit that is not above zero'
    require_answers(run, CHANGE, wanted, what, 'refused', lambda place: _why_accepted(run))
    for event in run.recording.phase('refused').messages(EVENTS):
        if field_of(event, 'goal_state.label') == 'errorprocessing':
            raise Failed(
                expected='FAILURE: the node returns to unconfigured, ready for another try',
                observed='an error: the node went to errorprocessing',
                why=WHY['error_not_failure'],
            )
    states = [{'current_state.label': 'unconfigured'}]
    require_answers(run, f'{NODE}/get_state', states, 'the request for its state', 'refused')


def _why_accepted(run: Run) -> Cause:
    """Explain a configuration that succeeded although the limit was not above zero."""
    if why := why_no_verdict(run):
        return why
    declared = Code(run.files).calls.get('declare_parameter', ())
    defaults = (call.args[1] for call in declared if len(call.args) > 1)
    values = (one.value for one in defaults if isinstance(one, ast.Constant))
    above = any(isinstance(value, (int, float)) and value > 0 for value in values)
    return WHY['wrong_default' if above else 'let_through']


def tells_why(run: Run) -> None:
    """It refuses NaN too, and logs one ERROR line that contains the limit for each refusal."""
    refused, logged = run.facts['refused'], own_logs(run.during('refused'), NODE, ERROR)
    last = run.during('not a number')
    done = [field_of(one, 'success') for one in last.recording.answers(CHANGE)]
    ready = [field_of(one, 'results.0.successful') for one in last.recording.answers(SETTING)]
    asked = [*done[:1], *ready] == [True, True]  # NaN was set after a cleanup
    taken = asked and done[1:] == [True]
    if asked:
        refused, logged = (*refused, math.nan), [*logged, *own_logs(last, NODE, ERROR)]
    found = [str(line['text']) for line in logged]
    if len(found) != len(refused) or not all(map(shows, found, refused)):
        raise Failed(
            expected=f'{len(refused)} refusals, each with one ERROR line that shows the limit',
            observed=lines(len(found), ERROR) + '; NaN was accepted' * taken,
            why=WHY['accepts_nan'] if taken else _why_not_logged(run, found, refused),
            shown_by=logged,
        )


def _why_not_logged(run: Run, found: Sequence[str], refused: Sequence[float]) -> Cause | None:
    part = run.recording.phase('refused')
    if not all(field_of(one, 'results.0.successful') for one in part.answers(SETTING)):
        return WHY['no_parameter']
    if not found:
        return why_not_logged(run, part.logs(), ERROR) or WHY['silent_refusal']
    if len(found) != len(refused):
        return WHY['silent_refusal'] if len(found) < len(refused) else WHY['repeated_log']
    if all(shows(text, refused[0]) for text in found):
        return WHY['read_once']
    if all(map(shows, found[1:], refused[1:])) and numbers_in(found[0]):
        return WHY['wrong_default']
    asked, came = run.asked('refusals'), list(map(numbers_in, found))
    return asked.cause(came, asked.wrong(came)[0]) or WHY['no_value']


def recovers(run: Run) -> None:
    """With a valid limit, it can be configured and activated."""
    taken, done = {'results.0.successful': True}, {'success': True}
    what = 'setting the parameter limit'
    require_answers(run, SETTING, [taken], what, 'accepted', lambda place: WHY['no_parameter'])
    why = _why_still_refused
    require_answers(run, CHANGE, [done], 'configure', 'accepted', lambda place: why(run))
    require_answers(run, CHANGE, [done], 'activate', 'active')


def _why_still_refused(run: Run) -> Cause:
    """Explain why the node also refuses a limit above zero."""
    part = run.during('accepted')
    states = part.recording.messages(EVENTS)
    if any(field_of(one, 'goal_state.label') == 'errorprocessing' for one in states):
        return why_refused(run, 'configure')
    logged = own_logs(part, NODE, ERROR)
    again = any(shows(line['text'], *run.facts['refused']) for line in logged)
    return WHY['read_once'] if again else WHY['still_refuses']


def warns_above_the_limit(run: Run) -> None:
    """While active, it logs exactly one WARN for each pressure strictly above the limit."""
    _require_warnings(run, 'active')


def ignores_while_not_active(run: Run) -> None:
    """While inactive, it logs no warning, however high the pressure."""
    found = [line for phase in INACTIVE for line in own_logs(run.during(phase), NODE, WARN)]
    if found:
        asked, came = run.asked('warnings'), warnings_after(_followed(run))
        quiet = [place for place, one in enumerate(asked.inputs) if not one.active]
        causes = (asked.cause(came, place, quiet) for place in asked.wrong(came, quiet)[:1])
        count = lines(len(found), WARN)
        raise WHY.failed('subscription_not_managed', next(causes, None), lines=count)
    sent = {one['index'] for phase in INACTIVE for one in run.recording.phase(phase).of('input')}
    later = [line for line in own_logs(run, NODE, WARN) if line['after_input'] in sent]
    if later:
        raise WHY.failed('judged_later', lines=lines(len(later), WARN))


def takes_the_new_limit(run: Run) -> None:
    """It uses a new limit after it is configured again, and not earlier."""
    done = [{'success': True}] * 5
    require_answers(run, CHANGE, done[:2], 'activate and deactivate', 'still')
    _require_warnings(run, 'still')
    require_answers(run, CHANGE, done[:3], 'cleanup, configure and activate', 'again')
    _require_warnings(run, 'again')
    what = 'deactivate, then cleanup and configure, twice'
    ways = ('deactivate', 'cleanup', 'configure', 'cleanup', 'configure')
    refused = {2: WHY['still_refuses'], 4: WHY['loses_the_limit']}

    def explain(place: int) -> Cause:
        return refused.get(place) or why_refused(run, ways[place], again=True)

    require_answers(run, CHANGE, done, what, 'highest', explain)


def _require_warnings(run: Run, phase: str) -> None:
    """Fail unless each pressure of a phase causes the expected number of warnings."""
    part = run.recording.phase(phase)
    if part.of('not_connected') or not part.of('input'):
        raise Failed(
            expected=f'a subscription on {TOPIC} of type {TYPE} while the node is active',
            observed='no subscription',
            why=why_silent(run)
            or (WHY['subscription_gone'] if run.recording.of('input') else None)
            or why_no_endpoint(run, 'subscription', TOPIC, TYPE),
        )
    asked, found = run.asked('warnings'), _followed(run)
    inputs = asked.inputs[: len(found)]
    places = [place for place, one in enumerate(inputs) if one.phase == phase]
    active = [place for place, one in enumerate(inputs[: places[-1] + 1]) if one.active]
    require_warnings(run, asked, found, places, active)


def _followed(run: Run) -> list[Row | None]:
    """Return the node's log lines after each pressure and the burst, None if it was not sent."""
    found: list[Row | None] = []
    for phase, pressures in groupby(run.asked('warnings').inputs, lambda one: one.phase):
        part = run.during(phase)
        lines = own_logs(part, NODE)
        for _, sent in zip_longest(pressures, part.recording.of('input')):
            after = [one for one in lines if sent and one['after_input'] == sent['index']]
            found.append(after if sent else None)
    burst = [line for row in found[-BURST:] for line in row or ()]
    return [*found[:-BURST], None if None in found[-BURST:] else burst]


def build(
    refused: Sequence[float],
    limits: tuple[float, float],
    highest: float,
    pressures: Mapping[str, Sequence[float]],
) -> Exam:
    """
    Return the exam for some limits and pressures.

    :param refused: invalid limits, the first one the parameter's default [bar]
    :param limits: for the first and the second configuration [bar]
    :param highest: another valid limit, for the end [bar]
    :param pressures: by phase: ``accepted`` and ``paused``, in which the node is not active;
        ``active`` under the first limit; ``still`` after the parameter was set; ``again`` under
        the second limit, the last ten as a burst above it [bar]
    """
    configure, activate = transition(NODE, 'configure'), transition(NODE, 'activate')
    deactivate, cleanup = transition(NODE, 'deactivate'), transition(NODE, 'cleanup')
    first, second, third, nan, *others = (
        set_parameters(NODE, {'limit': one}) for one in (*limits, highest, math.nan, *refused[1:])
    )
    sent = {
        phase: feeds(
            TOPIC,
            [{'data': value} for value in values],
            BURST if phase == 'again' else 0,
            optional=True,
            every_s=ANSWER_S,
            rest_s=0.0,
        )
        for phase, values in pressures.items()
    }
    refusal = (configure, Advance(ANSWER_S))
    steps = (
        *(Mark('refused'), *refusal),
        *(step for other in others for step in (other, *refusal)),
        *(state(NODE), Mark('accepted'), first, configure, *sent['accepted']),
        *(Mark('active'), activate, *sent['active']),
        *(Mark('paused'), deactivate, *sent['paused']),
        # A node may refuse to set the parameter before cleanup, so set it again afterwards.
        *(Mark('still'), second, activate, *sent['still'], deactivate),
        *(Mark('again'), cleanup, second, configure, activate, *sent['again']),
        *(Mark('highest'), deactivate, cleanup, third, configure, cleanup, configure),
        # Set NaN last, because a node that accepts it would be in the wrong state afterwards.
        *(Mark('not a number'), cleanup, nan, *refusal),
    )
    inputs = [
        Pressure(value, phase, limits) for phase, values in pressures.items() for value in values
    ]
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
        facts={'refused': refused},
        asks={
            'refusals': shown((*refused, math.nan), lambda limit: (limit,)),
            'warnings': Specification(inputs, warns(), SLIPS, BURST),
        },
    )
    exam.check(points=1, read=EXERCISE)(node(NODE, only_named=True))
    exam.check(points=2, needs=['starts_its_node'])(refuses_a_senseless_limit)
    exam.check(points=1, needs=['refuses_a_senseless_limit'])(tells_why)
    exam.check(points=2, needs=['refuses_a_senseless_limit'])(recovers)
    exam.check(points=2, needs=['recovers'], read=EXERCISE)(warns_above_the_limit)
    needs = ['warns_above_the_limit']
    exam.check(points=1, needs=needs, read=EXERCISE)(ignores_while_not_active)
    exam.check(points=1, needs=needs, read=EXERCISE)(takes_the_new_limit)
    return exam


exam = build(
    refused=(-1.0,),
    limits=(2.5, 6.0),
    highest=30.0,
    pressures={
        'accepted': (3.0,),
        'active': (2.4, 2.5, 2.6, 9.0, 1.0),
        'paused': (8.0,),
        'still': (4.0, 9.0),
        'again': (5.0, 7.0, *(6.25 + part / 8 for part in range(BURST))),
    },
)
