"""
Collect the topics, message types and parameters of an exam, for advice that shows code.

Advice for many exams contains placeholders such as ``$topic``.  The judge replaces them with the
names of the exam that it judges, so advice never shows the names of another exercise.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
import re

from autograder.exam.scenario import Scenario
from autograder.exam.steps import Call

_PLACEHOLDER = re.compile(r'\$(heard_topic|heard_type|topic|type|parameter)\b')


@dataclass(frozen=True)
class Names:
    """
    The names that a scenario uses; if there are none, advice contains general words instead.

    :param published: topics that the probe records, full name to type
    :param heard: topics on which the probe publishes, full name to type
    :param parameters: parameters that the scenario passes to the program, sets or reads
    """

    published: Mapping[str, str] = field(default_factory=dict)
    heard: Mapping[str, str] = field(default_factory=dict)
    parameters: tuple[str, ...] = ()

    @classmethod
    def of(cls, scenario: Scenario) -> Names:
        """Return the names of a scenario, in order of appearance."""
        published: dict[str, str] = {}
        heard: dict[str, str] = {}
        for kind, topic, name in (end for one in scenario.starts for end in one.endpoints()):
            (published if kind == 'publisher' else heard).setdefault(topic, name)
        parameters = (name for one in scenario.starts for name in _parameters(one))
        return cls(published, heard, tuple(dict.fromkeys(parameters)))

    @cached_property
    def homes(self) -> Mapping[str, str]:
        """Return the exam's message classes, joined by spaces, per module that defines them."""
        found: dict[str, list[str]] = {}
        for kind in {**self.heard, **self.published}.values():
            package, _, name = kind.partition('/msg/')
            found.setdefault(f'{package}.msg', []).append(name)
        return {module: ' '.join(names) for module, names in found.items()}

    def fill(self, text: str) -> str:
        """
        Replace the placeholders of a text with the names of the exam.

        :param text: may contain ``$topic`` and ``$type`` (what a node publishes), ``$heard_topic``
            and ``$heard_type`` (what it subscribes to), and ``$parameter``
        """
        return _PLACEHOLDER.sub(lambda found: self._words[found[1]], text)

    @cached_property
    def _words(self) -> Mapping[str, str]:
        topic, kind = next(iter({**self.published, **self.heard}.items()), ('topic', 'Type'))
        other, heard = next(iter({**self.heard, **self.published}.items()), ('topic', 'Type'))
        last = {'topic': topic, 'type': kind, 'heard_topic': other, 'heard_type': heard}
        # Leave out the namespace: in a hidden exam it is secret, and node code does not contain
        # it.
        words = {name: full.rpartition('/')[2] for name, full in last.items()}
        return {**words, 'parameter': next(iter(self.parameters), 'name')}


def _parameters(scenario: Scenario) -> Iterator[str]:
    for option, value in zip(scenario.arguments, scenario.arguments[1:], strict=False):
        if option == '-p':
            yield value.partition(':=')[0]
    for step in scenario.steps:
        if isinstance(step, Call):
            for one in step.request.get('parameters', ()):
                yield one['name']
            yield from step.request.get('names', ())
