"""
Describe a bag as ``ros2 bag info`` and ``metadata.yaml`` do.

Quality of service is stored as YAML, one profile per publisher.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
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

_NS = 10**9
_VERSION = 9
"""Version of metadata.yaml that ROS 2 Jazzy writes."""
_POLICIES = {
    'reliability': ReliabilityPolicy,
    'durability': DurabilityPolicy,
    'liveliness': LivelinessPolicy,
}
_PERIODS = ('deadline', 'lifespan', 'liveliness_lease_duration')
_ENDLESS_S = 2**31 - 1
"""Periods of this length or longer mean no limit; older ROS 2 releases stored exactly this."""
_DEPTH = 10
"""Depth for publishers whose depth is unknown, because the network does not announce it."""


@dataclass(frozen=True)
class BagTopic:
    """
    A recorded topic.

    :param profiles: quality of service of its publishers, see :func:`plain_profiles`
    :param hash: hash of the type, '' if unknown
    """

    name: str
    type: str
    profiles: Sequence[dict[str, Any]]
    hash: str
    count: int


@dataclass(frozen=True)
class Bag:
    """
    The summary of a bag.

    :param path: the file, or the folder that ``ros2 bag record`` has written
    :param start_ns: when the first message was received [ns since 1970]
    :param end_ns: when the last message was received [ns since 1970]
    :param distro: ROS 2 release of the recorder, '' if unknown
    """

    path: Path
    files: tuple[Path, ...]
    topics: tuple[BagTopic, ...]
    start_ns: int
    end_ns: int
    distro: str

    @property
    def count(self) -> int:
        """Number of messages."""
        return sum(topic.count for topic in self.topics)

    @property
    def seconds(self) -> float:
        """Time between the first and the last message [s]."""
        return (self.end_ns - self.start_ns) / _NS

    def metadata(self) -> dict[str, Any]:
        """Return the values of ``metadata.yaml``, in its order."""
        span = {
            'duration': {'nanoseconds': self.end_ns - self.start_ns},
            'starting_time': {'nanoseconds_since_epoch': self.start_ns},
            'message_count': self.count,
        }
        return {
            'version': _VERSION,
            'storage_identifier': 'mcap',
            **span,
            'topics_with_message_count': [_plain(topic) for topic in self.topics],
            'compression_format': '',
            'compression_mode': '',
            'relative_file_paths': [file.name for file in self.files],
            'files': [{'path': file.name, **span} for file in self.files],
            'custom_data': None,
            'ros_distro': self.distro,
        }

    def __repr__(self) -> str:
        pad = f'\n{" " * 19}'
        topics = pad.join(
            f'Topic: {topic.name} | Type: {topic.type} | Count: {topic.count} | '
            'Serialization Format: cdr'
            for topic in self.topics
        )
        return (
            f'Files:             {pad.join(file.name for file in self.files)}\n'
            f'Bag size:          {_size(sum(file.stat().st_size for file in self.files))}\n'
            'Storage id:        mcap\n'
            f'ROS Distro:        {self.distro or "unknown"}\n'
            f'Duration:          {_seconds(self.end_ns - self.start_ns)}s\n'
            f'Start:             {_moment(self.start_ns)}\n'
            f'End:               {_moment(self.end_ns)}\n'
            f'Messages:          {self.count}\n'
            f'Topic information: {topics}'
        )


def _plain(topic: BagTopic) -> dict[str, Any]:
    return {
        'topic_metadata': {
            'name': topic.name,
            'type': topic.type,
            'serialization_format': 'cdr',
            'offered_qos_profiles': list(topic.profiles),
            'type_description_hash': topic.hash,
        },
        'message_count': topic.count,
    }


def _size(count: int) -> str:
    power = min(max(count.bit_length() - 1, 0) // 10, 4)
    return f'{count / 1024**power:.{min(power, 1)}f} {("B", "KiB", "MiB", "GiB", "TiB")[power]}'


def _seconds(nanoseconds: int) -> str:
    return f'{nanoseconds // _NS}.{nanoseconds % _NS:09}'


def _moment(nanoseconds: int) -> str:
    there = datetime.fromtimestamp(nanoseconds // _NS)
    date = f'{there:%b} {there.day:2} {there:%Y %H:%M:%S}.{nanoseconds % _NS:09}'
    return f'{date} ({_seconds(nanoseconds)})'


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
