"""
The steps of a scenario, as the probe takes them; :mod:`autograder.runs.scenario` has them all.

Each is a function of the probe, the step's data, and whether the student's program answers our
round trips ("lockstep").  A program that does not is watched in wall time instead.

This file imports nothing of this project but the probe's own parts: only its text enters the
probe's sandbox.
"""

from __future__ import annotations

from collections.abc import Callable
import time
from typing import Any

from probe_wire import (  # type: ignore[import-not-found]  # beside this file
    fill,
    load_type,
    policy_name,
    qos_profile,
    to_json,
)
from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks

NANOSECONDS = 1_000_000_000
CONNECT_S = 1.0
TICK_EVERY_S = 0.01
# Of a clock that waits for the program: the longest step, and how much slower than real time.
LONGEST_TICK_S, SLOWEST_CLOCK = 0.1, 2
# What is watched in real time is judged by real pauses: from a third of a period on, a pause of
# ours would be taken for one of the program's.
MOST_STALLED_S = 0.3
DEAF_S = 0.5  # how long a program is watched that has not even taken the first request
STILL_S = 0.2  # how long a graph must stay as it is; news of an endpoint takes a millisecond
MOST_SOURCES = 50
WITHOUT_ANSWERS_S = 0.3  # what a program that never answers round trips gets to react to a step


class Stop(Exception):
    """The scenario ends here; the reason goes into the ``end`` event."""


def advance(probe: Any, step: dict[str, Any], lockstep: bool) -> None:
    """Move the clock forward in equal steps, each proven to be handled."""
    now = probe.clock_ns or 0
    if lockstep and probe.scenario['stand_still_s']:
        _stand_still(probe)
        if step is _last_advance(probe) and not probe.own_time:
            raise Stop('follows_the_clock')  # all that was to be found out
    if probe.own_time or not lockstep:
        watch = _advance_in_both_times if probe.own_time else _advance_in_wall_time
        watch(probe, now, DEAF_S if probe.deaf else step['watch_s'])
        return
    for number in range(step['steps']):
        probe.tick(now + step['first_ns'] + number * step['step_ns'])
        probe.barrier(2)
        # A rate in a thread of its own is woken by the tick, and must be asleep again
        # before the next one.
        probe.wait_until_quiet()
        probe.drain()


def _stand_still(probe: Any) -> None:
    """Notice what publishes, or logs if nothing is watched, while no time passes."""
    topics = probe.scenario['watch']
    ends = probe.seen.facts()['endpoints']
    if topics and not any(e['kind'] == 'publisher' and e['topic'] in topics for e in ends):
        return
    probe.heard_from.clear()
    # To the end: of two nodes, one may be slower than the other.
    probe.wait_until(lambda: False, probe.scenario['stand_still_s'])
    heard = {one for one in probe.heard_from if not topics or one in topics}
    if heard:
        probe.own_time = True
        probe.emit('other_clock', sources=sorted(heard)[:MOST_SOURCES])


def _last_advance(probe: Any) -> dict[str, Any]:
    steps: list[dict[str, Any]] = probe.scenario['steps']
    return [step for step in steps if step['do'] == 'advance'][-1]


def _advance_in_both_times(probe: Any, start_ns: int, seconds: float) -> None:
    """
    Watch a program of which only some part keeps its own time.

    The clock goes as fast as real time where the program keeps up, and slower where it does not:
    what follows the clock stands at its tick, however late a busy machine lets it run.
    """
    probe.emit('wall_time', seconds=seconds)
    clock_ns, end_ns = start_ns, start_ns + int(seconds * NANOSECONDS)
    until, seen = probe.patience_s + SLOWEST_CLOCK * seconds, time.monotonic()
    while clock_ns < end_ns and probe.patience_s < until:
        now = time.monotonic()
        clock_ns += int(min(now - seen, LONGEST_TICK_S) * NANOSECONDS)
        seen = now
        probe.tick(clock_ns)
        probe.barrier(2)  # not quiet too: what keeps its own time may compute all the time
        probe.drain()
        _pass_time(probe, now + TICK_EVERY_S)


def _advance_in_wall_time(probe: Any, start_ns: int, seconds: float) -> None:
    # Code that never answers the barrier keeps its own time; it is watched in ours.
    began = looked = time.monotonic()
    probe.emit('wall_time', seconds=seconds)
    while looked - began < seconds:
        probe.tick(start_ns + int((looked - began) * NANOSECONDS))
        _pass_time(probe, time.monotonic() + TICK_EVERY_S)
        before, looked = looked, time.monotonic()
        if looked - before > TICK_EVERY_S + MOST_STALLED_S:
            raise Stop('too_busy')


