"""
Keep the inputs, the namespace and the parameters of hidden exams out of feedback.

A student who learns these values could hard-code them and resubmit.  If
:attr:`autograder.exam.exam.Run.secret` is true, checks describe drawn values only in general
terms, and quote the student's node only if the quotation cannot repeat them.  The namespace is
part of most names, and an exception may quote a parameter.  So the judge removes the program's
arguments from all texts in one place.
"""

from collections.abc import Iterator
from dataclasses import replace
import re
from typing import Any

from autograder.exam.exam import Run
from autograder.exam.scenario import Scenario
from autograder.results import CheckResult

_OPTION = '__ns:='
_NUMBER = re.compile(r'\d+(?:[.,]\d+)?')
MOST_QUOTED = 120
PUBLIC = ('Celsius', 'Fahrenheit', 'temp_sensor_01', 'nan', '30')
"""Input values that every lesson shows; an error message that contains one reveals nothing."""


def namespace_of(scenario: Scenario) -> str:
    """Return the namespace in which a program is started, such as ``/lab``, empty for none."""
    chosen = [one.removeprefix(_OPTION) for one in scenario.arguments if one.startswith(_OPTION)]
    return chosen[-1] if chosen and chosen[-1] != '/' else ''


def without_arguments(scenario: Scenario, check: CheckResult) -> CheckResult:
    """
    Return a result of a hidden exam without the arguments of the program in its texts.

    Names of nodes and topics lose the namespace, and a description replaces the words ``the
    namespace /lab``.  Elsewhere, the namespace and the values of parameters become an ellipsis.
    """
    space = namespace_of(scenario).strip('/')
    settings = [one.partition(':=')[2] for one in scenario.arguments if ':=' in one]
    values = [re.escape(one) for one in settings if one.strip('/') != space]
    if not space and not values:
        return check

    def redact(text: str) -> str:
        for value in values:
            text = re.sub(rf'(?<![\w.]){value}(?![\w.]*\d)', '…', text)
        if not space:
            return text
        text = re.sub(rf'the namespace /{space}(?![\w/])', 'the namespace that we chose', text)
        text = re.sub(rf'/?{space}/(?=\w)', '', text)
        return text.replace(space, '…')  # random letters: no other word contains them

    shown = ('expected', 'observed', 'cause', 'try_this')
    texts: dict[str, Any] = {name: redact(getattr(check, name)) for name in shown}
    return replace(check, **texts)


def safe_quotation(run: Run, text: str, instead: str) -> str:
    """
    Return a quotation of the student's node if it cannot repeat a hidden input.

    That is certain if no input was sent, or if the text is in the code.

    :param instead: text that replaces a quotation that may repeat an input
    """
    open_to_all = not run.secret or not run.recording.of('input')
    if open_to_all or any(text in code for code in run.files.values()):
        return repr(text)
    return instead


def redacted(run: Run, text: str) -> str:
    """Return a logged text without the numbers and strings that a hidden exam sent."""
    text = ' '.join(text.split())
    if run.secret:
        for word in {one for one in drawn_values(run) if isinstance(one, str)} - {*PUBLIC, ''}:
            text = re.sub(re.escape(word), '…', text, flags=re.IGNORECASE)
        text = _NUMBER.sub('…', text)
    return text if len(text) <= MOST_QUOTED else f'{text[:MOST_QUOTED]}…'


def drawn_values(run: Run) -> Iterator[Any]:
    """Yield the values in the inputs, and the fractional numbers in the service requests."""
    for event in run.recording.of('input'):
        yield from _leaves(event['data'])
    for event in run.recording.of('answer') + run.recording.of('no_answer'):
        # Omit integers: they are also ids of transitions, or part of texts such as 'takes 0
        # arguments'.
        yield from (
            one for one in _leaves(event.get('request')) if isinstance(one, float) and one % 1
        )


def _leaves(value: Any) -> Iterator[Any]:
    if isinstance(value, (dict, list)):
        for part in value.values() if isinstance(value, dict) else value:
            yield from _leaves(part)
    else:
        yield value
