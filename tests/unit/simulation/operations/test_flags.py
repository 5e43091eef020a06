"""Switches are true or false at every door: ``"no"`` is neither."""

from __future__ import annotations

import inspect
from typing import Any

import numpy as np
import pytest

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.scene.spec_surroundings import EnvironmentSpec
from sailenv_ros.simulation.clock import Clock
from sailenv_ros.simulation.operations.operations import ALL_OPERATIONS
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.lights import Environment

NOT_FLAGS: tuple[Any, ...] = ("no", "false", "", 0, 1, [], 0.0)

FLAGS = [
    (name, parameter.name)
    for name, operation in ALL_OPERATIONS.items()
    for parameter in operation.signature.parameters.values()
    if str(parameter.annotation).startswith("bool")
]


def test_there_are_switches() -> None:
    """The tests below have something to look at."""
    assert {("move_object", "teleport"), ("set_waypoints", "loop")} <= set(FLAGS)


@pytest.mark.parametrize(("name", "argument"), FLAGS)
def test_a_switch_of_an_operation_is_strict(name: str, argument: str) -> None:
    """It was turned into its truth, so that ``teleport="no"`` was true."""
    operation = ALL_OPERATIONS[name]
    check = operation.checks[argument]
    for value in (True, False, np.True_):
        assert check(argument, value) is bool(value)
    for wrong in NOT_FLAGS:
        with pytest.raises(InvalidRequest, match=f"{argument} must be true or false"):
            check(argument, wrong)
    nothing = operation.signature.parameters[argument].default
    if nothing is not inspect.Parameter.empty:
        assert check(argument, nothing) is nothing


@pytest.mark.parametrize("wrong", NOT_FLAGS)
def test_a_switch_of_a_data_class_is_strict(wrong: Any) -> None:
    for make in (
        lambda: AgentSpec(name="eye", following=wrong),
        lambda: Environment(sky_blend=wrong),
        lambda: Clock("realtime", 1.0, paused=wrong),
        lambda: EnvironmentSpec(sky_blend=wrong),
    ):
        with pytest.raises(ValueError, match="true or false"):
            make()


def test_a_name_that_may_be_left_out_is_a_text_or_nothing() -> None:
    """Whatever is sent instead, the sentence is ours: `set_picture(agent=[])` was a TypeError."""
    check = ALL_OPERATIONS["set_picture"].checks["agent"]
    assert check("agent", "eye") == "eye"
    assert check("agent", None) is None
    for wrong in ([], {}, 3, "a\0", "\ud800"):
        with pytest.raises(InvalidRequest, match="agent must be a text"):
            check("agent", wrong)
