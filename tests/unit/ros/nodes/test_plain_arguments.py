"""Parameters of the simulator are read without ROS as ROS reads them, or left to it."""

from __future__ import annotations

import pytest

from sailenv_ros.errors import InvalidRequest, UnknownName
from sailenv_ros.ros.nodes.plain_arguments import plain_parameters


def test_without_arguments_all_is_as_the_table_says() -> None:
    """The defaults."""
    parameters = plain_parameters([])
    assert parameters is not None
    assert parameters.scene is None
    assert parameters.mode == "realtime"
    assert parameters.agent is not None
    assert parameters.agent.intrinsics.width == 640


def test_parameters_are_read_by_their_types() -> None:
    """Texts, numbers, truths and lists in YAML; the last of a name counts."""
    first = "--ros-args -p scene:=room_03 -p seed:=7 --param paused:=true -p agent.mover:= --"
    second = "--ros-args -p scene:=room_01 -p gateway.protocol:='0.6' -p real_time_factor:=2.0"
    parameters = plain_parameters(
        [*first.split(), *second.split(), "-p", "agent.views:=[rgb, depth]"]
    )
    assert parameters is not None
    assert (parameters.scene, parameters.seed, parameters.paused) == ("room_01", 7, True)
    assert (parameters.gateway_protocol, parameters.real_time_factor) == ("0.6", 2.0)
    assert parameters.agent is not None
    assert parameters.agent.views == ("rgb", "depth")


@pytest.mark.parametrize(
    "words",
    [
        ["--ros-args", "-r", "__ns:=/other"],
        ["--ros-args", "--params-file", "sim_node.yaml"],
        ["--ros-args", "-p", "sim_node:seed:=1"],
        ["--end-with-fd", "3"],
        ["-p", "seed:=1"],
    ],
)
def test_what_only_ros_reads_is_left_to_it(words: list[str]) -> None:
    """Nothing is guessed."""
    assert plain_parameters(words) is None


@pytest.mark.parametrize(
    ("assignment", "error"),
    [
        ("sceen:=room_01", UnknownName),
        ("seed:=1.5", InvalidRequest),
        ("seed:=-1", InvalidRequest),
        ("paused:=1", InvalidRequest),
        ("real_time_factor:=2", InvalidRequest),
        ("mode:=slow", UnknownName),
        ("agent.views:=[1]", InvalidRequest),
        ("scene:=[", InvalidRequest),
        ("use_sim_time:=true", InvalidRequest),
    ],
)
def test_what_ros_would_refuse_is_refused(assignment: str, error: type[Exception]) -> None:
    """With the parameter's name in the sentence."""
    name = assignment.partition(":=")[0]
    with pytest.raises(error, match=name):
        plain_parameters(["--ros-args", "-p", assignment])
