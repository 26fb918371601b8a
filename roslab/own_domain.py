"""
Give each kernel a different ROS domain, so that notebooks do not receive each other's messages.

``ROS_DOMAIN_ID`` is set at the start of the kernel, before ROS starts, and processes started by
cells inherit it.  A number set by the user is kept, so that two notebooks can share a domain.
"""

from collections.abc import Iterator
from contextlib import suppress
import os
from typing import Any
import zlib

import rclpy
from rclpy.utilities import get_default_context

from environment.ros_domain import Claim, claim, DOMAINS
from roslab.output import say

VARIABLE = 'ROS_DOMAIN_ID'

_DOMAIN_0 = 'This notebook is in domain 0 and receives messages from all programs in that domain.'
_ALL_CLAIMED = (
    f'Note: all {len(DOMAINS)} ROS domains on this machine are in use. {_DOMAIN_0} Shut down '
    'notebooks in the list of running kernels, at the left edge of JupyterLab, then restart this '
    'kernel.'
)

_claimed: Claim | None = None


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
