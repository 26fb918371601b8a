"""
Find the acts of a program that a single word of code does not show, such as a short queue.

As in :mod:`.source_code`, the code is never run, and the results affect only messages.
"""

import ast
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from typing import Any

from autograder.submission.code import assignments
from autograder.submission.code.program import (
    all_arguments,
    argument,
    FUNCTIONS,
    is_stored,
    last_name,
    names_in,
    Program,
)

Act = Callable[[Program], Iterable[ast.AST]]
_TIMERS = ('create_timer', 'create_rate', 'Timer', 'sleep')
_WALL = ('time', 'time_ns', 'monotonic', 'today', 'utcnow', 'Clock')
_ENDPOINTS = {'create_publisher': 2, 'create_lifecycle_publisher': 2, 'create_subscription': 3}
"""The functions that create publishers and subscriptions, with the index of the profile."""
USUAL_DEPTH = 10
_SHORT_PROFILES = ('qos_profile_sensor_data',)
"""Profiles of rclpy whose depth is below the usual one."""
_EVERYTHING = ('Exception', 'BaseException')
_EXITS = ('SystemExit', 'KeyboardInterrupt', 'ExternalShutdownException')
_LEVELS = ('debug', 'info', 'warn', 'warning', 'error', 'fatal')


def _periods(program: Program) -> list[ast.AST]:
    """Return the timer periods that equal the duration in question, or cannot be read."""
    arguments = (argument(one, 0, 'timer_period_sec') for one in program.calls(*_TIMERS))
    given = {one: program.origin(one) for one in arguments if one is not None}
    found = list(given.values())
    if (due := _due(program)) is None:
        return found
    if near := [one for one, value in given.items() if program.is_near(value, due)]:
        # A constant that is also a default value is right; the timer should use the argument.
        return [one if program.is_default(last_name(one)) else given[one] for one in near]
    unread = [one for one in found if program.number(one) is None]
    whole = (one for one in program.nodes if not isinstance(program.parents.get(one), ast.BinOp))
    return unread and ([one for one in whole if program.is_near(one, due)] or unread)


def _slow_periods(program: Program) -> list[ast.AST]:
    """Return the periods of timers and pauses of at least the duration in question."""
    found = [program.origin(one.args[0]) for one in program.calls(*_TIMERS) if one.args]
    return [one for one in found if (program.number(one) or 0.0) >= 0.95 * (_due(program) or 0.0)]


def _short_pauses(program: Program) -> Iterator[ast.AST]:
    """Yield the pauses that are shorter than the duration in question."""
    due = _due(program) or 0.0
    for call in program.calls('sleep'):
        if call.args and (program.number(call.args[0]) or due) < 0.95 * due:
            yield call


def _due(program: Program) -> float | None:
    """Return the duration in question [s]."""
    for text in program.about:
        with suppress(ValueError):
            return float(text)
    return None


def _endpoints(program: Program) -> Iterator[ast.Call]:
    """Yield the calls that create the publishers and subscriptions in question."""
    for call in program.calls(*_ENDPOINTS):
        name = argument(call, 1, 'topic')
        text = _text(program.origin(name)) if name else ''
        if any(_names(text, one) for one in program.about):
            yield call


def _profiles(program: Program) -> Iterator[ast.AST]:
    """Yield the QoS arguments in question, or their values if no other endpoint shares them."""
    given = {
        call: argument(call, _ENDPOINTS[last_name(call.func)], 'qos_profile')
        for call in program.calls(*_ENDPOINTS)
    }
    named = [last_name(one) for one in given.values() if one]
    for call in _endpoints(program):
        if one := given[call]:
            yield one if named.count(last_name(one) or '-') > 1 else program.origin(one)


def _depths(program: Program) -> Iterator[ast.AST]:
    """Yield the depths of subscriptions that are below the usual one."""
    for call in program.calls('create_subscription'):
        given = argument(call, 3, 'qos_profile')
        value = program.origin(given) if given else None
        if isinstance(value, ast.Call):
            given = argument(value, 0, 'depth')
            value = program.origin(given) if given else None
        if value is not None:
            depth = program.number(value)
            short = last_name(value) in _SHORT_PROFILES
            if short or (depth is not None and depth < USUAL_DEPTH):
                yield value


def _texts(program: Program) -> Sequence[ast.AST]:
    """Return the strings with the first of the names in question that occurs in the code."""
    for name in program.about:
        found = [node for node in program.strings if _names(_text(node), name)]
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


def _wall_clocks(program: Program) -> Iterator[ast.AST]:
    """Yield the calls that read the system time."""
    yield from program.calls(*_WALL)
    for call in program.calls('now'):
        if isinstance(call.func, ast.Attribute) and 'datetime' in names_in(call.func.value):
            yield call


def _truths(program: Program) -> Iterator[ast.AST]:
    """Yield the conditions that test whether a value is empty or zero."""
    for node in program.nodes:
        for test in _parts(node.test) if isinstance(node, (ast.If, ast.IfExp)) else ():
            if isinstance(test, (ast.Name, ast.Attribute)):
                yield test
    yield from program.calls('bool')


