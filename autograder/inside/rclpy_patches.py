"""
Work around two defects of rclpy's executors, so that correct programs do not fail at random.

An executor lists the entities of its nodes and then adds them to a wait set.  In between, another
executor thread may destroy a publisher or subscription, for example in a clean-up callback.  rclpy
7.1 then skips destroyed subscriptions, timers, services and clients, but not event handlers:
``InvalidHandle`` ends the program, in about one of four runs of a correct managed node with three
threads.  This patch also skips destroyed event handlers.

An executor stores its nodes in a set, whose order depends on their addresses in memory.  If timers
of two nodes are due at the same time, either callback may run first.  With this patch, an executor
serves its nodes in the order in which they were added.

Usage as a program: rclpy_patches.py SCRIPT [arguments], for the executables of a package.
"""

from collections.abc import Callable, Sequence
from importlib.machinery import ModuleSpec
import importlib.util
import itertools
from pathlib import Path
import runpy
import sys
import types
from typing import Any

from lazy_imports import use_lazy_imports  # type: ignore[import-not-found]  # next to this file


def patch_rclpy() -> None:
    """Patch rclpy when the program imports it; an import here could hide a missing import."""
    sys.meta_path.insert(0, _PatchFinder)


class _PatchFinder:
    """
    An import hook that patches the modules of rclpy in :data:`PATCHES` when they are loaded.

    The class does not inherit from ``importlib.abc.MetaPathFinder``, whose import takes 20 ms.
    """

    @staticmethod
    def find_spec(
        name: str, path: Sequence[str] | None, target: types.ModuleType | None = None
    ) -> ModuleSpec | None:
        patch = PATCHES.pop(name, None)
        if patch is None:
            return None
        spec = importlib.util.find_spec(name)  # asks the other finders
        if spec and spec.loader:
            load = spec.loader.exec_module

            def load_and_patch(module: types.ModuleType) -> None:
                load(module)
                patch(module)

            spec.loader.exec_module = load_and_patch  # type: ignore[method-assign]
        return spec


def skip_destroyed_events(module: Any) -> None:
    """Make the handlers in ``rclpy.event_handler`` skip an event that was destroyed meanwhile."""
    handler = module.EventHandler
    destroyed = module._rclpy.InvalidHandle
    add_to_wait_set, take_data = handler.add_to_wait_set, handler.take_data

    def add_unless_destroyed(self: Any, wait_set: Any) -> None:
        try:
            add_to_wait_set(self, wait_set)
        except destroyed:
            self._event_index = None  # for rclpy, None means "not in a wait set"

    def take_unless_destroyed(self: Any) -> Any:
        try:
            return take_data(self)
        except destroyed:
            return None

    handler.add_to_wait_set, handler.take_data = add_unless_destroyed, take_unless_destroyed


def keep_order_of_nodes(module: Any) -> None:
    """Make the executors in ``rclpy.executors`` serve nodes in the order of their addition."""
    executor = module.Executor
    add_node, get_nodes = executor.add_node, executor.get_nodes
    counter = itertools.count()

    def add_and_count(self: Any, node: Any) -> Any:
        node._added_as = next(counter)
        return add_node(self, node)

    def in_order(self: Any) -> list[Any]:
        return sorted(get_nodes(self), key=lambda node: getattr(node, '_added_as', -1))

    executor.add_node, executor.get_nodes = add_and_count, in_order


PATCHES: dict[str, Callable[[Any], None]] = {
    'rclpy.event_handler': skip_destroyed_events,
    'rclpy.executors': keep_order_of_nodes,
}


if __name__ == '__main__':
    use_lazy_imports()
    patch_rclpy()
    sys.argv = sys.argv[1:]
    sys.path[0] = str(Path(sys.argv[0]).parent)
    runpy.run_path(sys.argv[0], run_name='__main__')
