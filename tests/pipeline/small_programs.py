"""Run small programs through the steps of a scenario, in the sandbox with the probe."""

from collections.abc import Callable

from autograder.exam.scenario import Scenario
from autograder.recording import Recording
from autograder.runs.observe import observe
from autograder.sandboxes.choose import strongest

PROGRAM = """
import rclpy
from rclpy.duration import Duration
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import Int32, String


def main():
    rclpy.init()
    node = make()
    rclpy.spin(node)


{body}


main()
"""


def runner() -> Callable[..., Recording]:
    """Return a function that runs a program, given as the body of ``make``, through steps."""
    sandbox = strongest()

    def _run(body, *steps, **options):
        scenario = Scenario(file='program.py', steps=steps, **options).to_json()
        return observe('steps', scenario, {'program.py': PROGRAM.format(body=body)}, sandbox)[0]

    return _run
