"""Behaviours and movers by request, many agents with their own movers, the agents of scenes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sailenv_ros.errors import InvalidRequest, InvalidState, SailenvError, UnknownName
from sailenv_ros.simulation.synchronous import SynchronousSimulation
from sailenv_ros.simulation.view_planes import view_planes
from sailenv_ros.types.agents import MAX_AGENTS, AgentSpec
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.scene_info import SceneInfo
from tests.support.lockstep_core import lockstep_core

SMALL = CameraIntrinsics(width=16, height=12)

HALL = """
version: 1
objects:
{walls}
  - name: ball
    asset: sphere
    position: [0, 0, 1.5]
    scale: 0.3
    gravity: false
    behaviours:
      - {{type: uniform_movement_random_bounce, speed: 2.0, keep_in_view: watcher}}
movers:
  - name: rail
    total_time: 8
    waypoints: [{{position: [-1, 0, 1.5]}}, {{position: [-1, 1, 1.5]}}]
  - name: cart
    position: [1, 1, 1.5]
    controller: rigidbody
agents:
  - {{name: watcher, width: 32, height: 24, following: false, position: [-1.9, 0, 1.5]}}
  - {{name: rider, width: 16, height: 12, mover: cart}}
"""


def hall_text() -> str:
    """A closed box of 4 x 4 x 3 m of six cubes."""
    walls = []
    for name, position, scale in (
        ("floor", (0, 0, -0.1), (4.4, 4.4, 0.2)),
        ("ceiling", (0, 0, 3.1), (4.4, 4.4, 0.2)),
        ("north", (0, 2.1, 1.5), (4.4, 0.2, 3)),
        ("south", (0, -2.1, 1.5), (4.4, 0.2, 3)),
        ("east", (2.1, 0, 1.5), (0.2, 4, 3)),
        ("west", (-2.1, 0, 1.5), (0.2, 4, 3)),
    ):
        # A cube's origin is its middle.
        walls.append(
            f"  - {{name: {name}, asset: cube, static: true, "
            f"position: {list(position)}, scale: {list(scale)}}}"
        )
    return HALL.format(walls="\n".join(walls))


STAGE = hall_text()


def spec(name: str, **kwargs: Any) -> AgentSpec:
    return AgentSpec(name=name, intrinsics=SMALL, **kwargs)


def position(core: SynchronousSimulation, agent: str) -> tuple[float, float, float]:
    return core.get_pose(agent=agent).position_m


# -- behaviours --------------------------------------------------------------------------------


def test_an_attached_behaviour_begins_now_and_is_announced(core: SynchronousSimulation) -> None:
    """Its clock starts at the request, `moving` tells; detached, the object is left alone."""
    told: list[SceneInfo] = []
    core.on_info = told.append
    id_ = core.spawn_object(
        "cube",
        object_name="box",
        pose=Pose((0.0, 1.0, 1.0)),
        scale=(0.1, 0.1, 0.1),
        remove_dynamics=False,
    )
    core.step(100)
    core.move_object("box", pose=Pose((0.0, 1.0, 1.0)))
    track = [{"position": [0.0, 1.0, 1.0]}, {"position": [1.0, 1.0, 1.0]}]
    core.add_behaviour(
        "box", {"type": "linear_waypoints", **{"waypoints": track, "total_time": 2.0}}
    )
    assert id_ in told[-1].moving
    core.step(120)
    assert core.get_object("box").pose.position_m[0] == pytest.approx(0.5, abs=1e-3)
    assert core.get_object("box").behaviours[0]["type"] == "linear_waypoints"
    core.remove_behaviours(id_)
    assert id_ not in told[-1].moving
    assert core.get_object("box").behaviours == ()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("ball", {"type": "levitate"}), "levitate"),
        (("ghost", {"type": "poltergeist"}), "ghost"),
        ((9999, {"type": "poltergeist"}), "9999"),
        (("floor", {"type": "poltergeist"}), "static"),
        (("ball", {"type": "linear_waypoints", "waypoints": []}), "at least 1"),
        (
            ("ball", {"type": "linear_waypoints", "waypoints": [{"position": [0, 0]}]}),
            "three numbers",
        ),
        (("ball", {"type": "poltergeist", "duration": -1.0}), "above 0"),
        (("ball", [1]), "mapping"),
        (("ball", {"type": "no_such_module:thing"}), "no_such_module"),
    ],
)
def test_a_refused_behaviour_changes_nothing(
    core: SynchronousSimulation, arguments: tuple[Any, ...], words: str
) -> None:
    """One sentence with the user's own word; the same scene as before."""
    before = core.info
    with pytest.raises(SailenvError, match=words):
        core.add_behaviour(*arguments)
    after = core.info
    assert (after.revision, after.moving) == (before.revision, before.moving)
    assert after.instances == before.instances
    assert len(core.get_object("ball").behaviours) == 1


