"""
Provide claims: ready-made checks for ordinary nodes.

Each function returns a check with its name and sentence.  An exam reads like the table of its
lesson::

    exam.check(points=1)(node('/speed_limiter'))
    exam.check(points=1)(hears('/wanted', TWIST))
    exam.check(points=2)(one_for_one('speeds', '/cmd_vel'))
    exam.check(points=3, needs=['one_for_one'])(publishes('speeds', '/cmd_vel', 'linear.x'))

A :class:`autograder.exam.specification.Specification` in ``Exam(asks=...)`` gives the expected
answers and the slips.  The recorded answers to each input, or to a burst, are a *row*, see
:mod:`autograder.judging.rows`.
"""

from collections.abc import Callable, Collection, Mapping
from functools import partial
from itertools import zip_longest
from typing import Any

from autograder.exam.exam import Cause, Failed, Run
from autograder.exam.needs import asked_for, called, fed, marked, stepped, Test, watched
from autograder.exam.specification import same
from autograder.exam.steps import PARAMETER_TYPES, read_parameters, Value
from autograder.judging.causes.ended import why_silent
from autograder.judging.causes.text_table import cause_of
from autograder.judging.checks import (
    counted,
    field_of,
    own_logs,
    require_answers,
    require_endpoint,
    require_messages,
    require_node,
    require_partner,
    require_qos,
    require_reached,
    why_no_service,
)
from autograder.judging.log_rows import require_warnings
from autograder.judging.rhythm import require_period
from autograder.judging.rows import (
    published,
    require_all_sent,
    require_complete,
    require_one_for_one,
    require_values,
    rows,
)

Judge = Callable[[Run], None]
NONE: dict[str, Any] = {}


def claim(name: str, sentence: str, judge: Judge, *tests: Test) -> Judge:
    """
    Return a function as a check with a name and a sentence.

    :param name: name of the check
    :param sentence: the sentence that learners read
    :param tests: what the exam must have, tested when the check is added to it
    """
    judge.__name__, judge.__doc__ = name, sentence
    vars(judge)['tests'] = tests
    return judge


# -- nodes and endpoints ----------------------------------------------------------------------


def node(
    name: str, check: str = 'starts_its_node', sentence: str = '', only_named: bool = False
) -> Judge:
    """
    Return the check for a node.

    :param check: name of the check
    :param sentence: the sentence that learners read, by default a standard one; like ``check``,
        this is a parameter of all claims
    :param only_named: see :func:`autograder.judging.checks.require_node`
    """
    sentence = sentence or f'Your program starts a node called {name.rpartition("/")[2]}.'
    return claim(check, sentence, lambda run: require_node(run, name, only_named))


def hears(topic: str, kind: str, check: str = '', sentence: str = '') -> Judge:
    """Return the check for a subscription that receives messages from an ordinary publisher."""
    base = topic.rpartition('/')[2]
    what = f'{kind.rpartition("/")[2]} messages on {base}'
    sentence = sentence or f'It subscribes to {what} and receives them.'
    name = check or f'hears_{base}'
    return claim(name, sentence, lambda run: require_reached(run, topic, kind), fed(topic))


def offers(topic: str, kind: str, check: str = '', sentence: str = '', **qos: Any) -> Judge:
    """
    Return the check for a publisher that matches an ordinary subscription.

    :param qos: required policies, see :func:`autograder.judging.checks.require_qos`
    """
    base = topic.rpartition('/')[2]
    sentence = sentence or f'It publishes {kind.rpartition("/")[2]} messages on {base}.'

    def judge(run: Run) -> None:
        ends = require_endpoint(run, 'publisher', topic, kind)
        require_qos(ends, **qos)
        require_partner(ends)

    return claim(check or f'offers_{base}', sentence, judge)


