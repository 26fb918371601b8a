import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node

PERIODS = {'lookout': 1.0, 'keeper': 2.0}

rclpy.init()
nodes = [Node(name, namespace='harbour') for name in PERIODS]
executor = SingleThreadedExecutor()
for node in nodes:
    node.create_timer(
        PERIODS[node.get_name()],
        lambda log=node.get_logger(): log.info('fine'),
    )
    executor.add_node(node)
try:
    executor.spin()
except (KeyboardInterrupt, ExternalShutdownException):
    pass
finally:
    rclpy.try_shutdown()
