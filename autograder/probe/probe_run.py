"""
Run one scenario: create the probe's endpoints, receive messages, and wait in virtual time.

The probe is an ordinary ROS program that shares a virtual clock with the student's program.  Time
stands still while either of them computes.  So when a wait of the probe ends, the student's
program has handled every message sent to it, and all its answers have arrived; the probe needs no
other synchronisation.
"""

from collections.abc import Callable
import json
import os
import time
from typing import Any

from builtin_interfaces.msg import Time
from probe_graph import Graph  # type: ignore[import-not-found]  # next to this file
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
LOOK_S = 0.05  # interval between checks for the first node; discovery takes 0.11 s
# The time from the first node to the first step. This value keeps the steps off multiples of all
# usual periods, so that no input coincides with a timer.
MEET_S = 0.48
SETTLE_S = 0.2  # time for both sides to discover a new endpoint, or its removal
LONGEST_EVENT = 65536  # characters of a message's JSON; only the size of longer JSON is recorded
MOST_EVENTS = 20000
COMPLETE = 'complete'
MOST_ASKED = 50  # maximum number of nodes whose services are called at the end
ANSWER_S = 3.0
QUESTIONS = ((GetParameters, 'get_parameters'), (GetTypeDescription, 'get_type_description'))
# Turn off rclpy's warnings about incompatible QoS, which are not recorded. Without their event
# handlers, the probe waits on only a third as many entities.
SILENT_PUBLISHER = PublisherEventCallbacks(use_default_callbacks=False)
SILENT_SUBSCRIPTION = SubscriptionEventCallbacks(use_default_callbacks=False)