def serves(service: str, kind: str, check: str = '', sentence: str = '') -> Judge:
    """
    Return the check for a service.

    :param service: full name of a service that the scenario calls
    :param kind: its type, such as ``std_srvs/srv/SetBool``
    """
    base = service.rpartition('/')[2]
    sentence = sentence or f'It offers the service {base} of type {kind.rpartition("/")[2]}.'

    def judge(run: Run) -> None:
        require_endpoint(run, 'service', service, kind)

    return claim(check or f'serves_{base}', sentence, judge, called(service, kind))


def requests(topic: str, kind: str, check: str, sentence: str, **qos: Any) -> Judge:
    """Return the check for the QoS policies of a subscription; for ``qos`` see :func:`offers`."""

    def judge(run: Run) -> None:
        require_qos(require_endpoint(run, 'subscription', topic, kind), **qos)

    return claim(check, sentence, judge)


def passes(
    source: tuple[str, str],
    target: tuple[str, str],
    check: str = 'reads_and_writes',
    sentence: str = '',
) -> Judge:
    """Return the check that a node reads and writes topics, each given as (name, type)."""
    hear, say = source[0].rpartition('/')[2], target[0].rpartition('/')[2]

    def judge(run: Run) -> None:
        require_reached(run, *source)
        require_partner(require_endpoint(run, 'publisher', *target))

    sentence = sentence or f'It subscribes to {hear} and publishes on {say}.'
    return claim(check, sentence, judge, fed(source[0]), watched(target[0]))


def declares(
    name: str, values: Mapping[str, Value], check: str = 'declares', sentence: str = ''
) -> Judge:
    """
    Return the check for the parameters of a node, at the time when the scenario reads them.

    :param name: full name of the node
    :param values: expected values by parameter; the scenario has the steps
        ``read_parameters(name, values)``
    """
    steps = read_parameters(name, values)
    shown = ', '.join(f'{one} {value!r}' for one, value in values.items())

    def judge(run: Run) -> None:
        for step, due in zip(steps, values.values()):
            (one,), calls = step.request['names'], run.recording.answers(step.name)
            answer = next((call for call in calls if call.get('request') == step.request), {})
            if 'data' not in answer:
                raise Failed(
                    expected=f'an answer to the request for {one}',
                    observed='no answer',
                    why=why_silent(run) or why_no_service(run, step.name, answer),
                )
            seen = _parameter(answer)
            if type(seen) is type(due) and same(due, seen):
                continue
            declared = bool(field_of(answer, 'values'))
            situation = 'other_default' if declared else 'not_declared'
            there = 'of a different type' if seen is None else repr(seen)[:40]
            there = there if declared else 'not declared'
            why = cause_of(situation, name=one, due=repr(due), seen=there, about=[one])
            raise Failed(expected=f'{one} {due!r}', observed=f'{one} {there}', why=why)

    return claim(check, sentence or f'Its parameters are {shown}.', judge, stepped(steps))


def _parameter(answer: Mapping[str, Any]) -> Value | None:
    """Return the value in an answer of ``get_parameters``, None if it is not a single one."""
    words = dict(PARAMETER_TYPES.values())
    word = words.get(field_of(answer, 'values.0.type'), '')
    found: Value | None = field_of(answer, f'values.0.{word}_value') if word else None
    return float(found) if word == 'double' and found is not None else found


# -- answers to inputs ------------------------------------------------------------------------


def one_for_one(
    ask: str,
    topic: str,
    check: str = 'one_for_one',
    sentence: str = '',
    places: Collection[int] | None = None,
) -> Judge:
    """
    Return the check that each input causes the expected number of messages.

    :param ask: name of the specification; its answers are tuples with one value per message
    :param places: indices of the inputs to check, by default all
    """
    sentence = sentence or 'It publishes exactly the messages that each input requires.'

    def judge(run: Run) -> None:
        require_one_for_one(run, ask, topic, published(run, ask, topic), places)

    return claim(check, sentence, judge, asked_for(ask, tuple), watched(topic))


