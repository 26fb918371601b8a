"""
Test whether an exam has what a claim needs, when the claim is added to it.

Without these tests, a misspelt topic or a missing input would fail a correct program.  The claims
are in :mod:`autograder.judging.claims`.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence

from autograder.exam.exam import Exam
from autograder.exam.scenario import Scenario
from autograder.exam.steps import Call, Feed, Mark, Step

Test = Callable[[Exam, Scenario], Iterator[str]]
"""Yields what an exam, and the scenario of the start that is judged, lack."""


def _known(what: str, name: str, known: Iterable[str]) -> Iterator[str]:
    found = list(dict.fromkeys(known))
    if name not in found:
        yield f'expected {what} ({", ".join(map(repr, found)) or "none"}), got {name!r}'


def watched(topic: str) -> Test:
    """Return the test that the probe records a topic."""
    what = 'a topic that the scenario watches'
    return lambda exam, start: _known(what, topic, exam.names.published)


def fed(topic: str) -> Test:
    """Return the test that the probe publishes on a topic."""
    what = 'a topic on which the scenario publishes'
    return lambda exam, start: _known(what, topic, exam.names.heard)


def called(service: str) -> Test:
    """Return the test that the probe calls a service."""
    what = 'a service that the scenario calls'
    return lambda exam, start: _known(
        what, service, (step.name for step in start.steps if isinstance(step, Call))
    )


def marked(phase: str) -> Test:
    """Return the test that the scenario has a phase."""
    what = 'a phase that begins with a Mark'
    return lambda exam, start: _known(
        what, phase, (step.name for step in start.steps if isinstance(step, Mark))
    )


def stepped(steps: Sequence[Step]) -> Test:
    """Return the test that the scenario has some steps."""

    def test(exam: Exam, start: Scenario) -> Iterator[str]:
        missing = (step for step in steps if step not in start.steps)
        yield from (f'expected the step {step} in the scenario' for step in missing)

    return test


def asked_for(ask: str, each_is: type) -> Test:
    """
    Return the test that an exam has a specification, with an answer to each input that is sent.

    :param each_is: type of the answers
    """

    def test(exam: Exam, start: Scenario) -> Iterator[str]:
        if ask not in exam.asks:
            yield from _known('a specification of Exam(asks=...)', ask, exam.asks)
            return
        asked = exam.asks[ask]
        other = [one for one in asked.answers if not isinstance(one, each_is)]
        kind = 'a tuple with a value per message' if each_is is tuple else f'a {each_is.__name__}'
        yield from (f'expected {kind} as each answer of {ask!r}, got {one!r}' for one in other[:1])
        sent = sum(len(step.messages) for step in start.steps if isinstance(step, Feed))
        if each_is is not dict and len(asked.inputs) != sent:
            yield (
                f'expected an input of {ask!r} for each of the {sent} messages that the scenario '
                f'sends, got {len(asked.inputs)}'
            )

    return test
