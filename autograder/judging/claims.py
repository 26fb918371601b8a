"""
What an exam asks, as claims that are data: each returns a check with its name and its sentence.

They fit the usual node.  A mark sheet reads like the table of the lesson::

    exam.check(points=1)(node('/speed_limiter'))
    exam.check(points=1)(hears('/wanted', TWIST))
    exam.check(points=2)(one_for_one('speeds', '/cmd_vel'))
    exam.check(points=3, needs=['one_for_one'])(publishes('speeds', '/cmd_vel', 'linear.x'))

What is due after each input, and which slip explains something else, is a
:class:`autograder.exam.specification.Specification`, in ``Exam(asks=...)``.  What came is a *row*
for each input, or for a burst of them.
"""

from __future__ import annotations

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
from autograder.judging.lines import require_warnings
from autograder.judging.rhythm import require_period
from autograder.judging.rows import (
    published,
    require_all_sent,
    require_one_for_one,
    require_values,
    rows,
)

Judge = Callable[[Run], None]


def claim(name: str, sentence: str) -> Callable[[Judge], Judge]:
    """Return a decorator that gives a check its name and the sentence that learners read."""

    def named(judge: Judge) -> Judge:
        judge.__name__, judge.__doc__ = name, sentence
        return judge

    return named


def node(
    name: str, check: str = 'starts_its_node', sentence: str = '', only_named: bool = False
) -> Judge:
    """
    Return the check for a node.

    :param name: its full name
    :param only_named: see :func:`autograder.judging.checks.require_node`
    :param check: name of the check; so in all claims
    :param sentence: what learners read, by default a plain sentence; so in all claims
    """
    base = name.rpartition('/')[2]

    @claim(check, sentence or f'Your program starts a node called {base}.')
    def judge(run: Run) -> None:
        require_node(run, name, only_named)

    return judge


def hears(topic: str, kind: str, check: str = '', sentence: str = '') -> Judge:
    """
    Return the check for a subscription that an ordinary publisher reaches.

    :param topic: full name of a topic that the scenario feeds
    :param kind: type of its messages
    """
    base = topic.rpartition('/')[2]

    @claim(
        check or f'hears_{base}',
        sentence
        or f'It subscribes to {kind.rpartition("/")[2]} messages on {base} and receives them.',
    )
    def judge(run: Run) -> None:
        require_reached(run, topic, kind)

    return judge


def offers(topic: str, kind: str, check: str = '', sentence: str = '', **qos: Any) -> Judge:
    """
    Return the check for a publisher that an ordinary subscription is connected to.

    :param qos: policies that it must have, see :func:`autograder.judging.checks.require_qos`
    """
    base = topic.rpartition('/')[2]

    @claim(
        check or f'offers_{base}',
        sentence or f'It publishes {kind.rpartition("/")[2]} messages on {base}.',
    )
    def judge(run: Run) -> None:
        ends = require_endpoint(run, 'publisher', topic, kind)
        require_qos(ends, **qos)
        require_partner(ends)

    return judge


def requests(topic: str, kind: str, check: str, sentence: str, **qos: Any) -> Judge:
    """
    Return the check for the quality of service that a subscription asks for.

    :param qos: policies that it must have, see :func:`autograder.judging.checks.require_qos`
    """

    @claim(check, sentence)
    def judge(run: Run) -> None:
        require_qos(require_endpoint(run, 'subscription', topic, kind), **qos)

    return judge


def passes(
    source: tuple[str, str],
    target: tuple[str, str],
    check: str = 'reads_and_writes',
    sentence: str = '',
) -> Judge:
    """
    Return the check for a node with a topic that it hears and one on which it answers.

    :param source: full name and type of the topic that the scenario feeds
    :param target: those of the one that it watches
    """
    hear, say = source[0].rpartition('/')[2], target[0].rpartition('/')[2]

    @claim(check, sentence or f'It subscribes to {hear} and publishes on {say}.')
    def judge(run: Run) -> None:
        require_reached(run, *source)
        require_partner(require_endpoint(run, 'publisher', *target))

    return judge


def one_for_one(
    ask: str,
    topic: str,
    check: str = 'one_for_one',
    sentence: str = '',
    places: Collection[int] | None = None,
) -> Judge:
    """
    Return the check that each input is answered by as many messages as are due.

    :param ask: name of the specification; its answers are tuples with a value for each message
    :param topic: full name of a topic that the scenario watches
    :param places: of the inputs that the check is about, by default all
    """

    @claim(check, sentence or 'It publishes exactly what each input asks for, and nothing else.')
    def judge(run: Run) -> None:
        require_one_for_one(run, run.asked(ask), topic, published(run, ask, topic), places)

    return judge


def publishes(
    ask: str,
    topic: str,
    *fields: str,
    check: str = '',
    sentence: str = '',
    places: Collection[int] | None = None,
    what: str = 'what is due',
) -> Judge:
    """
    Return the check that the messages after each input have the values that are due.

    :param ask: see :func:`one_for_one`
    :param fields: whose values they are, a tuple of values where there are several; dots lead
        into nested messages
    :param places: of the inputs that the check is about, by default all
    :param what: what is due, in words that may be told of hidden inputs
    """
    base = topic.rpartition('/')[2]

    @claim(check or f'publishes_{base}', sentence or f'What it publishes on {base} is right.')
    def judge(run: Run) -> None:
        asked, found = run.asked(ask), published(run, ask, topic, *fields)
        require_values(run, asked, found, places, what)
        require_all_sent(run, found if places is None else [found[one] for one in places])

    return judge


def beats(
    topic: str,
    period_s: float,
    during_s: float,
    check: str = 'keeps_its_rhythm',
    sentence: str = '',
) -> Judge:
    """
    Return the check that messages come once a period, by whatever clock, to the end of the run.

    :param topic: full name of a topic that the scenario watches
    :param during_s: how long it is watched [s]
    """

    @claim(check, sentence or f'It publishes once every {period_s:g} s.')
    def judge(run: Run) -> None:
        require_period(run, require_messages(run, topic=topic), period_s, during_s)

    return judge


def warns(ask: str, logger: str, check: str = 'warns', sentence: str = '') -> Judge:
    """
    Return the check that each input is followed by as many WARN lines as are due.

    :param ask: name of the specification; its answers are counts, its inputs have a ``kind``,
        which is how they are called
    :param logger: full name of the node whose lines count
    """

    @claim(check, sentence or 'It logs exactly the warnings that each input asks for.')
    def judge(run: Run) -> None:
        asked, found = run.asked(ask), rows(run, ask, own_logs(run, logger))
        require_warnings(run, asked, found, range(len(found)))

    return judge


def answers(ask: str, service: str, check: str = '', sentence: str = '') -> Judge:
    """
    Return the check that each call of a service has the answer that is due.

    :param ask: name of the specification; its inputs are the requests in their order, its answers
        the fields that must be equal
    """
    base = service.rpartition('/')[2]

    @claim(check or f'answers_{base}', sentence or f'It answers each call of {base}.')
    def judge(run: Run) -> None:
        asked = run.asked(ask)
        nothing: dict[str, Any] = {}
        calls = zip_longest(asked.answers, run.recording.answers(service), fillvalue=nothing)
        came = [
            {name: field_of(one, name) for name in due} if 'data' in one else None
            for due, one in calls
        ]
        require_answers(
            run,
            service,
            asked.answers,
            f'the calls of {base}',
            explain=lambda place: asked.cause(came[: len(asked.answers)], place),
            secret=run.secret,
        )

    return judge
