from functools import partial

import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor

# 名字 -> 周期（秒）
岗位 = {'lookout': 1.0, 'keeper': 2.0}


def 报告(节点, 内容):
    节点.get_logger().info(内容)


def 建立(名字, 周期):
    节点 = rclpy.create_node(名字, namespace='harbour')
    节点.create_timer(周期, partial(报告, 节点, '一切正常'))
    return 节点


def main(args=None):
    rclpy.init(args=args)
    执行器 = SingleThreadedExecutor()
    for 节点 in [建立(名字, 周期) for 名字, 周期 in 岗位.items()]:
        执行器.add_node(节点)
    try:
        执行器.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
