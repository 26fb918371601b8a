"""Fill messages with values given as YAML."""

from __future__ import annotations

import array
from collections.abc import Mapping
from typing import Any

import yaml

from roslab.ros2.interface_files import interface_class


def parsed(text: str) -> dict[str, Any]:
    """
    Parse YAML text into a dictionary of values.

    :raises RuntimeError: if the text is not YAML, or not a mapping
    """
    try:
        values = yaml.safe_load(text)
    except yaml.YAMLError as error:
        raise RuntimeError(f'The passed value is no YAML: {error}') from None
    if values is None or values == '':
        return {}
    if not isinstance(values, dict):
        raise RuntimeError('The passed value needs to be a dictionary in YAML format')
    return values


def fill(message: Any, values: Mapping[str, Any], now: Any = None) -> None:
    """
    Set fields of a message from a dictionary.

    :param message: the message to change
    :param values: values by field name; a nested message is a nested mapping
    :param now: the time as a message, for ``stamp: now`` and ``header: auto``
    :raises AttributeError: if a field does not exist
    :raises TypeError, ValueError, AssertionError: if a value does not fit its field
    """
    kinds = message.get_fields_and_field_types()
    for name, value in values.items():
        old = getattr(message, name)
        if now is not None and value == 'now' and kinds[name] == 'builtin_interfaces/Time':
            setattr(message, name, now)
        elif now is not None and value == 'auto' and kinds[name] == 'std_msgs/Header':
            old.stamp = now
        elif hasattr(old, 'get_fields_and_field_types'):
            fill(old, value or {}, now)
        else:
            setattr(message, name, _converted(old, value, kinds[name], now))


def _converted(old: Any, value: Any, kind: str, now: Any) -> Any:
    """Return a value converted to the type of its field."""
    item = kind.removeprefix('sequence<').split('[')[0].split(',')[0].rstrip('>')
    if isinstance(old, list):
        if '/' in item:
            return [_message(item, one, now) for one in value]
        return [_single(one, item) for one in value]
    if isinstance(old, array.array):
        return array.array(old.typecode, value)
    if hasattr(old, 'dtype'):
        import numpy

        return numpy.array(value, dtype=old.dtype)
    if isinstance(old, bytes):
        return bytes([value]) if isinstance(value, int) else str(value).encode('latin-1')
    return type(old)(value)


def _single(value: Any, kind: str) -> Any:
    if kind in ('boolean', 'bool'):
        return bool(value)
    if kind == 'octet':
        return bytes([value])
    return str(value)


def _message(kind: str, value: Mapping[str, Any], now: Any) -> Any:
    message = interface_class(kind)()
    fill(message, value, now)
    return message
