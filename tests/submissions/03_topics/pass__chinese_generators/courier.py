import rclpy
from rclpy.executors import ExternalShutdownException
from std_msgs.msg import String


def 送货(发布者):
    while 发布者.get_subscription_count() == 0:
        yield '等待'
    发布者.publish(String(data='for you'))
    while True:
        yield '完成'


def main(args=None):
    rclpy.init(args=args)
    节点 = rclpy.create_node('courier')
    步骤 = 送货(节点.create_publisher(String, 'parcels', 10))
    节点.create_timer(0.1, lambda: next(步骤))
    try:
        rclpy.spin(节点)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
