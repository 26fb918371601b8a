"""
Nodes that are here before a notebook has any: of a lesson that is still open, or of a terminal.

The tab of a lesson may be closed and its kernel goes on.  All that its nodes publish is heard in
the next lesson, where nobody expects it.
"""

from __future__ import annotations

from rclpy.context import Context
from rclpy.node import Node

from roslab.output import say
from roslab.ros2.discovery import node_names, wait_for_graph

LOOK_S = 0.3
"""How long to look: kernels of the course announce themselves ten times a second."""
MOST_NAMED = 4


def nodes_of_others() -> list[str]:
    """Return the full names of the nodes that a new participant finds; hidden ones left out."""
    context = Context()
    context.init(args=[])
    try:
        node = Node(
            '_roslab_look', context=context, start_parameter_services=False, enable_rosout=False
        )
        try:
            wait_for_graph(node, LOOK_S)
            return list(dict.fromkeys(node_names(node, hidden=False)))
        finally:
            node.destroy_node()
    finally:
        context.try_shutdown()


def tell_of_strangers() -> None:
    """Say which nodes are here already, if there are any."""
    names = nodes_of_others()
    if not names:
        return
    more = f' and {len(names) - MOST_NAMED} more' if len(names) > MOST_NAMED else ''
    say(
        f'Note: {", ".join(names[:MOST_NAMED])}{more} run already, in another notebook or a '
        'terminal, and are heard here too. A notebook whose tab is closed goes on: shut it down '
        'in the list of running kernels, at the left edge of JupyterLab.'
    )
