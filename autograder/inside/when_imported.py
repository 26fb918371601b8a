"""Change a module of somebody else's as it is imported, and import nothing before that."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib.machinery import ModuleSpec
import importlib.util
import sys
import types


def when_imported(name: str, change: Callable[[types.ModuleType], None]) -> None:
    """
    Have a function change a module once it is loaded.

    :param name: of the module, with its packages
    :param change: called with the module before anybody else has it
    """
    sys.meta_path.insert(0, _Changer(name, change))


class _Changer:
    """
    Waits for one module, and is gone afterwards.

    A finder as importlib describes it; to import importlib.abc for a name takes 20 ms.
    """

    def __init__(self, name: str, change: Callable[[types.ModuleType], None]) -> None:
        self.name, self.change = name, change

    def find_spec(
        self, name: str, path: Sequence[str] | None, target: types.ModuleType | None = None
    ) -> ModuleSpec | None:
        if name != self.name:
            return None
        sys.meta_path.remove(self)
        spec = importlib.util.find_spec(name)
        if spec is None or spec.loader is None:
            return None
        load = spec.loader.exec_module

        def load_and_change(module: types.ModuleType) -> None:
            load(module)
            self.change(module)

        spec.loader.exec_module = load_and_change  # type: ignore[method-assign]
        return spec
