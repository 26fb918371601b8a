"""
One run of one scenario: the probe's endpoints, what it hears, and its waits.

The probe is an ordinary ROS program on the virtual clock that it shares with the student's
program.  Time stands still while either computes.  So when a wait of the probe is over, the
student's program has handled everything that it was sent, and all its answers have arrived: the
probe does not have to ask.

This file imports nothing of this project but the probe's own parts: only its text enters the
probe's sandbox.
"""

from __future__ import annotations

from collections.abc import Callable
import json
import os
import time
from typing import Any

from builtin_interfaces.msg import Time
from probe_graph import Graph  # type: ignore[import-not-found]  # beside this file
from probe_steps import CONNECT_S, Stop, take  # type: ignore[import-not-found]
from probe_wire import load_type, qos_profile, to_json  # type: ignore[import-not-found]
from rcl_interfaces.msg import Log
from rcl_interfaces.srv import GetParameters
import rclpy
from rclpy.context import Context
from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.executors import SingleThreadedExecutor
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.node import Node, NodeNameNonExistentError
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rosgraph_msgs.msg import Clock
from type_description_interfaces.srv import GetTypeDescription

SECOND = 1_000_000_000
LOOK_S = 0.05  # how often we look for the first node; two programs meet in 0.11 s
# From the first node to the first step. Together they put the steps off the grid of all usual
# periods, so no input meets a tick of a timer.
MEET_S = 0.48
SETTLE_S = 0.2
LONGEST_EVENT = 65536  # characters of one message's JSON; longer ones are recorded by their size
MOST_EVENTS = 20000
MOST_ASKED = 50  # nodes
ANSWER_S = 3.0
QUESTIONS = ((GetParameters, 'get_parameters'), (GetTypeDescription, 'get_type_description'))
# rclpy's own warnings about endpoints that do not fit are read by nobody here; without them there
# is a third of the entities to wait for.
SILENT_PUBLISHER = PublisherEventCallbacks(use_default_callbacks=False)
SILENT_SUBSCRIPTION = SubscriptionEventCallbacks(use_default_callbacks=False)


