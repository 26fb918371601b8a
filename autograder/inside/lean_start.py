"""
Import less: what rclpy brings along and a run does not need is two thirds of its start.

Of 0.45 s of processor time until a first node is there, numpy takes 0.13 s (and a thread for each
processor), though only messages with arrays of numbers use it; the generator of message classes
takes 0.08 s for a parser that only a build needs.  So numpy is loaded when somebody uses it, and
the generator is not there, which its package allows for.  Two processes a run gain by it.

The probe and the launcher of the student's program share this file.
"""

from __future__ import annotations

import importlib
import importlib.util
import sys
import threading
import types
from typing import Any

GENERATOR = 'rosidl_generator_py.generate_py_impl'


def lean() -> None:
    """Prepare this process, before it imports rclpy."""
    # The import system's own way to say that there is no such module.
    sys.modules[GENERATOR] = None  # type: ignore[assignment]
    if 'numpy' not in sys.modules and importlib.util.find_spec('numpy') is not None:
        sys.modules['numpy'] = _Later('numpy')


class _Later(types.ModuleType):
    """
    A module that becomes the real one as soon as an attribute of it is asked for.

    Not ``importlib.util.LazyLoader``, in which two threads that come at the same time could see
    half a module before Python 3.12.3.
    """

    def __init__(self, name: str) -> None:
        super().__init__(name)
        self.__spec__ = importlib.util.find_spec(name)
        self.__dict__['_loading'] = threading.RLock()

    def __getattr__(self, name: str) -> Any:
        own = self.__dict__
        with own['_loading']:
            if sys.modules.get(own['__name__']) is self:
                del sys.modules[own['__name__']]
                real = importlib.import_module(own['__name__'])
                own.update(real.__dict__)
        try:
            return own[name]
        except KeyError:
            return getattr(sys.modules[own['__name__']], name)