def _pass_time(probe: Any, until: float) -> None:
    """
    Handle what arrives until some moment.

    We hear our own tick, so one look is no pause: without one, there would be thousands a second,
    and the probe would need more of the processor than what it watches.
    """
    while (left := until - time.monotonic()) > 0:
        if probe.student_exited:
            raise Stop('student_exited')
        probe.spin(left)


def feed(probe: Any, step: dict[str, Any], lockstep: bool) -> None:
    """Send readings one by one, or as one burst, and collect what follows each."""
    cls, publisher = probe.feeds[step['topic']]
    if not probe.wait_until(lambda: publisher.get_subscription_count() > 0, CONNECT_S):
        probe.emit('not_connected', topic=step['topic'])
        if step['optional']:
            return
        raise Stop('not_connected')
    for message in step['messages']:
        probe.input = 0 if probe.input is None else probe.input + 1
        before, logs = _heard(probe), probe.logs
        probe.emit('input', index=probe.input, topic=step['topic'], data=message)
        publisher.publish(fill(cls(), message))
        if step['burst']:
            continue
        if lockstep:
            probe.settle(1)
            if _heard(probe) == before:
                _let_a_second_pass(probe)
        if probe.input == 0 and probe.scenario['first_log_s'] > 0:
            _wait_for_first_log(probe, logs, lockstep)
        elif not lockstep:
            _wait_for_answer(probe, before, WITHOUT_ANSWERS_S)
    if step['burst'] and lockstep:
        probe.settle(len(step['messages']))
        if _heard(probe) < before + len(step['messages']):
            _let_a_second_pass(probe)


def _heard(probe: Any) -> int:
    """Count what a node may answer with."""
    return int(probe.logs + probe.messages)


