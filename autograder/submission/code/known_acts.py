"""Find the acts of a program that a single word of code does not show, such as a short queue."""

from __future__ import annotations

import ast
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress

from autograder.submission.code import assignments
from autograder.submission.code.program import (
    argument,
    end_of,
    FUNCTIONS,
    is_stored,
    last_name,
    line_of,
    names_in,
    Program,
)

_TIMERS = ('create_timer', 'create_rate', 'Timer', 'sleep')
_WALL = ('time', 'time_ns', 'monotonic', 'today', 'utcnow', 'Clock')
_ENDPOINTS = {'create_publisher': 2, 'create_lifecycle_publisher': 2, 'create_subscription': 3}
"""The functions that create publishers and subscriptions, with the index of the profile."""
USUAL_DEPTH = 10
_SHORT_PROFILES = ('qos_profile_sensor_data',)
"""Profiles of rclpy whose depth is below the usual one."""
_EVERYTHING = ('Exception', 'BaseException')


def _periods(program: Program) -> list[ast.AST]:
    """Return the periods of timers that are the duration in question, or that cannot be read."""
    given = [argument(one, 0, 'timer_period_sec') for one in program.calls(*_TIMERS)]
    found = [program.origin(one) for one in given if one is not None]
    due = next(iter(_numbers(program)), None)
    if due is None:
        return found
    if near := [one for one in found if program.is_near(one, due)]:
        return near
    unread = [one for one in found if program.number(one) is None]
    whole = (one for one in program.nodes if not isinstance(program.parents.get(one), ast.BinOp))
    return unread and ([one for one in whole if program.is_near(one, due)] or unread)


def _slow_periods(program: Program) -> list[ast.AST]:
    """Return the periods of timers and pauses that last at least as long as asked."""
    given = [one.args[0] for one in program.calls(*_TIMERS) if one.args]
    found = [program.origin(one) for one in given]
    due = next(iter(_numbers(program)), 0.0)
    return [one for one in found if (program.number(one) or 0.0) >= 0.95 * due]


def _numbers(program: Program) -> Iterator[float]:
    for text in program.about:
        with suppress(ValueError):
            yield float(text)


def _short_pauses(program: Program) -> Iterator[ast.AST]:
    """Yield the pauses that last less than asked."""
    due = next(iter(_numbers(program)), 0.0)
    for call in program.calls('sleep'):
        if call.args and (program.number(call.args[0]) or due) < 0.95 * due:
            yield call


def _few_threads(program: Program) -> Iterator[ast.AST]:
    """Yield the numbers of threads of executors that have only one."""
    for call in program.calls('MultiThreadedExecutor'):
        given = argument(call, 0, 'num_threads')
        if given is not None and program.number(given) == 1:
            yield program.origin(given)


def _endpoints(program: Program) -> Iterator[ast.Call]:
    """Yield the calls that create the publishers and subscriptions in question."""
    for call in program.calls(*_ENDPOINTS):
        name = argument(call, 1, 'topic')
        text = _text(program.origin(name)) if name else ''
        if any(_names(text, one) for one in program.about):
            yield call


def _profiles(program: Program) -> Iterator[ast.AST]:
    """Yield the quality of service in question: where it is given if others share it."""
    given = {one: _profile(one) for one in program.calls(*_ENDPOINTS)}
    named = [last_name(one) for one in given.values() if one]
    for call in _endpoints(program):
        if one := given[call]:
            yield one if named.count(last_name(one) or '-') > 1 else program.origin(one)


def _profile(call: ast.Call) -> ast.AST | None:
    return argument(call, _ENDPOINTS[last_name(call.func)], 'qos_profile')


def _uses(program: Program) -> Iterator[ast.AST]:
    """Yield the uses of the classes and constants in question."""
    last = (one.rpartition('/')[2] for one in program.about)
    names = {one for one in last if one[:1].isupper()}
    return (one for one in program.nodes if last_name(one) in names and not is_stored(one))


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


