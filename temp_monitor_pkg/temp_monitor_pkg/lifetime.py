"""Run the process of a node: start, spin, and end cleanly on SIGINT and SIGTERM."""

from collections.abc import Callable

import rclpy
from rclpy.exceptions import ParameterException
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.logging import get_logger
from rclpy.node import Node

# How long a signal may remain unnoticed in the worst case, see run() [s].
LONGEST_WAIT_S = 0.5

BAD_PARAMETER_EXIT_CODE = 2


def run(make_node: Callable[[], Node], name: str, args: list[str] | None = None) -> int:
    """
    Run a node until SIGINT (Ctrl-C), SIGTERM or a shutdown by another part of the program.

    ``rclpy.spin(node)`` with ``except (KeyboardInterrupt, ExternalShutdownException)`` is the
    short form of this function and almost always sufficient. This function also closes two gaps in
    rclpy 7.1 for a signal that arrives while the node starts or between two waits: spin() may
    continue to sleep after the shutdown of ROS, or a call may fail because of the shutdown.

    :param make_node: creates the node; called after ``rclpy.init``
    :param name: name of the node, for error messages about a node that could not be created
    :param args: command line to use instead of ``sys.argv``
    :returns: exit code: 0, or 2 if a parameter has an invalid value
    """
    rclpy.init(args=args)
    node = None
    try:
        node = make_node()
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        while rclpy.ok():
            executor.spin_once(timeout_sec=LONGEST_WAIT_S)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass  # normal ways to end, not failures
    except ParameterException as error:
        get_logger(name).fatal(str(error))
        return BAD_PARAMETER_EXIT_CODE
    except Exception:
        if rclpy.ok():  # otherwise the error is a consequence of the shutdown, whatever its type
            raise
    finally:
        if node is not None:
            node.destroy_node()
        rclpy.try_shutdown()
    return 0
