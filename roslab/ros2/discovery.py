"""
Create a node for a command, and wait until the node knows the graph.

The real ``ros2`` queries a daemon that has watched the graph for a long time.  Here every command
discovers the graph itself, so it has to decide when discovery is complete.  It considers
discovery complete when all three conditions hold:

* every endpoint belongs to a node with a known name (Fast DDS announces endpoints first, and the
  names of their nodes up to half a second later);
* the graph has not changed for a short time;
* the graph has another node, or as much time has passed as the real command waits without its
  daemon.

On a busy machine, all three can hold before a process that got no CPU time has answered.  So a
command about one topic, node or service reports it as missing only after LIMIT_S; if the graph
contains it, the three conditions suffice.  A list command has no such check, so on a busy machine
its list may be incomplete.

If no other node appears, the command tries again a few times as a new participant.  A participant
often loses the answer to its first announcement because it is not listening yet.  With Fast DDS's
default settings, the next announcement follows up to 3 s later.  The course's kernels, and the
processes that this command starts, announce themselves ten times a second
(environment/fastdds.xml).
"""

import argparse
from collections.abc import Callable, Hashable, Iterator
from contextlib import contextmanager
import os
import time

import rclpy
from rclpy.node import Node
from rclpy.parameter import Parameter

from roslab.ros2.cli import flag, option
from roslab.ros2.graph import node_known, UNKNOWN

QUIET_S = 0.12
"""Time without a change in the graph; longer than the 0.1 s between two announcements [s]."""
QUIET_LOOKS = 8
"""Minimum number of polls without a change, so that a process without CPU time keeps polling."""
ALONE_S = 0.5
"""Maximum wait for a first other node; ``--spin-time`` of the real command [s]."""
AGAIN_S = (0.2, 0.2, 0.2)
"""Wait of each new participant: others answer its second announcement, after 0.1 s [s]."""
LIMIT_S = 3.0
"""Maximum time to wait for discovery, or for the entity that a command is about [s]."""
LOOK_S = 0.01

Known = Callable[[Node], object]
"""A function that returns whether a node's graph contains the entity of a command."""

NODE = (
    option(
        '--spin-time',
        type=float,
        default=ALONE_S,
        metavar='S',
        help='time to look for other nodes before reporting that there are none (default: 0.5)',
    ),
    flag('-s', '--use-sim-time', 'take the time from /clock'),
    flag('--no-daemon', 'no effect: this command has no daemon'),
)
"""The options that all verbs with a node share."""
NODE_NAME = option('node_name', help='Name of the ROS node')
HIDDEN_NODES = flag('--include-hidden-nodes', 'include hidden nodes')


@contextmanager
def ros_node(args: argparse.Namespace | None, name: str | None = None) -> Iterator[Node]:
    """
    Provide a node inside the ``with`` block, and shut ROS down afterwards.

    :param args: the parsed options of :data:`NODE`, None for a verb without them
    :param name: name of the node; by default a hidden name, which lists omit
    """
    # Write each log line immediately, even into a pipe, so that lines and messages keep their
    # order.
    os.environ.setdefault('RCUTILS_LOGGING_BUFFERED_STREAM', '1')
    rclpy.init(args=[])
    simulated = Parameter('use_sim_time', value=bool(args and args.use_sim_time))
    try:
        node = Node(
            name or f'_ros2cli_{os.getpid()}',
            start_parameter_services=False,
            parameter_overrides=[simulated],
        )
        try:
            yield node
        finally:
            node.destroy_node()
    finally:
        rclpy.try_shutdown()


@contextmanager
def knowing_node(args: argparse.Namespace, known: Known | None = None) -> Iterator[Node]:
    """Provide a node that has discovered the graph and, if it exists, what ``known`` tests for."""
    looks = (args.spin_time, *AGAIN_S, *([LIMIT_S] if known else []))
    for number, alone_s in enumerate(looks, 1):
        with ros_node(args) as node:
            if wait_for_graph(node, alone_s, known) or number == len(looks):
                yield node
                return


def wait_for_graph(node: Node, alone_s: float = ALONE_S, known: Known | None = None) -> bool:
    """
    Wait until the node has discovered the graph, at most the longer of LIMIT_S and ``alone_s``.

    :param alone_s: how long to wait for a first other node [s]
    :param known: if there are other nodes, the wait ends early only if this condition holds, too
    :returns: whether there are other nodes
    """
    began = changed = time.monotonic()
    last: Hashable = None
    others, still = False, 0
    while (now := time.monotonic()) - began < max(LIMIT_S, alone_s):
        seen = _graph(node)
        others = len(seen[0]) > 1
        still += 1
        if seen != last:
            last, changed, still = seen, now, 0
        complete = now - changed >= QUIET_S and still >= QUIET_LOOKS and not _nameless(node)
        if complete and ((not known or known(node)) if others else now - began >= alone_s):
            break
        time.sleep(LOOK_S)
    return others


def _graph(node: Node) -> tuple[tuple[object, ...], ...]:
    """Return nodes, topics with their endpoint counts, and services, as comparable data."""
    topics = (
        (name, *types, node.count_publishers(name), node.count_subscribers(name))
        for name, types in node.get_topic_names_and_types()
    )
    services = ((name, *types) for name, types in node.get_service_names_and_types())
    nodes = node.get_node_names_and_namespaces()
    return tuple(sorted(nodes)), tuple(sorted(topics)), tuple(sorted(services))


def _nameless(node: Node) -> bool:
    return any(
        info.node_name == UNKNOWN
        for name, _ in node.get_topic_names_and_types()
        for info in (
            *node.get_publishers_info_by_topic(name),
            *node.get_subscriptions_info_by_topic(name),
        )
    )


def wait_for(node: Node, condition: Callable[[], bool], limit_s: float = LIMIT_S) -> bool:
    """Spin until a condition holds; return False if it does not hold within ``limit_s`` [s]."""
    deadline = time.monotonic() + limit_s
    while not condition():
        if time.monotonic() > deadline:
            return False
        rclpy.spin_once(node, timeout_sec=0.02)
    return True


@contextmanager
def asking(
    args: argparse.Namespace, known: Callable[[Node, str], object] = node_known
) -> Iterator[tuple[Node, str]]:
    """
    Provide a node that has discovered the graph, and the full name of the command's target node.

    :raises RuntimeError: if the graph does not contain the target node
    """
    name = args.node_name if args.node_name.startswith('/') else f'/{args.node_name}'
    with knowing_node(args, lambda node: known(node, name)) as node:
        if not known(node, name):
            raise RuntimeError('Node not found')
        yield node, name
