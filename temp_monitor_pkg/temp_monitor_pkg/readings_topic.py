"""Define what both nodes agree on: the name of the topic and its QoS profile."""

from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy

# The name is relative: a namespace or a remapping can move both nodes together.
TOPIC = 'temperature_topic'

# The profile that the shorthand `10` stands for: lost packets are sent again, up to ten readings
# wait for a slow subscriber, and a subscriber that joins late gets no earlier readings.
READINGS_QOS = QoSProfile(
    history=HistoryPolicy.KEEP_LAST,
    depth=10,
    reliability=ReliabilityPolicy.RELIABLE,
    durability=DurabilityPolicy.VOLATILE,
)
