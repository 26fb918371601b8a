import rclpy
from rclpy.executors import ExternalShutdownException
from std_msgs.msg import String


def 问候():
    """一条接一条的问候。"""
    次数 = 1
    while True:
        yield String(data=f'hello {次数}')
        次数 += 1


def main(args=None):
    rclpy.init(args=args)
    节点 = rclpy.create_node('talker')
    发布者 = 节点.create_publisher(String, 'chatter', 10)
    句子 = 问候()
    节点.create_timer(0.5, lambda: 发布者.publish(next(句子)))
    try:
        rclpy.spin(节点)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
