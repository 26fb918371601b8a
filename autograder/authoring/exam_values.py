"""
Compare what an exam sends with the definitions of its messages: field names and values.

The definitions are read as text from the installed ROS packages, so no ROS module is imported.  A
value is refused if the probe could not send it: the probe would fail in the middle of a run, or
send a different value.  A string such as ``'nan'`` is a float, as in a recording.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from difflib import get_close_matches
from functools import lru_cache
import math
from pathlib import Path
import re
from typing import Any

_FIELD = re.compile(
    r'(?P<base>[\w/]+)(?:<=(?P<longest>\d+))?(?:\[(?P<most><=)?(?P<size>\d*)\])?\s+(?P<name>\w+)'
    r'(?P<constant>\s*=)?'
)
_WHOLE = re.compile(r'(u?)int(8|16|32|64)')
_LARGEST_FLOAT32 = 3.402823466e38
_LONGEST_SHOWN = 60


def value_mistakes(kind: str, data: Mapping[str, Any], prefixes: Sequence[Path]) -> Iterator[str]:
    """
    Yield the values that a message cannot hold, one line per field.

    :param kind: a type such as ``std_msgs/msg/String``, or that of a service
    :param data: fields of a message, or of the service's request
    :param prefixes: where ROS packages are installed, as in ``AMENT_PREFIX_PATH``
    """
    yield from _in_message(kind, data, tuple(prefixes), '')


def _in_message(kind: str, data: object, prefixes: tuple[Path, ...], place: str) -> Iterator[str]:
    fields = fields_of(kind, prefixes)
    if fields is None:
        return  # not installed: another check reports the missing type
    if not isinstance(data, Mapping):
        yield _wrong(f'the fields of {kind} by name', place, data)
        return
    for name, value in data.items():
        if name not in fields:
            close = get_close_matches(str(name), fields, n=1, cutoff=0.6)
            hint = f'; did you mean {close[0]!r}?' if close else ''
            where = f' in {place}' if place else ''
            yield f'expected a field of {kind}{where}, got {name!r}{hint}'
        else:
            where = f'{place}.{name}' if place else str(name)
            yield from _in_field(fields[name], value, prefixes, where)


def _in_field(
    field: re.Match[str], value: Any, prefixes: tuple[Path, ...], place: str
) -> Iterator[str]:
    """Yield what is wrong with the value of one field, which may be an array."""
    if field['size'] is None:
        yield from _in_element(field, value, prefixes, place)
        return
    size = int(field['size'] or 0)
    most = 'at most ' if field['most'] else ''
    wanted = f'a list of {most}{size} values' if size else 'a list'
    if not isinstance(value, (list, tuple)):
        yield _wrong(wanted, place, value)
    elif size and (len(value) > size if most else len(value) != size):
        yield f'expected {wanted} for {place}, got {len(value)}'
    else:
        for index, one in enumerate(value):
            yield from _in_element(field, one, prefixes, f'{place}[{index}]')


def _in_element(
    field: re.Match[str], value: Any, prefixes: tuple[Path, ...], place: str
) -> Iterator[str]:
    base = field['base']
    if '/' in base:
        yield from _in_message(base, value, prefixes, place)
    elif wanted := _unlike(base, field['longest'], value):
        yield _wrong(wanted, place, value)


def _unlike(base: str, longest: str | None, value: Any) -> str:
    """Return what a primitive type holds, or an empty string if the value fits."""
    is_bool = isinstance(value, bool)
    if whole := _WHOLE.fullmatch('uint8' if base == 'char' else base):
        bits = int(whole[2])
        low, high = (0, 2**bits - 1) if whole[1] else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)
        right = isinstance(value, int) and not is_bool and low <= value <= high
        return '' if right else f'a whole number from {low} to {high}'
    if base in ('float32', 'float64'):
        largest = _LARGEST_FLOAT32 if base == 'float32' else math.inf
        if is_bool or not isinstance(value, (int, float, str)):
            return 'a number'
        try:
            number = float(value)
        except (ValueError, OverflowError):
            return 'a number'
        return '' if abs(number) <= largest or not math.isfinite(number) else 'a float32'
    if base in ('string', 'wstring'):
        most = int(longest) if longest else math.inf
        right = isinstance(value, str) and len(value) <= most
        return '' if right else f'a string of at most {most} characters' if longest else 'a text'
    if base == 'bool':
        return '' if is_bool else 'True or False'
    # The probe gets its inputs as JSON, which has no bytes.
    return 'no value, because a byte cannot be sent' if base == 'byte' else ''


def _wrong(wanted: str, place: str, value: object) -> str:
    shown = repr(value)
    if len(shown) > _LONGEST_SHOWN:
        shown = f'{shown[:_LONGEST_SHOWN]}…'
    return f'expected {wanted}{f" for {place}" if place else ""}, got {shown}'


@lru_cache(maxsize=256)
def fields_of(kind: str, prefixes: tuple[Path, ...]) -> Mapping[str, re.Match[str]] | None:
    """
    Return the fields of a message, or of a service's request, without constants.

    :param kind: such as ``std_msgs/msg/String``, or ``std_msgs/String`` as in a definition
    :returns: by name, the parts of the line; None if the definition is not installed
    """
    package, _, rest = kind.partition('/')
    part = 'srv' if '/srv/' in kind else 'msg'
    for prefix in prefixes:
        path = prefix / 'share' / package / part / f'{rest.rpartition("/")[2]}.{part}'
        if path.is_file():
            request = re.split(r'^---', path.read_text('utf-8'), maxsplit=1, flags=re.MULTILINE)
            matches = (
                _FIELD.match(line.partition('#')[0].strip()) for line in request[0].splitlines()
            )
            return {
                found['name']: _FIELD.match(f'{package}/{found[0]}') or found
                if found['base'][0].isupper()  # defined in the same package
                else found
                for found in matches
                if found and not found['constant']
            }
    return None
