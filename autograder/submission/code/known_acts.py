"""
Find the acts of a program that a single word of code does not show, such as a short queue.

As in :mod:`.source_code`, the code is never run, and the results affect only messages.
"""

import ast
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from typing import Any

from autograder.submission.code.program import (
    all_arguments,
    argument,
    assigned,
    dotted,
    FUNCTIONS,
    is_stored,
    last_name,
    names_in,
)
from autograder.submission.code.source_code import Code

Act = Callable[[Code], Iterable[ast.AST]]
_WAITS = ('create_timer', 'Timer', 'sleep')
_TIMERS = (*_WAITS, 'create_rate')
_WALL = ('time', 'time_ns', 'monotonic', 'today', 'utcnow', 'Clock')
_ENDPOINTS = {'create_publisher': 2, 'create_lifecycle_publisher': 2, 'create_subscription': 3}
"""The functions that create publishers and subscriptions, with the index of the profile."""
_SHORT = range(10)
_SHORT_PROFILES = ('qos_profile_sensor_data',)
"""Depths below the usual one, and profiles of rclpy that have such a depth."""
_EVERYTHING = ('Exception', 'BaseException')
_EXITS = ('SystemExit', 'KeyboardInterrupt', 'ExternalShutdownException')
_LEVELS = ('debug', 'info', 'warn', 'warning', 'error', 'fatal')


# -- periods, endpoints and texts in question -----------------------------------------------------


def _periods(code: Code) -> list[ast.AST]:
    """Return the timer periods that equal the duration in question, or cannot be read."""
    arguments = (argument(one, 0, 'timer_period_sec') for one in code.calls_to(*_TIMERS))
    given = {one: code.origin(one) for one in arguments if one is not None}
    found = list(given.values())
    if (due := _due(code)) is None:
        return found
    if near := [one for one, value in given.items() if _is_near(code, value, due)]:
        # A constant that is also a default value is right; the timer should use the argument.
        defaults = {last_name(one) for one in _defaults(code)} - {''}
        return [one if last_name(one) in defaults else given[one] for one in near]
    unread = [one for one in found if code.number(one) is None]
    whole = (one for one in code.nodes if not isinstance(code.parents.get(one), ast.BinOp))
    return unread and ([one for one in whole if _is_near(code, one, due)] or unread)


def _is_near(code: Code, node: ast.AST, due: float) -> bool:
    """Return whether an expression is a number within 2 % of the given one."""
    value = None if isinstance(node, (ast.Name, ast.Attribute)) else code.number(node)
    return value is not None and abs(value - due) <= due / 50


def _defaults(code: Code) -> Iterator[ast.AST]:
    """Yield the default values of all arguments."""
    for node in code.nodes:
        if isinstance(node, ast.arguments):
            yield from filter(None, (*node.defaults, *node.kw_defaults))


def _slow_periods(code: Code) -> list[ast.AST]:
    """Return the periods of timers and pauses of at least the duration in question."""
    found = [code.origin(one.args[0]) for one in code.calls_to(*_TIMERS) if one.args]
    return [one for one in found if (code.number(one) or 0.0) >= 0.95 * (_due(code) or 0.0)]


def _due(code: Code) -> float | None:
    """Return the duration in question [s]."""
    for text in code.about:
        with suppress(ValueError):
            return float(text)
    return None


def _value(code: Code, call: ast.Call, place: int, name: str) -> ast.AST | None:
    """Return the value of an argument, None if it is not given."""
    given = argument(call, place, name)
    return given and code.origin(given)


def _endpoints(code: Code) -> Iterator[ast.Call]:
    """Yield the calls that create the publishers and subscriptions in question."""
    for call in code.calls_to(*_ENDPOINTS):
        name = _value(code, call, 1, 'topic')
        if name and any(_names(_text(name), one) for one in code.about):
            yield call


