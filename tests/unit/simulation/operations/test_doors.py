"""Every door to a value has the same bounds and the same words: they read one table."""

from __future__ import annotations

import asyncio
import json
import re
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import pytest

from sailenv_msgs_py.changes import changes_to_msg
from sailenv_msgs_py.services import SERVICES
from sailenv_ros.errors import SailenvError
from sailenv_ros.ros.nodes.plain_arguments import plain_parameters
from sailenv_ros.scene.schema import scene_schema
from sailenv_ros.simulation.core import SimulationCore
from sailenv_ros.simulation.operations import Operation, Operations
from sailenv_ros.types.agents import RATE, AgentSpec
from sailenv_ros.types.camera import INTRINSICS_LIMITS, CameraIntrinsics
from sailenv_ros.types.lens_settings import PINHOLE_FOV
from sailenv_ros.types.lights import ENVIRONMENT_LIMITS, LIGHT_LIMITS, Environment, Light
from sailenv_ros.types.picture_settings import LIMITS, PictureSettings
from sailenv_ros.types.rigid_body import RIGID_BODY_LIMITS, RigidBody
from sailenv_ros.types.validation import Bounds
from sailenv_ros.viewer.command_context import CommandContext
from sailenv_ros.viewer.edit_history import EditHistory
from sailenv_ros.viewer.operation_commands import OPERATION_COMMANDS
from sailenv_ros.viewer.request_arguments import arguments_of_text
from tests.support.lockstep_core import lockstep_core
from tests.unit.scene.reading import diagnostics

Door = Callable[[Any], object]
"""Takes a value; raises or returns a sentence if it is refused."""


@pytest.fixture(scope="module")
def core() -> Iterator[SimulationCore]:
    made = lockstep_core()
    Operations.register_agent(made, AgentSpec(name="eye"))
    for light_type in ("spot", "area"):
        Operations.add_light(made, light_type, cast(Any, light_type))
    yield made
    made.close()


def by_ros(core: SimulationCore, operation: Operation[..., Any], **given: Any) -> None:
    """Ask as a node does for a request with some changes."""
    service = SERVICES[operation.name]
    request = service.type.Request()
    request.changes = changes_to_msg(given.pop("changes"))
    for field, value in given.items():
        setattr(request, field, value)
    args, kwargs = service.arguments(request)
    operation(core, *args, **kwargs)


def by_viewer(core: SimulationCore, operation: Operation[..., Any], **given: Any) -> None:
    """Ask as a page does."""

    async def run(asked: Operation[..., Any], /, *args: Any, **kwargs: Any) -> Any:
        return asked(core, *args, **kwargs)

    context = SimpleNamespace(info=core.info, run=run, history=EditHistory())
    message = json.dumps({"do": operation.name, "id": 1, **given})
    command = OPERATION_COMMANDS[operation.name]
    asyncio.run(command.run(cast(CommandContext, context), arguments_of_text(message)))


def words(door: Door, value: object) -> str:
    """Return what a door accepts instead of a value; nothing where it accepts the value."""
    try:
        told = door(value)
    except SailenvError as refusal:
        told = str(refusal)
    found = re.search(r"must be (.+?), got ", str(told or ""))
    assert found or not told, told
    return found[1] if found else ""


def probes(bounds: Bounds) -> Iterator[object]:
    """Yield values on both sides of each bound, and what is no number."""
    low = bounds.least if bounds.above is None else bounds.above
    assert low is not None
    assert bounds.most is not None
    yield from (low, low - 1, bounds.most, bounds.most * 2 + 1, "much", True)
    yield from (2.5, 1e-3)


def expected(bounds: Bounds) -> dict[str, str]:
    """Return the table's verdict on each probe."""
    return {repr(value): bounds.refused(value) for value in probes(bounds)}


def verdicts(door: Door, bounds: Bounds) -> dict[str, str]:
    """Return a door's verdict on each probe."""
    return {repr(value): words(door, value) for value in probes(bounds)}


def doors_of_light(core: SimulationCore, folder: Path, name: str) -> dict[str, Door]:
    light = "area" if name in ("width_m", "height_m") else "spot"
    # The one cone leaves all angles to the other.
    beside = {"inner_cone_deg": {"outer_cone_deg": 89.0}, "outer_cone_deg": {"inner_cone_deg": 0.0}}
    changes: dict[str, Any] = beside.get(name, {})
    key = re.sub("_(m|deg)$", "", name)
    keys = {re.sub("_deg$", "", other): value for other, value in changes.items()}

    def in_file(value: object) -> str:
        entry = {"name": "a", "type": light, **keys, key: value}
        told = diagnostics(folder, f"version: 1\nlights: [{json.dumps(entry)}]\n")
        return "".join(each for each in told if f".{key}: " in each)

    return {
        "class": lambda v: Light(name="a", type=cast(Any, light), **{**changes, name: v}) and None,
        "Python": lambda v: Operations.set_light(core, light, **changes, **{name: v}) and None,
        "ROS": lambda v: by_ros(
            core, Operations.set_light, name=light, changes={**changes, name: v}
        ),
        "viewer": lambda v: by_viewer(
            core, Operations.set_light, light_name=light, changes={**changes, name: v}
        ),
        "file": in_file,
    }


@pytest.mark.parametrize("name", LIGHT_LIMITS)
def test_a_number_of_a_light(core: SimulationCore, tmp_path: Path, name: str) -> None:
    """A range of 0 among them, which files refused and programs did not."""
    bounds = LIGHT_LIMITS[name]
    for door, take in doors_of_light(core, tmp_path, name).items():
        assert verdicts(take, bounds) == expected(bounds), door


