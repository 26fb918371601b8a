import rclpy
from rclpy.executors import ExternalShutdownException
from std_msgs.msg import Float64


def 平均():
    总和, 个数, 结果 = 0.0, 0, None
    while True:
        数 = yield 结果
        总和 += 数
        个数 += 1
        结果 = 总和 / 个数


def main(args=None):
    rclpy.init(args=args)
    节点 = rclpy.create_node('running_mean')
    发布者 = 节点.create_publisher(Float64, 'mean', 10)
    平均值 = 平均()
    next(平均值)

    def 收到(消息):
        if 消息.data != 消息.data:  # 不是数
            return
        发布者.publish(Float64(data=平均值.send(消息.data)))

    节点.create_subscription(Float64, 'readings', 收到, 10)
    try:
        rclpy.spin(节点)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
