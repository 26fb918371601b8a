"""
Find the place where a program performs an act, such as creating its timer, without running it.

An act is written as words with bars between them.  :func:`place_of` tries these words from left to
right::

    round() | field         a call to round(), or else the value assigned to the field in question

Words without a bar between them are alternatives.  A word has one of these forms:

=============  ====================================================================
``name()``     a call to a function or method
``name(1)``    an argument of a call, by its index
``name=``      the value of a keyword argument or of an attribute
``>=``         an operator, see :data:`OPERATORS`
``while``      a statement, see :data:`STATEMENTS`
``if:name()``  the innermost ``if`` around a call; likewise for other statements, ``def`` and acts
``def:name``   a function or method
``to:name()``  the function that is passed to a call, such as the callback of a timer
``period``     and the other keys of :data:`.known_acts.ACTS`
``NAME``       any other word: a use of this name
``one@other``  an act inside another, such as ``>=@def:judge``, or in a function called there
``one+``       an act, but only if it has several places
``one*``       an act of which each place is a mistake; two or three lines are all named
=============  ====================================================================

As in :mod:`.source_code`, the results affect only messages.
"""

import ast
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

from autograder.errors import ExamInvalid
from autograder.submission.code.known_acts import ACTS
from autograder.submission.code.program import FUNCTIONS, is_stored, last_name, names_in
from autograder.submission.code.source_code import Code

OPERATORS: Mapping[str, type[ast.AST]] = {
    '%': ast.Mod,
    '//': ast.FloorDiv,
    '==': ast.Eq,
    '!=': ast.NotEq,
    '>': ast.Gt,
    '<': ast.Lt,
    '>=': ast.GtE,
    '<=': ast.LtE,
    'or': ast.Or,
    'not': ast.Not,
    'is': ast.Is,
    'in': ast.In,
    'not_in': ast.NotIn,
}
STATEMENTS: Mapping[str, tuple[type[ast.AST], ...]] = {
    'if': (ast.If, ast.IfExp),
    'while': (ast.While,),
    'for': (ast.For, ast.AsyncFor),
    'with': (ast.With, ast.AsyncWith),
    'raise': (ast.Raise,),
    'def': FUNCTIONS,
}


_FEW = range(2, 4)
"""Numbers of lines that a message may name."""


class Place(NamedTuple):
    """
    The place of an act.

    :param line: line of the file, from 1
    :param function: name of the function that begins in this line, if the act has several places
        in it; empty if the line itself performs the act
    :param others: further lines, for an act of which each place is a mistake
    """

    line: int
    function: str = ''
    others: Sequence[int] = ()

    @property
    def words(self) -> str:
        """Return the place as the beginning of a message."""
        first, *others = (one + 1 for one in (self.line, *self.others))  # after the magic line
        if others:
            return f'Lines {", ".join(map(str, (first, *others[:-1])))} and {others[-1]}: '
        return f'Line {first}{f", in {self.function[:40]}()" if self.function else ""}: '


def place_of(
    code: Code, acts: str, about: Sequence[str] = (), lines: Collection[int] = ()
) -> Place | None:
    """
    Return the place of the first act that has exactly one place; None if there is no such act.

    :param code: code of one file; line numbers from several files would be ambiguous
    :param acts: words with bars, see the module's docstring
    :param about: names, strings and numbers in question, such as the field of a message
    :param lines: lines of the log calls in question, which select one of several places
    :raises ExamInvalid: for an act with an unknown statement
    """
    if len(code.trees) != 1:
        return None
    asked = code.asked(about, lines)
    return next(filter(None, (_place(asked, act) for act in acts.split(' | '))), None)