def test_a_reset_puts_every_byte_back(core: SynchronousSimulation) -> None:
    """Attached, driven, spawned, and reset: 300 steps have the same bytes as at the start."""

    def run() -> bytes:
        core.step(300)
        return core.world.snapshot().world_from_body.tobytes()

    first = run()
    core.add_behaviour("ball", {"type": "poltergeist", **{"mean_interval": 0.1}})
    core.drive_mover(linear_m_s=(1, 0, 0), mover="cart")
    core.step(100)
    core.reset()
    assert run() == first
    core.reset(seed=1)
    assert run() != first


# -- in view -----------------------------------------------------------------------------------


@given(
    rpy=st.tuples(*[st.floats(-180, 180)] * 3),
    u=st.floats(-30, 60),
    v=st.floats(-30, 50),
    depth=st.floats(-3, 12),
)
def test_planes_enclose_what_a_camera_sees(
    rpy: tuple[float, float, float], u: float, v: float, depth: float
) -> None:
    """A point is in front of all planes if and only if its pixel is in the picture."""
    intrinsics = CameraIntrinsics(width=32, height=24, vertical_fov_deg=50.0)
    camera = Camera(intrinsics=intrinsics, pose=Pose.from_rpy_deg((1.0, -2.0, 0.5), rpy))
    margins = [u + 0.5, 31.5 - u, v + 0.5, 23.5 - v, depth - intrinsics.near_m, 9.0 - depth]
    if min(map(abs, margins)) < 1e-3 or depth <= 0.0:
        return
    ray = np.linalg.inv(intrinsics.K) @ (u, v, 1.0)
    point = camera.world_from_camera @ np.append(ray * depth, 1.0)
    planes = view_planes(camera, 9.0)
    np.testing.assert_allclose(np.linalg.norm(planes[:, :3], axis=1), 1.0)
    assert bool((planes @ point > 0.0).all()) == (min(margins) > 0.0)


def test_an_object_is_kept_in_an_agents_view(core: SynchronousSimulation) -> None:
    """30 s of bouncing about: its middle is never further outside than it goes in a step or two."""
    record = core.info.agents[0]
    assert record.name == "watcher"
    camera = Camera(intrinsics=record.intrinsics, pose=core.get_pose(agent="watcher"))
    planes, worst = view_planes(camera, 10.0), np.inf
    places = []
    for _ in range(720):
        core.step(10)
        place = core.get_object("ball").pose.position_m
        places.append(place)
        worst = min(worst, float((planes[:, :3] @ place + planes[:, 3]).min()))
    assert worst > -0.05
    assert np.ptp(places, axis=0).min() > 0.5


def test_a_view_that_is_gone_holds_nothing(core: SynchronousSimulation) -> None:
    """Without the agent the object goes where it likes, within the walls."""
    core.delete_agent("watcher")
    places = []
    for _ in range(360):
        core.step(20)
        places.append(core.get_object("ball").pose.position_m)
    assert np.min(places, axis=0)[0] < -1.3
    assert np.abs(np.asarray(places)[:, :2]).max() < 2.0


# -- movers ------------------------------------------------------------------------------------


def test_agents_follow_movers_of_their_own(core: SynchronousSimulation) -> None:
    """Each mover moves its followers alone; a set pose of one moves all that follow with it."""
    core.register_agent(spec("first", mover="rail"))
    core.register_agent(spec("second", mover="cart"))
    rail = position(core, "first")
    core.set_position((0.5, 0.5, 1.0), agent="second")
    assert position(core, "rider") == (0.5, 0.5, 1.0)
    assert position(core, "first") == rail
    core.drive_mover(linear_m_s=(0.5, 0.0, 0.0), mover="cart")
    core.step(120)
    assert position(core, "rider") == pytest.approx((0.75, 0.5, 1.0), abs=1e-6)
    assert position(core, "first") == pytest.approx((-1.0, 0.125, 1.5), abs=1e-9)
    core.set_follow(False, agent="rider")
    core.set_position((0.0, 0.0, 1.0), agent="rider")
    assert position(core, "second") == pytest.approx((0.75, 0.5, 1.0), abs=1e-6)


def test_a_controller_is_switched_while_running(core: SynchronousSimulation) -> None:
    """Waypoints stop where they are, commands drive, waypoints go on; each change is announced."""
    core.register_agent(spec("eye", mover="rail"))
    told: list[SceneInfo] = []
    core.on_info = told.append
    with pytest.raises(InvalidState, match="set_mover_controller"):
        core.drive_mover(linear_m_s=(1, 0, 0), mover="rail")
    core.step(240)
    core.set_mover_controller("rigidbody", "rail")
    assert [mover.controller for mover in told[-1].movers] == ["rigidbody", "rigidbody"]
    here = position(core, "eye")
    assert here == pytest.approx((-1.0, 0.25, 1.5))
    core.step(100)
    assert position(core, "eye") == here
    core.drive_mover(linear_m_s=(0, -1, 0), mover="rail")
    core.step(60)
    assert position(core, "eye") == pytest.approx((-1.0, 0.0, 1.5), abs=1e-6)
    core.set_mover_controller("waypoint", "rail")
    core.step(240)
    assert position(core, "eye") == pytest.approx((-1.0, 0.5, 1.5))
    with pytest.raises(UnknownName, match="waypoint"):
        core.set_mover_controller("autopilot", "rail")  # type: ignore[arg-type]  # what is refused
    with pytest.raises(UnknownName, match="tram"):
        core.set_mover_controller("waypoint", "tram")


