"""
Read one message field, given by a path such as ``temperature``, ``header.stamp.sec``, ``data[0]``.

The path is checked against the message definition before the first message arrives, so a wrong
path is reported at once, with the fields that exist.
"""

from __future__ import annotations

from collections.abc import Callable
import re
from typing import Any

from roslab.errors import NotHereError, RoslabError
from roslab.lookup import message_class

_STEP = re.compile(r'([A-Za-z_]\w*)((?:\[\d+\])*)')
_LIST = re.compile(r'(?:sequence<(?P<item>[^,>]+)(?:, *\d+)?>|(?P<fixed>[^\[\]]+)\[\d+\])')
_NUMBERS = re.compile(r'(?:u?int(?:8|16|32|64)|float|double|boolean|octet|char)')
_MOST_NAMED = 12
_DEEPEST = 4


def numeric_fields(msg_type: Any) -> list[str]:
    """
    Return the paths of all numeric fields of a message, with ``[0]`` for the items of arrays.

    :param msg_type: class of the message
    """
    return _numeric(msg_type, '', _DEEPEST)


def _numeric(msg_type: Any, prefix: str, depth: int) -> list[str]:
    found = []
    for name, kind in msg_type.get_fields_and_field_types().items():
        path = f'{prefix}{name}'
        item = _item_type(kind)
        if item is not None:
            path, kind = f'{path}[0]', item
        if _NUMBERS.fullmatch(kind):
            found.append(path)
        elif '/' in kind and depth > 1:
            try:
                inner = _class_of(kind)
            except NotHereError:
                continue
            found.extend(_numeric(inner, f'{path}.', depth - 1))
    return found


def number_getter(msg_type: Any, path: str) -> Callable[[Any], float | None]:
    """
    Return a function that reads a numeric field from a message.

    :param msg_type: class of the messages
    :param path: field names joined by dots, array indices in brackets
    :returns: the function, which returns None if an array is too short
    :raises RoslabError: if the field does not exist or is not numeric
    """
    steps: list[str | int] = []
    here: Any = msg_type
    kind = ''
    for part in path.split('.'):
        step = _STEP.fullmatch(part.strip())
        fields = here.get_fields_and_field_types() if here is not None else {}
        if step is None or step[1] not in fields:
            raise _no_field(msg_type, path)
        steps.append(step[1])
        kind = fields[step[1]]
        for index in re.findall(r'\d+', step[2]):
            item = _item_type(kind)
            if item is None:
                raise _no_field(msg_type, path)
            steps.append(int(index))
            kind = item
        here = _class_of(kind) if '/' in kind and _item_type(kind) is None else None
    if not _NUMBERS.fullmatch(kind):
        raise _no_number(msg_type, path, kind)
    return lambda message: _value(message, steps)


def _value(message: Any, steps: list[str | int]) -> float | None:
    value = message
    for step in steps:
        if isinstance(step, str):
            value = getattr(value, step)
        elif step < len(value):
            value = value[step]
        else:
            return None
    return float(value[0]) if isinstance(value, bytes) else float(value)


def _item_type(kind: str) -> str | None:
    """Return the type of an array's items, or None if the type is not an array."""
    match = _LIST.fullmatch(kind)
    return (match['item'] or match['fixed']) if match else None


def _class_of(kind: str) -> Any:
    """Return the message class for a field type ``package/Name``."""
    package, _, name = kind.partition('/')
    return message_class(f'{package}/msg/{name.split("/")[-1]}')


def _no_field(msg_type: Any, path: str) -> RoslabError:
    return RoslabError(f'{msg_type.__name__} has no field {path!r}. {_offer(msg_type)}')


def _no_number(msg_type: Any, path: str, kind: str) -> RoslabError:
    item = _item_type(kind)
    if item is not None and _NUMBERS.fullmatch(item):
        return RoslabError(
            f'The field {path!r} of {msg_type.__name__} is an array, {kind}. '
            f'Name one of its items, as in {path + "[0]"!r}.'
        )
    return RoslabError(
        f'The field {path!r} of {msg_type.__name__} is not a number but {kind}. {_offer(msg_type)}'
    )


def _offer(msg_type: Any) -> str:
    """Return a sentence that lists the numeric fields of a message."""
    found = numeric_fields(msg_type)
    if not found:
        every = ', '.join(msg_type.get_fields_and_field_types()) or 'none'
        return f'It has no numeric field; its fields: {every}.'
    more = f' and {len(found) - _MOST_NAMED} more' if len(found) > _MOST_NAMED else ''
    return f'Numeric fields: {", ".join(found[:_MOST_NAMED])}{more}.'
