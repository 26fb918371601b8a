"""
What many checks have in common: each function looks at one thing and fails with words.

They are the bodies of checks, not checks: the docstring that learners read stays in the exam::

    def starts_its_node(run: Run) -> None:
        '''Your program starts a node called talker.'''
        require_node(run, '/talker')

Each raises :class:`autograder.judging.exam.Failed` or returns.  All names of nodes and topics are
full.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import pairwise
from typing import Any

from autograder.judging.causes import why_no_endpoint, why_no_message, why_no_node, why_silent
from autograder.judging.exam import Cause, Failed, Run
from autograder.judging.learners_code import without_texts
from autograder.judging.own_time import is_flood, is_regular, names_another_clock
from autograder.judging.stalled import why_it_sleeps
from autograder.judging.unlogged import LEVELS, why_left_out, why_not_logged
from autograder.judging.untold import own_words
from autograder.runs.recording import Event

SECOND = 1_000_000_000
WHILE_IT_STOOD = 'something came also while that clock stood still'
OTHER_CLOCK = Cause(
    'other_clock',
    "The messages do not come in the rhythm of the node's own clock, and your code names another.",
    'Use self.create_timer() without a clock of its own, and no time.sleep() or time.time().',
)
ALONE = Cause(
    'other_clock',
    "What paces your program follows the computer's own clock: it goes on while the ROS clock "
    'stands still.',
    'Use self.create_timer() of the node without clock=, not threading.Timer, time.sleep() in a '
    'thread or asyncio.sleep(); and leave use_sim_time and the arguments of the program alone.',
)
PACED_BY_SPIN_ONCE = Cause(
    'paced_by_spin_once',
    'spin_once() comes back as soon as anything has happened, a tick of the clock too, so it '
    'paces nothing.',
    'Use self.create_timer() with the period in seconds, and rclpy.spin(node).',
)
OWN_LOOP = Cause(
    'own_loop',
    'Your program keeps its own time: nobody spins the node, so its clock stands still.',
    'Use self.create_timer(1.0, ...) and rclpy.spin(node) instead of a loop.',
)


def require_node(run: Run, node: str) -> None:
    """
    Fail unless a node was seen.

    :param node: full name, ``/talker`` or ``/lab/talker``
    """
    if node in run.recording.nodes:
        return
    namespace, _, base = node.rpartition('/')
    where = f' in the namespace {namespace}' if namespace else ''
    shown = [name if namespace else name.lstrip('/') for name in run.recording.nodes[:5]]
    raise Failed(
        expected=f'a node called {base}{where}',
        observed=', '.join(name[:60] for name in shown) or 'no node',
        why=_why_elsewhere(run, namespace, base) or why_no_node(run, node),
    )


def _why_elsewhere(run: Run, namespace: str, base: str) -> Cause | None:
    """Explain a node of the right name that is in another namespace."""
    for name in run.recording.nodes:
        other, _, last = name.rpartition('/')
        if last == base and other != namespace:
            return Cause(
                'namespace',
                f'Your node {base} is in the namespace {other or "/"}.',
                'Give the node its plain name and let the command line choose the namespace.',
            )
    return None


def require_endpoint(run: Run, kind: str, topic: str, type_name: str) -> list[Event]:
    """
    Return the endpoints on a topic, or fail if none has the type.

    :param kind: ``'publisher'`` or ``'subscription'``
    """
    ends = [end for end in run.recording.endpoints(kind, topic) if end['type'] == type_name]
    if not ends:
        raise Failed(
            expected=f'a {kind} on {topic} of type {type_name}',
            observed=f'no such {kind}',
            why=why_no_endpoint(run, kind, topic, type_name),
        )
    return ends


def require_partner(ends: Iterable[Event]) -> None:
    """
    Fail unless endpoints connect to a partner that was made with a plain depth, such as 10.

    A publisher may offer more than that, a subscription may ask for less.

    :param ends: from :func:`require_endpoint`
    """
    for end in ends:
        qos, topic = end['qos'], end['topic'].rpartition('/')[2]
        if end['kind'] == 'publisher' and qos['reliability'] == 'BEST_EFFORT':
            raise Failed(
                expected='a publisher that a subscription of depth 10 is connected to',
                observed='reliability BEST_EFFORT',
                why=Cause(
                    'offers_too_little',
                    f'Most subscriptions ask for reliable delivery, and then {topic} stays silent '
                    'for them: the policy RELIABILITY does not match.',
                    'Give create_publisher() the number 10, or ReliabilityPolicy.RELIABLE.',
                ),
            )
        if end['kind'] == 'subscription' and qos['durability'] == 'TRANSIENT_LOCAL':
            raise Failed(
                expected='a subscription that a publisher of depth 10 is connected to',
                observed='durability TRANSIENT_LOCAL',
                why=Cause(
                    'asks_too_much',
                    f'Your subscription on {topic} asks for old messages, which most publishers '
                    'do not keep: the policy DURABILITY does not match, and it hears nothing.',
                    'Give create_subscription() the number 10, or leave out the durability.',
                ),
            )


def require_messages(
    run: Run, found: Sequence[Event], least: int, what: str = 'messages'
) -> Sequence[Event]:
    """
    Return the messages if there are enough of them, or fail.

    :param found: from :meth:`autograder.runs.recording.Recording.messages`
    :param what: what they are, with the topic
    """
    if len(found) < least:
        raise Failed(
            expected=f'at least {least} {what}' if least > 1 else what,
            observed=f'{len(found)}' if found else none_of(run, 'none'),
            why=why_silent(run) if found else why_no_message(run),
        )
    return found


def none_of(run: Run, word: str) -> str:
    """Return the word for no message; what comes from a node that stops answering is luck."""
    if run.recording.end_reason == 'unresponsive':
        return f'{word} that could be waited for: your node stopped answering'
    return word


def require_field(run: Run, messages: Iterable[Event], field: str, wanted: Any) -> None:
    """
    Fail unless a field has one value in every message.

    :param messages: of the student's node
    :param field: its name; dots lead into nested messages
    """
    others = [value for one in messages if (value := field_of(one, field)) != wanted]
    if not others:
        return
    shown = ', '.join(dict.fromkeys(_own_value(run, value) for value in others[:3]))
    near = isinstance(wanted, str) and any(
        str(value).strip().lower() == wanted.lower() for value in others
    )
    slip = 'Upper and lower case and spaces count.' if near else f'Another value is in {field}.'
    raise Failed(
        expected=f'{field} {wanted!r} in every message',
        observed=f'{field} {shown}',
        why=Cause('wrong_value', slip, f'Set msg.{field} = {wanted!r} before you publish.'),
    )


def _own_value(run: Run, value: Any) -> str:
    """Show what stands in a field, unless it may be an input of a hidden exam."""
    if isinstance(value, str):
        return own_words(run, value, 'another text')[:40]
    return 'another value' if run.secret else repr(value)[:40]


def field_of(message: Event, field: str) -> Any:
    """Return a field of a message; None for one too large to be recorded."""
    value: Any = message.get('data')
    for name in field.split('.'):
        value = value.get(name) if isinstance(value, Mapping) else None
    return value


def require_period(
    run: Run, found: Sequence[Event], period_s: float, during_s: float, step_s: float = 0.25
) -> None:
    """
    Fail unless messages come once a period of simulated time, whenever the timer was created.

    A message is seen at the first clock step at or after it is due, so a gap may be one step
    longer or shorter; and one message more or less fits into the time that was watched.

    :param found: messages of one phase, in order
    :param during_s: simulated length of the phase [s]
    """
    seconds = [one['clock_ns'] / SECOND for one in found if one['clock_ns'] is not None]
    if run.recording.in_wall_time:
        return _require_period_in_wall_time(run, [one['wall_s'] for one in found], period_s)
    gaps = [later - earlier for earlier, later in pairwise(seconds)]
    due = during_s / period_s
    # Each gap may be one step off, all together too: else 0.9 s would pass for 1 s.
    drift = abs(sum(gaps) - len(gaps) * period_s)
    steady = drift <= step_s and all(abs(gap - period_s) <= step_s for gap in gaps)
    if abs(len(seconds) - due) <= 1.5 and steady:
        return None
    why = why_silent(run) or _why_other_rhythm(gaps, len(seconds) > due + 1.5, period_s, step_s)
    # How often a steady or a system timer fires in simulated time is luck, so no count is told.
    lucky = why is None and names_another_clock(run.files)
    odd = [late for early, late in pairwise(seconds) if abs(late - early - period_s) > step_s]
    raise Failed(
        expected=f'one message every {period_s:g} s for {during_s:g} s of simulated time',
        observed='messages in another rhythm'
        if lucky
        else f'{len(seconds)} messages'
        + (f', with gaps from {min(gaps):.2g} to {max(gaps):.2g} s' if gaps else ''),
        why=why_it_sleeps(run) or OTHER_CLOCK if lucky else why,
        at=round(odd[0] * SECOND) if odd and not lucky else None,
        every_s=period_s,
    )


def _require_period_in_wall_time(run: Run, times_s: list[float], period_s: float) -> None:
    """Fail unless code with a loop of its own, which keeps real time, is regular in that."""
    refuse_own_clock(run, f'one message every {period_s:g} s of simulated time')
    if is_regular(run.recording, times_s, period_s):
        return
    raise Failed(
        expected=f'one message every {period_s:g} s',
        observed='another rhythm in the seconds of real time in which it was watched',
        why=(why_silent(run) if len(times_s) < 2 else None) or OWN_LOOP,
        every_s=period_s,
    )


def refuse_own_clock(run: Run, expected: str) -> None:
    """
    Fail if a program that listens goes on while the ROS clock stands still.

    :param expected: what is due by that clock, in words
    """
    if run.recording.goes_on_alone:
        raise Failed(expected=expected, observed=WHILE_IT_STOOD, why=why_own_time(run))


def why_own_time(run: Run) -> Cause:
    """Explain a program that was watched in wall time."""
    if not run.recording.goes_on_alone:
        return OWN_LOOP
    code = '\n'.join(map(without_texts, run.files.values()))
    others = names_another_clock(run.files) or 'thread' in code.lower()
    if 'spin_once(' in code and 'create_timer' not in code and not others:
        return PACED_BY_SPIN_ONCE
    return why_it_sleeps(run) or ALONE


def _why_other_rhythm(
    gaps: Sequence[float], too_many: bool, period_s: float, step_s: float
) -> Cause | None:
    """
    Explain messages that come in another rhythm, if their gaps show why.

    :param gaps: simulated time between messages [s]
    """
    if too_many and 0.0 in gaps:
        return Cause(
            'several_at_once',
            'Several messages come at the same moment.',
            'Publish once in the callback of the timer, and make one timer only.',
        )
    mean_s = sum(gaps) / len(gaps) if gaps else 0.0
    if len(gaps) > 1 and all(abs(gap - mean_s) <= step_s for gap in gaps):
        # A timer that is shorter than a clock step fires once a step.
        flood = mean_s > 0 and is_flood(period_s / mean_s, 1.0)
        often = 'far too often' if flood else f'about once every {mean_s:.2g} s'
        return Cause(
            'wrong_rate',
            f'Your node publishes {often}.',
            f'The first argument of create_timer() is the period in seconds: {period_s:g}.',
        )
    return None


def require_qos(ends: Iterable[Event], **wanted: Any) -> None:
    """
    Fail unless each endpoint has the policies that are named.

    :param ends: from :func:`require_endpoint`
    :param wanted: as recorded: ``reliability='RELIABLE'``, ``durability='VOLATILE'``,
        ``liveliness='AUTOMATIC'``, ``deadline_ns=200_000_000``, ``lifespan_ns=None``,
        ``liveliness_lease_duration_ns=None``; the wire does not tell history and depth
    """
    for end in ends:
        for policy, value in wanted.items():
            if end['qos'][policy] != value:
                name = policy.removesuffix('_ns')
                raise Failed(
                    expected=f'{name} {_policy_text(policy, value)}',
                    observed=f'{name} {_policy_text(policy, end["qos"][policy])}',
                    why=Cause(
                        f'qos_{name}',
                        f'The {end["kind"]} on {end["topic"]} has another {name}.',
                        f'Pass a QoSProfile with {name}={_policy_code(policy, value)}.',
                    ),
                )


def _policy_text(policy: str, value: Any) -> str:
    if policy.endswith('_ns'):
        return 'without limit' if value is None else f'{value / SECOND:g} s'
    return str(value)


def _policy_code(policy: str, value: Any) -> str:
    if policy.endswith('_ns'):
        return 'Infinite' if value is None else f'Duration(seconds={value / SECOND:g})'
    return f'{policy.capitalize()}Policy.{value}'


def own_logs(run: Run, node: str, level: int | None = None) -> list[Event]:
    """
    Return the log lines of a node's own logger and of its children, in order.

    :param node: full name
    :param level: 10 DEBUG, 20 INFO, 30 WARN, 40 ERROR, 50 FATAL
    """
    logger = node.strip('/').replace('/', '.')
    return [
        entry
        for entry in run.recording.logs(level=level)
        if entry['name'] == logger or entry['name'].startswith(f'{logger}.')
    ]


def require_log(
    run: Run, found: Sequence[Event], level: int, count: int | None, when: str
) -> None:
    """
    Fail unless there are so many lines of a level among some log entries.

    :param found: log entries of the moment in question, see :func:`own_logs`
    :param count: None for at least one
    :param when: such as ``after a message of 31 °C``
    """
    lines = [entry for entry in found if entry['level'] == level]
    if len(lines) == count or (count is None and lines):
        return
    amount = 'at least one' if count is None else count_of(count)
    fewer = len(lines) < (count or 1)
    why = why_left_out(run, level) if fewer else None
    raise Failed(
        expected=f'{amount} {LEVELS[level]} line{"" if count in (None, 1) else "s"} {when}',
        observed=f'{count_of(len(lines))} {LEVELS[level]} line{"" if len(lines) == 1 else "s"}',
        why=why if lines else why_not_logged(run, found, level),
    )


def require_ros_clock(run: Run) -> None:
    """Fail if the program keeps its own time, so that the rhythm of its lines proves nothing."""
    if run.recording.in_wall_time:
        raise Failed(
            expected='lines in the rhythm of the simulated clock',
            observed='a program with a clock of its own',
            why=why_own_time(run),
        )


def count_of(number: int) -> str:
    """Return a count in words for a sentence."""
    return str(number) if number else 'no'


def require_answers(
    run: Run, service: str, wanted: Sequence[Mapping[str, Any]], what: str
) -> None:
    """
    Fail unless the calls of a service were answered as wanted, one after the other.

    :param service: full name
    :param wanted: for each call, the fields that must be equal; an empty mapping takes any
    :param what: the calls in words, such as ``the transitions configure and activate``
    """
    answers = run.recording.answers(service)
    for number, fields in enumerate(wanted):
        answer = answers[number] if number < len(answers) else {'event': 'no_answer'}
        if answer['event'] == 'no_answer':
            why = why_silent(run)
            if not why and answer.get('reason') == 'no_service':
                why = Cause(
                    'no_service',
                    f'There is no service {service}.',
                    'Is it the right class of node, with the right name?',
                )
            raise Failed(
                expected=f'an answer to {what}', observed=f'none to number {number + 1}', why=why
            )
        got = {name: field_of(answer, name) for name in fields}
        if got != dict(fields):
            raise Failed(
                expected=f'{what}: {_shown(fields)} to number {number + 1}',
                observed=_shown(got),
                why=why_silent(run),
            )


def _shown(fields: Mapping[str, Any]) -> str:
    return ', '.join(f'{name} {value!r}' for name, value in fields.items())[:300]