# -- many agents -------------------------------------------------------------------------------


def test_a_mover_is_turned_at_once_and_walks_on(core: SynchronousSimulation) -> None:
    """Angles add up, pitch ends before the zenith, and a command that moves it goes on."""
    core.drive_mover(linear_m_s=(-0.5, 0.0, 0.0), mover="cart")
    core.step(24)
    before = core.get_mover_pose("cart")
    core.turn_mover(pitch_rad=0.1, yaw_rad=0.2, mover="cart")
    core.turn_mover(yaw_rad=0.2, mover="cart")
    turned = core.get_mover_pose("cart")
    assert turned.position_m == before.position_m
    assert turned.rpy_deg == pytest.approx((0.0, np.degrees(0.1), np.degrees(0.4)))
    core.step(24)
    assert core.get_mover_pose("cart").position_m != before.position_m
    core.turn_mover(pitch_rad=-3.0, mover="cart")
    assert core.get_mover_pose("cart").rpy_deg[1] == pytest.approx(-89.0)


@pytest.mark.parametrize(
    ("mover", "angles", "error"),
    [
        ("rail", {"yaw_rad": 0.1}, InvalidState),
        ("cart", {"yaw_rad": 4.0}, InvalidRequest),
        ("cart", {"pitch_rad": float("nan")}, InvalidRequest),
        ("nobody", {"yaw_rad": 0.1}, InvalidRequest),
    ],
)
def test_a_turn_that_is_none_is_refused(
    core: SynchronousSimulation, mover: str, angles: dict[str, float], error: type[Exception]
) -> None:
    """Waypoints turn a mover themselves; more than half a turn is a mistake."""
    before = core.get_mover_pose("cart")
    with pytest.raises(error):
        core.turn_mover(**angles, mover=mover)
    assert core.get_mover_pose("cart") == before


def test_sixteen_agents_each_at_their_own_rate(core: SynchronousSimulation) -> None:
    """All 16 get the frames of their own rate; one whose consumer sleeps takes none from others."""
    rates = {f"agent_{number}": 5.0 * (number + 1) for number in range(MAX_AGENTS - 2)}
    streams = {}
    for name, rate in rates.items():
        core.register_agent(spec(name, rate_hz=rate))
        streams[name] = core.open_stream(name, ("depth",), lambda _: None)
    with pytest.raises(InvalidState, match="16 agents, which is the most"):
        core.register_agent(spec("one_more"))
    taken = dict.fromkeys(rates, 0)
    for _ in range(240):
        core.step(1)
        for name in list(rates)[1:]:
            frame = None
            while streams[name].delivered + streams[name].dropped < core.agents[name].sequence:
                frame = streams[name].get(1.0)
            taken[name] += frame is not None
    for name, rate in list(rates.items())[1:]:
        assert streams[name].dropped == 0
        assert abs(taken[name] - rate) <= 1
    sleeper = streams["agent_0"]
    assert sleeper.delivered == 0
    assert sleeper.dropped == pytest.approx(5, abs=1)


def test_agents_come_and_go_while_others_stream(core: SynchronousSimulation) -> None:
    """A deleted agent ends its own stream; another's frames go on without a gap."""
    core.register_agent(spec("stays"))
    stream = core.open_stream("stays", ("depth",), lambda _: None)
    for _ in range(10):
        core.register_agent(spec("guest", rate_hz=60.0))
        guests = core.open_stream("guest", ("depth",), lambda _: None)
        core.step(24)
        core.delete_agent("guest")
        assert guests.closed
    frame = stream.get(1.0)
    assert frame.sequence == 31
    assert frame.dt_ns == pytest.approx(1e9 / 30, rel=1e-6)


def test_a_scenes_agents_are_there_after_a_change_to_it(stage: Path) -> None:
    """They come with the scene, once; those that were there stay and follow its first mover."""
    core = lockstep_core("optical", stage.parent)
    core.register_agent(spec("eye"))
    core.change_scene("stage")
    assert [agent.name for agent in core.info.agents] == ["eye", "watcher", "rider"]
    assert core.get_agent_pose(agent="eye").mover == "rail"
    assert core.get_agent_pose(agent="rider").mover == "cart"
    core.change_scene("optical")
    core.change_scene("stage")
    assert len(core.info.agents) == 3
    core.close()


def test_a_scene_whose_agents_do_not_fit_is_refused(stage: Path) -> None:
    """15 agents and a scene with 2 more: refused, and the old scene is as it was."""
    core = lockstep_core("optical", stage.parent)
    for number in range(MAX_AGENTS - 1):
        core.register_agent(spec(f"agent_{number}"))
    before = core.info
    with pytest.raises(InvalidState, match="there would be 17 agents, and 16 is the most"):
        core.change_scene("stage")
    after = core.info
    assert (after.scene, after.epoch, after.agents) == (before.scene, before.epoch, before.agents)
    core.step(1)
    core.close()
