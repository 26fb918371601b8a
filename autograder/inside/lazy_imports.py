"""
Speed up the import of rclpy, which loads many modules that a run does not need.

Of the 0.45 s of processor time before the first node exists, numpy takes 0.13 s (and starts a
thread per processor), although only messages with numeric arrays use it.  The generator of message
classes takes 0.08 s for a parser that only a build needs.  YAML, for parameter files, takes
0.015 s.  So numpy and YAML are loaded on first use, and the generator is hidden, which its package
tolerates.  Both the probe and the student's program start faster.

The probe and the launcher of the student's program share this file.
"""

import importlib
from importlib.machinery import ModuleSpec
import importlib.util
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