def _profiles(code: Code) -> Iterator[ast.AST]:
    """Yield the QoS arguments in question, or their values if no other endpoint shares them."""
    given = {
        call: argument(call, _ENDPOINTS[last_name(call.func)], 'qos_profile')
        for call in code.calls_to(*_ENDPOINTS)
    }
    named = [last_name(one) for one in given.values() if one]
    for call in _endpoints(code):
        if one := given[call]:
            yield one if named.count(last_name(one) or '-') > 1 else code.origin(one)


def _depths(code: Code) -> Iterator[ast.AST]:
    """Yield the depths of subscriptions that are below the usual one."""
    for call in code.calls_to('create_subscription'):
        value = _value(code, call, 3, 'qos_profile')
        if isinstance(value, ast.Call):
            value = _value(code, value, 0, 'depth')
        if value and (last_name(value) in _SHORT_PROFILES or code.number(value) in _SHORT):
            yield value


def _texts(code: Code) -> Sequence[ast.AST]:
    """Return the strings with the first of the names in question that occurs in the code."""
    for name in code.about:
        found = [node for node in code.strings if _names(_text(node), name)]
        exact = [node for node in found if _text(node) == name]
        if name.strip('/') and found:
            return exact or found
    return ()


def _names(text: str, name: str) -> bool:
    """Return whether a string is a name, with or without its namespace."""
    text = text.strip('~/')
    return bool(text) and f'/{name.strip("/")}'.endswith(f'/{text}')


def _text(node: ast.AST) -> str:
    """Return the text of a string, or the longest fixed part of an f-string."""
    parts = (one for one in ast.walk(node) if isinstance(one, ast.Constant))
    return max((one.value for one in parts if isinstance(one.value, str)), key=len, default='')


def _truths(code: Code) -> Iterator[ast.AST]:
    """Yield the conditions that test whether a value is empty or zero."""
    left = [node.test for node in code.nodes if isinstance(node, (ast.If, ast.IfExp))]
    for test in left:  # the loop continues with the parts of a condition
        if isinstance(test, ast.BoolOp):
            left += test.values
        elif isinstance(test, ast.UnaryOp):
            left.append(test.operand)
        elif isinstance(test, (ast.Name, ast.Attribute)):
            yield test


def _wall_clocks(code: Code) -> Iterator[ast.AST]:
    """Yield the calls that read the system time."""
    yield from code.calls_to(*_WALL)
    for call in code.calls_to('now'):
        if isinstance(call.func, ast.Attribute) and 'datetime' in names_in(call.func.value):
            yield call


def _conversions(code: Code) -> Iterator[ast.AST]:
    """Yield the conversions between Celsius and Fahrenheit."""
    for node in code.nodes:
        if isinstance(node, ast.BinOp) and not isinstance(code.parents[node], ast.BinOp):
            parts = (one for one in ast.walk(node) if isinstance(one, ast.expr))
            if 32.0 in map(code.number, parts):
                yield node


def _publishing_timers(code: Code) -> Iterator[ast.AST]:
    """Yield the calls that create a timer whose callback publishes."""
    publishing = set(code.calls_to('publish'))
    for call in code.calls_to('create_timer'):
        bodies = code.reached(code.bodies(*all_arguments(call)))
        if any(not publishing.isdisjoint(ast.walk(one)) for one in bodies):
            yield call


def _own_arguments(code: Code) -> Iterator[ast.AST]:
    """Yield the calls that make a node ignore its command line."""
    yield from code.given('use_global_arguments')
    yield from code.given('cli_args')
    for call in code.calls_to('init'):
        given = argument(call, 0, 'args')
        if isinstance(given, (ast.List, ast.Tuple, ast.Call, ast.BoolOp)):
            yield call


# -- statements that set names and attributes -----------------------------------------------------


def _counts(code: Code) -> Iterator[ast.AST]:
    """Yield the statements that add 1 to a name or an attribute."""
    for node in code.nodes:
        if isinstance(node, ast.AugAssign) and _is_one(node.value):
            yield node
        if isinstance(node, ast.Assign) and last_name(node.targets[0]) in names_in(node.value):
            sums = (one for one in ast.walk(node.value) if isinstance(one, ast.BinOp))
            if any(_is_one(one.right) for one in sums):
                yield node