def _parts(test: ast.AST) -> Iterator[ast.AST]:
    """Yield the parts of a condition, without ``and``, ``or`` and ``not``."""
    if isinstance(test, ast.BoolOp):
        for one in test.values:
            yield from _parts(one)
    elif isinstance(test, ast.UnaryOp) and isinstance(test.op, ast.Not):
        yield from _parts(test.operand)
    else:
        yield test


def _conversions(program: Program) -> Iterator[ast.AST]:
    """Yield the conversions between Celsius and Fahrenheit."""
    for node in program.nodes:
        if isinstance(node, ast.BinOp) and not isinstance(program.parents[node], ast.BinOp):
            parts = [program.number(one) for one in ast.walk(node) if isinstance(one, ast.expr)]
            if 32.0 in parts:
                yield node


def _publishing_timers(program: Program) -> Iterator[ast.AST]:
    """Yield the calls that create a timer whose callback publishes."""
    publishing = set(program.calls('publish'))
    for call in program.calls('create_timer'):
        bodies = program.reached(program.bodies(*all_arguments(call)))
        if any(not publishing.isdisjoint(ast.walk(one)) for one in bodies):
            yield call


def _own_arguments(program: Program) -> Iterator[ast.AST]:
    """Yield the calls that make a node ignore its command line."""
    yield from program.given('use_global_arguments')
    yield from program.given('cli_args')
    for call in program.calls('init'):
        given = argument(call, 0, 'args')
        if isinstance(given, (ast.List, ast.Tuple, ast.Call, ast.BoolOp)):
            yield call


def _nodes(kind: type[ast.AST] | tuple[type[ast.AST], ...], holds: Callable[[Any], bool]) -> Act:
    """Return an act that finds the nodes of a kind for which a condition holds."""
    return lambda program: (one for one in program.nodes if isinstance(one, kind) and holds(one))


ACTS: Mapping[str, Act] = {
    'calls_of_callback': lambda program: program.calls(
        *(getattr(one, 'name', '') for one in program.passed('create_timer'))
    ),
    'catch_all': _nodes(
        ast.ExceptHandler,
        lambda node: node.type is None or not names_in(node.type).isdisjoint(_EVERYTHING),
    ),
    'compared_count': assignments.compared_counts,
    'conversion': _conversions,
    'count': assignments.counts,
    'depth': _depths,
    'early_return': _nodes(ast.Return, lambda node: node.value is None),
    'endpoint': _endpoints,
    'few_threads': lambda program: (
        program.origin(one)
        for call in program.calls('MultiThreadedExecutor')
        if (one := argument(call, 0, 'num_threads')) and program.number(one) == 1
    ),
    'forgotten': assignments.forgotten,
    'exact': lambda program: (
        node for node in program.strings if _text(node) in program.about[:1]
    ),
    'field': lambda program: (
        program.origin(one)
        for name in filter(None, program.about)
        for one in program.given(name.rpartition('.')[2])
    ),
    # the functions in question, or the callbacks of the transitions in question
    'function': lambda program: program.functions(
        *program.about, *(f'on_{name}' for name in program.about)
    ),
    # a number that is parsed from an f-string
    'joined': lambda program: (
        call
        for call in program.calls('float', 'int')
        if any(isinstance(one, ast.JoinedStr) for one in ast.walk(call))
    ),
    'kept_first': assignments.kept_first,
    'kept_message': assignments.kept_messages,
    'limit': lambda program: program.operations(ast.Lt, ast.Gt, ast.LtE, ast.GtE),
    # collections of numbers
    'list': _nodes(
        (ast.List, ast.Tuple, ast.Set),
        lambda node: (
            len(node.elts) > 1
            and all(isinstance(getattr(one, 'value', ''), (int, float)) for one in node.elts)
        ),
    ),
    'log': lambda program: (
        call
        for call in program.calls(*_LEVELS)
        if any(call.lineno <= line <= (call.end_lineno or 0) for line in program.lines)
    ),
    'longer_pause': assignments.longer_pauses,
    'named_logger': lambda program: (
        call for call in program.calls('get_logger', 'getLogger') if call.args
    ),
    'own_arguments': _own_arguments,
    'period': _periods,
    'profile': _profiles,
    'publishing_timer': _publishing_timers,
    'raised_exit': _nodes(ast.Raise, lambda node: not names_in(node).isdisjoint(_EXITS)),
    'recount': assignments.recounts,
    'reset': assignments.resets,
    # the strings that occur in one of the texts in question
    'says': lambda program: (
        node
        for node in program.strings
        if len(words := _text(node).strip()) > 1 and any(words in one for one in program.about)
    ),
    'set_back': assignments.set_back,
    'short_pause': _short_pauses,
    'slow_period': _slow_periods,
    'slice': _nodes(ast.Subscript, lambda node: True),
    'stored': assignments.stored,
    'stores_time': assignments.stored_times,
    'stuck': assignments.stuck,
    'text': _texts,
    'truth': _truths,
    # the classes and constants in question
    'use': lambda program: (
        node
        for node in program.nodes
        if last_name(node)[:1].isupper()
        and last_name(node) in {one.rpartition('/')[2] for one in program.about}
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
    'wrapped_count': assignments.wrapped_counts,
}
"""These acts by name, see :mod:`.acts`."""
