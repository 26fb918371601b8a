from functools import partial

import rclpy
from rclpy.executors import ExternalShutdownException


def 守夜(日志):
    """每秒走一步的生成器。"""
    次数 = 0
    while True:
        次数 += 1
        if 次数 % 5 == 0:
            日志.warning(f'第{次数}更，换班')
        else:
            日志.info(f'第{次数}更')
        yield


def main(args=None):
    rclpy.init(args=args)
    节点 = rclpy.create_node('night_watch')
    节点.create_timer(1.0, partial(next, 守夜(节点.get_logger())))
    try:
        rclpy.spin(节点)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        节点.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
