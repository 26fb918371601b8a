import rclpy
from rclpy.executors import ExternalShutdownException
from std_msgs.msg import String


def main(args=None):
    rclpy.init(args=args)
    node = rclpy.create_node('courier')
    publisher = node.create_publisher(String, 'parcels', 10)
    parcels = ['for you']
    try:
        while rclpy.ok():
            rclpy.spin_once(node, timeout_sec=0.05)
            if parcels and publisher.get_subscription_count() >= 1:
                publisher.publish(String(data=parcels.pop()))
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == '__main__':
    main()