def _let_a_second_pass(probe: Any) -> None:
    """Move the clock, so that a node that answers from a timer of its own answers."""
    for _ in range(4):
        probe.tick((probe.clock_ns or 0) + NANOSECONDS // 4)
        probe.barrier(2)
        probe.drain()
    probe.settle(1)


def _wait_for_first_log(probe: Any, logs: int, lockstep: bool) -> None:
    if not probe.wait_until(lambda: probe.logs > logs, probe.scenario['first_log_s']):
        probe.emit('no_first_log')
        if not lockstep:
            raise Stop('silent')
    elif lockstep:
        probe.settle(1)


def _wait_for_answer(probe: Any, before: int, seconds: float) -> None:
    probe.wait_until(lambda: _heard(probe) > before, seconds)


def call(probe: Any, step: dict[str, Any], lockstep: bool) -> None:
    """
    Call a service once.

    It is never sent again: a transition asked for twice is another thing.  Our client was there
    before the program, so the discovery barrier has proven that its server knows it.
    """
    facts = {'service': step['service'], 'type': step['type'], 'request': step['request']}
    client = probe.services[step['service']]
    # A node that has not answered a first question in seconds is spun by nobody.
    node = step['service'].rpartition('/')[0]
    silent = node in probe.unreachable
    patience_s = min(CONNECT_S, step['patience_s']) if silent else step['patience_s']
    if node in probe.deaf:
        patience_s = WITHOUT_ANSWERS_S
    try:
        if not probe.wait_until(client.service_is_ready, CONNECT_S):
            probe.emit('no_answer', **facts, reason='no_service')
            return
        future = client.call_async(fill(client.srv_type.Request(), step['request']))
        if not probe.wait_until(future.done, patience_s):
            client.remove_pending_request(future)
            if silent:  # what it was asked it will not do later: the rest is not worth seconds
                probe.deaf.add(node)
            probe.emit('no_answer', **facts, reason='too_late')
            return
    except Stop as stop:
        probe.emit('no_answer', **facts, reason=str(stop))
        raise
    probe.emit('answer', **facts, data=to_json(future.result()))
    _let_it_react(probe, lockstep)


def join(probe: Any, step: dict[str, Any], lockstep: bool) -> None:
    """Join with a subscription and listen until nothing more comes."""
    name, topic = step['name'], step['topic']
    refused: list[str] = []

    def heard(message: Any) -> None:
        probe.message(topic, message, listener=name)

    callbacks = SubscriptionEventCallbacks(
        incompatible_qos=lambda status: refused.append(policy_name(status)),
        use_default_callbacks=False,
    )
    probe.listeners[name] = subscription = probe.node.create_subscription(
        load_type(step['type']), topic, heard, qos_profile(step['qos']), event_callbacks=callbacks
    )
    _meet(probe, lambda: subscription.get_publisher_count() > 0 or bool(refused), lockstep)
    matched = subscription.get_publisher_count() > 0
    probe.emit('joined', listener=name, topic=topic, matched=matched, refused=refused[:1])
    _listen(probe, step['listen_s'])
    _let_it_react(probe, lockstep)


def offer(probe: Any, step: dict[str, Any], lockstep: bool) -> None:
    """Offer a topic with a publisher."""
    name, topic, cls = step['name'], step['topic'], load_type(step['type'])
    refused: list[str] = []
    callbacks = PublisherEventCallbacks(
        incompatible_qos=lambda status: refused.append(policy_name(status)),
        use_default_callbacks=False,
    )
    publisher = probe.node.create_publisher(
        cls, topic, qos_profile(step['qos']), event_callbacks=callbacks
    )
    probe.feeds[name] = cls, publisher
    _meet(probe, lambda: publisher.get_subscription_count() > 0 or bool(refused), lockstep)
    matched = publisher.get_subscription_count() > 0
    probe.emit('offered', publisher=name, topic=topic, matched=matched, refused=refused[:1])
    _let_it_react(probe, lockstep)


def leave(probe: Any, step: dict[str, Any], lockstep: bool) -> None:
    """Take a publisher or a subscription of ours away."""
    name = step['name']
    if name in probe.listeners:
        probe.node.destroy_subscription(probe.listeners.pop(name))
    else:
        _, publisher = probe.feeds.pop(name)
        probe.node.destroy_publisher(publisher)
    if lockstep:
        probe.meet()
    probe.emit('left', name=name)
    _let_it_react(probe, lockstep)


def mark(probe: Any, step: dict[str, Any], lockstep: bool) -> None:
    """Begin a phase."""
    probe.emit('mark', name=step['name'])


def look(probe: Any, step: dict[str, Any], lockstep: bool) -> None:
    """Write down the graph, when no more news of it comes."""
    for _ in range(20):
        before = probe.seen.facts()
        if not probe.wait_until(lambda before=before: probe.seen.facts() != before, STILL_S):
            break
    probe.graph(step['when'])


def await_(probe: Any, step: dict[str, Any], lockstep: bool) -> None:
    """Wait for what wall time brings."""
    logs = probe.before_step[0] + step['logs']
    messages = probe.before_step[1] + step['messages']

    def enough() -> bool:
        return bool(probe.logs >= logs and probe.messages >= messages)

    probe.emit('awaited', enough=probe.wait_until(enough, step['seconds']))
    _let_it_react(probe, lockstep)


def _meet(probe: Any, met: Callable[[], bool], lockstep: bool) -> None:
    """Wait until an endpoint of ours is matched or refused, on both sides."""
    probe.wait_until(met, CONNECT_S)
    if lockstep:
        probe.meet()


def _let_it_react(probe: Any, lockstep: bool) -> None:
    if lockstep:
        probe.settle(1)
    else:
        probe.wait_until(lambda: False, WITHOUT_ANSWERS_S)


def _listen(probe: Any, seconds: float) -> None:
    """Listen until nothing has come for so long; a topic that never rests is left alone."""
    for _ in range(100):
        before = probe.events
        if not probe.wait_until(lambda before=before: probe.events > before, seconds):
            return


STEPS: dict[str, Callable[[Any, dict[str, Any], bool], None]] = {
    'advance': advance,
    'feed': feed,
    'call': call,
    'join': join,
    'offer': offer,
    'leave': leave,
    'mark': mark,
    'look': look,
    'await': await_,
}


def take(probe: Any, number: int, step: dict[str, Any], lockstep: bool) -> None:
    """
    Take one step.

    :raises RuntimeError: if we fail at it; its words are one line, the only one the grader shows
    """
    try:
        STEPS[step['do']](probe, step, lockstep)
    except Stop:
        raise
    except Exception as error:
        words = ' '.join(f'{type(error).__name__}: {error}'.split())
        raise RuntimeError(f'step {number} ({step["do"]}): {words}') from error
