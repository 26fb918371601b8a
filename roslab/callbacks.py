"""
Watch what the executors in this process do: when each callback was due, began and ended.

While it lasts, the watch replaces two functions of rclpy: the one that creates an executor's
handler for a ready entity, and the one that publishes.  The watch works with every executor in
this process, including executors created earlier.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from itertools import count
import threading
import time
from typing import Any, NamedTuple, TYPE_CHECKING

from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import await_or_execute, Executor
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.subscription import Subscription
from rclpy.timer import Timer

from roslab.errors import RoslabError

if TYPE_CHECKING:
    from typing import Self

MAX_CALLS = 300
"""Maximum number of callbacks that a watch records; it ignores later ones."""


class Source(NamedTuple):
    """
    A timer, subscription, service or event whose callback an executor calls.

    :param name: a topic, a service or a period
    :param function: name of the callback, empty for a lambda
    :param group: the callback group, empty for the default one of the node
    """

    node: str
    name: str
    function: str
    group: str


class Call(NamedTuple):
    """
    One callback, or an event without a callback; times count from the start of the watch [s].

    :param came: when its message arrived, or when its timer was due; None if unknown
    :param began: None if no callback began during the watch
    :param ended: None if it did not end during the watch
    :param thread: number of the thread, beginning with 1; 0 without a callback
    :param lost: True for a skipped tick, and for a message older than one that was taken
    """

    source: Source
    came: float | None
    began: float | None = None
    ended: float | None = None
    thread: int = 0
    lost: bool = False

    @property
    def times(self) -> list[float]:
        """The known times [s]."""
        return [time for time in (self.came, self.began, self.ended) if time is not None]


class Watch:
    """
    A record of the callbacks in a ``with`` block.

    :param nodes: nodes, their names or full names; if empty, all nodes that are not hidden
    :raises RoslabError: if one of ``nodes`` is neither a node nor a name
    """

    def __init__(self, nodes: tuple[Node | str, ...]) -> None:
        for node in nodes:
            if not isinstance(node, (Node, str)):
                raise RoslabError(
                    f'watch_callbacks() expected nodes or their names, got {node!r}. '
                    'Try: watch_callbacks() for all nodes.'
                )
        self._nodes = nodes
        self._zero_ns = time.time_ns()
        self._sources: dict[int, tuple[Any, Source]] = {}
        self._groups: list[Any] = []
        self._threads: list[int] = []
        self._published: list[tuple[str, int, int]] = []
        self._taken: dict[int, list[int]] = {}
        self._found: dict[int, Call] = {}
        self._numbers = count(1)
        self.end: float | None = None
        """End of the watch [s]; None until then."""

    @property
    def calls(self) -> list[Call]:
        """The callbacks that have ended, in the order in which they began."""
        return [call for call in self.events if call.ended is not None]

    @property
    def lost(self) -> list[Call]:
        """The messages and ticks that got no callback; complete after the watch."""
        return [call for call in self.events if call.lost]

    @property
    def full(self) -> bool:
        """True if the record has reached its limit."""
        return len(self._found) >= MAX_CALLS

    @property
    def events(self) -> list[Call]:
        """All recorded callbacks, then the events without a callback."""
        return sorted(self._found.values(), key=lambda call: (call.began is None, call.began or 0))

    def __enter__(self) -> Self:
        """Replace the functions of rclpy."""
        make, publish = self._originals = Executor._make_handler, Publisher.publish

        def make_handler(executor: Executor, entity: Any, node: Node, take: Any) -> Any:
            return make(executor, entity, node, partial(self.take, node, take))

        def publish_noted(publisher: Publisher, msg: Any) -> None:
            topic, began_ns = publisher.topic_name, time.time_ns()
            publish(publisher, msg)
            if len(self._published) < MAX_CALLS:
                self._published.append((topic, began_ns, time.time_ns()))

        Executor._make_handler = make_handler  # type: ignore[method-assign]
        Publisher.publish = publish_noted  # type: ignore[method-assign]
        return self

    def __exit__(self, *_: object) -> None:
        """End the record, and add the messages and due ticks that got no callback."""
        Executor._make_handler, Publisher.publish = self._originals  # type: ignore[method-assign]
        end_ns = time.time_ns()
        self.end = self._seconds(end_ns)
        for key, (entity, source) in tuple(self._sources.items()):
            if isinstance(entity, Subscription):
                self._add_unheard(source, self._taken[key])
            elif isinstance(entity, Timer):
                # A timer calls its callback once for all the ticks that it has missed.
                for number, tick in enumerate(_due_ticks(entity, end_ns)):
                    self._add(Call(source, self._seconds(tick), lost=number > 0))
        self._nodes = ()  # the record must not keep nodes and entities alive
        self._sources.clear()
        self._groups.clear()

    def take(self, node: Node, take: Callable[[Any], Any], entity: Any) -> Any:
        """Take from a ready entity as ``take`` does; return the callback's coroutine function."""
        try:
            source = self._source(node, entity) if self.end is None else None
        except rclpy_implementation.InvalidHandle:  # destroyed after it became ready
            source = None
        if source is None:
            return take(entity)
        came: float | None = None
        if isinstance(entity, Subscription):
            run, stamps = _take_message(entity)
            if run is not None:
                self._taken[id(entity)].append(stamps['source_timestamp'])
                came = self._seconds(stamps['received_timestamp'])
        elif isinstance(entity, Timer):
            run, due, skipped = _take_timer(entity, take)
            for tick in skipped:
                if tick >= self._zero_ns:  # ignore ticks missed before the watch
                    self._add(Call(source, self._seconds(tick), lost=True))
            came = None if due is None else self._seconds(due)
        else:
            run = take(entity)
        return run and self._noted(source, came, run)

    def _noted(self, source: Source, came: float | None, run: Callable[[], Any]) -> Any:
        """Return the coroutine function of a callback that records its start and end."""

        async def noted() -> None:
            thread = threading.get_ident()
            if thread not in self._threads:
                self._threads.append(thread)
            began = self._seconds(time.time_ns())
            call = Call(source, came, began, thread=self._threads.index(thread) + 1)
            number = self._add(call) if self.end is None else 0
            try:
                await run()
            finally:
                if number and self.end is None:
                    self._found[number] = call._replace(ended=self._seconds(time.time_ns()))

        return noted

    def _add(self, call: Call) -> int:
        """Record a call; return its number, 0 if the record is full."""
        number = next(self._numbers)  # atomic, unlike the length of a dict
        if number > MAX_CALLS:
            return 0
        self._found[number] = call
        return number

    def _add_unheard(self, source: Source, taken: list[int]) -> None:
        """Record the messages of a topic that a subscription did not take."""
        last = max(taken, default=0)
        for topic, began, ended in self._published:
            if topic == source.name and not any(began <= one <= ended for one in taken):
                number = next(self._numbers)
                self._found[number] = Call(source, self._seconds(began), lost=ended < last)

    def _seconds(self, stamp_ns: int) -> float:
        return (stamp_ns - self._zero_ns) / 1e9

    def _source(self, node: Node, entity: Any) -> Source | None:
        """Return the description of an entity, None if it is not watched or has no callback."""
        if id(entity) in self._sources:
            return self._sources[id(entity)][1]
        name = node.get_name()
        names = name, node.get_fully_qualified_name()
        watched = any(one is node or one in names for one in self._nodes)
        watched = watched if self._nodes else not name.startswith('_')
        callback = getattr(entity, 'callback', None)
        if not watched or callback is None:
            return None
        function = getattr(getattr(callback, 'func', callback), '__name__', '')
        function = function.replace('<lambda>', '')
        source = Source(name, _name(entity), function, self._group(node, entity))
        self._sources[id(entity)] = entity, source
        self._taken[id(entity)] = []
        return source

    def _group(self, node: Node, entity: Any) -> str:
        group = entity.callback_group
        if group is node.default_callback_group:
            return ''
        if group not in self._groups:
            self._groups.append(group)
        kind = 'reentrant ' * isinstance(group, ReentrantCallbackGroup)
        return f'{kind}group {self._groups.index(group) + 1}'


