"""
Convert messages, service requests and QoS profiles between JSON and ROS, for the probe.

This file imports nothing from this project.
"""

import importlib
import math
import re
from typing import Any

from rclpy.duration import Duration
from rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    LivelinessPolicy,
    qos_policy_name_from_kind,
    QoSProfile,
    ReliabilityPolicy,
)

_SEQUENCE = re.compile(r'^(?:sequence<(?P<item>[\w/]+)(?:, \d+)?>|(?P<fixed>[\w/]+)\[\d+\])$')


def load_type(name: str) -> Any:
    """Return the class of an interface type such as ``std_msgs/msg/String``."""
    package, kind, cls = name.split('/')
    return getattr(importlib.import_module(f'{package}.{kind}'), cls)


def to_json(value: Any) -> Any:
    """Convert a message to JSON types; non-finite floats become 'nan', 'inf' and '-inf'."""
    if hasattr(value, 'get_fields_and_field_types'):
        return {name: to_json(getattr(value, name)) for name in value.get_fields_and_field_types()}
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    if isinstance(value, (bytes, bytearray)):
        return list(value)
    if isinstance(value, (str, bool, int, float)):
        return value
    return [to_json(item) for item in value]


def fill(message: Any, data: dict[str, Any]) -> Any:
    """Set a message's fields from JSON types and return the message."""
    types = message.get_fields_and_field_types()
    for name, value in data.items():
        current = getattr(message, name)
        if hasattr(current, 'get_fields_and_field_types'):
            fill(current, value)
        elif match := _SEQUENCE.match(types[name]):
            setattr(message, name, [_item(match['item'] or match['fixed'], one) for one in value])
        else:
            setattr(message, name, float(value) if isinstance(current, float) else value)
    return message


def _item(type_name: str, value: Any) -> Any:
    """Convert one element of a sequence from JSON types."""
    if '/' in type_name:
        return fill(load_type(type_name.replace('/', '/msg/'))(), value)
    return float(value) if type_name in ('float', 'double') else value


def qos_json(profile: QoSProfile) -> dict[str, Any]:
    """Return the QoS policies that discovery transmits; durations that are not set are None."""
    periods = {}
    for name in ('deadline', 'lifespan', 'liveliness_lease_duration'):
        nanoseconds = getattr(profile, name).nanoseconds
        periods[f'{name}_ns'] = nanoseconds if 0 < nanoseconds < 2**62 else None
    return {
        'reliability': profile.reliability.name,
        'durability': profile.durability.name,
        'liveliness': profile.liveliness.name,
        **periods,
    }


def qos_profile(data: dict[str, Any]) -> QoSProfile:
    """Return the QoS profile that a scenario describes; a depth of 0 means KEEP_ALL."""
    periods = {
        'deadline': data['deadline_s'],
        'lifespan': data['lifespan_s'],
        'liveliness_lease_duration': data['lease_s'],
    }
    return QoSProfile(
        history=HistoryPolicy.KEEP_LAST if data['depth'] else HistoryPolicy.KEEP_ALL,
        depth=data['depth'],
        reliability=ReliabilityPolicy[data['reliability']],
        durability=DurabilityPolicy[data['durability']],
        liveliness=LivelinessPolicy[data['liveliness']],
        **{name: Duration(seconds=s) for name, s in periods.items() if s is not None},
    )


def policy_name(status: Any) -> str:
    """Return the name of the policy that caused an incompatible-QoS event."""
    return str(qos_policy_name_from_kind(status.last_policy_kind)).removesuffix('_QOS_POLICY')
