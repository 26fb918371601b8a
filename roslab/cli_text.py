"""
Format facts as ROS 2's command line tools print them.

These functions need no node, session or terminal.  ``echo``, ``hz``, ``info`` and ``topics`` in
notebooks, and the commands of :mod:`roslab.ros2`, print what these functions return.
"""

from collections.abc import Iterable, Mapping, Sequence
from itertools import pairwise
import math
from typing import Any, NamedTuple

import yaml

NamesAndTypes = Iterable[tuple[str, Sequence[str]]]

TRUNCATE_AT = 128
"""``ros2 topic echo`` truncates longer strings and arrays, unless an option changes this."""

_WIDEST = 2**31 - 1
_SECTIONS = (
    'Subscribers',
    'Publishers',
    'Service Servers',
    'Service Clients',
    'Action Servers',
    'Action Clients',
)


class Shorten(NamedTuple):
    """
    Settings for shortening values; the defaults are those of ``ros2 topic echo``.

    :param truncate: longest string or array to write in full, None for no limit
    :param no_arr: write only the type and length of arrays
    :param no_str: write only the length of strings
    """

    truncate: int | None = TRUNCATE_AT
    no_arr: bool = False
    no_str: bool = False


AS_ECHO, COMPLETE = Shorten(), Shorten(None)


def message_yaml(message: Any, shorten: Shorten = AS_ECHO) -> str:
    """Return a message as YAML, with a line break at the end."""
    return to_yaml(message_dict(message, shorten))


def field_text(
    value: Any, field_type: str, shorten: Shorten = AS_ECHO, *, flow: bool = False
) -> str:
    """
    Return the value of one field as ``ros2 topic echo --field`` prints it, with a line break.

    :param field_type: its type as in ``get_fields_and_field_types``, needed for ``no_arr``
    """
    plain = _plain(value, field_type, shorten)
    return to_yaml(plain, flow) if isinstance(plain, dict) else f'{plain}\n'


def echo_text(message: Any) -> str:
    """Return what ``ros2 topic echo`` prints for one message."""
    return f'{message_yaml(message)}---'


def message_dict(message: Any, shorten: Shorten = COMPLETE) -> dict[str, Any]:
    """Return a message as a dictionary of plain values, in the order of its definition."""
    return {
        name: _plain(getattr(message, name), kind, shorten)
        for name, kind in message.get_fields_and_field_types().items()
    }


def _plain(value: Any, field_type: str, shorten: Shorten) -> Any:
    """Return a field's value as a type that YAML can represent."""
    if isinstance(value, bytes):
        value = value.decode('latin-1')
    if isinstance(value, str):
        return _text(value, shorten)
    if hasattr(value, 'get_fields_and_field_types'):
        return message_dict(value, shorten)
    if hasattr(value, 'item') and not hasattr(value, '__len__'):
        return value.item()  # a single NumPy number
    return _sequence(value, field_type, shorten) if hasattr(value, '__len__') else value


def _text(value: str, shorten: Shorten) -> str:
    if shorten.no_str:
        return f'<string length: <{len(value)}>>'
    if shorten.truncate is not None and len(value) > shorten.truncate:
        return f'{value[: shorten.truncate]}...'
    return value


def _sequence(value: Any, field_type: str, shorten: Shorten) -> Any:
    if shorten.no_arr:
        form = 'sequence' if field_type.startswith('sequence<') else 'array'
        return f'<{form} type: {item_type(field_type)}, length: {len(value)}>'
    cut = shorten.truncate is not None and len(value) > shorten.truncate
    items = [_plain(item, '', shorten) for item in value[: shorten.truncate]]
    return items + ['...'] if cut else items


def item_type(field_type: str) -> str:
    """Return the type of an array's items, and any other type unchanged."""
    return field_type.split('[')[0].removeprefix('sequence<').split(',')[0].rstrip('>')


class _Dumper(yaml.SafeDumper):
    """A YAML dumper that writes repeated objects in full instead of referring to the first one."""

    def ignore_aliases(self, data: Any) -> bool:
        """Prevent PyYAML from writing anchors."""
        return True


def to_yaml(data: Any, flow: bool = False) -> str:
    """Return plain values as YAML, in their order."""
    how = {'allow_unicode': True, 'width': _WIDEST, 'sort_keys': False}
    return str(yaml.dump(data, Dumper=_Dumper, default_flow_style=flow, **how))


def topic_list_text(topics: NamesAndTypes, types: bool = False) -> str:
    """Return what ``ros2 topic list`` prints, with types as ``-t`` does if they are requested."""
    return '\n'.join(
        f'{name} [{", ".join(kinds)}]' if types else name for name, kinds in sorted(topics)
    )


def topic_info_text(
    types: Sequence[str],
    publishers: Sequence[Any],
    subscriptions: Sequence[Any],
    verbose: bool = True,
) -> str:
    """
    Return what ``ros2 topic info`` prints.

    :param types: types of the topic; more than one type, which is a mistake, is shown as a list
    :param publishers: rclpy's ``TopicEndpointInfo``, whose ``str()`` is printed
    """
    blocks = [
        f'Type: {types[0] if len(types) == 1 else list(types)}',
        f'Publisher count: {len(publishers)}',
        *(str(info) for info in publishers if verbose),
        f'Subscription count: {len(subscriptions)}',
        *(str(info) for info in subscriptions if verbose),
    ]
    return ('\n\n' if verbose else '\n').join(blocks)


def node_info_text(name: str, entities: Mapping[str, NamesAndTypes]) -> str:
    """
    Return what ``ros2 node info`` prints.

    :param name: full name of the node
    :param entities: names and types by section: 'Subscribers', 'Publishers', 'Service Servers',
        'Service Clients', 'Action Servers', 'Action Clients'; a missing section is empty
    """
    lines = [name]
    for section in _SECTIONS:
        lines.append(f'  {section}:')
        found = sorted(entities.get(section, ()))
        lines.extend(f'    {entity}: {", ".join(types)}' for entity, types in found)
        if not found:
            lines.append('')
    return '\n'.join(lines)


def hz_text(times: Sequence[float]) -> str:
    """Return what ``ros2 topic hz`` prints for the arrival times of two or more messages [s]."""
    gaps = [later - earlier for earlier, later in pairwise(times)]
    mean = sum(gaps) / len(gaps)
    deviation = math.sqrt(sum((gap - mean) ** 2 for gap in gaps) / len(gaps))
    return (
        f'average rate: {1.0 / mean if mean > 0 else 0.0:.3f}\n'
        f'\tmin: {min(gaps):.3f}s max: {max(gaps):.3f}s '
        f'std dev: {deviation:.5f}s window: {len(gaps)}'
    )
