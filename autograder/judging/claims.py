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

from collections.abc import Callable, Collection
from itertools import zip_longest
from typing import Any

from autograder.exam.exam import Run
from autograder.judging.checks import (
    field_of,
    own_logs,
    require_answers,
    require_endpoint,
    require_messages,
    require_node,
    require_partner,
    require_qos,
    require_reached,
)
from autograder.judging.log_rows import require_warnings
from autograder.judging.rhythm import require_period
from autograder.judging.rows import (
    published,
    require_all_sent,
    require_one_for_one,
    require_values,
    rows,
)

Judge = Callable[[Run], None]
NONE: dict[str, Any] = {}


def claim(name: str, sentence: str, judge: Judge) -> Judge:
    """Return a function as a check with a name and a sentence that learners read."""
    judge.__name__, judge.__doc__ = name, sentence
    return judge


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
    return claim(check or f'hears_{base}', sentence, lambda run: require_reached(run, topic, kind))


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

    return claim(check, sentence or f'It subscribes to {hear} and publishes on {say}.', judge)


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

    return claim(check, sentence, judge)


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

    return claim(check or f'publishes_{base}', sentence, judge)


def beats(
    topic: str,
    period_s: float,
    during_s: float,
    check: str = 'keeps_its_rhythm',
    sentence: str = '',
) -> Judge:
    """Return the check that messages arrive once per period, on any clock, until the run ends."""

    def judge(run: Run) -> None:
        require_period(run, require_messages(run, topic=topic), period_s, during_s)

    return claim(check, sentence or f'It publishes once every {period_s:g} s.', judge)


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

    return claim(check, sentence, judge)


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

    return claim(check or f'answers_{base}', sentence, judge)
