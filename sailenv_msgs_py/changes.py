"""Some of many values by their names, as `rcl_interfaces/Parameter[]`: a partial update.

The one way in which services change some attributes of a thing and leave the others: lights,
objects, surroundings, pictures. A value that is not set stands for None.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue

from sailenv_ros.errors import InvalidRequest

__all__ = ["changes_from_msg", "changes_to_msg"]

_FIELDS = {
    ParameterType.PARAMETER_BOOL: "bool_value",
    ParameterType.PARAMETER_INTEGER: "integer_value",
    ParameterType.PARAMETER_DOUBLE: "double_value",
    ParameterType.PARAMETER_STRING: "string_value",
    ParameterType.PARAMETER_BYTE_ARRAY: "byte_array_value",
    ParameterType.PARAMETER_BOOL_ARRAY: "bool_array_value",
    ParameterType.PARAMETER_INTEGER_ARRAY: "integer_array_value",
    ParameterType.PARAMETER_DOUBLE_ARRAY: "double_array_value",
    ParameterType.PARAMETER_STRING_ARRAY: "string_array_value",
}


def changes_to_msg(changes: Mapping[str, Any]) -> list[Parameter]:
    """Return values by their names as parameters.

    Parameters
    ----------
    changes : mapping of str to bool, int, float, str, None, or a sequence of numbers or texts
        NumPy's scalars and arrays count as numbers and sequences.

    Raises
    ------
    InvalidRequest
        If a value is of another type.
    """
    return [Parameter(name=name, value=_to_value(name, value)) for name, value in changes.items()]


def changes_from_msg(parameters: Iterable[Parameter]) -> dict[str, Any]:
    """Return values by their names; arrays become lists.

    Raises
    ------
    InvalidRequest
        If a name comes twice, or a type is none of ROS's.
    """
    changes: dict[str, Any] = {}
    for parameter in parameters:
        if parameter.name in changes:
            raise InvalidRequest("changes", parameter.name, "each name once")
        changes[parameter.name] = _from_value(parameter)
    return changes


def _to_value(name: str, value: Any) -> ParameterValue:
    if isinstance(value, np.generic | np.ndarray):
        value = value.tolist()
    if value is None:
        return ParameterValue(type=ParameterType.PARAMETER_NOT_SET)
    if isinstance(value, list | tuple):
        return _to_array(
            name, [item.item() if isinstance(item, np.generic) else item for item in value]
        )
    if isinstance(value, bool):
        return ParameterValue(type=ParameterType.PARAMETER_BOOL, bool_value=value)
    if isinstance(value, int) and -(2**63) <= value < 2**63:
        return ParameterValue(type=ParameterType.PARAMETER_INTEGER, integer_value=value)
    if isinstance(value, int | float):
        return ParameterValue(type=ParameterType.PARAMETER_DOUBLE, double_value=float(value))
    if isinstance(value, str):
        return ParameterValue(type=ParameterType.PARAMETER_STRING, string_value=value)
    raise _unfit(name, value)


def _to_array(name: str, values: list[Any]) -> ParameterValue:
    if all(isinstance(value, str) for value in values) and values:
        kind = ParameterType.PARAMETER_STRING_ARRAY
    elif all(isinstance(value, bool) for value in values) and values:
        kind = ParameterType.PARAMETER_BOOL_ARRAY
    elif all(isinstance(value, int | float) and not isinstance(value, bool) for value in values):
        kind = ParameterType.PARAMETER_DOUBLE_ARRAY
        values = [float(value) for value in values]
    else:
        raise _unfit(name, values)
    return ParameterValue(type=kind, **{_FIELDS[kind]: values})


def _from_value(parameter: Parameter) -> Any:
    kind = parameter.value.type
    if kind == ParameterType.PARAMETER_NOT_SET:
        return None
    if kind not in _FIELDS:
        raise InvalidRequest(
            f"type of {parameter.name}", kind, "one of rcl_interfaces/ParameterType"
        )
    value = getattr(parameter.value, _FIELDS[kind])
    return list(value) if kind >= ParameterType.PARAMETER_BYTE_ARRAY else value


def _unfit(name: str, value: object) -> InvalidRequest:
    return InvalidRequest(name, value, "a number, a text, a truth value, or a list of them")
