import rclpy
from rclpy.context import Context
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node

WATCHERS = {'lookout': 1.0, 'keeper': 2.0}


def main(args=None):
    with Context() as context, SingleThreadedExecutor(context=context) as executor:
        for name, period in WATCHERS.items():
            executor.add_node(node := Node(name, namespace='harbour', context=context))
            log = node.get_logger()
            match name:
                case 'lookout':
                    node.create_timer(period, lambda log=log: log.info('no ship in sight'))
                case 'keeper':
                    node.create_timer(period, lambda log=log: log.info('gate is closed'))
        try:
            executor.spin()
        except (KeyboardInterrupt, ExternalShutdownException):
            pass


if __name__ == '__main__':
    main()
