"""
Test whether the probe can send the messages of an exam; runs in a separate process with ROS.

    python exam_values.py PROBE_FOLDER

Standard input is a JSON list of pairs: a type, and the fields of a message or a request, or null
to test only the type.  Standard output is a JSON list with one string per pair: the reason why the
probe cannot send the pair, empty if it can.
"""

import importlib
import json
import sys
from typing import Any


def problem(kind: str, data: dict[str, Any] | None) -> str:
    """
    Return why the probe cannot send a message, empty if it can.

    :param kind: type of a message, such as ``std_msgs/msg/String``, or of a service
    :param data: fields of the message or request; None to test only the type
    """
    wire = importlib.import_module('probe_wire')
    try:
        cls = wire.load_type(kind)
    except (ImportError, AttributeError) as error:
        return f'{kind} is not installed: {error}'
    try:
        wire.fill(getattr(cls, 'Request', cls)(), data or {})
    except (AssertionError, AttributeError, TypeError, ValueError, OverflowError) as error:
        return f'{kind} cannot hold this: {error}'
    return ''


if __name__ == '__main__':
    sys.path.insert(0, sys.argv[1])
    json.dump([problem(*pair) for pair in json.load(sys.stdin)], sys.stdout)
