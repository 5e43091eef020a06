"""One program, run against an `Agent` over ROS and against a `Simulation` in the process."""

from __future__ import annotations

import inspect
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from sailenv_ros import Agent, Simulation
from sailenv_ros.errors import SailenvError
from sailenv_ros.simulation.operations import ALL_OPERATIONS, Operations
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.geometry import Pose
from tests.support.sim_node_process import NodeProcess

pytestmark = [pytest.mark.ros, pytest.mark.gl]

SCENE = "optical"


def program(env: Operations) -> Iterator[Any]:
    """Look, change everything, look again, and be refused; yield what can be compared."""
    env.reset(7)
    env.set_follow(False)
    env.set_pose(Pose.from_rpy_deg((-3.0, 0.0, 1.5), (0.0, 10.0, 0.0)), teleport=True)
    yield env.get_frame()
    env.step(24)
    cube = env.spawn_object("cube", position=(0.0, 0.5, 0.5), rotation=(0.0, 0.0, 30.0), scale=0.4)
    ball = env.spawn_object("sphere", pose=Pose((0.0, -0.5, 1.0)), mass_kg=1.0)
    env.add_behaviour(ball, {"type": "poltergeist"})
    yield cube, ball, env.instances[cube], env.get_object(cube).pose
    env.step(12)
    yield env.get_frame(["normals", "occlusion"])
    env.move_object(cube, position=(0.2, 0.4, 0.6))
    env.change_object(cube, colour="#aa3311", scale=(0.3, 0.4, 0.5), name="block")
    env.set_light("sun", intensity=1.5)
    env.add_light("lamp", "point", position_m=(0.0, 0.0, 2.0), intensity=4.0)
    env.set_light_color("lamp", 255, 128, 0)
    env.set_ambient_light((0.25, 0.25, 0.5))
    env.set_environment(exposure=0.5)
    env.set_gravity((0.0, 0.5, -5.0))
    yield env.get_gravity()
    env.set_picture(bloom=0.125)
    off_centre = {"cx_offset_px": 6.0, "cy_offset_px": -3.5}
    lens = CameraIntrinsics(width=48, height=40, fx_px=30.5, fy_px=26.25, **off_centre)
    env.set_intrinsics(lens)
    np.testing.assert_array_equal(env.get_frame()["K"], lens.K)
    yield env.get_object("block").pose, env.lights_names, env.get_light_color("lamp")
    yield env.get_frame()
    env.set_waypoints([((0, 0, 1), (0, 0, 0)), ((1, 0, 1), (0, 0, 90))], total_time_s=4.0)
    env.step(60)
    yield env.get_mover_pose(), env.get_position(), env.get_rotation(), sorted(env.movers)
    yield env.capture(["depth", "instance"])
    yield env.scene_text(title="The same")
    yield env.get_thumbnail("cube")
    env.despawn_object("block")
    env.remove_light("lamp")
    yield env.get_frame(), sorted(env.instances), env.scenes, env.categories
    for refused in (
        lambda: env.spawn_object("cubee"),
        lambda: env.spawn_object("cube", scale=0.0),
        lambda: env.set_position((0, 0)),
        lambda: env.set_rate("often"),  # type: ignore[arg-type]  # on purpose
        lambda: env.get_object(60000),
        lambda: env.get_object("nobody"),
        lambda: env.set_light("sun", brightness=1.0),
        lambda: env.change_object(ball, scale=-1.0),
        lambda: env.add_light("sun", "point"),
        lambda: env.set_picture(exposure=99.0),
        lambda: env.set_background("sea"),  # type: ignore[arg-type]  # on purpose
        lambda: env.pause(),
        lambda: env.turn_mover(0.1),
        lambda: env.change_scene("nowhere"),
        lambda: env.delete_agent("nobody"),
    ):
        with pytest.raises(SailenvError) as caught:
            refused()
        yield type(caught.value), str(caught.value)


def test_one_program_has_the_same_results_from_both() -> None:
    """Every byte of every frame, every pose, every id, every error's type and sentence."""
    lens = CameraIntrinsics(width=64, height=48)
    spec = AgentSpec(name="eye", intrinsics=lens, rate_hz=0.0)
    with (
        NodeProcess("/script", scene=SCENE, mode="lockstep", agent__name=""),
        Agent(width=64, height=48, name="eye", namespace="/script") as remote,
        Simulation(SCENE, mode="lockstep", agent=spec) as local,
    ):
        results = zip(program(remote), program(local), strict=True)
        for number, (one, other) in enumerate(results):
            assert_same(one, other, f"result {number}")


def test_both_have_the_same_operations() -> None:
    """By name and signature, since there is one declaration."""
    for name, operation in ALL_OPERATIONS.items():
        for owner in (Agent, Simulation):
            assert getattr(owner, name) is operation
            assert inspect.signature(getattr(owner, name)) == operation.__signature__


def assert_same(one: Any, other: Any, where: str) -> None:
    """Compare results of any kind, arrays byte for byte."""
    if isinstance(one, dict):
        assert list(one) == list(other), where
        for key in one:
            # How long it took is not a result.
            if key != "render_s":
                assert_same(one[key], other[key], f"{where}, {key}")
    elif where.endswith("world_from_camera"):
        # Derived from the pose, which comes as a quaternion in a message.
        np.testing.assert_allclose(one, other, rtol=0.0, atol=1e-12)
    elif isinstance(one, Camera):
        assert (one.intrinsics, one.name) == (other.intrinsics, other.name), where
        assert_same(one.world_from_camera, other.world_from_camera, f"{where}, world_from_camera")
    elif isinstance(one, np.ndarray):
        assert (one.shape, one.dtype) == (other.shape, other.dtype), where
        assert one.tobytes() == other.tobytes(), where
    elif hasattr(one, "to_dict"):
        assert (one.agent, one.epoch, one.stamp_ns) == (other.agent, other.epoch, other.stamp_ns)
        assert_same(one.to_dict(), other.to_dict(), where)
    elif isinstance(one, list | tuple):
        assert len(one) == len(other), where
        for index, (a, b) in enumerate(zip(one, other, strict=True)):
            assert_same(a, b, f"{where}[{index}]")
    else:
        assert one == other, where
