#!/usr/bin/env python3
from __future__ import annotations

from typing import Final

from rcl_interfaces.msg import ParameterDescriptor
import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.lifecycle import LifecycleNode, LifecycleState, TransitionCallbackReturn
from rclpy.qos import QoSProfile
from std_msgs.msg import Float64

UNSET: Final[float] = -1.0


class PressureMonitor(LifecycleNode):
    """Warns above a limit, while it is active."""

    def __init__(self) -> None:
        super().__init__('pressure_monitor')
        about = ParameterDescriptor(description='highest pressure that is fine [bar]')
        self.declare_parameter('limit', UNSET, about)
        self._limit: float | None = None
        self._armed: bool = False
        self._subscription = self.create_subscription(
            Float64, 'pressure', self._on_pressure, QoSProfile(depth=10)
        )

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        limit: float = self.get_parameter('limit').value
        if not limit > 0.0:
            self.get_logger().error(f'Refusing the limit {limit:g} bar.')
            return TransitionCallbackReturn.FAILURE
        self._limit = limit
        return super().on_configure(state)

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        self._armed = True
        return super().on_activate(state)

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        self._armed = False
        return super().on_deactivate(state)

    def _on_pressure(self, msg: Float64) -> None:
        if self._armed and self._limit is not None and msg.data > self._limit:
            self.get_logger().warning(f'{msg.data:g} bar exceeds {self._limit:g} bar.')


def main(args: list[str] | None = None) -> None:
    rclpy.init(args=args)
    monitor = PressureMonitor()
    try:
        rclpy.spin(monitor)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        monitor.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