def _fields(program: Program) -> Iterator[ast.AST]:
    """Yield what the field in question gets."""
    for name in filter(None, program.about):
        yield from map(program.origin, program.given(name.rpartition('.')[2]))


def _texts(program: Program) -> Sequence[ast.AST]:
    """Return the strings that give the first of the names in question that the code has."""
    for name in program.about:
        found = [node for node in program.strings if _names(_text(node), name)]
        exact = [node for node in found if _text(node) == name]
        if name.strip('/') and found:
            return exact or found
    return ()


def _exact_texts(program: Program) -> Iterator[ast.AST]:
    """Yield the strings that are the name in question, letter by letter."""
    yield from (node for node in program.strings if _text(node) in program.about[:1])


def _names(text: str, name: str) -> bool:
    """Return whether a string gives a name, with or without its namespace."""
    text = text.strip('~/')
    return bool(text) and f'/{name.strip("/")}'.endswith(f'/{text}')


def _sayings(program: Program) -> Iterator[ast.AST]:
    """Yield the strings and f-strings whose words are in a text that the program gave."""
    for node in program.strings:
        words = _text(node).strip()
        if len(words) > 1 and any(words in text for text in program.about):
            yield node


def _text(node: ast.AST) -> str:
    """Return the text of a string, or the longest fixed part of an f-string."""
    parts = (one for one in ast.walk(node) if isinstance(one, ast.Constant))
    return max((one.value for one in parts if isinstance(one.value, str)), key=len, default='')


def _wall_clocks(program: Program) -> Iterator[ast.AST]:
    """Yield the calls that ask the system for the time."""
    yield from program.calls(*_WALL)
    for call in program.calls('now'):
        if isinstance(call.func, ast.Attribute) and 'datetime' in names_in(call.func.value):
            yield call


def _lists(program: Program) -> Iterator[ast.AST]:
    """Yield the collections of numbers."""
    for node in program.nodes:
        if isinstance(node, (ast.List, ast.Tuple, ast.Set)) and len(node.elts) > 1:
            values = (getattr(one, 'value', None) for one in node.elts)
            if all(isinstance(one, (int, float)) for one in values):
                yield node


def _joined(program: Program) -> Iterator[ast.AST]:
    """Yield the numbers that are assembled as text."""
    for call in program.calls('float', 'int'):
        if any(isinstance(one, ast.JoinedStr) for one in ast.walk(call)):
            yield call


def _truths(program: Program) -> Iterator[ast.AST]:
    """Yield the conditions that ask whether a value is empty or zero."""
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


def _early_returns(program: Program) -> Iterator[ast.AST]:
    """Yield the statements that leave a function without a value."""
    for node in program.nodes:
        if isinstance(node, ast.Return) and node.value is None:
            yield node


def _conversions(program: Program) -> Iterator[ast.AST]:
    """Yield the calculations between Celsius and Fahrenheit."""
    for node in program.nodes:
        if isinstance(node, ast.BinOp) and not isinstance(program.parents[node], ast.BinOp):
            parts = [program.number(one) for one in ast.walk(node) if isinstance(one, ast.expr)]
            if 32.0 in parts:
                yield node


def _slices(program: Program) -> Iterator[ast.AST]:
    """Yield the uses of a part of a text or a list."""
    yield from (node for node in program.nodes if isinstance(node, ast.Subscript))


def _catches_all(program: Program) -> Iterator[ast.AST]:
    """Yield the handlers that catch every exception."""
    for node in program.nodes:
        caught = getattr(node, 'type', None)
        everything = caught is None or not names_in(caught).isdisjoint(_EVERYTHING)
        if isinstance(node, ast.ExceptHandler) and everything:
            yield node


def _calls_of_callback(program: Program) -> list[ast.Call]:
    """Return the calls of functions that a timer calls too."""
    return program.calls(*(getattr(one, 'name', '') for one in program.passed('create_timer')))


