"""
Record topics of this kernel's domain in a file, and replay them.

The modules for bags are imported inside functions, because importing mcap takes a quarter of a
second and few notebooks record.
"""

from __future__ import annotations

from collections.abc import Sequence
import math
from pathlib import Path
import time
from typing import TYPE_CHECKING

from rclpy.node import Node

from autograder.simulated import Simulation
from roslab.errors import RoslabError
from roslab.interrupts import HeldInterrupts
from roslab.lookup import no_publisher, resolved
from roslab.output import say
from roslab.session import session, timeout_error, wait_in

if TYPE_CHECKING:
    from roslab.bags.bag import Bag

_LOOK_S = 0.1
"""Time between two checks for new topics [s]."""
PLAYER = 'rosbag2_player'


def record(file: str | Path, *sources: str | Simulation, seconds: float = 5.0) -> Bag:
    """
    Record messages in an MCAP file, as ``ros2 bag record`` does, while nodes run.

    An interrupt ends the recording and keeps the messages that have arrived.

    :param file: a name that ends in .mcap; an existing file is replaced
    :param sources: names of topics, none for all topics; or one simulation to save
    :param seconds: how long to record [s]
    :returns: the summary of the file, as ``ros2 bag info`` prints it
    :raises RoslabError: if an argument is wrong, or the file cannot be written
    :raises TimeoutError: if no message arrived; then no file is written
    """
    path = _path(file, sources)
    try:
        if any(isinstance(one, Simulation) for one in sources):
            return _saved(path, sources)
        return _recorded(path, sources, _positive('seconds', seconds))
    except TimeoutError:
        raise
    except OSError as error:
        raise RoslabError(f'{path}: cannot be written: {error.strerror or error}.') from None


def replay(file: str | Path, *topics: str, rate: float = 1.0) -> None:
    """
    Publish recorded messages again, with their types, QoS and timing, as ``ros2 bag play`` does.

    :param file: an MCAP file, or the folder that ``ros2 bag record`` has written
    :param topics: only these topics
    :param rate: speed relative to the recording, 2.0 for twice as fast
    :raises RoslabError: if the file is damaged or not a bag, or a type has since changed
    """
    from roslab.bags.player import CONNECT_S, Player
    from roslab.bags.reader import open_bag

    speed = _positive('rate', rate)
    current = session()
    if current.executor.is_this_thread:
        raise RoslabError(
            'A callback cannot call replay(), because no other callback runs until it ends.'
        )
    bag = open_bag(Path(file))
    names = [resolved(current.helper, topic) for topic in topics]
    node = current.start(Node, PLAYER)
    try:
        player = Player(node, bag, names)
        wait_in(player.connected, CONNECT_S)
        say(f'Replaying {file}: {bag.count} messages, {bag.seconds / speed:.1f} s')
        player.play(speed)
    finally:
        current.stop(node)


def _recorded(path: Path, sources: Sequence[object], seconds: float) -> Bag:
    from roslab.bags.writer import BagWriter, Recorder

    current = session()
    node = current.helper
    names = [resolved(node, str(topic)) for topic in sources]
    with BagWriter(path) as writer:
        recorder = Recorder(node, writer, names)
        end = time.monotonic() + seconds
        try:
            while (left := end - time.monotonic()) > 0:
                with HeldInterrupts():
                    recorder.look()
                wait_in(lambda: recorder.heard, min(left, _LOOK_S))
                with HeldInterrupts():
                    recorder.drain()
        finally:
            with HeldInterrupts():
                for subscription in recorder.subscriptions.values():
                    current.forget(node, subscription)
                recorder.drain()
        refused = ' '.join(why for name, why in recorder.refused.items() if name in names)
        if not writer.count:
            silent = ' and '.join(names) or 'any topic'
            nobody = [no_publisher(node, one) for one in names if not node.count_publishers(one)]
            raise timeout_error(
                f'Heard no message on {silent} in {seconds:g} s, so no file was written.',
                refused,
                *nobody,
                current.losses(),
            )
        if refused:
            raise RoslabError(f'{refused} No file was written.')
    assert writer.bag is not None
    return writer.bag


def _saved(path: Path, sources: Sequence[object]) -> Bag:
    from roslab.bags.writer import BagWriter, write_simulation

    if len(sources) != 1 or not isinstance(sources[0], Simulation):
        raise RoslabError(
            "record() expected names of topics, or one simulation, as in record('run.mcap', run)."
        )
    with BagWriter(path) as writer:
        write_simulation(sources[0], writer)
    if writer.bag is None:
        raise RoslabError('The simulated program sent and logged nothing, so no file was written.')
    return writer.bag


def _path(file: str | Path, sources: Sequence[object]) -> Path:
    if not isinstance(file, (str, Path)) or Path(file).suffix != '.mcap':
        raise RoslabError(
            'record() expected the name of a file that ends in .mcap and then topics, as in '
            f"record('run.mcap', 'chatter'), got {file!r} first."
        )
    for one in sources:
        if not isinstance(one, (str, Simulation)):
            raise RoslabError(f'record() expected the name of a topic, got {one!r}.')
    return Path(file)


def _positive(name: str, value: float) -> float:
    if not isinstance(value, (int, float)) or not (0 < value < math.inf):
        raise RoslabError(f'{name}: expected a number above 0, as in {name}=2.0, got {value!r}.')
    return float(value)