@pytest.mark.parametrize("name", ENVIRONMENT_LIMITS)
def test_a_number_of_the_surroundings(core: SimulationCore, tmp_path: Path, name: str) -> None:
    bounds = ENVIRONMENT_LIMITS[name]
    doors: dict[str, Door] = {
        "class": lambda v: Environment(**{name: v}) and None,
        "Python": lambda v: Operations.set_environment(core, **{name: v}),
        "ROS": lambda v: by_ros(core, Operations.set_environment, changes={name: v}),
        "viewer": lambda v: by_viewer(core, Operations.set_environment, changes={name: v}),
        "file": lambda v: "".join(
            diagnostics(tmp_path, f"version: 1\nenvironment: {json.dumps({name: v})}\n")
        ),
    }
    for door, take in doors.items():
        assert verdicts(take, bounds) == expected(bounds), door


@pytest.mark.parametrize("name", LIMITS)
def test_a_number_of_a_picture(core: SimulationCore, tmp_path: Path, name: str) -> None:
    bounds, key = LIMITS[name], name.removesuffix("_m")
    doors: dict[str, Door] = {
        "class": lambda v: PictureSettings(**{name: v}) and None,
        "Python": lambda v: Operations.set_picture(core, agent="eye", **{name: v}) and None,
        "viewer": lambda v: by_viewer(core, Operations.set_picture, agent="eye", changes={name: v}),
        "file": lambda v: "".join(
            diagnostics(
                tmp_path,
                "version: 1\nagents: " + json.dumps([{"name": "eye", "picture": {key: v}}]) + "\n",
            )
        ),
    }
    for door, take in doors.items():
        assert verdicts(take, bounds) == expected(bounds), door


@pytest.mark.parametrize("name", RIGID_BODY_LIMITS)
def test_a_number_of_a_rigid_body(tmp_path: Path, name: str) -> None:
    bounds, key = RIGID_BODY_LIMITS[name], re.sub("_(kg|m|per_s)$", "", name)
    doors: dict[str, Door] = {
        "class": lambda v: RigidBody(**{name: v}) and None,
        "file": lambda v: "".join(
            diagnostics(tmp_path, f"version: 1\nmovers: {json.dumps([{'body': {key: v}}])}\n")
        ),
    }
    for door, take in doors.items():
        assert verdicts(take, bounds) == expected(bounds), door


@pytest.mark.parametrize(
    ("name", "parameter"),
    {
        "width": "agent.width",
        "height": "agent.height",
        "vertical_fov_deg": "agent.vertical_fov_deg",
    }.items(),
)
def test_a_number_of_a_lens(tmp_path: Path, name: str, parameter: str) -> None:
    """Parameters of the node are typed, so only numbers of their type come to the bounds."""
    bounds, key = INTRINSICS_LIMITS[name], name.removesuffix("_deg")
    # The node's agent is a pin-hole; a fisheye may see more.
    fisheye: dict[str, Any] = {"distortion_model": "equidistant", "distortion": [0, 0, 0, 0]}
    doors: dict[str, Door] = {
        "class": lambda v: CameraIntrinsics(**{name: v}, **fisheye) and None,
        "file": lambda v: "".join(
            diagnostics(
                tmp_path, f"version: 1\nagents: {json.dumps([{'name': 'e', key: v, **fisheye}])}\n"
            )
        ),
    }
    for door, take in doors.items():
        assert verdicts(take, bounds) == expected(bounds), door
    bounds = PINHOLE_FOV if name == "vertical_fov_deg" else bounds
    kind = int if bounds.whole else float
    for value in (bounds.least, cast(float, bounds.least) / 2, cast(float, bounds.most) * 2):
        given = kind(cast(float, value))
        wrong = bounds.refused(given)
        asked = ["--ros-args", "-p", f"{parameter}:={given}"]
        assert words(lambda v: plain_parameters(cast(Any, v)) and None, asked) == wrong


def test_a_rate(core: SimulationCore, tmp_path: Path) -> None:
    doors: dict[str, Door] = {
        "class": lambda v: AgentSpec(name="a", rate_hz=cast(float, v)) and None,
        "Python": lambda v: Operations.set_rate(core, cast(float, v), agent="eye"),
        "file": lambda v: "".join(
            diagnostics(tmp_path, f"version: 1\nagents: {json.dumps([{'name': 'e', 'rate': v}])}\n")
        ),
    }
    for door, take in doors.items():
        assert verdicts(take, RATE) == expected(RATE), door


def test_editors_are_told_the_same_bounds() -> None:
    """In JSON Schema, by which they underline what is wrong while it is typed."""
    tables: Mapping[str, Mapping[str, Bounds]] = {
        "SpotLightSpec": {
            "range": LIGHT_LIMITS["range_m"],
            "inner_cone": LIGHT_LIMITS["inner_cone_deg"],
            "intensity": LIGHT_LIMITS["intensity"],
        },
        "AreaLightSpec": {"width": LIGHT_LIMITS["width_m"]},
        "EnvironmentSpec": dict(ENVIRONMENT_LIMITS),
        "PictureSpec": {key.removesuffix("_m"): bounds for key, bounds in LIMITS.items()},
    }
    definitions = scene_schema({})["$defs"]
    for model, fields in tables.items():
        for key, bounds in fields.items():
            told = definitions[model]["properties"][key]
            assert told.get("exclusiveMinimum") == bounds.above, key
            assert told.get("minimum") == bounds.least, key
            assert told["maximum"] == bounds.most, key
            assert told["type"] == ("integer" if bounds.whole else "number"), key