def publishes(
    ask: str,
    topic: str,
    *fields: str,
    check: str = '',
    sentence: str = '',
    places: Collection[int] | None = None,
    what: str = 'the expected values',
) -> Judge:
    """
    Return the check that the messages after each input have the expected values.

    For the other parameters see :func:`one_for_one`.

    :param fields: names of the fields to compare; several fields give a tuple of values; dots
        separate nested fields
    :param what: description of the expected values that may be shown for hidden inputs
    """
    base = topic.rpartition('/')[2]
    sentence = sentence or f'It publishes the correct messages on {base}.'

    def judge(run: Run) -> None:
        asked, found = run.asked(ask), published(run, ask, topic, *fields)
        require_values(run, asked, found, places, what, fields)
        require_all_sent(run, found if places is None else [found[one] for one in places])

    return claim(
        check or f'publishes_{base}', sentence, judge, asked_for(ask, tuple), watched(topic)
    )


def beats(
    topic: str,
    period_s: float,
    phase: str,
    check: str = 'keeps_its_rhythm',
    sentence: str = '',
) -> Judge:
    """
    Return the check that messages arrive once per period, on any clock, during a phase.

    :param topic: full name of a topic that the probe records
    :param phase: name of one or more :class:`autograder.exam.steps.Mark`; each part of the run
        that begins with it is judged alone
    """

    def judge(run: Run) -> None:
        require_endpoint(run, 'publisher', topic, run.names.published[topic])
        for part, during_s in run.parts(phase):
            found = part.recording.messages(topic)
            # A part does not show why the whole program is silent.
            explain = partial(why_silent, run) if not found else lambda: None
            require_period(part, found, period_s, during_s, explain=explain)
        require_complete(run)

    sentence = sentence or f'It publishes once every {period_s:g} s.'
    return claim(check, sentence, judge, watched(topic), marked(phase, 3 * period_s))


def quiet(
    topic: str,
    phase: str,
    check: str = 'is_quiet',
    sentence: str = '',
    why: Cause | None = None,
) -> Judge:
    """
    Return the check that no message arrives during a phase, in a run with messages elsewhere.

    :param topic: full name of a topic that the probe records
    :param phase: see :func:`beats`
    :param why: the likely cause of messages in this phase
    """
    base = topic.rpartition('/')[2]

    def judge(run: Run) -> None:
        require_messages(run, topic=topic)
        found = run.recording.phase(phase).messages(topic)
        if found:
            raise Failed(
                expected=f'no messages on {base} in this phase',
                observed=counted(len(found), 'message'),
                why=why,
                at=found[0]['clock_ns'],
            )
        require_complete(run)

    sentence = sentence or f'It publishes nothing on {base} in the phase {phase}.'
    return claim(check, sentence, judge, watched(topic), marked(phase))


def warns(ask: str, logger: str, check: str = 'warns', sentence: str = '') -> Judge:
    """
    Return the check that each input causes the expected number of WARN lines.

    :param ask: name of the specification; its answers are counts, and each input has a ``kind``,
        its description in feedback
    """
    sentence = sentence or 'It logs exactly the warnings that each input requires.'

    def judge(run: Run) -> None:
        asked, found = run.asked(ask), rows(run, ask, own_logs(run, logger))
        require_warnings(run, asked, found, range(len(found)))

    return claim(check, sentence, judge, asked_for(ask, int))


def answers(ask: str, service: str, check: str = '', sentence: str = '') -> Judge:
    """
    Return the check that each call of a service has the expected response.

    :param ask: name of the specification; its inputs are the requests in order, its answers the
        fields that must be equal
    """
    base = service.rpartition('/')[2]
    sentence = sentence or f'It answers each call of {base}.'

    def judge(run: Run) -> None:
        asked, calls = run.asked(ask), run.recording.answers(service)
        came = [
            {name: field_of(one, name) for name in due} if 'data' in one else None
            for due, one in zip_longest(asked.answers, calls[: len(asked.answers)], fillvalue=NONE)
        ]
        require_answers(
            run,
            service,
            asked.answers,
            f'the calls of {base}',
            explain=lambda place: asked.cause(came, place),
            secret=run.secret,
            inputs=asked.inputs,
        )

    return claim(check or f'answers_{base}', sentence, judge, asked_for(ask, dict, service))
