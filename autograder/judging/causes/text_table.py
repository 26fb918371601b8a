"""Read the tables of causes, and compare code with the conditions in ``by_code.txt``."""

from collections.abc import Callable, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import NamedTuple

from autograder.exam.exam import Cause, Run
from autograder.exam.words import about_of, Causes, rows
from autograder.submission.code.acts import find
from autograder.submission.code.source_code import Code

FOLDER = Path(__file__).parent
cause_of = Causes(FOLDER / 'by_evidence.txt').of


class Row(NamedTuple):
    """
    One row of a table of causes.

    :param cause_id: short stable name of the cause; may contain names in braces
    :param more: the other words of the first line, separated by ``|``
    :param when: the evidence: a pattern, or conditions on the code; empty in ``by_limit.txt``
    :param text: description of the mistake, with names in braces
    :param try_this: the repair, with names in braces
    """

    cause_id: str
    more: Sequence[str]
    when: str
    text: str
    try_this: str

    def cause(self, **words: object) -> Cause:
        """Return the cause, with values for the names in braces."""
        text, try_this = self.text.format(**words), self.try_this.format(**words)
        return Cause(self.cause_id.format(**words), text, try_this, about_of(words))


@cache
def rows_of(name: str) -> tuple[Row, ...]:
    """Return the rows of a file of causes, such as ``by_code.txt``."""
    found = []
    for head, *when, text, try_this in rows((FOLDER / name).read_text(encoding='utf-8')):
        cause_id, *more = head.split('|')
        found.append(Row(cause_id, more, ''.join(when), text, try_this))
    return tuple(found)


@cache
def acts_by_cause() -> dict[str, str]:
    """Return the acts of each cause in ``places.txt``."""
    text = (FOLDER / 'places.txt').read_text(encoding='utf-8').replace('\n  ', ' ')
    lines = (line.split(': ') for line in text.splitlines() if line and line[0] != '#')
    return {one: acts for causes, acts in lines for one in causes.split()}


# -- conditions on the code ----------------------------------------------------------------------


def why_by_code(situation: str, run: Run, **names: object) -> Cause:
    """
    Return the first cause in ``by_code.txt`` whose conditions hold, to explain missing output.

    For code that Python cannot parse, only the last row of a situation (``always``) matches.

    :param situation: such as ``idle``; its rows name conditions that must all hold: a name that
        the code uses, ``name()`` if the code calls it, or a fact of :data:`_FACTS`; ``!`` negates
    :param names: values for the names in braces
    """
    code = Code(run.files)
    here = (row for row in rows_of('by_code.txt') if situation in row.more[0].split())
    row = next(row for row in here if all(_holds(code, word) for word in row.when.split()))
    return row.cause(**names)


def _holds(code: Code, word: str) -> bool:
    if word == 'always' or not code.names:
        return word == 'always'
    name = word.removeprefix('!')
    if fact := _FACTS.get(name):
        found = fact(code)
    else:
        found = name[:-2] in code.calls if name.endswith('()') else name in code.names
    return found is (name == word)


def _has_callbacks(code: Code) -> bool:
    starts = ('create_timer', 'create_subscription', 'create_service', 'create_rate', 'on_')
    return any('callback' in name or name.startswith(starts) for name in code.names)


def _main_unused(code: Code) -> bool:
    """Return whether neither the code nor an entry point in setup.py calls main()."""
    unused = code.defines_unused('main') and not any(one.endswith(':main') for one in code.texts)
    return unused or ('__name__' in code.names and '__main__' not in code.texts)


def _destroyed_first(code: Code) -> bool:
    """Return whether the code calls destroy_node() above spin()."""
    first = {name: code.calls[name][0] for name in ('destroy_node', 'spin') if name in code.calls}
    at = [(call.lineno, call.col_offset) for call in first.values()]
    return len(at) == 2 and at[0] < at[1]


_FACTS: Mapping[str, Callable[[Code], bool]] = {
    'catches_all': lambda code: bool(find(code, 'catch_all')),
    'chooses_domain': lambda code: 'ROS_DOMAIN_ID' in code.texts or bool(find(code, 'domain_id=')),
    'ends_itself': lambda code: code.can_exit,
    'loops': lambda code: code.has_loop,
    'serves': lambda code: 'spin' in code.calls or code.has_loop,
    'spins': lambda code: any(name.startswith('spin') for name in code.names),
    'creates_executor': lambda code: any(name.endswith('Executor') for name in code.calls),
    'overrides_activate': lambda code: (
        'on_activate' in code.functions and 'on_activate' not in code.calls
    ),
    'counted_spins': lambda code: bool(find(code, 'for:spin_once()')) and not find(code, 'while'),
    'creates_node': lambda code: any(
        name.endswith('Node') or name in ('__init__', 'create_node') for name in code.calls
    ),
    'has_callbacks': _has_callbacks,
    'main_unused': _main_unused,
    'destroyed_first': _destroyed_first,
}
