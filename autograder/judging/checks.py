"""
Provide bodies for checks: each function tests one property and explains a failure.

The functions are not checks themselves, because the docstring that learners read stays in the
exam.  Each ``require_...`` function raises :class:`autograder.exam.exam.Failed` or returns.  All
names of nodes and topics are full names.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from autograder.errors import ExamInvalid
from autograder.exam.exam import Cause, Failed, Run
from autograder.judging.causes.ended import (
    ended_after_refusal,
    why_no_endpoint,
    why_no_message,
    why_no_node,
    why_silent,
)
from autograder.judging.causes.redaction import safe_quotation
from autograder.judging.causes.text_table import cause_of
from autograder.recording import Event, LEVELS, SECOND

NO_RESULT = 'Callback returned an invalid type'
"""The reason with which rclpy refuses a change whose callback returns no result."""


def require_node(run: Run, node: str, only_named: bool = False) -> None:
    """
    Fail unless the probe saw a node.

    :param only_named: whether dependent checks still run if the program's only node has a wrong
        name
    """
    if node in run.recording.nodes:
        return
    namespace, _, base = node.rpartition('/')
    where = f' in the namespace {namespace}' if namespace else ''
    shown = [name if namespace else name.lstrip('/') for name in run.recording.nodes[:5]]
    raise Failed(
        expected=f'a node called {base}{where}',
        observed=', '.join(name[:60] for name in shown) or 'no node',
        why=why_other_namespace(run, node) or why_no_node(run, node),
        blocks=not (only_named and len(run.recording.nodes) == 1),
    )


def why_other_namespace(run: Run, node: str, repair: str = '') -> Cause | None:
    """
    Explain a node with the right name in a wrong namespace.

    :param repair: the advice, by default for a namespace that the command line chooses
    """
    namespace, _, base = node.rpartition('/')
    spaces = [name.rpartition('/')[0] for name in run.recording.nodes if name.endswith(f'/{base}')]
    if not spaces or namespace in spaces:
        return None
    where = f'the namespace {spaces[0]}' if spaces[0] else 'no namespace'
    name = 'namespace' if repair else 'own_namespace'
    return cause_of(name, node=base, where=where, repair=repair, about=[spaces[0], base])


def require_endpoint(run: Run, kind: str, topic: str, type_name: str) -> list[Event]:
    """
    Return the endpoints on a topic with a given type; fail if there are none.

    :param kind: ``'publisher'``, ``'subscription'`` or ``'service'``; services have no QoS profile
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
    Fail unless endpoints match a partner that was created with a plain depth, such as 10.

    A publisher may offer more, and a subscription may request less.
    """
    for end in ends:
        policy, wrong, cause_id, partner = _UNUSUAL[end['kind']]
        if end['qos'][policy] == wrong:
            base = end['topic'].rpartition('/')[2]
            raise Failed(
                expected=f'a {end["kind"]} that connects to a {partner} of depth 10',
                observed=f'{policy} {wrong}',
                why=cause_of(cause_id, on=base, about=[wrong, base]),
            )


_UNUSUAL = {
    'publisher': ('reliability', 'BEST_EFFORT', 'offers_too_little', 'subscription'),
    'subscription': ('durability', 'TRANSIENT_LOCAL', 'asks_too_much', 'publisher'),
}
"""By kind of endpoint: a policy, a value that few partners match, the cause, the partner."""


def require_reached(run: Run, topic: str, kind: str) -> None:
    """Fail unless a subscription exists and receives messages from an ordinary publisher."""
    ends = require_endpoint(run, 'subscription', topic, kind)
    require_partner(ends)
    lost = {event['topic'] for event in run.recording.of('not_connected')}
    if topic not in lost and (lost or run.recording.of('input')):
        _require_from_the_start(run, topic)
        return
    asked = 'a deadline' if ends[0]['qos']['deadline_ns'] else 'a quality of service'
    raise Failed(
        expected=f'a subscription on {topic} of type {kind}',
        observed='a subscription that receives nothing',
        why=why_silent(run) or cause_of('qos_incompatible', asked=asked),
    )


def _require_from_the_start(run: Run, topic: str) -> None:
    """Fail if a subscription did not exist at the start, so that it could miss messages."""
    graphs = run.recording.of('graph', when='start')
    there = {end['topic'] for graph in graphs for end in graph['endpoints']}
    if graphs and topic not in there:
        raise Failed(
            expected=f'a subscription on {topic} from the start',
            observed='a subscription that is created later',
            why=cause_of('subscribed_late', topic=topic, about=[topic.rpartition('/')[2]]),
            blocks=False,  # later messages reach the node
        )


def why_not_reached(run: Run, topic: str, kind: str) -> Cause | None:
    """Explain why no message reaches a subscription, None if there is no reason."""
    try:
        require_reached(run, topic, kind)
    except Failed as failure:
        return failure.why
    return None


def require_messages(
    run: Run,
    found: Sequence[Event] | None = None,
    least: int = 1,
    what: str = 'messages',
    *,
    topic: str = '',
) -> Sequence[Event]:
    """
    Return the messages if there are enough, otherwise fail.

    :param found: from :meth:`autograder.recording.Recording.messages`; by default all messages on
        the topic
    :param what: description of the messages, with the topic
    :param topic: full name of a watched topic, which must have a publisher
    :raises ExamInvalid: if the scenario does not watch the topic
    """
    if found is None or topic:
        kind = run.names.published.get(topic)
        if kind is None:
            known = ', '.join(map(repr, run.names.published)) or 'none'
            raise ExamInvalid(
                f'require_messages: expected topic= to be a topic that the scenario watches '
                f'({known}), got {topic!r}.'
            )
        found = run.recording.messages(topic) if found is None else found
        # If a program ends before discovery, its message arrives only in some runs.
        if least > 0:
            require_endpoint(run, 'publisher', topic, kind)
        what = f'messages on {topic.rpartition("/")[2]}' if what == 'messages' else what
    if len(found) < least:
        raise Failed(
            expected=f'at least {least} {what}' if least > 1 else what,
            observed=counted(len(found), 'message'),
            why=why_silent(run) if found else why_no_message(run),
        )
    return found


def require_field(run: Run, messages: Iterable[Event], field: str, wanted: Any) -> None:
    """
    Fail unless a field has the given value in every message.

    :param field: name of the field; dots separate nested fields
    """
    others = [value for one in messages if (value := field_of(one, field)) != wanted]
    if not others:
        return
    shown = ', '.join(dict.fromkeys(_own_value(run, value) for value in others[:3]))
    texts = [str(value).strip().lower() for value in others]
    near = isinstance(wanted, str) and wanted.lower() in texts
    slip = f'The field {field} has a different value.'
    raise Failed(
        expected=f'{field} {wanted!r} in every message',
        observed=f'{field} {shown}',
        why=cause_of(
            'wrong_value',
            slip='Upper and lower case and spaces matter.' if near else slip,
            field=field,
            wanted=repr(wanted),
            about=[field, *map(str, others[:1])],
        ),
    )


def _own_value(run: Run, value: Any) -> str:
    """Return the value of a field as text, unless it may be an input of a hidden exam."""
    if isinstance(value, str):
        return safe_quotation(run, value, 'a different string')[:40]
    return 'a different value' if run.secret else repr(value)[:40]


def field_of(message: Event, field: str) -> Any:
    """
    Return a field of a message, None if it was not recorded.

    :param field: name of the field; dots separate nested fields and list indices
    """
    value: Any = message.get('data')
    for name in field.split('.'):
        if isinstance(value, list) and name.isdigit():
            value = value[int(name)] if int(name) < len(value) else None
        else:
            value = value.get(name) if isinstance(value, Mapping) else None
    return value


def require_qos(ends: Iterable[Event], **wanted: Any) -> None:
    """
    Fail unless each endpoint has the given policies.

    :param wanted: policies as recorded: ``reliability='RELIABLE'``, ``durability='VOLATILE'``,
        ``liveliness='AUTOMATIC'``, ``deadline_ns=200_000_000``, ``lifespan_ns=None``,
        ``liveliness_lease_duration_ns=None``; discovery does not announce history and depth
    """
    for end in ends:
        for policy, value in wanted.items():
            if end['qos'][policy] != value:
                name, has = policy.removesuffix('_ns'), end['qos'][policy]
                (due, code), (seen, _) = _policy(policy, value), _policy(policy, has)
                words = {'policy': name, 'code': code, 'kind': end['kind'], 'on': end['topic']}
                words |= {'has': seen, 'due': due}
                raise Failed(
                    expected=f'{name} {due}',
                    observed=f'{name} {seen}',
                    why=cause_of('qos', **words, about=[str(has), end['topic']]),
                )


def _policy(policy: str, value: Any) -> tuple[str, str]:
    """Return the value of a policy as text, and as code."""
    if not policy.endswith('_ns'):
        return str(value), f'{policy.capitalize()}Policy.{value}'
    if value is None:
        return 'without limit', 'Infinite'
    return f'{value / SECOND:g} s', f'Duration(seconds={value / SECOND:g})'


def own_logs(run: Run, node: str, level: int | None = None) -> list[Event]:
    """
    Return the log lines of a node's own logger and of its child loggers, in order.

    :param node: full name; ignored if the program has only one node
    :param level: as in :data:`autograder.recording.LEVELS`; None for all levels
    """
    nodes = run.recording.nodes
    meant = nodes[0] if len(nodes) == 1 else node
    logger = meant.strip('/').replace('/', '.')
    return [
        entry
        for entry in run.recording.logs(level=level)
        if entry['name'] == logger or entry['name'].startswith(f'{logger}.')
    ]


def counted(count: int, noun: str) -> str:
    """Return a count with its noun, such as ``no messages``, ``1 message`` or ``2 messages``."""
    return f'{count or "no"} {noun}{"" if count == 1 else "s"}'


def lines(count: int, level: int) -> str:
    """Return a count of log lines with their level as text for a sentence."""
    return counted(count, f'{LEVELS[level]} line')


def require_answers(
    run: Run,
    service: str,
    wanted: Sequence[Mapping[str, Any]],
    what: str,
    phase: str = '',
    explain: Callable[[int], Cause | None] = lambda place: None,
    secret: bool = False,
    inputs: Sequence[object] = (),
) -> None:
    """
    Fail unless the calls of a service have the wanted responses, in order.

    :param wanted: for each call, the fields that must be equal; an empty mapping accepts any
        response
    :param what: description of the calls, such as ``the transitions configure and activate``
    :param phase: phase of the run whose calls count, by default all phases
    :param explain: returns the exam's cause of a wrong response, given its index
    :param secret: whether the responses may reveal inputs of a hidden exam
    :param inputs: values that the calls send, for feedback
    """
    answers = (run.recording.phase(phase) if phase else run.recording).answers(service)
    for number, fields in enumerate(wanted):
        answer = answers[number] if number < len(answers) else {'event': 'no_answer'}
        if answer['event'] == 'no_answer':
            raise Failed(
                expected=f'an answer to {what}',
                observed=f'no answer to call {number + 1}',
                why=why_silent(run) or why_no_service(run, service, answer),
            )
        got = {name: field_of(answer, name) for name in fields}
        if got != dict(fields):
            due = 'the expected answer' if secret else _shown(fields)
            where = f'{what}: {due} in answer {number + 1}'
            if inputs and not secret:
                where = f'{due} as the answer to {_asked(inputs[number])}'
            raise Failed(
                expected=where,
                observed='a different answer' if secret else _shown(got),
                why=_why_no_result(answer) or explain(number) or why_silent(run),
            )


def _why_no_result(answer: Event) -> Cause | None:
    """Explain a refusal by rclpy itself, which tells its reason."""
    reasons = [field_of(answer, one) for one in ('results.0.reason', 'result.reason')]
    return cause_of('returns_no_result') if NO_RESULT in reasons else None


def why_no_service(run: Run, service: str, answer: Event) -> Cause | None:
    """
    Explain why a call has no response.

    :param service: full name
    :param answer: the event ``no_answer``
    """
    if answer.get('reason') == 'too_late':
        return cause_of('no_response')
    if answer.get('reason') != 'no_service' or ended_after_refusal(run):
        return None
    if kind := run.names.services.get(service):
        there = [end['type'] for end in run.recording.endpoints('service', service)]
        if kind in there:
            return cause_of('service_at_times', service=service)
        return why_no_endpoint(run, 'service', service, kind)
    return cause_of('no_service', service=service)


def _asked(sent: object) -> str:
    return ' = '.join(map(str, sent)) if isinstance(sent, tuple) else repr(sent)


def _shown(fields: Mapping[str, Any]) -> str:
    texts = (f'{name.rpartition(".")[2]} {value!r}' for name, value in fields.items())
    return ', '.join(texts)[:300]
