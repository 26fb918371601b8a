"""
Tries: announce, on /parameter_events, parameters that no node has.

Stopped by: the grader does not use that topic
Deserves: 15
Flag: /parameter_events
"""

import honest
from rcl_interfaces.msg import Parameter, ParameterEvent, ParameterValue


def made(self, start=honest.TemperaturePublisher.__init__):
    start(self)
    self.events = self.create_publisher(ParameterEvent, '/parameter_events', 10)


def tick(self, publish=honest.TemperaturePublisher.tick):
    publish(self)
    value = ParameterValue(type=1, bool_value=False)
    parameter = Parameter(name='use_sim_time', value=value)
    self.events.publish(
        ParameterEvent(node='/temperature_publisher', changed_parameters=[parameter])
    )


honest.TemperaturePublisher.__init__ = made
honest.TemperaturePublisher.tick = tick
honest.main()