class Probe:
    """
    One run of one scenario.

    :param scenario: see :class:`autograder.exam.scenario.Scenario`
    """

    def __init__(self, scenario: dict[str, Any]) -> None:
        """Create every endpoint of the probe before the student's code is started."""
        self.scenario = scenario
        # Other output on standard output, such as rclpy's own warnings, is not an event.
        self.output = os.fdopen(os.dup(1), 'w', encoding='utf-8')
        os.dup2(2, 1)
        self.events, self.full = 0, False
        self.began_ns: int | None = None
        self.over_ns: int | None = None
        self.input: int | None = None
        self.context = Context()
        # A probe may write no files.
        options = ['--ros-args', '--disable-external-lib-logs']
        rclpy.init(args=options, context=self.context)
        self.node = Node(
            scenario['name'],
            context=self.context,
            start_parameter_services=False,
            enable_rosout=False,
            use_global_arguments=False,
        )
        self.executor = SingleThreadedExecutor(context=self.context)
        self.executor.add_node(self.node)
        self.watched: list[Any] = []
        self._watch_topics()
        self.clock = self._publisher(Clock, '/clock', 10) if scenario['ros_clock'] else None
        self.ticks = 0
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

    def _watch_topics(self) -> None:
        # A best-effort, volatile reader matches every writer, so a QoS mistake is seen as what it
        # is and not as silence.
        hearing = QoSProfile(
            depth=100,
            reliability=ReliabilityPolicy.BEST_EFFORT,
            durability=DurabilityPolicy.VOLATILE,
        )
        for topic, name in self.scenario['watch'].items():

            def heard(message: Any, info: Any, topic: str = topic) -> None:
                self.message(topic, message, info)

            self.watched.append(self._subscribe(load_type(name), topic, heard, hearing))
        logs = QoSProfile(depth=1000, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self._subscribe(Log, '/rosout', self._log, logs)

    def _publisher(self, cls: Any, topic: str, qos: Any) -> Any:
        return self.node.create_publisher(cls, topic, qos, event_callbacks=SILENT_PUBLISHER)

    def _subscribe(self, cls: Any, topic: str, heard: Callable[..., None], qos: Any) -> Any:
        events = SILENT_SUBSCRIPTION
        return self.node.create_subscription(cls, topic, heard, qos, event_callbacks=events)

    # -- writing ---------------------------------------------------------------------------

    @property
    def clock_ns(self) -> int | None:
        """Return the virtual time since the program was let go; it ends with the last step."""
        if self.began_ns is None or self.over_ns is not None:
            return self.over_ns
        return time.monotonic_ns() - self.began_ns

    def emit(self, event: str, **facts: Any) -> None:
        """Write one event; what comes when the last step is over is left out."""
        if self.over_ns is not None and event in ('message', 'log'):
            return
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

    def message(self, topic: str, message: Any, info: Any, **facts: Any) -> None:
        """Write down a message that was received, and how many its publisher had sent by then."""
        data = to_json(message)
        size = len(json.dumps(data))
        what = {'too_large': size} if size > LONGEST_EVENT else {'data': data}
        facts['number'] = info['publication_sequence_number']
        self.emit('message', topic=topic, **what, after_input=self.input, **facts)

    def _log(self, entry: Log, _info: Any) -> None:
        self.emit(
            'log',
            name=entry.name[:256],
            level=int(entry.level),
            text=entry.msg[:2000],
            function=entry.function[:256],
            line=entry.line,
            after_input=self.input,
        )

    def graph(self, when: str) -> None:
        """Write down the graph as it is now."""
        seen = self.seen.facts()
        if self.seen.own_name in seen['nodes'] and not self.imitated:
            self.imitated = True
            self.emit('imitated')
        self.emit('graph', when=when, **seen)

    # -- waiting ---------------------------------------------------------------------------

    def listen(self, seconds: float) -> None:
        """
        Let virtual time pass, and handle the messages that arrive.

        The probe waits on the middleware itself: an executor checks every entity of the node
        again for each wait, and that was half of the probe's cost.
        """
        until_ns = time.monotonic_ns() + round(seconds * SECOND)
        while (now_ns := time.monotonic_ns()) < until_ns:
            self._take_messages(self._due_ns(now_ns, until_ns) - now_ns)

    def _take_messages(self, most_ns: int) -> None:
        """Wait at most so long for messages, and handle them, of each topic one in turn."""
        heard = list(self.node.subscriptions)
        waiting = _rclpy.WaitSet(len(heard), 0, 0, 0, 0, 0, self.context.handle)
        waiting.clear_entities()
        for subscription in heard:
            waiting.add_subscription(subscription.handle)
        waiting.wait(most_ns)
        while heard:
            found = [(one, one.handle.take_message(one.msg_type, False)) for one in heard]
            heard = [one for one, message in found if message]
            for one, message in found:
                if message:
                    one.callback(*message)

    def wait_until(self, condition: Callable[[], bool], seconds: float) -> bool:
        """Wait until something holds, at most so long; tell whether it does."""
        until_ns = time.monotonic_ns() + round(seconds * SECOND)
        while not condition():
            now_ns = time.monotonic_ns()
            if now_ns >= until_ns:
                return False
            # A time-out is a float of seconds, which is cut to whole nanoseconds.
            self.executor.spin_once(
                timeout_sec=(self._due_ns(now_ns, until_ns) - now_ns + 0.5) / SECOND
            )
        return True

    def _due_ns(self, now_ns: int, until_ns: int) -> int:
        """Return when to look next; the ROS time that is due by now is told."""
        return min(until_ns, self._tick(now_ns)) if self.clock else until_ns

    def settle(self) -> None:
        """Listen until both sides know of an endpoint of ours, or that it is gone."""
        self.listen(SETTLE_S)

    def _tick(self, now_ns: int) -> int:
        """Publish the ROS time if it is due, and return when the next one is."""
        clock = self.scenario['ros_clock']
        step_ns = round(clock['step_s'] * SECOND)
        every_ns = round(step_ns / clock['rate'])
        assert self.began_ns is not None
        assert self.clock is not None
        due_ns = self.began_ns + self.ticks * every_ns
        if now_ns >= due_ns:
            told_ns = round(clock['begins_s'] * SECOND) + self.ticks * step_ns
            seconds, rest = divmod(told_ns, SECOND)
            self.clock.publish(Clock(clock=Time(sec=seconds, nanosec=rest)))
            self.ticks += 1
            due_ns += every_ns
        return due_ns

    # -- the scenario ----------------------------------------------------------------------

    def run(self) -> None:
        """Run the whole scenario; always ends with a graph and an ``end`` event."""
        self.began_ns = time.monotonic_ns()
        reason = 'complete'
        try:
            if not self._somebody_comes():
                raise Stop('no_node')
            self.emit('seen', nodes=self.seen.askable())
            self.graph('seen')  # for a program that ends with the first tick of a timer
            self.listen(MEET_S)
            self.graph('start')
            for number, step in enumerate(self.scenario['steps'], 1):
                take(self, number, step)
        except Stop as stop:
            reason = str(stop)
        self.over_ns = self.clock_ns
        self.graph('end')
        if reason in ('complete', 'not_connected'):
            self._ask_all()
        self.emit('end', reason=reason)

    def _somebody_comes(self) -> bool:
        """Listen until there is a node; tell whether one came in time."""
        for _ in range(round(self.scenario['appear_s'] / LOOK_S)):
            self.listen(LOOK_S)
            if self.seen.askable():
                return True
        return False

    def _ask_all(self) -> None:
        """Find out which nodes are spun: each has a service that only its executor answers."""
        nodes = self.seen.askable()[:MOST_ASKED]
        clients = {name: self._client_of(name) for name in nodes}
        self.wait_until(lambda: all(map(_is_ready, clients.values())), CONNECT_S)
        answers = {
            name: client.call_async(client.srv_type.Request())
            for name, client in clients.items()
            if _is_ready(client)
        }
        self.wait_until(lambda: all(answer.done() for answer in answers.values()), ANSWER_S)
        for name in nodes:
            self.emit('asked', node=name, answered=name in answers and answers[name].done())

    def _client_of(self, name: str) -> Any:
        """Return a client of a service that every node has: REP 2016 if it has no parameters."""
        namespace, _, base = name.rpartition('/')
        try:
            known = self.node.get_service_names_and_types_by_node(base, namespace or '/')
        except NodeNameNonExistentError:
            return None
        for kind, service in QUESTIONS:
            if f'{name}/{service}' in dict(known):
                return self.node.create_client(kind, f'{name}/{service}')
        return None


def _is_ready(client: Any) -> bool:
    return client is not None and client.service_is_ready()
