"""
Check the ROS variables of a kernel, and give each kernel a different ROS domain.

Notebooks in different domains do not receive each other's messages.  ``ROS_DOMAIN_ID`` is set at
the start of the kernel, before ROS starts, and processes started by cells inherit it.  A number
set by the user is kept, so that two notebooks can share a domain.
"""

from collections.abc import Iterator, Mapping
from contextlib import suppress
import os
from typing import Any
import zlib

import rclpy
from rclpy.utilities import get_default_context

from environment.install_files import KERNEL_TITLE
from environment.ros import ros_environment, RosEnvironmentError
from environment.ros_domain import Claim, claim, DOMAINS
from roslab.errors import RoslabError
from roslab.output import say

VARIABLE = 'ROS_DOMAIN_ID'

_DOMAIN_0 = 'This notebook is in domain 0 and receives messages from all programs in that domain.'
_ALL_CLAIMED = (
    f'Note: all {len(DOMAINS)} ROS domains on this machine are in use. {_DOMAIN_0} Shut down '
    'notebooks in the list of running kernels, at the left edge of JupyterLab, then restart this '
    'kernel.'
)

_claimed: Claim | None = None


class WrongKernelError(RoslabError):
    """Raised when a notebook runs in a kernel other than the course's."""


def require_variables(environ: Mapping[str, str]) -> None:
    """
    Check that a kernel started with the variables that ROS needs.

    VS Code recommends the plain Python of ``.venv``, which lacks these variables.  Setting them
    later does not help: LD_LIBRARY_PATH has no effect on a process that is already running.

    :param environ: variables of the kernel
    :raises WrongKernelError: if one is missing; the message names it and the kernel to choose
    """
    try:
        needed = ros_environment().variables
    except RosEnvironmentError:
        return
    if lacking := sorted(needed.keys() - environ.keys()):
        raise WrongKernelError(
            f'this kernel lacks environment variables that ROS needs, such as {lacking[0]}. Try: '
            f'choose the kernel {KERNEL_TITLE} (in VS Code, it is in the list Jupyter Kernel...)'
        )


def claim_domain(shell: Any) -> None:
    """Give this kernel a domain that no other kernel uses, unless the user has set one."""
    global _claimed
    if chosen := os.environ.get(VARIABLE):
        # Claim the user's domain too, if the system allows it, so that other kernels avoid it.
        with suppress(OSError, ValueError):
            _claimed = _claimed or claim([int(chosen)])
        return
    try:
        _claimed = claim(_in_order())
        lacking = '' if _claimed else _ALL_CLAIMED
    except OSError as error:
        lacking = f'Note: this system cannot claim a ROS domain ({error.strerror}). {_DOMAIN_0}'
    if lacking:
        _say_in_first_cell(shell, lacking)
    os.environ[VARIABLE] = str(_claimed.domain if _claimed else 0)


def domain() -> None:
    """Print the ROS domain of this notebook, and the command that connects a terminal to it."""
    running = rclpy.ok()
    number = get_default_context().get_domain_id() if running else os.environ.get(VARIABLE, '0')
    say(
        f'This notebook is in ROS domain {number}. A terminal joins it with this line:\n'
        f'export {VARIABLE}={number}'
    )


def _in_order() -> Iterator[int]:
    """Yield all domains, starting with the same one after each restart of the kernel."""
    notebook = os.environ.get('JPY_SESSION_NAME') or os.getcwd()
    first = zlib.crc32(f'{os.getuid()} {notebook}'.encode()) % len(DOMAINS)
    yield from (*DOMAINS[first:], *DOMAINS[:first])


def _say_in_first_cell(shell: Any, text: str) -> None:
    """Print a message when the first cell runs."""

    def tell(_: Any) -> None:
        shell.events.unregister('pre_run_cell', tell)
        say(text)

    shell.events.register('pre_run_cell', tell)
