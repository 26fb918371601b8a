"""Reject kernels without the ROS environment of the course."""

from collections.abc import Mapping

from environment.install_files import KERNEL_TITLE
from environment.ros import ros_environment, RosEnvironmentError
from roslab.errors import RoslabError


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
