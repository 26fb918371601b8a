"""
Execute the steps of a scenario, which :mod:`autograder.exam.steps` defines.

Each kind of step is a function that gets the probe and the step's data.
"""

from collections.abc import Callable
from typing import Any

from probe_wire import (  # type: ignore[import-not-found]  # next to this file
    fill,
    load_type,
    policy_name,
    qos_profile,
    to_json,
)
from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks

CONNECT_S = 1.0  # timeout for the discovery of an endpoint


class Stop(Exception):
    """End the scenario early; the message is the reason in the ``end`` event."""


def advance(probe: Any, step: dict[str, Any]) -> None:
    """Let virtual time pass."""
    probe.listen(step['seconds'])


def feed(probe: Any, step: dict[str, Any]) -> None:
    """
    Send messages, at intervals of ``every_s`` or in one burst, and listen after the last one.

    :raises Stop: if the program does not subscribe to the topic and the step is not optional
    """
    cls, publisher = probe.feeds[step['topic']]
    if not probe.wait_until(lambda: publisher.get_subscription_count() > 0, CONNECT_S):
        probe.emit('not_connected', topic=step['topic'])
        if step['optional']:
            return
        raise Stop('not_connected')
    for message in step['messages']:
        probe.input = 0 if probe.input is None else probe.input + 1
        probe.emit('input', index=probe.input, topic=step['topic'], data=message)
        publisher.publish(fill(cls(), message))
        if not step['burst']:
            probe.listen(step['every_s'])
    if step['burst']:
        probe.listen(step['every_s'] * len(step['messages']))
    probe.listen(step['rest_s'])


def call(probe: Any, step: dict[str, Any]) -> None:
    """Call a service once, without a retry: a second call could cause another transition."""
    facts = {'service': step['service'], 'type': step['type'], 'request': step['request']}
    client = probe.services[step['service']]
    if not probe.wait_until(client.service_is_ready, CONNECT_S):
        client = _client_of_only_node(probe, step)
    if client is None:
        probe.emit('no_answer', **facts, reason='no_service')
        return
    future = client.call_async(fill(client.srv_type.Request(), step['request']))
    if probe.wait_until(future.done, step['patience_s']):
        probe.emit('answer', **facts, data=to_json(future.result()))
    else:
        client.remove_pending_request(future)
        probe.emit('no_answer', **facts, reason='too_late')
    probe.settle()


def _client_of_only_node(probe: Any, step: dict[str, Any]) -> Any:
    """
    Return a client for the same service of the program's only node, or None.

    A wrong node name then fails only the check of the name, not all checks of the service.  The
    name of a service that does not begin with the node's is the program's own choice.
    """
    names, service = probe.seen.askable(), step['service']
    base = service.rpartition('/')[2]
    if len(names) != 1 or service != f'{step["node"]}/{base}':
        return None
    other = f'{names[0]}/{base}'
    client = probe.node.create_client(load_type(step['type']), other)
    if other == service or not probe.wait_until(client.service_is_ready, CONNECT_S):
        probe.node.destroy_client(client)
        return None
    probe.services[service] = client  # later calls use this client too
    return client


def join(probe: Any, step: dict[str, Any]) -> None:
    """Add one or more subscriptions of the probe, and listen."""
    name, topic = step['name'], step['topic']
    refused: list[str] = []

    def heard(message: Any, info: Any) -> None:
        probe.message(topic, message, info, listener=name)

    callbacks = SubscriptionEventCallbacks(**_noting(refused))
    cls, qos = load_type(step['type']), qos_profile(step['qos'])
    probe.listeners[name] = [
        probe.node.create_subscription(cls, topic, heard, qos, event_callbacks=callbacks)
        for _ in range(step['copies'])
    ]
    matched = _is_matched(probe, probe.listeners[name][-1].get_publisher_count, refused)
    probe.emit('joined', listener=name, topic=topic, matched=matched, refused=refused[:1])
    probe.listen(step['listen_s'])
    probe.settle()


def offer(probe: Any, step: dict[str, Any]) -> None:
    """Add a publisher of the probe."""
    name, topic, cls = step['name'], step['topic'], load_type(step['type'])
    refused: list[str] = []
    callbacks = PublisherEventCallbacks(**_noting(refused))
    publisher = probe.node.create_publisher(
        cls, topic, qos_profile(step['qos']), event_callbacks=callbacks
    )
    probe.feeds[name] = cls, publisher
    matched = _is_matched(probe, publisher.get_subscription_count, refused)
    probe.emit('offered', publisher=name, topic=topic, matched=matched, refused=refused[:1])
    probe.settle()


def _noting(refused: list[str]) -> dict[str, Any]:
    """Return arguments for event callbacks that note the policies which do not match."""
    return {
        'incompatible_qos': lambda status: refused.append(policy_name(status)),
        'use_default_callbacks': False,
    }


def _is_matched(probe: Any, count: Callable[[], int], refused: list[str]) -> bool:
    """Wait until an endpoint has a partner or is refused; return whether it has a partner."""
    probe.wait_until(lambda: count() > 0 or bool(refused), CONNECT_S)
    return count() > 0


def leave(probe: Any, step: dict[str, Any]) -> None:
    """Remove a publisher or a subscription of the probe."""
    name = step['name']
    if name in probe.feeds:
        _, publisher = probe.feeds.pop(name)
        probe.node.destroy_publisher(publisher)
    # A recorded topic that is left at the start has no subscription yet.
    for subscription in (*probe.listeners.pop(name, ()), probe.watched.pop(name, None)):
        if subscription:
            probe.node.destroy_subscription(subscription)
    probe.emit('left', name=name)
    probe.settle()


def watch(probe: Any, step: dict[str, Any]) -> None:
    """Subscribe to a recorded topic again."""
    probe.watch(step['topic'])
    probe.emit('watched', topic=step['topic'])
    probe.settle()


def mark(probe: Any, step: dict[str, Any]) -> None:
    """Record the start of a phase of the scenario."""
    probe.emit('mark', name=step['name'])


def look(probe: Any, step: dict[str, Any]) -> None:
    """Record the graph."""
    probe.graph(step['when'])


STEPS: dict[str, Callable[[Any, dict[str, Any]], None]] = {
    step.__name__: step for step in (advance, feed, call, join, offer, leave, watch, mark, look)
}


def take(probe: Any, number: int, step: dict[str, Any]) -> None:
    """
    Execute one step.

    :raises Stop: if the scenario ends with this step
    :raises RuntimeError: if the probe fails; the error message is one line, because the grader
        shows only the last line
    """
    try:
        STEPS[step['do']](probe, step)
    except (Stop, MemoryError):
        raise
    except Exception as error:
        words = ' '.join(f'{type(error).__name__}: {error}'.split())
        raise RuntimeError(f'step {number} ({step["do"]}): {words}') from error
