"""
Test whether an exam has what a claim needs, when the claim is added to it.

Without these tests, a misspelt topic or a missing input would fail a correct program.  The claims
are in :mod:`autograder.judging.claims`.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence

from autograder.exam.exam import Exam
from autograder.exam.scenario import Scenario
from autograder.exam.steps import Advance, Call, Feed, Mark, Offer, Step

Test = Callable[[Exam, Scenario], Iterator[str]]
"""Yields what an exam, and the scenario of the start that is judged, lack."""
OF_EACH_NODE = ('rcl_interfaces/', 'type_description_interfaces/', 'lifecycle_msgs/')
"""Packages of services that each node has, as in ``probe/probe_graph.py``."""


def _known(what: str, name: str, known: Iterable[str]) -> Iterator[str]:
    found = list(dict.fromkeys(known))
    if name not in found:
        yield f'expected {what} ({", ".join(map(repr, found)) or "none"}), got {name!r}'


def watched(topic: str) -> Test:
    """Return the test that the probe records a topic."""
    what = 'a topic that the scenario watches'
    return lambda exam, start: _known(what, topic, start.watch)


def fed(topic: str) -> Test:
    """Return the test that the probe publishes on a topic."""

    def test(exam: Exam, start: Scenario) -> Iterator[str]:
        offers = {step.name: step.topic for step in start.steps if isinstance(step, Offer)}
        sent = (step.topic for step in start.steps if isinstance(step, Feed))
        what = 'a topic on which a Feed publishes'
        yield from _known(what, topic, (offers.get(one, one) for one in sent))

    return test


def called(service: str, kind: str) -> Test:
    """
    Return the test that the probe calls a service of a given type.

    The probe does not record services that ROS itself creates for each node.
    """

    def test(exam: Exam, start: Scenario) -> Iterator[str]:
        calls = [step for step in start.steps if isinstance(step, Call)]
        yield from _known(
            'a service that the scenario calls', service, (one.name for one in calls)
        )
        types = [one.type for one in calls if one.name == service]
        yield from _known(f'the type of {service} in the scenario', kind, types) if types else ()
        if kind.startswith(OF_EACH_NODE):
            yield f'expected a service of the exercise, got one that each node has: {kind}'

    return test


def marked(phase: str, least_s: float = 0.0) -> Test:
    """
    Return the test that the scenario has a phase.

    :param least_s: minimum duration of each part of the phase [s]
    """

    def test(exam: Exam, start: Scenario) -> Iterator[str]:
        names, lasts_s = [''], [0.0]
        for step in start.steps:
            if isinstance(step, Mark):
                names.append(step.name)
                lasts_s.append(0.0)
            lasts_s[-1] += _seconds(step)
        yield from _known('a phase that begins with a Mark', phase, names[1:])
        short = [one for name, one in zip(names, lasts_s) if name == phase and one < least_s]
        if short and phase in names[1:]:
            yield f'the phase {phase!r} lasts {short[0]:g} s; expected at least {least_s:g} s'

    return test


def _seconds(step: Step) -> float:
    if isinstance(step, Feed):
        return step.every_s * len(step.messages) + step.rest_s
    return step.seconds if isinstance(step, Advance) else 0.0


def stepped(steps: Sequence[Step]) -> Test:
    """Return the test that the scenario has some steps."""

    def test(exam: Exam, start: Scenario) -> Iterator[str]:
        missing = (step for step in steps if step not in start.steps)
        yield from (f'expected the step {step} in the scenario' for step in missing)

    return test


def asked_for(ask: str, each_is: type, service: str = '') -> Test:
    """
    Return the test that an exam has a specification, and that its inputs are sent.

    :param each_is: type of the answers
    :param service: full name of the service that receives the inputs, by default messages
    """

    def test(exam: Exam, start: Scenario) -> Iterator[str]:
        if ask not in exam.asks:
            yield from _known('a specification of Exam(asks=...)', ask, exam.asks)
            return
        asked = exam.asks[ask]
        other = [one for one in asked.answers if not isinstance(one, each_is)]
        kind = 'a tuple with a value per message' if each_is is tuple else f'a {each_is.__name__}'
        yield from (f'expected {kind} as each answer of {ask!r}, got {one!r}' for one in other[:1])
        calls = [step for step in start.steps if isinstance(step, Call) and step.name == service]
        feeds = [len(step.messages) for step in start.steps if isinstance(step, Feed)]
        sent = len(calls) if service else sum(feeds)
        if len(asked.inputs) > sent:
            what = f'calls of {service}' if service else 'messages'
            count = len(asked.inputs)
            yield f'{ask!r} has {count} inputs, more than the {what} in the scenario ({sent})'

    return test
