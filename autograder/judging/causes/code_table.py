"""
Find in the code why a program produced nothing.

The table ``by_code.txt`` has the rows for all such situations; this module evaluates their
conditions.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

from autograder.exam.exam import Cause, Run
from autograder.judging.causes.text_table import rows_of
from autograder.submission.code.acts import find
from autograder.submission.code.learners_code import Code


def why_by_code(situation: str, run: Run, **names: object) -> Cause:
    """
    Return the first cause of a situation that matches the code.

    For code that Python cannot parse, only the last row of a situation (``always``) matches.

    :param situation: such as ``idle``; its rows name conditions that must all hold: a name that
        the code uses, ``name()`` if the code calls it, or a fact of :data:`_FACTS`; ``!`` negates
    :param names: values for the names in braces
    """
    code = Code(run.files)
    here = (row for row in rows_of('by_code.txt') if situation in row.more[0].split())
    row = next(row for row in here if row.when == 'always' or _fits(code, row.when))
    return row.cause(**names)


def _fits(code: Code, words: str) -> bool:
    if not code.names:
        return False
    return all(_holds(code, word.removeprefix('!')) != (word[0] == '!') for word in words.split())


def _holds(code: Code, word: str) -> bool:
    if fact := _FACTS.get(word):
        return fact(code)
    return word[:-2] in code.calls if word.endswith('()') else word in code.names


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


def _creates_node(code: Code) -> bool:
    made = (name.endswith('Node') or name in ('__init__', 'create_node') for name in code.calls)
    return any(made)


_FACTS: Mapping[str, Callable[[Code], bool]] = {
    'catches_all': lambda code: any(find(one, 'catch_all') for one in code.programs),
    'ends_itself': lambda code: code.ends_itself,
    'loops': lambda code: code.loops,
    'serves': lambda code: 'spin' in code.calls or code.loops,
    'spins': lambda code: any(name.startswith('spin') for name in code.names),
    'creates_executor': lambda code: any(name.endswith('Executor') for name in code.calls),
    'overrides_activate': lambda code: (
        'on_activate' in code.functions and 'on_activate' not in code.calls
    ),
    'creates_node': _creates_node,
    'has_callbacks': _has_callbacks,
    'main_unused': _main_unused,
    'destroyed_first': _destroyed_first,
}
