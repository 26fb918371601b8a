"""
Create a node that replaces the older node of the same name.

Running a cell twice would create a second node of the same name.  ROS 2 allows this with a
warning, but destroying one of the two nodes breaks the logging of both.  ``start(Talker)`` does
not reveal the node's name: it becomes known when ``Node.__init__`` is called, so that call first
destroys the older node.
"""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import wraps
from itertools import pairwise
import threading
from typing import Any

from rclpy.context import Context
from rclpy.node import Node
from rclpy.parameter import Parameter

from roslab.interrupts import HeldInterrupts


@dataclass
class Construction:
    """
    The changes to apply while a node is created, and the nodes created so far.

    :param context: context of nodes that specify none
    :param make_room: called with the key of a node just before its creation
    :param name: replaces the name given by the class, as ``-r __node:=`` does
    :param parameters: initial values of parameters, as ``-p name:=value`` does
    """

    context: Context
    make_room: Callable[[str], None]
    name: str | None = None
    parameters: Mapping[str, Any] = field(default_factory=dict)
    made: list[Node] = field(default_factory=list)

    def arguments(self, name: str, given: dict[str, Any]) -> tuple[str, dict[str, Any]]:
        """Return the changed arguments of ``Node.__init__``."""
        arguments = {**given, 'context': given.get('context') or self.context}
        if self.made:  # name and parameters apply to the first node that a factory creates
            return name, arguments
        if self.parameters:
            overrides = {item.name: item for item in given.get('parameter_overrides') or ()}
            overrides |= {key: Parameter(key, value=it) for key, it in self.parameters.items()}
            arguments['parameter_overrides'] = list(overrides.values())
        return self.name or name, arguments


def key_of(name: str, namespace: str | None) -> str:
    """Return the key of a node in a notebook: its name, or its full name if it has a namespace."""
    space = (namespace or '').strip('/')
    return f'/{space}/{name}' if space else name


def _remapped(name: str, arguments: Mapping[str, Any]) -> tuple[str, str | None]:
    """Return the name and namespace of a node after applying the rules of its ``cli_args``."""
    given = list(arguments.get('cli_args') or ())
    found = {'__node': name, '__ns': arguments.get('namespace')}
    rules = [rule for option, rule in pairwise(given) if option in ('-r', '--remap')]
    for rule in reversed(rules):
        left, assigned, right = str(rule).partition(':=')
        node, _, what = left.rpartition(':')
        what = '__node' if what == '__name' else what
        if assigned and what in found and node in ('', name):
            found[what] = right
    return str(found['__node']), found['__ns']


@contextmanager
def constructing(construction: Construction) -> Iterator[None]:
    """Apply a construction to the nodes that this thread creates inside the ``with`` block."""
    original = Node.__init__
    thread = threading.get_ident()

    @wraps(original)  # so that errors about its arguments mention Node.__init__
    def init(self: Node, node_name: str, **given: Any) -> None:
        if threading.get_ident() != thread:
            original(self, node_name, **given)
            return
        name, arguments = construction.arguments(node_name, given)
        with HeldInterrupts():
            if isinstance(name, str):
                construction.make_room(key_of(*_remapped(name, arguments)))
            original(self, name, **arguments)
            construction.made.append(self)

    Node.__init__ = init  # type: ignore[method-assign]
    try:
        yield
    finally:
        Node.__init__ = original  # type: ignore[method-assign]
