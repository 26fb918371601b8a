"""The definition of a message type as a bag stores it, so that readers need no ROS."""

from __future__ import annotations

import json

from roslab.ros2.interface import parts_of
from roslab.ros2.interface_files import interface_file

_SEPARATOR = '=' * 80


def definition_of(name: str) -> str:
    """
    Return the text of a message type, followed by those of all its parts.

    :raises LookupError: if a package or a type is not installed
    """
    texts: dict[str, str] = {}
    waiting = [name]
    while waiting:
        one = waiting.pop(0)
        if one not in texts:
            texts[one] = interface_file(one).read_text(encoding='utf-8')
            waiting += parts_of(one)
    own = texts.pop(name)
    parts = (
        f'{_SEPARATOR}\nMSG: {part.replace("/msg/", "/")}\n{text}' for part, text in texts.items()
    )
    return '\n'.join([own, *parts])


def hash_of(name: str) -> str:
    """
    Return the hash of a message type, which changes with its fields but not with its comments.

    :returns: such as ``RIHS01_df66...``, or ``''`` if the package was built without it
    :raises LookupError: if the type is not installed
    """
    file = interface_file(name).with_suffix('.json')
    if not file.is_file():
        return ''
    hashes = json.loads(file.read_text(encoding='utf-8'))['type_hashes']
    return next((one['hash_string'] for one in hashes if one['type_name'] == name), '')
