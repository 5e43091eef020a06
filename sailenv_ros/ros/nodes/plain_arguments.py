"""Reads ROS's arguments without ROS, as far as they are parameters of the simulator.

``--ros-args -p name:=value`` in, a `SimParameters` out. Whatever else ROS understands (remapping,
files of parameters, logging) is left to ROS.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import yaml

from sailenv_ros.errors import InvalidRequest, UnknownName
from sailenv_ros.ros.nodes.parameter_table import (
    PARAMETERS,
    USE_SIM_TIME,
    Parameter,
    SimParameters,
    sim_parameters,
    without_a_clock,
)
from sailenv_ros.system.yaml_text import from_yaml

__all__ = ["plain_parameters"]


def plain_parameters(arguments: Sequence[str]) -> SimParameters | None:
    """Return the parameters that arguments name; None if there is more in them than parameters.

    Parameters
    ----------
    arguments : sequence of str
        Without the name of the program.

    Raises
    ------
    InvalidRequest, UnknownName
        For a parameter that is unknown, of the wrong type or out of range.
    """
    given = _assignments(arguments)
    if given is None:
        return None
    of_time = given.pop(USE_SIM_TIME, "false")
    if of_time != "false":
        raise without_a_clock(of_time)
    for name in given:
        if name not in PARAMETERS:
            raise UnknownName("parameter", name, PARAMETERS)
    return sim_parameters(
        {
            name: _checked(name, entry, given[name]) if name in given else entry.default
            for name, entry in PARAMETERS.items()
        }
    )


def _assignments(arguments: Sequence[str]) -> dict[str, str] | None:
    """Return the values by names, as they were written; later ones win, as in ROS."""
    given: dict[str, str] = {}
    words = iter(arguments)
    of_ros = False
    for word in words:
        if word == "--ros-args":
            of_ros = True
        elif word == "--" and of_ros:
            of_ros = False
        elif word in ("-p", "--param") and of_ros:
            name, assigned, value = next(words, "").partition(":=")
            if not assigned or ":" in name:  # of one node alone, which ROS reads
                return None
            given[name] = value
        else:
            return None
    return given


def _checked(name: str, entry: Parameter, written: str) -> Any:
    try:
        value = from_yaml(written)
    except yaml.YAMLError as problem:
        raise InvalidRequest(f"parameter {name}", written, f"a value in YAML ({problem})") from None
    kind = type(entry.default)
    fits = type(value) is kind and (
        kind is not list or all(isinstance(item, str) for item in value)
    )
    if not fits and kind is str and value is None and not written.strip():
        value, fits = "", True
    if not fits:
        raise entry.of_wrong_type(name, value)
    if entry.bounds is not None and entry.bounds.refused(value):
        raise entry.out_of_range(name, value)
    entry.check_choice(name, value)
    return value
