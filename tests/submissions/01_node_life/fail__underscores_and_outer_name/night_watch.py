import rclpy

number = 0

def main(args=None):
    rclpy.init(args=args)
    node = rclpy.create_node('night_watch')
    def report():
        number += 1
        node.get_logger().info('Watch %d' % number)
    node.create_timer(1.0, report)
    rclpy.spin(node)

if __name__ == '__main__':
    main()
