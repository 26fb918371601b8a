"""Define the ``--qos-*`` options, and find a QoS profile compatible with existing publishers."""

from __future__ import annotations

import argparse

from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    LivelinessPolicy,
    QoSPresetProfiles,
    QoSProfile,
    ReliabilityPolicy,
)

_POLICIES = {
    'history': HistoryPolicy,
    'reliability': ReliabilityPolicy,
    'durability': DurabilityPolicy,
    'liveliness': LivelinessPolicy,
}


def add_qos_arguments(parser: argparse.ArgumentParser, entity: str, profile: str) -> None:
    """
    Add the options.

    :param entity: purpose of the profile, for the help: 'publish' or 'subscribe'
    :param profile: name of the default profile
    """
    parser.add_argument(
        '--qos-profile',
        choices=QoSPresetProfiles.short_keys(),
        help=f'Quality of service preset profile to {entity} with (default: {profile})',
    )
    parser.add_argument(
        '--qos-depth', metavar='N', type=int, help='Queue size (overrides that of the profile)'
    )
    for name, policy in _POLICIES.items():
        parser.add_argument(
            f'--qos-{name}',
            choices=policy.short_keys(),
            help=f'Quality of service {name} setting (overrides that of the profile)',
        )
    parser.add_argument(
        '--qos-liveliness-lease-duration-seconds',
        type=float,
        metavar='S',
        help='Quality of service liveliness lease duration [s]',
    )


def qos_asked_for(args: argparse.Namespace, profile: str) -> QoSProfile | None:
    """
    Return the QoS profile given by the options, None if there are no such options.

    :param profile: name of the profile that the options change
    """
    wishes = {
        name: policy.get_from_short_key(value)
        for name, policy in _POLICIES.items()
        if (value := getattr(args, f'qos_{name}')) is not None
    }
    if args.qos_depth is not None:
        wishes['depth'] = args.qos_depth
    if args.qos_liveliness_lease_duration_seconds is not None:
        lease = Duration(seconds=args.qos_liveliness_lease_duration_seconds)
        wishes['liveliness_lease_duration'] = lease
    if not wishes and args.qos_profile is None:
        return None
    qos = preset(args.qos_profile or profile)
    for name, value in wishes.items():
        setattr(qos, name, value)
    return qos


def preset(name: str) -> QoSProfile:
    """Return a copy of a preset profile, which the caller may change."""
    profile = QoSPresetProfiles.get_from_short_key(name)
    return QoSProfile(**{key[1:]: getattr(profile, key[1:]) for key in QoSProfile.__slots__})


def qos_for_publishers(node: Node, topic: str) -> QoSProfile:
    """
    Return a QoS profile that is compatible with every existing publisher.

    It requests the stronger policy only if all publishers offer it, and prints a note if only some
    do.
    """
    qos = preset('sensor_data')
    publishers = [info.qos_profile for info in node.get_publishers_info_by_topic(topic)]
    strong: tuple[tuple[str, ReliabilityPolicy | DurabilityPolicy, str], ...] = (
        ('reliability', ReliabilityPolicy.RELIABLE, 'BEST_EFFORT'),
        ('durability', DurabilityPolicy.TRANSIENT_LOCAL, 'VOLATILE'),
    )
    for name, policy, weak in strong:
        offers = [getattr(profile, name) == policy for profile in publishers]
        if offers and all(offers):
            setattr(qos, name, policy)
        elif any(offers):
            kind = f'QoS{name.capitalize()}Policy'
            print(
                f'Some, but not all, publishers are offering {kind}.{policy.name}. Falling back '
                f'to {kind}.{weak} as it will connect to all publishers'
            )
    return qos
