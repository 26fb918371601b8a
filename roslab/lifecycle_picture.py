"""Draw the state machine of a lifecycle node with its current state."""

from collections.abc import Sequence
from typing import Any

from lifecycle_msgs.srv import GetState
from rclpy.lifecycle.node import LifecycleNodeMixin
from rclpy.node import Node

from drawing import svg
from roslab.errors import NotHereError, RoslabError
from roslab.ros2.service_calls import wait_for_discovery
from roslab.session import session, wait_in

STATES = {
    'unconfigured': (10, 60),
    'inactive': (220, 60),
    'active': (430, 60),
    'finalized': (220, 170),
}
"""The primary states and the upper left corners of their boxes."""
WAYS = {
    'unconfigured': {'configure': 'inactive', 'shutdown': 'finalized'},
    'inactive': {'cleanup': 'unconfigured', 'activate': 'active', 'shutdown': 'finalized'},
    'active': {'deactivate': 'inactive', 'shutdown': 'finalized'},
    'finalized': {},
}
"""The transitions that can be requested from each primary state, and their target states."""
_WIDTH, _HEIGHT = 120, 46
Corners = Sequence[tuple[int, int]]
_ARROWS: tuple[tuple[str, str, Corners, tuple[int, int]], ...] = (
    ('unconfigured', 'configure', ((130, 72), (216, 72)), (173, 64)),
    ('inactive', 'cleanup', ((220, 96), (134, 96)), (177, 114)),
    ('inactive', 'activate', ((340, 72), (426, 72)), (383, 64)),
    ('active', 'deactivate', ((430, 96), (344, 96)), (387, 114)),
    ('unconfigured', 'shutdown', ((70, 106), (70, 193), (216, 193)), (140, 186)),
    ('inactive', 'shutdown', ((280, 106), (280, 166)), (316, 144)),
    ('active', 'shutdown', ((490, 106), (490, 193), (344, 193)), (420, 186)),
)
"""State, transition, corners of the arrow, and position of its label."""
_LEGEND = 'solid: possible now · dashed: not now'
_PATIENCE_S = 3.0


class LifecyclePicture:
    """A state machine at one moment, shown as a picture in a notebook and as text by ``str()``."""

    def __init__(self, name: str, state: str) -> None:
        self.name = name
        self.state = state

    def __repr__(self) -> str:
        row = '   '.join(f'[{name}]' if name == self.state else name for name in STATES)
        return f'{self.name} is {self.state}\n{row}\n{self._next()}'

    def _next(self) -> str:
        """Return a sentence that lists the possible transitions."""
        if self.state not in STATES:
            return 'still in a transition state'
        ways = [f'{how} to {goal}' for how, goal in WAYS[self.state].items()]
        return (
            f'next: {", ".join(ways)}'
            if ways
            else 'next: nothing, because this is the final state'
        )

    def _repr_html_(self) -> str:
        title = f'{self.name}: {self.state}'
        if self.state not in STATES:  # a transition state has no box
            title += f', {self._next()}'
        parts = [svg.text(10, 24, title, bold=True), svg.text(10, 234, _LEGEND, size=11)]
        parts += [_box(name, name == self.state) for name in STATES]
        parts += [_arrow(*arrow, self.state) for arrow in _ARROWS]
        words = ' '.join(repr(self).splitlines()[::2])
        return svg.picture(560, 240, f'States of {self.name}', words, parts, self._table())

    def _table(self) -> svg.Table:
        """Return one row per transition."""
        rows = [
            (state, how, goal, 'yes' if state == self.state else 'no')
            for state, ways in WAYS.items()
            for how, goal in ways.items()
        ]
        return [('state', 'transition', 'leads to', 'possible now'), *rows]


def _box(name: str, here: bool) -> str:
    """Return the box of a state; the current one has a thick border, bold text and "now"."""
    x, y = STATES[name]
    look = 'stroke-width="3" fill="#2196f333"' if here else 'stroke-width="1" fill="none"'
    middle = x + _WIDTH / 2
    return (
        f'<rect x="{x}" y="{y}" width="{_WIDTH}" height="{_HEIGHT}" rx="10" '
        f'stroke="currentColor" {look}/>'
        + svg.text(middle, y + 28 - 7 * here, name, anchor='middle', size=13, bold=here)
        + (svg.text(middle, y + 37, 'now', anchor='middle', size=13) if here else '')
    )


def _arrow(start: str, how: str, corners: Corners, label: tuple[int, int], state: str) -> str:
    """Return the arrow of a transition, which is solid if the transition is possible now."""
    dashes = '' if start == state else ' stroke-dasharray="3 4" opacity="0.6"'
    path = 'L'.join(f'{x} {y}' for x, y in corners)
    (before_x, _), (x, y) = corners[-2:]
    if x == before_x:
        head = f'{x - 4},{y - 5} {x + 4},{y - 5} {x},{y + 4}'
    else:
        ahead = 1 if x > before_x else -1
        head = f'{x - 5 * ahead},{y - 4} {x - 5 * ahead},{y + 4} {x + 4 * ahead},{y}'
    return (
        f'<path d="M{path}" fill="none" stroke="currentColor"{dashes}/>'
        f'<polygon points="{head}"/>{svg.text(*label, how, anchor="middle", size=11)}'
    )


def lifecycle(node: Node | str) -> LifecyclePicture:
    """
    Return a picture of a lifecycle node's states that marks the current state.

    :param node: the node, or the name of a node in this or another process
    :raises RoslabError: if the node is not a lifecycle node
    :raises NotHereError: if the node was stopped, or no node with this name answers
    """
    if isinstance(node, str):
        node = session().nodes().get(node.lstrip('/'), node)
    if isinstance(node, str):
        return LifecyclePicture(f'/{node.lstrip("/")}', _request_state(f'/{node.lstrip("/")}'))
    if not isinstance(node, LifecycleNodeMixin):
        raise RoslabError(
            f'lifecycle({node.get_name()}) expected a LifecycleNode, got a {type(node).__name__}, '
            'which has no states. Try: from rclpy.lifecycle import LifecycleNode, then '
            'class X(LifecycleNode)'
        )
    machine: Any = getattr(node, '_state_machine', None)
    if machine is None:  # destroyed together with the node, see force_destroy
        raise NotHereError('lifecycle() expected a running node, but this one was stopped.')
    return LifecyclePicture(node.get_fully_qualified_name(), str(machine.current_state[1]))


def _request_state(name: str) -> str:
    """Request the current state of a node in another process."""
    helper = session().helper
    client: Any = helper.create_client(GetState, f'{name}/get_state')
    try:
        ready = wait_in(client.service_is_ready, _PATIENCE_S)
        if ready and wait_for_discovery(helper, client.service_name, _PATIENCE_S, wait_in):
            future = client.call_async(GetState.Request())
            if wait_in(future.done, _PATIENCE_S):
                return str(future.result().current_state.label)
    finally:
        helper.destroy_client(client)
    raise NotHereError(
        f'lifecycle({name!r}) found no lifecycle node that answers within {_PATIENCE_S:g} s. '
        'Has it been started, and is it spinning?'
    )
