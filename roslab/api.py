"""The short functions that lessons call; each uses the session of the running kernel."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any, TYPE_CHECKING, TypeVar

from rclpy.node import Node
from rclpy.qos import QoSProfile

from autograder.simulated import Simulation, TopicRecord
from roslab.callback_picture import Callbacks
from roslab.callbacks import watching
from roslab.graph_picture import Graph, graph_now
from roslab.introspection import print_info, print_messages, print_rate, print_topics
from roslab.listening import Listener
from roslab.live_plot import Plot
from roslab.logtable import log_table, LogTable
from roslab.session import session
from roslab.timeline_picture import make_timeline, Timeline
from roslab.waiting import wait_until_in

if TYPE_CHECKING:
    from roslab.bags.bag import Bag

T = TypeVar('T')


def start(
    factory: Callable[..., Any] | Node,
    *,
    name: str | None = None,
    parameters: Mapping[str, Any] | None = None,
) -> Node:
    """
    Create a node and run it in the background, replacing an older node of the same name.

    :param factory: a subclass of Node, a function that returns a node, or an existing node
    :param name: replaces the node's own name, as ``-r __node:=name`` does in a terminal
    :param parameters: initial values of declared parameters, as ``-p name:=value`` does
    """
    return session().start(factory, name, parameters)


def stop(node: Node | str) -> None:
    """
    Stop and destroy a node.

    :param node: the node, or its name
    """
    session().stop(node)


def stop_all() -> None:
    """Stop and destroy all nodes of this notebook, and end all subscriptions of ``listen``."""
    session().stop_all()


def nodes() -> dict[str, Node]:
    """Return the nodes that this notebook runs, by name."""
    return session().nodes()


def listen(
    topic: str, msg_type: type, *, depth: int = 10, qos: QoSProfile | None = None
) -> Listener:
    """
    Subscribe to a topic and store the received messages in ``messages``.

    :param topic: name of the topic
    :param msg_type: class of the topic's messages
    :param depth: how many messages can wait in the queue for the callback
    :param qos: a complete QoS profile, instead of a reliable one of this depth
    """
    return Listener(session(), topic, msg_type, qos or QoSProfile(depth=depth))


def wait_until(condition: Callable[[], T], timeout: float = 5.0, what: str = 'a condition') -> T:
    """
    Wait until a condition is true; nodes continue to run meanwhile.

    :param condition: called after each callback, until it returns a true value
    :param timeout: the longest time to wait [s]
    :param what: description of the condition, for the error message
    :returns: what the condition returned
    :raises TimeoutError: after ``timeout``; its message lists possible reasons
    """
    return wait_until_in(session(), condition, timeout, what)


def logs(node: Node | str | None = None) -> LogTable:
    """
    Return the log lines recorded in this notebook so far, as a table.

    :param node: return only the lines of this node (a node or its name)
    """
    if node is None:
        return log_table()
    name = node if isinstance(node, str) else node.get_fully_qualified_name()
    return log_table(name.strip('/').replace('/', '.'))


def graph(topic: str | None = None, *, all: bool = False) -> Graph:
    """
    Return the nodes and topics of the current graph: a picture, or lines of text with ``str()``.

    Nodes of this notebook appear at once, those of other programs after discovery.

    :param topic: show only this topic and its nodes
    :param all: include hidden nodes, ``/rosout`` and ``/parameter_events``
    """
    return graph_now(session(), topic, all)


def timeline(
    *sources: Listener | Plot | Simulation | TopicRecord,
    marks: Mapping[str, Iterable[float]] | None = None,
    seconds: float | None = None,
) -> Timeline:
    """
    Show messages on a time axis: a picture, or a plain-text table with ``str()``.

    :param sources: listeners, plots, simulations or recorded topics. The axis begins when the
        first listener began to listen; a simulation contributes all its topics
    :param marks: names and times of other events, on the scale of the first listener's ``now`` [s]
    :param seconds: show only this much time before the newest event [s]
    """
    return make_timeline(sources, marks, seconds)


def watch_callbacks(*nodes: Node | str) -> AbstractContextManager[Callbacks]:
    """
    Record the callbacks that executors of this notebook run until the end of a ``with`` block.

    The record shows a picture as the last line of a cell, and a plain-text table with ``str()``.
    It knows lost messages only of publishers in this notebook, and late or skipped ticks only of
    timers on a real clock.

    :param nodes: nodes or their names; none for all nodes that are not hidden
    :returns: a context manager that gives the record, whose ``calls`` are the callbacks so far
    :raises RoslabError: if something else is given
    """
    return watching(Callbacks(nodes))


def plot(
    topic: str | TopicRecord,
    field: str,
    *,
    seconds: float | None = None,
    threshold: float | None = None,
    marks: Mapping[str, Iterable[float]] | None = None,
) -> Plot:
    """
    Plot a numeric field of a topic against time; the picture in this cell stays up to date.

    :param topic: its name (the graph gives its type), or the messages of a simulation, as in
        ``plot(run['temperature_topic'], 'temperature_value')``
    :param field: path of the field, such as ``temperature``, ``header.stamp.sec`` or ``data[0]``
    :param seconds: length of the time axis [s]; None for 20 s, or for a whole simulation
    :param threshold: a value to draw as a horizontal line; values above it are highlighted
    :param marks: names and times of other events, as in ``timeline`` [s]
    """
    if seconds is None:
        seconds = topic.seconds if isinstance(topic, TopicRecord) else 20.0
    made = Plot(session(), topic, field, seconds, threshold, marks)
    made.begin()
    return made


def echo(
    topic: str, count: int = 1, timeout: float = 5.0, *, qos: QoSProfile | None = None
) -> None:
    """
    Print messages as they arrive, as ``ros2 topic echo`` does.

    :param topic: its name; the graph gives its type
    :param count: how many messages to print
    :param timeout: how long to wait for all of them [s]
    :param qos: profile of the subscription, instead of one that is compatible with all publishers
    """
    print_messages(session(), topic, count, timeout, qos)


def hz(topic: str, count: int = 5, timeout: float = 10.0) -> None:
    """
    Print how often messages arrive, as ``ros2 topic hz`` does.

    :param topic: its name; the graph gives its type
    :param count: how many messages to measure
    :param timeout: how long to wait for them [s]
    """
    print_rate(session(), topic, count, timeout)


def info(name: str) -> None:
    """
    Print the output of ``ros2 topic info -v`` for a topic, or of ``ros2 node info`` for a node.

    :param name: name of a topic or a node
    """
    print_info(session(), name)


def topics(types: bool = True) -> None:
    """
    Print all topics, as ``ros2 topic list -t`` does.

    :param types: print the type of each topic too
    """
    print_topics(session(), types)


def record(file: str | Path, *sources: str | Simulation, seconds: float = 5.0) -> Bag:
    """
    Record messages in an MCAP file, as ``ros2 bag record`` does, while nodes run.

    An interrupt ends the recording and keeps what has arrived.

    :param file: a name that ends in .mcap; an existing file is replaced
    :param sources: names of topics; none for all topics. Or one simulation, to save it
    :param seconds: how long to record [s]
    :returns: the summary of the file, as ``ros2 bag info`` prints it
    :raises RoslabError: if an argument is wrong, or the file cannot be written
    :raises TimeoutError: if no message arrived; then no file is written
    """
    # Not at the top: mcap takes a quarter of a second, and few notebooks record.
    from roslab.recording import record_to

    return record_to(session(), file, sources, seconds)


def replay(file: str | Path, *topics: str, rate: float = 1.0) -> None:
    """
    Publish recorded messages again, with their types, QoS and rhythm, as ``ros2 bag play`` does.

    :param file: an MCAP file, or the folder that ``ros2 bag record`` has written
    :param topics: only these topics
    :param rate: 2.0 for twice as fast as recorded
    :raises RoslabError: if the file is damaged or foreign, or a type has changed since
    """
    from roslab.recording import replay_from

    replay_from(session(), file, topics, rate)
