"""The parameters of a node: declared in ROS from a table and read.

A parameter that is misspelt, of the wrong type or out of range is refused with a sentence.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rclpy.exceptions import InvalidParameterTypeException, InvalidParameterValueException
from rclpy.node import Node

from sailenv_ros.errors import UnknownName
from sailenv_ros.ros.nodes.parameter_table import (
    LIVE,
    PARAMETERS,
    USE_SIM_TIME,
    Parameter,
    SimParameters,
    sim_parameters,
    without_a_clock,
)

__all__ = ["declare_parameters", "declare_table", "given_parameters"]


def declare_parameters(node: Node) -> SimParameters:
    """Declare every parameter of the simulator node and read it.

    Raises
    ------
    InvalidRequest
        If a value that was given has the wrong type or is out of range, or a name is unknown.
    """
    if node.get_parameter(USE_SIM_TIME).value:
        raise without_a_clock(True)
    return sim_parameters(declare_table(node, PARAMETERS))


def declare_table(node: Node, table: Mapping[str, Parameter]) -> dict[str, Any]:
    """Declare the parameters of any node of this package; return their values by name.

    Raises
    ------
    InvalidRequest
        If a value that was given has the wrong type or is out of range, or a name is unknown.
    """
    _refuse_unknown(node, table)
    return {name: _declare(node, name, entry) for name, entry in table.items()}


def _declare(node: Node, name: str, entry: Parameter) -> Any:
    try:
        descriptor = _descriptor(entry, live=name in LIVE)
        value = node.declare_parameter(name, entry.default, descriptor).value
    except InvalidParameterTypeException:
        raise entry.of_wrong_type(name, given_parameters(node)[name]) from None
    except InvalidParameterValueException:
        raise entry.out_of_range(name, given_parameters(node)[name]) from None
    entry.check_choice(name, value)
    return value


def given_parameters(node: Node) -> dict[str, Any]:
    """Return the values that a node was started with, by the names of their parameters."""
    given = node._parameter_overrides  # rclpy tells it nowhere else
    return {name: parameter.value for name, parameter in given.items()}


def _refuse_unknown(node: Node, table: Mapping[str, Parameter]) -> None:
    """Refuse a misspelt parameter, which ROS would pass over in silence."""
    for name in given_parameters(node):
        ours = name in table
        of_ros = name.startswith("qos_overrides.") or node.has_parameter(name)
        if not ours and not of_ros:
            raise UnknownName("parameter", name, table)


def _descriptor(entry: Parameter, *, live: bool) -> ParameterDescriptor:
    result = ParameterDescriptor(description=entry.description, read_only=not live)
    if entry.choices:
        result.additional_constraints = "one of: " + ", ".join(entry.choices)
    if entry.bounds is not None:
        low, high = entry.bounds.least, entry.bounds.most
        assert low is not None
        assert high is not None
        if entry.bounds.whole:
            span = IntegerRange(from_value=int(low), to_value=int(high), step=1)
            result.integer_range = [span]
        else:
            reach = FloatingPointRange(from_value=float(low), to_value=float(high))
            result.floating_point_range = [reach]
    return result
