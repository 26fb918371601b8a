"""The life of a node's process: start, spin, and a clean end on SIGINT and SIGTERM."""

from collections.abc import Callable

import rclpy
from rclpy.exceptions import ParameterException
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.logging import get_logger
from rclpy.node import Node

# How long a signal may go unnoticed in the worst case, see run() [s].
LONGEST_WAIT_S = 0.5

BAD_PARAMETER_EXIT_CODE = 2


def run(make_node: Callable[[], Node], name: str, args: list[str] | None = None) -> int:
    """
    Run a node until SIGINT (Ctrl-C), SIGTERM or a shutdown from elsewhere.

    ``rclpy.spin(node)`` with ``except (KeyboardInterrupt, ExternalShutdownException)`` is the
    short form of this function and right nearly always. What is added here closes two gaps of
    rclpy 7.1, where a signal arrives while the node is starting or between two waits: spin()
    may sleep on although ROS is shut down, or a call may fail because ROS is shut down.

    :param make_node: creates the node; called after ``rclpy.init``
    :param name: the node's name, for messages of a node that could not be created
    :param args: command line to use in place of ``sys.argv``
    :returns: exit code: 0, or 2 if the user gave a parameter a bad value
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
        pass  # the usual ends: neither is a failure
    except ParameterException as error:
        get_logger(name).fatal(str(error))
        return BAD_PARAMETER_EXIT_CODE
    except Exception:
        if rclpy.ok():  # otherwise it is a consequence of the shutdown, whatever its type
            raise
    finally:
        if node is not None:
            node.destroy_node()
        rclpy.try_shutdown()
    return 0
