"""
The probe: stands in the network of the student's sandbox, drives it, and writes what it sees.

It knows the *scenario* (which topics to watch, what to send, how far to move the clock) and no
expected value.  It reads one JSON line from standard input, runs the scenario, and writes one JSON
event a line to standard output; :mod:`autograder.runs.recording` documents the events.  It runs as
a process of its own, confined and disposable, because it parses whatever the student's code sends.

Four rules keep the recording the same from run to run, however slow the machine is:

1. *Discovery barrier.*  No clock before one round trip to every student node's ``get_parameters``
   service: created last on our side, it proves that the student's side knows all our endpoints.
2. *Processing barrier.*  An executor takes one message a subscription and pass, and answers
   services last, so after K messages K + 1 round trips prove that all were handled.
3. *Quiet.*  Callbacks on several threads may be at work when the service answers.  After a round
   the grader, who sees the program's threads from outside, is asked until none of them runs,
   and none of ours: what was sent has arrived then.
4. *Log barrier.*  A first log line can be late while a reader fetches the history: nothing begins
   until the program and we have rested for longer than the middleware's timers, and the first
   input of a scenario is waited for until its log arrives, or a bound is reached.

This file and the other ``probe_*.py`` import nothing of this project but each other: only their
text enters the probe's sandbox.
"""

from __future__ import annotations

from collections.abc import Callable
import json
import os
import select
import time
from typing import Any

from lean_start import lean  # type: ignore[import-not-found]  # beside this file in the sandbox

lean()  # before anything of ROS
# ruff: noqa: E402

from builtin_interfaces.msg import Time
from probe_graph import Graph  # type: ignore[import-not-found]  # beside this file
import probe_loopback  # type: ignore[import-not-found]
from probe_round_trips import RoundTrips  # type: ignore[import-not-found]
from probe_steps import Stop, take  # type: ignore[import-not-found]
from probe_wire import load_type, qos_profile, to_json  # type: ignore[import-not-found]
from rcl_interfaces.msg import Log
import rclpy
from rclpy.context import Context
from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rosgraph_msgs.msg import Clock

NANOSECONDS = 1_000_000_000
# What the grader says while the scenario runs, one byte each: the program had another TICK_S of
# time; none of its threads runs; it has ended. Time in which somebody waits for a processor does
# not count, so that a busy machine changes no verdict.
TICK, QUIET, EXITED = b't', b'q', b'e'
TICK_S = 0.05
LEAVE_S = 2.0
AGAIN_S = 0.5  # in the program's own time; who ends does so in less
# A question may be lost while endpoints match, and is asked again after half a second. A node
# whose turn comes when others have used up the time is asked three times all the same, while there
# is some to spare: a program of fifty silent nodes is not watched for minutes.
LEAST_S, SPARE_S = 1.2, 5.0
LONGEST_EVENT = 65536  # characters of one message's JSON; longer ones are recorded by their size
MOST_EVENTS = 20000
MOST_AT_ONCE = 200  # of a topic; of those we watch, a reader holds a hundred
# rclpy's own warnings about endpoints that do not fit are read by nobody here; without them there
# is a third of the entities to wait for.
SILENT_PUBLISHER = PublisherEventCallbacks(use_default_callbacks=False)
SILENT_SUBSCRIPTION = SubscriptionEventCallbacks(use_default_callbacks=False)


