"""The agreement between the two nodes: the name of the topic and its quality of service."""

from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy

# A relative name: a namespace or a remapping can move both nodes together.
TOPIC = 'temperature_topic'

# What the shorthand `10` stands for, spelled out: lost packets are sent again, at most ten
# readings wait for a slow reader, and a reader that joins late gets none of the earlier ones.
READINGS_QOS = QoSProfile(
    history=HistoryPolicy.KEEP_LAST,
    depth=10,
    reliability=ReliabilityPolicy.RELIABLE,
    durability=DurabilityPolicy.VOLATILE,
)
