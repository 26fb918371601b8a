"""Draw the state machine of a lifecycle node with its current state."""

from __future__ import annotations

from html import escape
from typing import Any

from lifecycle_msgs.srv import GetState
from rclpy.lifecycle.node import LifecycleNodeMixin
from rclpy.node import Node

from drawing.svg import data_table, FONT, Table
from roslab.errors import NotHereError, RoslabError
from roslab.ros2.service_calls import meet
from roslab.session import session
from roslab.waiting import wait_in

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
_ARROWS = (
    ('configure', 'M130 72 H216', (173, 64)),
    ('cleanup', 'M220 96 H134', (177, 114)),
    ('activate', 'M340 72 H426', (383, 64)),
    ('deactivate', 'M430 96 H344', (387, 114)),
    ('shutdown', 'M70 106 V193 H216', (140, 186)),
    ('shutdown', 'M280 106 V166', (316, 144)),
    ('shutdown', 'M490 106 V193 H344', (420, 186)),
)
_PATIENCE_S = 3.0


class LifecyclePicture:
    """
    A state machine at one moment: a picture as the last line of a cell, text with ``str()``.

    :param name: full name of the node
    :param state: label of the current state, which may be a transition state
    """

    def __init__(self, name: str, state: str) -> None:
        self.name = name
        self.state = state

    def __repr__(self) -> str:
        row = '   '.join(f'[{name}]' if name == self.state else name for name in STATES)
        return f'{self.name} is {self.state}\n{row}\n{self._next()}'

    def _next(self) -> str:
        """Return a sentence that lists the possible transitions."""
        if self.state not in STATES:
            return 'a transition state: its callback has not returned'
        ways = [f'{how} to {goal}' for how, goal in WAYS[self.state].items()]
        return (
            f'next: {", ".join(ways)}'
            if ways
            else 'next: nothing, because this is the final state'
        )

    def _on_the_way(self) -> str:
        """Return a description of a transition state, which has no box."""
        return '' if self.state in STATES else f', {self._next()}'

    def _repr_html_(self) -> str:
        about = escape(' '.join(repr(self).splitlines()[::2]), quote=True)
        parts = [self._box(name) for name in STATES] + [self._arrow(*one) for one in _ARROWS]
        return (
            f'<svg role="img" aria-label="{about}" viewBox="0 0 560 240" width="560" '
            f'style="max-width:100%;font:13px {escape(FONT)}" fill="none" stroke="currentColor">'
            f'<text x="10" y="24" stroke="none" fill="currentColor">{escape(self.name)}: '
            f'<tspan font-weight="bold">{escape(self.state)}</tspan>{self._on_the_way()}</text>'
            '<text x="10" y="234" stroke="none" fill="currentColor" font-size="11">'
            f'solid: possible now · dashed: not now</text>{"".join(parts)}</svg>'
            f'{data_table(f"states of {self.name}", self._table())}'
        )

    def _table(self) -> Table:
        """Return one row per transition."""
        rows = [
            (state, how, goal, 'yes' if state == self.state else 'no')
            for state, ways in WAYS.items()
            for how, goal in ways.items()
        ]
        return [('state', 'transition', 'leads to', 'possible now'), *rows]

    def _box(self, name: str) -> str:
        """Return the box of a state; the current one has a thick border, bold text and "now"."""
        x, y = STATES[name]
        here = name == self.state
        look = 'stroke-width="3" fill="#2196f333"' if here else 'stroke-width="1"'
        middle = f'x="{x + _WIDTH // 2}" text-anchor="middle" stroke="none" fill="currentColor"'
        box = f'<rect x="{x}" y="{y}" width="{_WIDTH}" height="{_HEIGHT}" rx="10" {look}/>'
        if not here:
            return f'{box}<text y="{y + 28}" {middle}>{name}</text>'
        return (
            f'{box}<text y="{y + 21}" {middle} font-weight="bold">{name}</text>'
            f'<text y="{y + 37}" {middle}>now</text>'
        )

    def _arrow(self, how: str, path: str, label: tuple[int, int]) -> str:
        """Return the line of a transition, which is solid if the transition is possible now."""
        possible = path in _possible(self.state)
        dashes = '' if possible else ' stroke-dasharray="3 4" opacity="0.6"'
        x, y = label
        return (
            f'<path d="{path}"{dashes}/>{_head(path)}'
            f'<text x="{x}" y="{y}" text-anchor="middle" stroke="none" fill="currentColor" '
            f'font-size="11">{how}</text>'
        )


def _possible(state: str) -> set[str]:
    """Return the paths of the arrows that start at a state."""
    if state not in STATES:
        return set()
    left = STATES[state][0]
    starts = {f'M{left + _WIDTH}', f'M{left}', f'M{left + _WIDTH // 2}'}
    return {
        path for how, path, _ in _ARROWS if how in WAYS[state] and path.partition(' ')[0] in starts
    }


def _head(path: str) -> str:
    """Return the arrowhead for a path that ends in a horizontal or vertical line."""
    words = path.replace('M', '').split()
    x, y, dx, dy = int(words[0]), int(words[1]), 0, 1
    for word in words[2:]:
        value = int(word[1:])
        dx, dy = ((value > x) - (value < x), 0) if word[0] == 'H' else (0, 1)
        x, y = (value, y) if word[0] == 'H' else (x, value)
    side = 4
    corners = (
        (x + 4 * dx, y + 4 * dy),
        (x - 5 * dx + side * dy, y - 5 * dy + side * dx),
        (x - 5 * dx - side * dy, y - 5 * dy - side * dx),
    )
    points = ' '.join(f'{a},{b}' for a, b in corners)
    return f'<polygon points="{points}" fill="currentColor" stroke="none"/>'


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
        return LifecyclePicture(f'/{node.lstrip("/")}', _asked(f'/{node.lstrip("/")}'))
    if not isinstance(node, LifecycleNodeMixin):
        raise RoslabError(
            f'lifecycle({node.get_name()}) expected a LifecycleNode, got a {type(node).__name__}, '
            'which has no states. Try: class X(LifecycleNode), from rclpy.lifecycle.'
        )
    machine: Any = getattr(node, '_state_machine', None)
    if machine is None:  # destroyed together with the node, see destroy_wholly
        raise NotHereError('lifecycle() expected a running node, but this one was stopped.')
    return LifecyclePicture(node.get_fully_qualified_name(), str(machine.current_state[1]))


def _asked(name: str) -> str:
    """Request the current state of a node in another process."""
    helper = session().helper
    client: Any = helper.create_client(GetState, f'{name}/get_state')
    try:
        ready = wait_in(client.service_is_ready, _PATIENCE_S)
        if ready and meet(helper, client.service_name, _PATIENCE_S, wait_in):
            future = client.call_async(GetState.Request())
            if wait_in(future.done, _PATIENCE_S):
                return str(future.result().current_state.label)
    finally:
        helper.destroy_client(client)
    raise NotHereError(
        f'lifecycle({name!r}) found no lifecycle node that answers within {_PATIENCE_S:g} s. '
        'Has it been started, and is it spinning?'
    )
