from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.impl.rcutils_logger import RcutilsLogger
from rclpy.node import Node
from rclpy.timer import Timer


@dataclass
class Watch:
    number: int = 0

    def advance(self) -> Watch:
        self.number += 1
        return self

    @property
    def is_fifth(self) -> bool:
        return self.number % 5 == 0


class NightWatch(Node):
    def __init__(self, **kwargs: Any) -> None:
        super().__init__('night_watch', **kwargs)
        self._watch: Watch = Watch()
        self._log: RcutilsLogger = self.get_logger()
        self._timer_1hz: Timer = self.create_timer(1.0, self._on_timer)

    def _on_timer(self) -> None:
        watch = self._watch.advance()
        if watch.is_fifth:
            self._log.warning(f'Watch {watch.number}!')
        else:
            self._log.info(f'Watch {watch.number}.')


def main(args: list[str] | None = None) -> None:
    rclpy.init(args=args)
    try:
        rclpy.spin(NightWatch())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
