"""Short ways to declare parameters with a description and a range."""

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rclpy.node import Node


def text(node: Node, name: str, default: str, description: str, allowed: str = '') -> str:
    """
    Declare a text parameter.

    :param node: the node that owns the parameter
    :param name: the parameter's name
    :param default: its value unless the user gives one
    :param description: what it does
    :param allowed: in words, which values are allowed; the node has to check them itself
    :returns: the value, from the user if there is one
    """
    descriptor = ParameterDescriptor(description=description, additional_constraints=allowed)
    return str(node.declare_parameter(name, default, descriptor).value)


def number(
    node: Node, name: str, default: float, description: str, smallest: float, largest: float
) -> float:
    """
    Declare a floating-point parameter that has a range.

    :param node: the node that owns the parameter
    :param name: the parameter's name, which ends in the unit
    :param default: its value unless the user gives one
    :param description: what it does, with its unit
    :param smallest: the smallest value that is allowed
    :param largest: the largest value that is allowed
    :returns: the value, from the user if there is one
    :raises InvalidParameterValueException: if it is outside of the range; NaN is, too
    :raises InvalidParameterTypeException: if the user gave another type, even an integer
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
    Declare an integer parameter that can be given at the start only.

    :param node: the node that owns the parameter
    :param name: the parameter's name
    :param default: its value unless the user gives one
    :param description: what it does
    :param smallest: the smallest value that is allowed
    :param largest: the largest value that is allowed
    :returns: the value, from the user if there is one
    :raises InvalidParameterValueException: if it is outside of the range
    :raises InvalidParameterTypeException: if the user gave another type
    """
    descriptor = ParameterDescriptor(
        description=description,
        additional_constraints=f'from {smallest} to {largest}; only at the start of the node',
        read_only=True,
        integer_range=[IntegerRange(from_value=smallest, to_value=largest, step=1)],
    )
    return int(node.declare_parameter(name, default, descriptor).value)