def _is_one(node: ast.AST) -> bool:
    return isinstance(node, ast.Constant) and node.value == 1


def _counted(code: Code) -> set[str]:
    """Return the names that count something."""
    return {last_name(target) for one in _counts(code) for target, _ in assigned(one)} - {''}


def _recounts(code: Code) -> Iterator[ast.AST]:
    """Yield the statements outside ``__init__`` that reset a count."""
    counted = _counted(code)
    return (node for node, target, _ in _fixed(code) if last_name(target) in counted)


def _compared_counts(code: Code) -> Iterator[ast.AST]:
    """Yield the comparisons of a count."""
    counted = _counted(code)
    compared = (one for one in code.nodes if isinstance(one, ast.Compare))
    return (one for one in compared if counted & names_in(one))


def _wrapped_counts(code: Code) -> Iterator[ast.AST]:
    """Yield the modulo operations on a count, except those in conditions."""
    counted = _counted(code)
    tests = {getattr(one, 'test', None) for one in code.nodes}
    for node in code.operations(ast.Mod):
        left = getattr(node, 'left', None) or getattr(node, 'target', None)
        if counted and left and counted & names_in(left):
            whole = (node, *code.around(node))
            if not any(isinstance(one, ast.Compare) or one in tests for one in whole):
                yield node


def _longer_pauses(code: Code) -> Iterator[ast.AST]:
    """Yield the statements that change the period of a timer or a pause, as ``+=`` does."""
    given = {last_name(one) for name in _WAITS for one in code.arguments(name, 0)} - {''}
    for node in code.nodes:
        if isinstance(node, ast.AugAssign) and last_name(node.target) in given:
            yield node
        if isinstance(node, ast.Assign) and last_name(node.targets[0]) in given:
            target = dotted(node.targets[0])
            sums = (one for one in ast.walk(node.value) if isinstance(one, ast.BinOp))
            if any(target in map(dotted, (one.left, one.right)) for one in sums):
                yield node


def _kept_messages(code: Code) -> Iterator[ast.AST]:
    """Yield the statements that store a message for later and replace the previous one."""
    for body in code.reached(code.passed('create_subscription')):
        given = {one.arg for one in ast.walk(body) if isinstance(one, ast.arg)} - {'self'}
        for node in ast.walk(body):
            if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Attribute):
                uses = [bool(given & names_in(one, ast.Name)) for one in (node.targets[0], node)]
                if uses == [False, True]:
                    yield node


def _set_back(code: Code) -> Iterator[ast.AST]:
    """Yield the statements that give an attribute its first value again."""
    for node, target, value in _fixed(code):
        given = (one for one in code.values_of(target) if one and not _is_later(code, one))
        if any(_is_fixed(one) and ast.dump(one) == ast.dump(value) for one in given):
            yield node


def _fixed(code: Code) -> Iterator[tuple[ast.AST, ast.AST, ast.AST]]:
    """Yield the statements outside ``__init__`` that set an attribute to a fixed value."""
    for node in code.nodes:
        for target, value in assigned(node):
            kept = isinstance(target, ast.Attribute) and value and _is_fixed(value)
            if kept and value and _is_later(code, node):
                yield node, target, value


def _is_own(target: ast.AST) -> bool:
    """Return whether a name is an attribute of the object itself, or a part of one."""
    base = target
    while isinstance(base, (ast.Attribute, ast.Subscript)):
        base = base.value
    return base is not target and last_name(base) == 'self'


def _is_fixed(value: ast.AST) -> bool:
    """Return whether a value is fixed: it does not depend on other values."""
    if isinstance(value, ast.Call):
        return not all_arguments(value) and isinstance(value.func, ast.Name)
    if isinstance(value, (ast.List, ast.Tuple, ast.Set)):
        return not value.elts
    return isinstance(value, ast.Constant) or (isinstance(value, ast.Dict) and not value.keys)


