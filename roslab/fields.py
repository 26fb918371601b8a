"""
Read one message field, given by a path such as ``temperature``, ``header.stamp.sec``, ``data[0]``.

The path is checked against the message definition before the first message arrives, so a wrong
path is reported at once, with the fields that exist.
"""

from collections.abc import Callable, Iterator
import re
from typing import Any

from rosidl_parser.definition import AbstractNestedType, BasicType, NamespacedType

from roslab.cli_text import item_type
from roslab.errors import NotHereError, RoslabError
from roslab.lookup import message_class

_STEP = re.compile(r'([A-Za-z_]\w*)((?:\[\d+\])*)')
_MOST_NAMED = 12
_DEEPEST = 4


def numeric_fields(msg_type: Any) -> list[str]:
    """Return the paths of all numeric fields of a message; arrays appear with index ``[0]``."""
    return list(_numeric(msg_type, '', _DEEPEST))


def _types(msg_type: Any) -> dict[str, Any]:
    """Return the types of the fields by name, in the order of the definition."""
    return dict(zip(msg_type.get_fields_and_field_types(), msg_type.SLOT_TYPES))


def _numeric(msg_type: Any, prefix: str, depth: int) -> Iterator[str]:
    for name, kind in _types(msg_type).items():
        path = f'{prefix}{name}'
        if isinstance(kind, AbstractNestedType):
            path, kind = f'{path}[0]', kind.value_type
        if isinstance(kind, BasicType):
            yield path
        elif isinstance(kind, NamespacedType) and depth > 1:
            try:
                inner = _class_of(kind)
            except NotHereError:
                continue
            yield from _numeric(inner, f'{path}.', depth - 1)


def number_getter(msg_type: Any, path: str) -> Callable[[Any], float | None]:
    """
    Return a function that reads a numeric field from a message.

    :param path: field names joined by dots, array indices in brackets
    :returns: the function, which returns None if an array is too short
    :raises RoslabError: if the field does not exist or is not numeric
    """
    steps: list[str | int] = []
    missing = RoslabError(f'{msg_type.__name__} has no field {path!r}. {_offer(msg_type)}')
    fields, kind, said = msg_type, None, ''
    for part in path.split('.'):
        step = _STEP.fullmatch(part.strip())
        if step is None or fields is None or step[1] not in _types(fields):
            raise missing
        kind, said = _types(fields)[step[1]], fields.get_fields_and_field_types()[step[1]]
        steps.append(step[1])
        for index in re.findall(r'\d+', step[2]):
            if not isinstance(kind, AbstractNestedType):
                raise missing
            steps.append(int(index))
            kind, said = kind.value_type, item_type(said)
        fields = _class_of(kind) if isinstance(kind, NamespacedType) else None
    if not isinstance(kind, BasicType):
        raise _no_number(msg_type, path, kind, said)
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


def _class_of(kind: NamespacedType) -> Any:
    return message_class('/'.join([*kind.namespaces, kind.name]))


def _no_number(msg_type: Any, path: str, kind: Any, said: str) -> RoslabError:
    """Return the error for a field that is not numeric; ``said`` describes its type."""
    field = f'The field {path!r} of {msg_type.__name__} is'
    if isinstance(kind, AbstractNestedType) and isinstance(kind.value_type, BasicType):
        item = f'{path}[0]'
        return RoslabError(f'{field} an array, {said}. Name one of its items, as in {item!r}.')
    return RoslabError(f'{field} not a number but {said}. {_offer(msg_type)}')


def _offer(msg_type: Any) -> str:
    """Return a sentence that lists the numeric fields of a message."""
    found = numeric_fields(msg_type)
    if not found:
        every = ', '.join(msg_type.get_fields_and_field_types()) or 'none'
        return f'It has no numeric field; its fields: {every}.'
    more = f' and {len(found) - _MOST_NAMED} more' if len(found) > _MOST_NAMED else ''
    return f'Numeric fields: {", ".join(found[:_MOST_NAMED])}{more}.'
