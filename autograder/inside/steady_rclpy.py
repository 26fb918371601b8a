"""
Work around a defect of rclpy's executors, so that it never costs points by chance.

An executor lists the entities of its nodes and then puts them into a wait set.  Another of its
threads may destroy a publisher or subscription in between, for example in a callback that cleans
up.  rclpy 7.1 then skips destroyed subscriptions, timers, services and clients, but not events:
``InvalidHandle`` ends the program, in about one of four runs of a correct managed node on three
threads.  This patch also skips destroyed events.

Usage as a program: steady_rclpy.py SCRIPT [arguments], for the executables of a package.
"""

from __future__ import annotations

from collections.abc import Sequence
from importlib.machinery import ModuleSpec
import importlib.util
from pathlib import Path
import runpy
import sys
import types
from typing import Any

from lean_start import lean  # type: ignore[import-not-found]  # beside this file


def steady() -> None:
    """Patch rclpy when it is imported; importing it here could hide a forgotten import."""
    sys.meta_path.insert(0, _Patching())


class _Patching:
    """
    Find one module of rclpy, patch it as it is loaded, and remove this finder.

    The class does not inherit from importlib.abc, because that import takes 20 ms.
    """

    def find_spec(
        self, name: str, path: Sequence[str] | None, target: types.ModuleType | None = None
    ) -> ModuleSpec | None:
        if name != 'rclpy.event_handler':
            return None
        sys.meta_path.remove(self)
        spec = importlib.util.find_spec(name)
        if spec is None or spec.loader is None:
            return None
        load = spec.loader.exec_module

        def load_and_patch(module: types.ModuleType) -> None:
            load(module)
            mend(module.EventHandler)

        spec.loader.exec_module = load_and_patch  # type: ignore[method-assign]
        return spec


def mend(handler: Any) -> None:
    """
    Make a class of event handlers tolerate that its event was destroyed meanwhile.

    :param handler: ``rclpy.event_handler.EventHandler``, changed in place
    """
    from rclpy.impl.implementation_singleton import rclpy_implementation

    destroyed = rclpy_implementation.InvalidHandle
    add_to_wait_set, take_data = handler.add_to_wait_set, handler.take_data

    def add_if_there(self: Any, wait_set: Any) -> None:
        try:
            add_to_wait_set(self, wait_set)
        except destroyed:
            self._event_index = None  # rclpy's own word for "not in a wait set"

    def take_if_there(self: Any) -> Any:
        try:
            return take_data(self)
        except destroyed:
            return None

    handler.add_to_wait_set, handler.take_data = add_if_there, take_if_there


if __name__ == '__main__':
    lean()
    steady()
    sys.argv = sys.argv[1:]
    sys.path[0] = str(Path(sys.argv[0]).parent)
    runpy.run_path(sys.argv[0], run_name='__main__')