def _publishing_timers(program: Program) -> Iterator[ast.AST]:
    """Yield the calls that create a timer whose callback publishes."""
    publishing = set(program.calls('publish'))
    for call in program.calls('create_timer'):
        given = (*call.args, *(one.value for one in call.keywords))
        bodies = program.reached(
            one for name in given for one in program.functions(last_name(name))
        )
        if any(not publishing.isdisjoint(ast.walk(one)) for one in bodies):
            yield call


def _named_loggers(program: Program) -> Iterator[ast.AST]:
    """Yield the calls that create a logger with a name."""
    return (one for one in program.calls('get_logger', 'getLogger') if one.args)


def _functions_named(program: Program) -> list[ast.AST]:
    """Return the functions in question, or the callbacks of the transitions in question."""
    return program.functions(*program.about, *(f'on_{name}' for name in program.about))


def _without_result(program: Program) -> Iterator[ast.AST]:
    """Yield the callbacks of transitions that return nothing."""
    for node in program.nodes:
        if isinstance(node, FUNCTIONS) and node.name.startswith('on_'):
            returns = (one for one in ast.walk(node) if isinstance(one, ast.Return))
            if not any(one.value is not None for one in returns):
                yield node


def _own_arguments(program: Program) -> Iterator[ast.AST]:
    """Yield the calls that make a node ignore its command line."""
    for node in program.nodes:
        if isinstance(node, ast.keyword) and node.arg in ('use_global_arguments', 'cli_args'):
            yield node.value
    for call in program.calls('init'):
        given = argument(call, 0, 'args')
        if isinstance(given, (ast.List, ast.Tuple, ast.Call, ast.BoolOp)):
            yield call


def _limits(program: Program) -> Iterator[ast.AST]:
    """Yield the comparisons of size."""
    for sign in (ast.Lt, ast.Gt, ast.LtE, ast.GtE):
        yield from program.operations(sign)


def _log_calls(program: Program) -> Iterator[ast.AST]:
    """Yield the log calls in question."""
    levels = ('debug', 'info', 'warn', 'warning', 'error', 'fatal')
    return (one for one in program.calls(*levels) if _covers(one, program.lines))


def _covers(node: ast.AST, lines: Collection[int]) -> bool:
    return any(line_of(node) <= one <= end_of(node) for one in lines)


ACTS: Mapping[str, Callable[[Program], Iterable[ast.AST]]] = {
    'calls_of_callback': _calls_of_callback,
    'catch_all': _catches_all,
    'compared_count': assignments.compared_counts,
    'conversion': _conversions,
    'count': assignments.counts,
    'depth': _depths,
    'early_return': _early_returns,
    'endpoint': _endpoints,
    'few_threads': _few_threads,
    'forgotten': assignments.forgotten,
    'exact': _exact_texts,
    'field': _fields,
    'joined': _joined,
    'kept_first': assignments.kept_first,
    'kept_message': assignments.kept_messages,
    'limit': _limits,
    'list': _lists,
    'log': _log_calls,
    'longer_pause': assignments.longer_pauses,
    'named_logger': _named_loggers,
    'own_arguments': _own_arguments,
    'period': _periods,
    'profile': _profiles,
    'publishing_timer': _publishing_timers,
    'recount': assignments.recounts,
    'reset': assignments.resets,
    'says': _sayings,
    'set_back': assignments.set_back,
    'short_pause': _short_pauses,
    'slow_period': _slow_periods,
    'slice': _slices,
    'stored': assignments.stored,
    'stores_time': assignments.times,
    'stuck': assignments.stuck,
    'text': _texts,
    'function': _functions_named,
    'truth': _truths,
    'use': _uses,
    'wall_clock': _wall_clocks,
    'without_result': _without_result,
    'wrapped_count': assignments.wrapped_counts,
}
"""The names of these acts, see :mod:`.acts`."""
