"""Define the ``--qos-*`` options."""

import argparse

from rclpy.duration import Duration
from rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    LivelinessPolicy,
    QoSPresetProfiles,
    QoSProfile,
    ReliabilityPolicy,
)

from roslab.ros2.cli import Option, option
from roslab.ros2.graph import preset

_POLICIES = {
    'history': HistoryPolicy,
    'reliability': ReliabilityPolicy,
    'durability': DurabilityPolicy,
    'liveliness': LivelinessPolicy,
}


def qos_arguments(entity: str, profile: str) -> list[Option]:
    """Return the options."""
    return [
        option(
            '--qos-profile',
            choices=QoSPresetProfiles.short_keys(),
            help=f'Quality of service preset profile to {entity} with (default: {profile})',
        ),
        option('--qos-depth', metavar='N', type=int, help='Queue size (overrides the profile)'),
        *(
            option(
                f'--qos-{name}',
                choices=policy.short_keys(),
                help=f'Quality of service {name} setting (overrides the profile)',
            )
            for name, policy in _POLICIES.items()
        ),
        option(
            '--qos-liveliness-lease-duration-seconds',
            type=float,
            metavar='S',
            help='Quality of service liveliness lease duration [s]',
        ),
    ]


def qos_asked_for(args: argparse.Namespace, profile: str) -> QoSProfile | None:
    """Return the QoS profile given by the options, None if there are no such options."""
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