class Probe:
    """
    One run of one scenario.

    :param scenario: see :class:`autograder.runs.scenario.Scenario`
    """

    def __init__(self, scenario: dict[str, Any]) -> None:
        """Create every endpoint of ours before the student's code is let go."""
        self.scenario = scenario
        # Whatever else writes to standard output, such as rclpy's own warnings, is no event.
        self.output = os.fdopen(os.dup(1), 'w', encoding='utf-8')
        os.dup2(2, 1)
        self.events, self.full = 0, False
        self.clock_ns: int | None = None
        self.input: int | None = None
        self.logs = self.messages = 0
        self.before_step = (0, 0)
        self.student_exited = False
        self.quiet = False
        self.patience_s = 0.0
        self.trips = RoundTrips(self)
        self.asked: set[str] = set()
        self.late_s = scenario['first_answer_s']  # for all nodes together that come later
        self.spare_s = SPARE_S
        self.unreachable: set[str] = set()
        self.deaf: set[str] = set()
        self.context = Context()
        # Only our own command line counts, and we have none.
        rclpy.init(args=[], context=self.context)
        self.node = Node(
            scenario['name'],
            context=self.context,
            start_parameter_services=False,
            enable_rosout=False,
            use_global_arguments=False,
        )
        self.executor = SingleThreadedExecutor(context=self.context)
        self.executor.add_node(self.node)
        self.clock = self._publisher(Clock, '/clock', 10)
        self.ticks: set[int] | None = set()
        self._subscribe(Clock, '/clock', self._tick_heard, 10)
        self._watch_topics()
        self.feeds: dict[str, tuple[Any, Any]] = {}
        for topic, feed in scenario['feed'].items():
            cls, qos = load_type(feed['type']), qos_profile(feed['qos'])
            self.feeds[topic] = cls, self._publisher(cls, topic, qos)
        self.services = {
            step['service']: self.node.create_client(load_type(step['type']), step['service'])
            for step in scenario['steps']
            if step['do'] == 'call'
        }
        self.listeners: dict[str, Any] = {}
        self.seen = Graph(self.node)
        self.imitated = False
        self.own_time = False
        self.heard_from: set[str] = set()

    def _watch_topics(self) -> None:
        # A best-effort, volatile reader matches every writer, so a QoS mistake is seen as what it
        # is and not as silence.
        hearing = QoSProfile(
            depth=100,
            reliability=ReliabilityPolicy.BEST_EFFORT,
            durability=DurabilityPolicy.VOLATILE,
        )
        for topic, name in self.scenario['watch'].items():

            def heard(message: Any, topic: str = topic) -> None:
                self.message(topic, message)

            self._subscribe(load_type(name), topic, heard, hearing)
        logs = QoSProfile(depth=1000, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self._subscribe(Log, '/rosout', self._log, logs)

    def _publisher(self, cls: Any, topic: str, qos: Any) -> Any:
        return self.node.create_publisher(cls, topic, qos, event_callbacks=SILENT_PUBLISHER)

    def _subscribe(self, cls: Any, topic: str, heard: Callable[[Any], None], qos: Any) -> None:
        events = SILENT_SUBSCRIPTION
        self.node.create_subscription(cls, topic, heard, qos, event_callbacks=events)

    # -- writing ---------------------------------------------------------------------------

    def emit(self, event: str, **facts: Any) -> None:
        """Write one event; the clock is the last one that was published."""
        self.events += 1
        if self.events > MOST_EVENTS and event not in ('graph', 'end', 'imitated'):
            if self.full:
                return  # what was on its way when the scenario was broken off
            self.full = True
            raise Stop('too_many_events')
        self.write({'event': event, 'clock_ns': self.clock_ns, **facts})

    def write(self, line: dict[str, Any]) -> None:
        """Write one line to the grader."""
        print(json.dumps(line, allow_nan=False), file=self.output, flush=True)

    def message(self, topic: str, message: Any, **facts: Any) -> None:
        """Write down a message that was received."""
        self.messages += 1
        self.heard_from.add(topic)
        data = to_json(message)
        size = len(json.dumps(data))
        what = {'too_large': size} if size > LONGEST_EVENT else {'data': data}
        facts = {**what, 'after_input': self.input, 'wall_s': self.now(), **facts}
        self.emit('message', topic=topic, **facts)

    def _log(self, entry: Log) -> None:
        self.logs += 1
        self.heard_from.add(entry.name[:256])
        self.emit(
            'log',
            name=entry.name[:256],
            level=int(entry.level),
            text=entry.msg[:2000],
            function=entry.function[:256],
            line=entry.line,
            after_input=self.input,
        )

    def _tick_heard(self, message: Clock) -> None:
        """Notice a clock that is not ours, once."""
        tick = message.clock.sec * NANOSECONDS + message.clock.nanosec
        if self.ticks is not None and tick not in self.ticks:
            self.emit('foreign_clock')
            self.ticks = None

    def now(self) -> float:
        """Return wall seconds since the scenario began, to the millisecond."""
        return round(time.monotonic() - self.began, 3)

    # -- waiting ---------------------------------------------------------------------------

    def spin(self, seconds: float) -> None:
        """Handle what has arrived; wait at most this long for something to arrive."""
        self.executor.spin_once(timeout_sec=seconds)
        self.hear_grader(0)

    def hear_grader(self, seconds: float) -> None:
        """Read what the grader says, if it says something: see TICK, QUIET and EXITED."""
        if not select.select([0], [], [], seconds)[0]:
            return
        self.heed(os.read(0, 4096))

    def heed(self, heard: bytes) -> None:
        """Take what the grader said; nothing at all is its end."""
        self.patience_s += heard.count(TICK) * TICK_S
        self.quiet = self.quiet or QUIET in heard or not heard
        self.student_exited = self.student_exited or EXITED in heard or not heard

    def wait_until_quiet(self, question: str = 'is_it_quiet') -> None:
        """
        Wait until no thread of the student's program runs, or it has ended, and none of ours.

        The grader bounds the wait.

        :param question: ``is_it_still`` is whether none has run for some milliseconds
        """
        self.quiet = False
        self.write({'event': question})
        while not self.quiet:
            self.hear_grader(1.0)

    def drain(self) -> None:
        """
        Handle every message that has already arrived.

        Taken one by one from each topic in turn, as an executor does, but without asking the
        middleware each time who has one: that costs a millisecond, and most have none.
        """
        for _ in range(MOST_AT_ONCE):
            taken = False
            for subscription in list(self.node.subscriptions):
                with subscription.handle:
                    found = subscription.handle.take_message(subscription.msg_type, False)
                if found is not None:
                    taken = True
                    subscription.callback(found[0])
            if not taken:
                return

    def student_nodes(self) -> list[str]:
        """Return the fully qualified names of all nodes but ours, sorted."""
        return self.seen.askable()

    def wait_for_nodes(self) -> None:
        """Wait until the student's side shows a node."""
        deadline = self.patience_s + self.scenario['appear_s']
        while not self.student_nodes():
            if self.student_exited:
                raise Stop('student_exited')
            if self.patience_s > deadline:
                raise Stop('no_node')
            self.spin(0.02)

    def ask_all(self) -> None:
        """
        Ask every node of the program for a first answer.

        News of a second node may come after the first one has been seen, and even after it has
        answered; so it goes on until the program is quiet and there is nobody left to ask.
        """
        until = self.patience_s + self.scenario['first_answer_s']
        while new := [name for name in self.student_nodes() if name not in self.asked]:
            for name in new:
                self.ask_first(name, until - self.patience_s)
            self.wait_until_quiet()
            self.drain()

    def ask_first(self, name: str, patience_s: float) -> None:
        """
        Ask a node for a first answer; one that gives none is not asked again.

        :param patience_s: what is left of the time of all; the node has some time in any case
        """
        self.asked.add(name)
        began, left = self.patience_s, max(patience_s, 2 * TICK_S)
        if not self.trips.ask(name, 1, max(left, min(LEAST_S, self.spare_s))):
            self.unreachable.add(name)
        self.spare_s -= max(0.0, self.patience_s - began - left)
        self.emit('barrier', node=name, answered=name not in self.unreachable)

    def ask_again(self) -> None:
        """
        Prove that the program lives on after its first answer, or notice that it ends.

        A program that spins once answers, too.  While it ends all of it may be at rest, and
        whether its node is still in the graph is a matter of milliseconds.
        """
        until = self.patience_s + AGAIN_S
        for name in sorted(self.asked - self.unreachable):
            # One with a loop of its own may take its time: that is no matter here.
            self.trips.ask(name, 1, max(until - self.patience_s, TICK_S))
        # What was logged before we met is fetched, and belongs before the first step.
        self.wait_until_quiet('is_it_still')
        self.drain()

    def barrier(self, rounds: int) -> None:
        """
        Prove that every node that answers has handled all it was sent before.

        What it sent in turn has arrived; :meth:`drain` takes it in.
        """
        names = self.student_nodes()
        if not names:
            # Nobody is left to answer: the program takes its node down, usually to end.
            self.wait_until(lambda: False, LEAVE_S)
            raise Stop('no_node_left')
        for name in names:
            # News of a second context of the program can be seconds late.
            if name not in self.asked:
                before = self.patience_s
                self.ask_first(name, self.late_s)
                self.late_s -= self.patience_s - before
                self.wait_until_quiet('is_it_still')
            if name in self.unreachable:
                continue
            if not self.trips.ask(name, rounds, self.scenario['answer_s']):
                self.emit('unresponsive', node=name)
                raise Stop('unresponsive')

    def settle(self, in_flight: int) -> None:
        """Run barriers until a round brings no further log or message."""
        self.barrier(in_flight + 1)
        self.drain()
        for _ in range(5):
            before = self.events
            self.wait_until_quiet()
            self.barrier(1)
            self.drain()
            if self.events == before:
                return

    def meet(self) -> None:
        """
        Prove that every node that answers knows which endpoints of ours there are by now.

        Announcements are in order, so the answer to a client made last proves all earlier ones.
        """
        self.trips.forget()
        self.barrier(1)
        self.drain()

    # -- the scenario ----------------------------------------------------------------------

    def run(self) -> None:
        """Run the whole scenario; always ends with a graph and an ``end`` event."""
        self.began = time.monotonic()
        reason, started = 'complete', False
        try:
            self.wait_for_nodes()
            self.emit('seen', nodes=self.student_nodes())
            self.ask_all()
            seen = self.seen.facts()
            self.ask_again()
            self.graph('start', seen)
            started = True
            lockstep = len(self.unreachable) < len(self.student_nodes())
            for number, step in enumerate(self.scenario['steps'], 1):
                if step['do'] not in ('await', 'mark', 'look'):
                    self.before_step = (self.logs, self.messages)
                take(self, number, step, lockstep and not self.own_time)
        except Stop as stop:
            reason = str(stop)
        # What it sent last, just before it ended, may still be on its way.
        self.wait_until_quiet()
        self.drain()
        # A program that ended before its node could be asked has shown nothing for certain:
        # whether its node is still in the graph is a matter of milliseconds.
        if started or reason != 'student_exited':
            self.graph('end')
        self.emit('end', reason=reason, wall_s=self.now())

    def tick(self, nanoseconds: int) -> None:
        """Publish the simulated time."""
        self.clock_ns = nanoseconds
        if self.ticks is not None:
            self.ticks.add(nanoseconds)
        seconds, rest = divmod(nanoseconds, NANOSECONDS)
        self.clock.publish(Clock(clock=Time(sec=seconds, nanosec=rest)))

    def wait_until(self, condition: Callable[[], bool], seconds: float) -> bool:
        """Wait until something holds, at most so long; tell whether it does."""
        deadline = self.patience_s + seconds
        while not condition():
            if self.student_exited:
                raise Stop('student_exited')
            if self.patience_s > deadline:
                return False
            self.spin(0.05)
        return True

    def graph(self, when: str, seen: dict[str, Any] | None = None) -> None:
        """Write down the graph, as it is now or was."""
        seen = seen or self.seen.facts()
        if self.seen.own_name in seen['nodes'] and not self.imitated:
            self.imitated = True
            self.emit('imitated')
        self.emit('graph', when=when, **seen)


def main() -> None:
    """Read the scenario, say that we are ready, run, and leave without a long good-bye."""
    probe_loopback.wait()
    # Unbuffered: later words are waited for on the descriptor itself; some may be there already.
    heard = b''
    while b'\n' not in heard:
        said = os.read(0, 1 << 16)
        if not said:
            return  # the grader is gone, and nobody wants to know
        heard += said
    line, _, more = heard.partition(b'\n')
    probe = Probe(json.loads(line))
    if more:
        probe.heed(more)
    probe.write({'event': 'ready'})
    probe.run()
    probe.node.destroy_node()
    rclpy.shutdown(context=probe.context)


if __name__ == '__main__':
    main()
