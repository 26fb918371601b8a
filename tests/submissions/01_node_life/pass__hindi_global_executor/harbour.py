import rclpy
from rclpy.node import Node


# बंदरगाह का एक पहरेदार
class Paharedar(Node):
    def __init__(self, naam, samay):
        super().__init__(naam, namespace='harbour')
        self.create_timer(samay, self.khabar)

    def khabar(self):
        self.get_logger().info('सब ठीक है')


def main(args=None):
    rclpy.init(args=args)
    nazar = Paharedar('lookout', 1.0)
    rakhwala = Paharedar('keeper', 2.0)
    # rclpy.spin वाला executor, उसमें दोनों node
    rclpy.get_global_executor().add_node(rakhwala)
    try:
        rclpy.spin(nazar)
    except KeyboardInterrupt:
        pass


if __name__ == '__main__':
    main()
