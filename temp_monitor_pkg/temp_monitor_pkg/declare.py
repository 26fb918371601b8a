"""Declare parameters with a description and a range in one call."""

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rclpy.node import Node


def text(node: Node, name: str, default: str, description: str, allowed: str = '') -> str:
    """
    Declare a string parameter.

    :param node: the node that owns the parameter
    :param name: the parameter's name
    :param default: its value unless the user sets one
    :param description: what the parameter does
    :param allowed: description of the allowed values; the node has to check them itself
    :returns: the user's value, or the default
    """
    descriptor = ParameterDescriptor(description=description, additional_constraints=allowed)
    return str(node.declare_parameter(name, default, descriptor).value)


def number(
    node: Node, name: str, default: float, description: str, smallest: float, largest: float
) -> float:
    """
    Declare a floating-point parameter with a range.

    :param node: the node that owns the parameter
    :param name: the parameter's name, which ends in the unit
    :param default: its value unless the user sets one
    :param description: what the parameter does, with its unit
    :param smallest: the smallest value allowed
    :param largest: the largest value allowed
    :returns: the user's value, or the default
    :raises InvalidParameterValueException: if the value is outside the range or NaN
    :raises InvalidParameterTypeException: if the user's value is not a float but, say, an integer
    """
    limits = FloatingPointRange(from_value=smallest, to_value=largest, step=0.0)
    descriptor = ParameterDescriptor(
        description=description,
        additional_constraints=f'from {smallest:g} to {largest:g}; with a decimal point',
        floating_point_range=[limits],
    )
    return float(node.declare_parameter(name, default, descriptor).value)


def fixed_integer(
    node: Node, name: str, default: int, description: str, smallest: int, largest: int
) -> int:
    """
    Declare an integer parameter that can only be set when the node starts.

    :param node: the node that owns the parameter
    :param name: the parameter's name
    :param default: its value unless the user sets one
    :param description: what the parameter does
    :param smallest: the smallest value allowed
    :param largest: the largest value allowed
    :returns: the user's value, or the default
    :raises InvalidParameterValueException: if the value is outside the range
    :raises InvalidParameterTypeException: if the user's value is not an integer
    """
    descriptor = ParameterDescriptor(
        description=description,
        additional_constraints=f'from {smallest} to {largest}; only at the start of the node',
        read_only=True,
        integer_range=[IntegerRange(from_value=smallest, to_value=largest, step=1)],
    )
    return int(node.declare_parameter(name, default, descriptor).value)
