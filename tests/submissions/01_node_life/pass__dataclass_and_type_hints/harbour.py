from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Final, Optional

import rclpy
from rclpy.executors import Executor, ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.timer import Timer

NAMESPACE: Final[str] = 'harbour'


@dataclass
class Post:
    """A post in the harbour: its node, and the timer of its reports."""

    name: str
    period_s: float
    node: Node = field(init=False)
    timer: Timer = field(init=False)
    reports: int = 0

    def __post_init__(self) -> None:
        self.node = rclpy.create_node(self.name, namespace=NAMESPACE)
        self.timer = self.node.create_timer(self.period_s, self.report)

    def report(self) -> None:
        self.reports += 1
        self.node.get_logger().info(f'report {self.reports} of {self.name}')


def serve(posts: Sequence[Post]) -> None:
    executor: Executor = SingleThreadedExecutor()
    for post in posts:
        executor.add_node(post.node)
    try:
        executor.spin()
    finally:
        for post in posts:
            post.node.destroy_node()


def main(args: Optional[list[str]] = None) -> None:
    rclpy.init(args=args)
    try:
        serve([Post('lookout', 1.0), Post('keeper', 2.0)])
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