def _name(entity: Any) -> str:
    if isinstance(entity, Timer):
        return f'timer {entity.timer_period_ns / 1e9:g} s'
    return getattr(entity, 'topic_name', getattr(entity, 'srv_name', 'event'))


def _take_message(entity: Subscription) -> tuple[Callable[[], Any] | None, dict[str, int]]:
    """Take a message as rclpy does; return a function that calls the callback, and the times."""
    try:
        with entity.handle:
            taken = entity.handle.take_message(entity.msg_type, entity.raw)
    except rclpy_implementation.InvalidHandle:  # destroyed after it became ready
        return None, {}
    if taken is None:
        return None, {}
    alone = entity._callback_type is Subscription.CallbackType.MessageOnly
    return partial(await_or_execute, entity.callback, *taken[: 1 if alone else 2]), taken[1]


def _take_timer(
    timer: Timer, take: Callable[[Any], Any]
) -> tuple[Callable[[], Any] | None, int | None, list[int]]:
    """Call a timer; return its callback, when it was due, and the ticks that it skips [ns]."""
    if not _is_real(timer):
        return take(timer), None, []
    try:
        due = _next_ns(timer)
        run = take(timer)
        following = _next_ns(timer)
    except rclpy_implementation.InvalidHandle:
        return None, None, []
    if due is None or following is None:  # cancelled
        return run, due, []
    period = timer.timer_period_ns
    skipped = round((following - due) / period) - 1 if period else 0
    return run, due, [due + period * number for number in range(1, skipped + 1)]


def _due_ticks(timer: Timer, end_ns: int) -> range:
    """Return the due times of the ticks that are still waiting at the end of a watch [ns]."""
    try:
        due = _next_ns(timer) if _is_real(timer) else None
    except rclpy_implementation.InvalidHandle:
        due = None
    return range(end_ns if due is None else due, end_ns, max(timer.timer_period_ns, 1))


def _is_real(timer: Timer) -> bool:
    """Return whether the picture's time axis can show when a tick of a timer was due."""
    return not getattr(timer.clock, 'ros_time_is_active', False)


def _next_ns(timer: Timer) -> int | None:
    """Return the system time of the next tick [ns], None if the timer is cancelled."""
    left = timer.time_until_next_call()
    return None if left is None else time.time_ns() + left
