"""Quality of service as ``ros2 bag`` stores it: YAML, one profile per publisher."""

from collections.abc import Iterable
from typing import Any

from rclpy.duration import Duration
from rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    LivelinessPolicy,
    QoSProfile,
    ReliabilityPolicy,
)
import yaml

_POLICIES = {
    'reliability': ReliabilityPolicy,
    'durability': DurabilityPolicy,
    'liveliness': LivelinessPolicy,
}
_PERIODS = ('deadline', 'lifespan', 'liveliness_lease_duration')
_NS = 10**9
_ENDLESS_S = 2**31 - 1
"""Periods of this length or longer mean no limit; older ROS 2 releases stored exactly this."""
_DEPTH = 10
"""Depth for publishers whose depth is unknown, because the network does not announce it."""


def plain_profiles(profiles: Iterable[QoSProfile]) -> list[dict[str, Any]]:
    """Return profiles as plain values for YAML, in the order that ``ros2 bag`` uses."""
    return [
        {
            'history': qos.history.short_key,
            'depth': qos.depth,
            'reliability': qos.reliability.short_key,
            'durability': qos.durability.short_key,
            'deadline': _parts(qos.deadline),
            'lifespan': _parts(qos.lifespan),
            'liveliness': qos.liveliness.short_key,
            'liveliness_lease_duration': _parts(qos.liveliness_lease_duration),
            'avoid_ros_namespace_conventions': False,
        }
        for qos in profiles
    ]


def profile_to_offer(stored: list[dict[str, Any]]) -> QoSProfile:
    """
    Return the profile with which a recorded topic is published again.

    :param stored: plain values from :func:`plain_profiles`, or from another recorder
    :returns: the recorded profile, or rclpy's default if the publishers offered different ones
    :raises ValueError: if a value is unknown
    """
    if not stored or any(one != stored[0] for one in stored):
        return QoSProfile(depth=_DEPTH)
    values = stored[0]
    try:
        history = _policy(HistoryPolicy, values['history'])
        known = history in (HistoryPolicy.KEEP_LAST, HistoryPolicy.KEEP_ALL)
        return QoSProfile(
            history=history if known else HistoryPolicy.KEEP_LAST,
            depth=values['depth'] or _DEPTH,
            **{name: _policy(kind, values[name]) for name, kind in _POLICIES.items()},
            **{
                name: Duration(nanoseconds=values[name]['sec'] * _NS + values[name]['nsec'])
                for name in _PERIODS
                if values[name]['sec'] < _ENDLESS_S
            },
        )
    except (KeyError, TypeError, AttributeError) as error:
        raise ValueError(f'unknown quality of service: {error}') from None


def read_profiles(text: str) -> list[dict[str, Any]]:
    """Return the profiles in YAML text, which may be empty; ValueError if it is not a list."""
    try:
        stored = yaml.safe_load(text) or []
    except yaml.YAMLError as error:
        raise ValueError(f'the stored QoS profiles are not valid YAML: {error}') from None
    if not isinstance(stored, list):
        raise ValueError('the stored QoS profiles are not a list')
    return stored


def _parts(period: Duration) -> dict[str, int]:
    seconds, nanoseconds = divmod(period.nanoseconds, _NS)
    return {'sec': seconds, 'nsec': nanoseconds}


def _policy(kind: Any, value: str | int) -> Any:
    """Return a policy from its name, or from its number, which releases before Jazzy stored."""
    return kind(value) if isinstance(value, int) else kind.get_from_short_key(value)