class Probe:
    """One run of one scenario, see :class:`autograder.exam.scenario.Scenario`."""

    def __init__(self, scenario: dict[str, Any]) -> None:
        """Create the probe's first endpoints, before the student's code starts."""
        self.scenario = scenario
        # Standard output is only for events: send rclpy's warnings to standard error.
        self.output = os.fdopen(os.dup(1), 'w', encoding='utf-8')
        os.dup2(2, 1)
        self.events, self.full = 0, False
        self.began_ns: int | None = None
        self.over_ns: int | None = None
        self.input: int | None = None
        self.context = Context()
        # The probe cannot write log files in its sandbox.
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
        self.watched: dict[str, Any] = {}
        acts = [step for step in scenario['steps'] if step['do'] != 'mark']
        alone = [step['name'] for step in acts[:1] if step['do'] == 'leave']
        for topic in scenario['watch']:
            if topic not in alone:
                self.watch(topic)
        logs = QoSProfile(depth=1000, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self._subscribe(Log, '/rosout', self._log, logs)
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

    def watch(self, topic: str) -> None:
        """Subscribe to a topic that the scenario records."""
        # A best-effort, volatile subscription matches every publisher, so a wrong QoS profile in
        # the program does not hide its messages.
        hearing = QoSProfile(
            depth=100,
            reliability=ReliabilityPolicy.BEST_EFFORT,
            durability=DurabilityPolicy.VOLATILE,
        )

        def heard(message: Any, info: Any) -> None:
            self.message(topic, message, info)

        kind = load_type(self.scenario['watch'][topic])
        self.watched[topic] = self._subscribe(kind, topic, heard, hearing)

    def _publisher(self, cls: Any, topic: str, qos: Any) -> Any:
        return self.node.create_publisher(cls, topic, qos, event_callbacks=SILENT_PUBLISHER)

    def _subscribe(self, cls: Any, topic: str, heard: Callable[..., None], qos: Any) -> Any:
        events = SILENT_SUBSCRIPTION
        return self.node.create_subscription(cls, topic, heard, qos, event_callbacks=events)

    # -- writing ---------------------------------------------------------------------------

    @property
    def clock_ns(self) -> int | None:
        """Return the virtual time since the release [ns]; None before it, fixed after the end."""
        if self.began_ns is None or self.over_ns is not None:
            return self.over_ns
        return time.monotonic_ns() - self.began_ns

    def emit(self, event: str, **facts: Any) -> None:
        """
        Write one event; messages and log lines after the last step are dropped.

        :raises Stop: if the recording has too many events
        """
        if self.over_ns is not None and event in ('message', 'log'):
            return
        self.events += 1
        if self.events > MOST_EVENTS and event not in ('graph', 'end', 'imitated'):
            if self.full:
                return  # callbacks may still run after the scenario was stopped
            self.full = True
            raise Stop('too_many_events')
        self.write({'event': event, 'clock_ns': self.clock_ns, **facts})

    def write(self, line: dict[str, Any]) -> None:
        """Write one line of JSON to the grader."""
        print(json.dumps(line, allow_nan=False), file=self.output, flush=True)

    def message(self, topic: str, message: Any, info: Any, **facts: Any) -> None:
        """Write an event for a received message, with the publisher's sequence number."""
        if self.over_ns is not None:
            return
        data = to_json(message)
        size = len(json.dumps(data))
        what = {'too_large': size} if size > LONGEST_EVENT else {'data': data}
        facts['number'] = info['publication_sequence_number']
        # A publisher may keep messages for late subscriptions, so they can be old on arrival.
        if age_ns := time.time_ns() - info['source_timestamp']:
            facts['age_ns'] = age_ns
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
        """Write the current graph."""
        seen = self.seen.facts()
        if self.seen.own_name in seen['nodes'] and not self.imitated:
            self.imitated = True
            self.emit('imitated')
        self.emit('graph', when=when, **seen)

    # -- waiting ---------------------------------------------------------------------------

    def listen(self, seconds: float) -> None:
        """
        Let virtual time pass, and handle the messages that arrive.

        The probe uses a wait set directly: an executor checks every entity of the node again for
        each wait, which took half of the probe's processor time.
        """
        until_ns = time.monotonic_ns() + round(seconds * SECOND)
        while (now_ns := time.monotonic_ns()) < until_ns:
            self._take_messages(self._due_ns(now_ns, until_ns) - now_ns)

    def _take_messages(self, most_ns: int) -> None:
        """Wait for messages, at most ``most_ns``, and handle all, one per subscription in turn."""
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
        """Wait until a condition is true; return False if it is still false after the timeout."""
        until_ns = time.monotonic_ns() + round(seconds * SECOND)
        while not condition():
            now_ns = time.monotonic_ns()
            if now_ns >= until_ns:
                return False
            # rclpy truncates the timeout to whole nanoseconds; adding 0.5 ns prevents a loss.
            self.executor.spin_once(
                timeout_sec=(self._due_ns(now_ns, until_ns) - now_ns + 0.5) / SECOND
            )
        return True

    def settle(self) -> None:
        """Listen until both sides have discovered a new endpoint of the probe, or its removal."""
        self.listen(SETTLE_S)

    def _due_ns(self, now_ns: int, until_ns: int) -> int:
        """Publish the ROS time if it is due, and return when the current wait must end [ns]."""
        if not self.clock:
            return until_ns
        clock = self.scenario['ros_clock']
        step_ns = round(clock['step_s'] * SECOND)
        every_ns = round(step_ns / clock['rate'])
        assert self.began_ns is not None
        due_ns = self.began_ns + self.ticks * every_ns
        if now_ns >= due_ns:
            ros_ns = round(clock['begins_s'] * SECOND) + self.ticks * step_ns
            seconds, rest = divmod(ros_ns, SECOND)
            self.clock.publish(Clock(clock=Time(sec=seconds, nanosec=rest)))
            self.ticks += 1
            due_ns += every_ns
        return min(until_ns, due_ns)

    # -- the scenario ----------------------------------------------------------------------

    def run(self) -> None:
        """Run the scenario, then write the last graph and the ``end`` event."""
        self.began_ns = time.monotonic_ns()
        reason = self._why_over(self._take_steps)
        self.over_ns = self.clock_ns
        self.graph('end')
        if reason in (COMPLETE, 'not_connected'):
            reason = self._why_over(self._ask_all, reason)
        self.emit('end', reason=reason)

    def _why_over(self, part: Callable[[], None], reason: str = COMPLETE) -> str:
        """Run a part of the run; return why it stopped, or the given reason if it did not."""
        try:
            part()
        except Stop as stop:
            return str(stop)
        except MemoryError:  # only what the program sends is large
            return 'too_much_recorded'
        return reason

    def _take_steps(self) -> None:
        if not self._wait_for_node():
            raise Stop('no_node')
        self.emit('seen', nodes=self.seen.askable())
        self.graph('seen')  # the program may end in its first timer callback
        self.listen(MEET_S)
        self.graph('start')
        for number, step in enumerate(self.scenario['steps'], 1):
            take(self, number, step)

    def _wait_for_node(self) -> bool:
        """Listen until a node appears; return whether one appeared in time."""
        for _ in range(round(self.scenario['appear_s'] / LOOK_S)):
            self.listen(LOOK_S)
            if self.seen.askable():
                return True
        return False

    def _ask_all(self) -> None:
        """Record which nodes are spun: each node has a service that only its executor answers."""
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
        """
        Return a client for a standard service of a node; None if the node has no such service.

        A node without parameter services has the type description service of REP 2016.
        """
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
