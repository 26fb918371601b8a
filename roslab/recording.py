"""``record`` and ``replay``: topics of this kernel's domain, to a file and back."""

from __future__ import annotations

from collections.abc import Sequence
import math
from pathlib import Path
import time

from rclpy.node import Node

from autograder.simulated import Simulation
from roslab.bags.bag import Bag
from roslab.bags.player import CONNECT_S, Player
from roslab.bags.reader import open_bag
from roslab.bags.recorder import Recorder
from roslab.bags.simulated import write_simulation
from roslab.bags.writer import BagWriter
from roslab.errors import RoslabError
from roslab.interrupts import HeldInterrupts
from roslab.lookup import resolved
from roslab.output import say
from roslab.session import Session
from roslab.silence import no_publisher
from roslab.waiting import timeout_error, wait_in

_LOOK_S = 0.1
"""Time between two looks for new topics [s]."""
PLAYER = 'rosbag2_player'


def record_to(
    session: Session, file: str | Path, sources: Sequence[str | Simulation], seconds: float
) -> Bag:
    """
    Record topics for some time, or save a simulation.

    :param file: the file, which ends in .mcap
    :param sources: names of topics, none for all; or one simulation
    :param seconds: how long to record [s]
    :returns: the summary of the file
    :raises RoslabError: if an argument is wrong, or the file cannot be written
    :raises TimeoutError: if no message arrived
    """
    path = _path(file, sources)
    try:
        if any(isinstance(one, Simulation) for one in sources):
            return _saved(path, sources)
        return _recorded(session, path, sources, _positive('seconds', seconds))
    except OSError as error:
        if isinstance(error, TimeoutError):
            raise
        raise RoslabError(f'{path}: cannot be written: {error.strerror or error}.') from None


def replay_from(session: Session, file: str | Path, topics: Sequence[str], rate: float) -> None:
    """
    Publish the messages of a bag again, from a node of this kernel.

    :param topics: only these; none for all
    :param rate: 2.0 for twice as fast as recorded
    :raises RoslabError: if the bag cannot be used, or an argument is wrong
    """
    speed = _positive('rate', rate)
    if session.executor.is_this_thread:
        raise RoslabError(
            'A callback cannot replay, because no other callback runs before it ends.'
        )
    bag = open_bag(Path(file))
    names = [resolved(session.helper, topic) for topic in topics]
    node = session.start(Node, PLAYER)
    try:
        player = Player(node, bag, names)
        wait_in(session, player.connected, CONNECT_S)
        say(f'Replaying {file}: {bag.count} messages, {bag.seconds / speed:.1f} s')
        player.play(speed)
    finally:
        session.stop(node)


def _recorded(session: Session, path: Path, sources: Sequence[object], seconds: float) -> Bag:
    node = session.helper
    names = [resolved(node, str(topic)) for topic in sources]
    with BagWriter(path) as writer:
        recorder = Recorder(node, writer, names)
        end = time.monotonic() + seconds
        try:
            while (left := end - time.monotonic()) > 0:
                with HeldInterrupts():
                    recorder.look()
                wait_in(session, lambda: recorder.heard, min(left, _LOOK_S))
                with HeldInterrupts():
                    recorder.drain()
        finally:
            with HeldInterrupts():
                for subscription in recorder.subscriptions.values():
                    session.forget(node, subscription)
                recorder.drain()
        refused = ' '.join(why for name, why in recorder.refused.items() if name in names)
        if not writer.count:
            silent = ' and '.join(names) or 'any topic'
            nobody = [no_publisher(node, one) for one in names if not node.count_publishers(one)]
            raise timeout_error(
                f'Heard no message on {silent} in {seconds:g} s, so no file was written.',
                refused,
                *nobody,
                session.losses(),
            )
        if refused:
            raise RoslabError(f'{refused} No file was written.')
    assert writer.bag is not None
    return writer.bag


def _saved(path: Path, sources: Sequence[object]) -> Bag:
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
