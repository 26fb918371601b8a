"""
Round trips to the student's nodes: what the probe's barriers are made of.

A question goes to a service that every node has, and its answer comes from the node's executor.
The probe waits for it on the middleware itself: rclpy's executor looks at every entity of a node
anew for each wait, and that was half of what the probe cost.

This file imports nothing of this project but the probe's own parts: only its text enters the
probe's sandbox.
"""

from __future__ import annotations

import time
from typing import Any

from probe_steps import Stop  # type: ignore[import-not-found]  # beside this file
from rcl_interfaces.srv import GetParameters
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.node import NodeNameNonExistentError
from type_description_interfaces.srv import GetTypeDescription

RESEND_S = 0.5  # a request lost while endpoints still match; about one run in a hundred
LOOK_S = 0.05  # how often the grader is heard while we wait
KNOWN_S = 0.02  # how often we look whether a node can be asked yet
# Questions on their way to one node. A service keeps ten that nobody has taken (its QoS depth).
AT_ONCE = 2
NANOSECONDS = 1_000_000_000
QUESTIONS = ((GetParameters, 'get_parameters'), (GetTypeDescription, 'get_type_description'))


class RoundTrips:
    """
    Questions to the student's nodes.

    :param probe: whose node asks, and whose patience counts
    """

    def __init__(self, probe: Any) -> None:
        """Ask nobody yet."""
        self.probe = probe
        self.clients: dict[str, Any] = {}

    def forget(self) -> None:
        """Take all clients away; new ones are made when somebody is asked again."""
        for client in self.clients.values():
            self.probe.node.destroy_client(client)
        self.clients.clear()

    def ask(self, name: str, rounds: int, patience_s: float) -> bool:
        """
        Ask a node several times, and wait for all answers.

        An executor takes one request of a service in a pass, so each answer is a pass of its own
        although the next question is there already.

        :param patience_s: for each answer, in the program's own time
        :returns: whether all answers came
        :raises Stop: if the program ends
        """
        probe, resend = self.probe, 0.0
        waiting: set[int] = set()
        pause_s, until = LOOK_S, probe.patience_s + patience_s
        while rounds:
            if probe.patience_s > until:
                return False
            client = self._client_of(name)
            if not waiting and (client is None or not client.service_is_ready()):
                self._listen(None, KNOWN_S)
            else:
                if waiting and time.monotonic() >= resend:
                    waiting.clear()
                    # Who wants the processor often is often found waiting for it, and that
                    # time counts for nobody.
                    pause_s = RESEND_S
                question = client.srv_type.Request()
                while len(waiting) < min(rounds, AT_ONCE):
                    waiting.add(client.handle.send_request(question))
                    resend = time.monotonic() + RESEND_S
                self._listen(client, pause_s)
                if answered := waiting & _answers(client):
                    waiting -= answered
                    rounds -= len(answered)
                    until = probe.patience_s + patience_s
            if rounds and probe.student_exited:
                raise Stop('student_exited')
        return True

    def _client_of(self, name: str) -> Any:
        """
        Return our client of a service that every node has, or None while none is known.

        A node made without parameter services still describes its types (REP 2016); both are
        answered by the node's own executor, which is what a barrier needs.
        """
        node = self.probe.node
        if name not in self.clients:
            namespace, _, base = name.rpartition('/')
            try:
                known = node.get_service_names_and_types_by_node(base, namespace or '/')
            except NodeNameNonExistentError:
                return None
            names = {service for service, _ in known}
            for kind, service in QUESTIONS:
                if f'{name}/{service}' in names:
                    self.clients[name] = node.create_client(kind, f'{name}/{service}')
                    break
        return self.clients.get(name)

    def _listen(self, client: Any, seconds: float) -> None:
        """Wait for an answer or a message, handle messages, and hear the grader."""
        # Our own clock comes back to us with each tick; it has time until the next drain.
        heard = [each.handle for each in self.probe.node.subscriptions if each.topic != '/clock']
        asked = [client.handle] if client is not None else []
        context = self.probe.context.handle
        waiting = _rclpy.WaitSet(len(heard), 0, 0, len(asked), 0, 0, context)
        waiting.clear_entities()
        for handle in heard:
            waiting.add_subscription(handle)
        for handle in asked:
            waiting.add_client(handle)
        waiting.wait(int(seconds * NANOSECONDS))
        if waiting.get_ready_entities('subscription'):
            self.probe.drain()
        self.probe.hear_grader(0)


def _answers(client: Any) -> set[int]:
    """Take all answers that have arrived; return the numbers of their questions."""
    numbers: set[int] = set()
    while True:
        header, _ = client.handle.take_response(client.srv_type.Response)
        if header is None:
            return numbers
        numbers.add(header.request_id.sequence_number)