def _place(code: Code, act: str) -> Place | None:
    """Return the place of an act, which is given as alternative words."""
    found = [node for word in act.split() for node in find(code, word)]
    seen = [node for node in found if _is_seen(code, node)]
    working = list(filter(code.is_working, found))
    for some in (found, seen, working):
        if len({getattr(one, 'lineno', 0) for one in some}) == 1:
            name = some[0].name if isinstance(some[0], FUNCTIONS) else ''
            return Place(getattr(some[0], 'lineno', 0), name)
    all_lines = sorted({getattr(one, 'lineno', 0) for one in seen or working or found})
    if '*' in act and len(all_lines) in _FEW:
        return Place(all_lines[0], others=all_lines[1:])
    outer = code.function_around(*(seen or working or found))
    return Place(outer.lineno, outer.name) if outer else None


def _is_seen(code: Code, node: ast.AST) -> bool:
    """Return whether a node is in a function with one of the log calls in question."""
    outer = code.function_around(node)
    ends = (outer.lineno, outer.end_lineno or 0) if outer else (1, 0)
    return any(ends[0] <= line <= ends[1] for line in code.lines)


def find(code: Code, word: str) -> list[ast.AST]:
    """Return the nodes that a word describes."""
    word, _, outer = word.partition('@')
    found = list(_find(code, word.rstrip('+*')))
    if outer:
        bodies = set(find(code, outer))
        scopes = set(code.reached(bodies))
        found = [node for node in found if not scopes.isdisjoint(code.around(node))]
        found = _shared(code, found, bodies) or found
    if word.endswith('+') and len(found) < 2:
        return []
    is_value = word.endswith('=') and word not in OPERATORS
    return list(map(code.origin, found)) if is_value or word[-2:-1].isdigit() else found


def _shared(code: Code, found: Sequence[ast.AST], bodies: set[ast.AST]) -> list[ast.AST]:
    """Return the calls from the given functions to helpers that other functions call too."""
    if any(not bodies.isdisjoint(code.around(node)) for node in found):
        return []
    helpers = {one.name for node in found if (one := code.function_around(node))}
    calls = code.calls_to(*helpers)
    inside: list[ast.AST] = [one for one in calls if not bodies.isdisjoint(code.around(one))]
    return inside if len(inside) < len(calls) else []


def _find(code: Code, word: str) -> Iterable[ast.AST]:
    if known := ACTS.get(word):
        return known(code)
    if word in OPERATORS:
        return code.operations(OPERATORS[word])
    if word in STATEMENTS:
        return (node for node in code.nodes if isinstance(node, STATEMENTS[word]))
    kind, _, name = word.rpartition(':')
    if kind == 'to':
        return code.passed(name.removesuffix('()'))
    if kind and kind not in STATEMENTS:
        kinds = ', '.join(('to', *STATEMENTS))
        raise ExamInvalid(
            f'The act {word!r} begins with the unknown prefix {kind!r}.', f'Use one of: {kinds}.'
        )
    if kind:
        inner = name.endswith('()') or name in ACTS
        return _around(code, name, STATEMENTS[kind]) if inner else code.functions_named(name)
    name, _, inside = word.partition('(')
    if inside:
        return code.calls_to(name) if inside == ')' else code.arguments(name, int(inside[:-1]))
    if word.endswith('='):
        return code.given(word[:-1])
    return (node for node in code.nodes if last_name(node) == word and not is_stored(node))


def _around(code: Code, word: str, kinds: tuple[type[ast.AST], ...]) -> Iterator[ast.AST]:
    """Yield the innermost statement around each place of an act or each call to its function."""
    left, seen = list(_find(code, word)), set[str]()
    for node in left:
        around = (one for one in code.around(node) if isinstance(one, (*kinds, *FUNCTIONS)))
        found = next(around, None)
        if isinstance(found, kinds) and not _is_usual(found):
            yield found
        elif isinstance(found, FUNCTIONS) and found.name not in seen:
            seen.add(found.name)
            left += code.calls_to(found.name)  # the loop continues with these calls


def _is_usual(node: ast.AST) -> bool:
    """Return whether a condition only tests whether ROS is running, or tests ``__name__``."""
    test = getattr(node, 'test', None)
    running = isinstance(test, ast.Call) and last_name(test.func) == 'ok'
    return running or (test is not None and '__name__' in names_in(test))