def _is_later(code: Code, node: ast.AST) -> bool:
    """Return whether a statement is in a function other than ``__init__``."""
    inner = code.function_around(node)
    return inner is not None and inner.name != '__init__'


# -- the table ------------------------------------------------------------------------------------


def _nodes(kind: type[ast.AST] | tuple[type[ast.AST], ...], holds: Callable[[Any], bool]) -> Act:
    """Return an act that finds the nodes of a kind for which a condition holds."""
    return lambda code: (one for one in code.nodes if isinstance(one, kind) and holds(one))


def _settings(holds: Callable[[ast.AST, ast.AST | None], bool]) -> Act:
    """Return an act that finds the statements that set a name for which a condition holds."""
    return lambda code: (node for node in code.nodes for one in assigned(node) if holds(*one))


ACTS: Mapping[str, Act] = {
    'calls_of_callback': lambda code: code.calls_to(
        *(getattr(one, 'name', '') for one in code.passed('create_timer'))
    ),
    'catch_all': _nodes(
        ast.ExceptHandler,
        lambda node: node.type is None or not names_in(node.type).isdisjoint(_EVERYTHING),
    ),
    'compared_count': _compared_counts,
    'conversion': _conversions,
    'count': _counts,
    'depth': _depths,
    'early_return': _nodes(ast.Return, lambda node: node.value is None),
    'endpoint': _endpoints,
    'field': lambda code: (
        code.origin(one)
        for name in filter(None, code.about)
        for one in code.given(name.rpartition('.')[2])
    ),
    # the functions in question, or the callbacks of the transitions in question
    'function': lambda code: code.functions_named(
        *code.about, *(f'on_{name}' for name in code.about)
    ),
    # a number that is parsed from an f-string
    'joined': lambda code: (
        call
        for call in code.calls_to('float', 'int')
        if any(isinstance(one, ast.JoinedStr) for one in ast.walk(call))
    ),
    # an attribute that is set only if it has no value yet, with ``or``
    'kept_first': _settings(
        lambda target, value: (
            isinstance(value, ast.BoolOp)
            and _is_own(target)
            and last_name(target) in names_in(value)
        )
    ),
    'kept_message': _kept_messages,
    'limit': lambda code: code.operations(ast.Lt, ast.Gt, ast.LtE, ast.GtE),
    'log': lambda code: (
        call
        for call in code.calls_to(*_LEVELS)
        if any(call.lineno <= line <= (call.end_lineno or 0) for line in code.lines)
    ),
    'longer_pause': _longer_pauses,
    'own_arguments': _own_arguments,
    'period': _periods,
    'profile': _profiles,
    'publishing_timer': _publishing_timers,
    'raised_again': _nodes(ast.Raise, lambda node: node.exc is None),
    'raised_exit': _nodes(ast.Raise, lambda node: not names_in(node).isdisjoint(_EXITS)),
    'recount': _recounts,
    'reset': lambda code: (node for node, _, _ in _fixed(code)),
    # the strings that occur in one of the texts in question
    'says': lambda code: (
        node
        for node in code.strings
        if len(words := _text(node).strip()) > 1 and any(words in one for one in code.about)
    ),
    'set_back': _set_back,
    'slow_period': _slow_periods,
    'slice': _nodes(ast.Subscript, lambda node: True),
    'stored': _settings(lambda target, _: _is_own(target)),
    'text': _texts,
    'truth': _truths,
    # the classes and constants in question
    'use': lambda code: (
        node
        for node in code.nodes
        if last_name(node)[:1].isupper()
        and last_name(node) in {one.rpartition('/')[2] for one in code.about}
        and not is_stored(node)
    ),
    'wall_clock': _wall_clocks,
    # the callbacks of transitions that return nothing
    'without_result': _nodes(
        FUNCTIONS,
        lambda node: (
            node.name.startswith('on_')
            and not any(isinstance(one, ast.Return) and one.value for one in ast.walk(node))
        ),
    ),
    'wrapped_count': _wrapped_counts,
}
"""These acts by name, see :mod:`.acts`."""
