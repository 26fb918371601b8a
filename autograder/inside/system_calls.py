"""
System calls that Python has no name for, each with an error where it fails.

The probe, and the launcher of a program behind Landlock, give up with them what they need no more.
This file imports nothing of this project: it enters sandboxes alone.
"""

from __future__ import annotations

import ctypes
import os
import struct
from typing import Any

# From linux/prctl.h and linux/seccomp.h.
PR_SET_PDEATHSIG, PR_SET_SECCOMP, PR_CAPBSET_DROP = 1, 22, 24
PR_SET_CHILD_SUBREAPER, PR_SET_NO_NEW_PRIVS = 36, 38
SECCOMP_MODE_FILTER = 2
LANDLOCK_CREATE_RULESET = 444  # the same on all processors, as all newer ones
ASK_VERSION = 1

_libc = ctypes.CDLL(None, use_errno=True)
_libc.syscall.restype = ctypes.c_long


def call(name: str, *arguments: Any) -> None:
    """
    Call a function of the C library that returns 0.

    :raises OSError: with its name, if it returns something else
    """
    if getattr(_libc, name)(*arguments) != 0:
        number = ctypes.get_errno()
        raise OSError(number, f'{name}: {os.strerror(number)}')


def by_number(number: int, *arguments: Any) -> int:
    """
    Make a system call that the C library has no function for, and return what it returns.

    :raises OSError: if that is an error
    """
    result = int(_libc.syscall(number, *arguments))
    if result < 0:
        raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))
    return result


def prctl(option: int, *arguments: Any) -> None:
    """
    Change something about this process, see the manual page of its name in section 2.

    :raises OSError: if the kernel refuses
    """
    values = [ctypes.c_ulong(value) if isinstance(value, int) else value for value in arguments]
    call('prctl', option, *values, *[ctypes.c_ulong(0)] * (4 - len(values)))


def filter_calls(code: bytes) -> None:
    """
    Load a system-call filter, for ever; there must be no new privileges before.

    :param code: sock_filter records, eight bytes an instruction: seccomp(2)
    :raises OSError: if the kernel refuses
    """
    held = ctypes.create_string_buffer(code, len(code))
    program = struct.pack('HxxxxxxP', len(code) // 8, ctypes.addressof(held))
    prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, ctypes.c_char_p(program))


def landlock_version() -> int:
    """
    Return which version of Landlock the kernel has.

    :raises OSError: ENOSYS if it was built without, EOPNOTSUPP if it is switched off
    """
    return by_number(LANDLOCK_CREATE_RULESET, None, ctypes.c_size_t(0), ctypes.c_uint(ASK_VERSION))
