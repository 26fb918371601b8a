"""
Import less of rclpy: imports that a run does not need take two thirds of its start.

Of the 0.45 s of processor time before the first node exists, numpy takes 0.13 s (and a thread for
each processor), although only messages with arrays of numbers use it; the generator of message
classes takes 0.08 s for a parser that only a build needs; YAML, for files of parameters, takes
0.015 s.  So numpy and YAML are loaded at their first use, and the generator is missing, which its
package tolerates.  Two processes per run start faster.

rclpy loads a hundred libraries at once, and the loader then looks for each of 18 000 symbols in
one library after the other.  Loaded first and on its own, as in most installations of ROS 2, the
middleware finds its symbols among fewer: a tenth of the processor time until rclpy is there.

The probe and the launcher of the student's program share this file.
"""

from __future__ import annotations

from contextlib import suppress
import importlib
from importlib.machinery import ModuleSpec
import importlib.util
import os
import sys
import threading
import types
from typing import Any

GENERATOR = 'rosidl_generator_py.generate_py_impl'
LATER = ('numpy', 'yaml')
MIDDLEWARE = 'librmw_fastrtps_cpp.so'


def lean() -> None:
    """Replace slow modules in this process, before it imports rclpy."""
    # The import system's own way to say that there is no such module.
    sys.modules[GENERATOR] = None  # type: ignore[assignment]
    for name in LATER:
        spec = importlib.util.find_spec(name) if name not in sys.modules else None
        if spec is not None:
            sys.modules[name] = _Later(spec)
    with suppress(ImportError, OSError):  # then rclpy loads it
        from _ctypes import dlopen

        dlopen(MIDDLEWARE, os.RTLD_LAZY)


class _Later(types.ModuleType):
    """
    A module that becomes the real one as soon as one of its attributes is used.

    ``importlib.util.LazyLoader`` would not do: before Python 3.12.3, two threads at the same time
    could see half a module.
    """

    def __init__(self, spec: ModuleSpec) -> None:
        super().__init__(spec.name)
        self.__spec__ = spec
        # For each log line, rclpy looks through the files of all modules.
        self.__file__ = spec.origin
        self._loading = threading.RLock()

    def __getattr__(self, name: str) -> Any:
        with self._loading:
            if sys.modules.get(self.__name__) is self:
                del sys.modules[self.__name__]
                self.__dict__.update(importlib.import_module(self.__name__).__dict__)
        return getattr(sys.modules[self.__name__], name)
