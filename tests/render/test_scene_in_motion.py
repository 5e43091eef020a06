"""A whole scene in motion: several cameras at rates of their own, each with its own exact flow."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from sailenv_ros.frame.frame import Frame
from sailenv_ros.render.cpu.renderer import NativeRenderer
from sailenv_ros.simulation.synchronous import SynchronousSimulation
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.snapshot import WorldSnapshot
from tests.support.lockstep_core import lockstep_core
from tests.support.ray_cast import cast, flow_by_arithmetic

VIEWS = ("depth", "instance", "category", "flow", "flow_valid")
FREE = Pose.from_rpy_deg((-4.0, 0.3, 1.3), (0.0, 2.0, 3.0))


@pytest.fixture
def core() -> Iterator[SynchronousSimulation]:
    made = lockstep_core("optical", renderer=NativeRenderer())
    yield made
    made.close()


def seen(core: SynchronousSimulation, agent: str) -> tuple[Frame, WorldSnapshot, Camera]:
    """Capture a frame together with what it was made from."""
    frame = core.capture(VIEWS, agent=agent)
    return frame, core.world.snapshot(), frame.camera


def check(
    now: tuple[Frame, WorldSnapshot, Camera], then: tuple[Frame, WorldSnapshot, Camera]
) -> None:
    """Compare a frame with rays and rigid-body arithmetic since the camera's earlier frame."""
    frame, snapshot, camera = now
    _, past, past_camera = then
    assert frame.dt_ns == snapshot.sim_time_ns - past.sim_time_ns
    hits = cast(snapshot, camera)
    sure = hits.away_from_edges()
    assert sure.mean() > 0.3
    ids = np.concatenate([snapshot.contents.instance_ids, [0]])
    np.testing.assert_array_equal(frame["instance"][sure], ids[hits.row[sure]])
    table = snapshot.contents.category_of_instance
    np.testing.assert_array_equal(frame["category"], table[frame["instance"]])
    expected = flow_by_arithmetic(hits, snapshot, camera, past, past_camera)
    error_px = np.abs(frame["flow"][sure] - expected[sure]) * frame.dt_s
    assert error_px.max() < 1e-3
    assert np.abs(expected[sure]).max() * frame.dt_s > 0.5
    assert frame["flow_valid"][sure].all()


def test_two_cameras_at_different_rates_have_flows_of_their_own(
    core: SynchronousSimulation,
) -> None:
    """One camera every 8 steps on the mover, one every 20 steps and free: neither disturbs the
    other's past, and both agree with arithmetic to 1e-3 px per frame."""
    lens = CameraIntrinsics(width=96, height=72)
    core.register_agent(AgentSpec(name="quick", intrinsics=lens))
    core.register_agent(AgentSpec(name="slow", intrinsics=lens, following=False, pose=FREE))
    last = {agent: seen(core, agent) for agent in ("quick", "slow")}
    compared = {"quick": 0, "slow": 0}
    for step in range(4, 61, 4):
        core.step(4)
        for agent, period in (("quick", 8), ("slow", 20)):
            if step % period == 0:
                now = seen(core, agent)
                check(now, last[agent])
                last[agent] = now
                compared[agent] += 1
    assert compared == {"quick": 7, "slow": 3}


def test_a_set_position_is_seen_as_motion(core: SynchronousSimulation) -> None:
    """A camera driven by set_position and set_rotation has exact flow; a teleport has none."""
    lens = CameraIntrinsics(width=96, height=72)
    core.register_agent(AgentSpec(name="driven", intrinsics=lens, following=False, pose=FREE))
    before = seen(core, "driven")
    core.set_position((-3.97, 0.28, 1.31), agent="driven")
    core.set_rotation((0.5, 2.5, 4.0), agent="driven")
    core.step(8)
    check(seen(core, "driven"), before)
    core.step(8)
    core.set_position((-3.9, 0.2, 1.3), teleport=True, agent="driven")
    jumped = core.capture(VIEWS, agent="driven")
    assert not jumped["flow_valid"].any()
    assert jumped.dt_ns == 0
