"""
Speed up the import of rclpy, and work around two defects of its executors.

Of the 0.45 s of processor time before the first node exists, numpy takes 0.13 s (and starts a
thread per processor), although only messages with numeric arrays use it.  The generator of message
classes takes 0.08 s for a parser that only a build needs.  YAML, for parameter files, takes
0.015 s.  So numpy and YAML are loaded on first use, and the generator is hidden, which its package
tolerates.  Both the probe and the student's program start faster.

Without the patches, correct programs fail at random.  An executor lists the entities of its nodes
and then adds them to a wait set.  In between, another executor thread may destroy a publisher or
subscription, for example in a clean-up callback.  rclpy 7.1 then skips destroyed subscriptions,
timers, services and clients, but not event handlers: ``InvalidHandle`` ends the program, in about
one of four runs of a correct managed node with three threads.  A patch also skips destroyed event
handlers.

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
import threading
import types
from typing import Any

GENERATOR = 'rosidl_generator_py.generate_py_impl'
LAZY_MODULES = ('numpy', 'yaml')


def use_lazy_imports() -> None:
    """Replace slow modules in this process, before it imports rclpy."""
    # None in sys.modules makes an import raise ModuleNotFoundError.
    sys.modules[GENERATOR] = None  # type: ignore[assignment]
    for name in LAZY_MODULES:
        spec = importlib.util.find_spec(name) if name not in sys.modules else None
        if spec is not None:
            sys.modules[name] = _LazyModule(spec)


class _LazyModule(types.ModuleType):
    """
    A module that is imported when one of its attributes is first used.

    ``importlib.util.LazyLoader`` is not safe: before Python 3.12.3, a second thread could see a
    partly initialised module.
    """

    def __init__(self, spec: ModuleSpec) -> None:
        super().__init__(spec.name)
        self.__spec__ = spec
        # rclpy reads the file names of all modules for each log line.
        self.__file__ = spec.origin
        self._loading = threading.RLock()

    def __getattr__(self, name: str) -> Any:
        with self._loading:
            if sys.modules.get(self.__name__) is self:
                del sys.modules[self.__name__]
                self.__dict__.update(importlib.import_module(self.__name__).__dict__)
        return getattr(sys.modules[self.__name__], name)


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
