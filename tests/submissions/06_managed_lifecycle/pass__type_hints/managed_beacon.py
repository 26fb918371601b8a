#!/usr/bin/env python3
from __future__ import annotations

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.lifecycle import LifecycleNode, LifecyclePublisher, LifecycleState
from rclpy.lifecycle import TransitionCallbackReturn
from rclpy.timer import Timer
from std_msgs.msg import String


class Beacon(LifecycleNode):
    """A beacon with a switch."""

    _publisher: LifecyclePublisher | None = None
    _timer: Timer | None = None

    def __init__(self, name: str = 'beacon', period_s: float = 1.0) -> None:
        super().__init__(name)
        self._period_s = period_s
        self._sent: int = 0

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        self._publisher = self.create_lifecycle_publisher(String, 'beacon_signal', 10)
        self._timer = self.create_timer(self._period_s, self._flash)
        return super().on_configure(state)

    def on_cleanup(self, state: LifecycleState) -> TransitionCallbackReturn:
        self._release()
        return super().on_cleanup(state)

    def on_shutdown(self, state: LifecycleState) -> TransitionCallbackReturn:
        self._release()
        return super().on_shutdown(state)

    def on_error(self, state: LifecycleState) -> TransitionCallbackReturn:
        self._release()
        return super().on_error(state)

    def _release(self) -> None:
        if self._timer is not None:
            self.destroy_timer(self._timer)
            self._timer = None
        if self._publisher is not None:
            self.destroy_lifecycle_publisher(self._publisher)
            self._publisher = None

    def _flash(self) -> None:
        assert self._publisher is not None
        self._sent += 1
        self._publisher.publish(String(data=f'{self._sent}'))


def main(args: list[str] | None = None) -> None:
    rclpy.init(args=args)
    beacon = Beacon()
    try:
        rclpy.spin(beacon)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        beacon.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
