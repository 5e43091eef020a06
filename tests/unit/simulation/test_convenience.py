"""Short ways to say common things: one view by its name, an agent by its size."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from sailenv_ros.errors import InvalidRequest, InvalidState, UnknownName
from sailenv_ros.frame.motion.forward import forward_views
from sailenv_ros.simulation import Simulation
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.views import FIVE_VIEWS, checked_views


@pytest.fixture(scope="module")
def simulation() -> Iterator[Simulation]:
    """Return a simulation with an agent of its own, by its size."""
    with Simulation(
        "optical", mode="lockstep", backend="native", width=32, height=24, views="normals"
    ) as running:
        yield running


def test_one_view_is_said_by_its_name(simulation: Simulation) -> None:
    """Wherever views are taken; its letters are no views."""
    assert list(simulation.capture("depth")) == ["depth"]
    assert list(simulation.capture.submit("rgb").result(30)) == ["rgb"]
    assert "albedo" in simulation.get_frame("albedo")
    assert checked_views("flow") == ("flow",)
    assert AgentSpec(name="eye", views="rgb").views == ("rgb",)  # type: ignore[arg-type]
    with simulation.stream("own", "depth") as stream:
        assert stream.views == ("depth",)
        stream.set_views("rgb")
        assert stream.views == ("rgb",)
    assert list(forward_views(simulation.capture(), None, "flow_forward")) == ["flow_forward"]
    with pytest.raises(UnknownName, match=r"did you mean 'depth'\?\), got 'dept'"):
        simulation.capture("dept")


def test_a_simulation_has_an_agent_of_a_size(simulation: Simulation) -> None:
    """As `Agent` takes width, height and more views; it is the one that operations mean."""
    assert simulation.own_agent == "own"
    frame = simulation.capture()
    assert (frame.agent, frame["rgb"].shape) == ("own", (24, 32, 3))
    assert set(frame) == {*FIVE_VIEWS, "normals"}
    spec = next(one for one in simulation.info.agents if one.name == "own")
    assert (spec.rate_hz, spec.following) == (0.0, True)


def test_two_places_of_one_object_are_refused(simulation: Simulation) -> None:
    """A position beside a pose was ignored without a word."""
    before = simulation.instances
    here = Pose((0.0, 0.0, 4.0))
    for places in ({"position": (0, 0, 3)}, {"rotation": (0, 0, 90)}):
        with pytest.raises(InvalidRequest, match="pose must be left out where position"):
            simulation.spawn_object("cube", **places, pose=here)  # type: ignore[arg-type]
        with pytest.raises(InvalidRequest, match="pose must be left out where position"):
            simulation.move_object("red cube", **places, pose=here)  # type: ignore[arg-type]
    assert simulation.instances == before
    spawned = simulation.spawn_object("cube", rotation=(0, 0, 90))
    pose = simulation.get_object(spawned).pose
    assert pose.position_m == (0.0, 0.0, 0.0)
    assert pose.rpy_deg == pytest.approx((0.0, 0.0, 90.0))
    simulation.despawn_object(spawned)


def test_a_step_of_a_running_clock_names_the_mode() -> None:
    with (
        Simulation("optical", backend="native") as running,
        pytest.raises(InvalidState, match='mode="lockstep"'),
    ):
        running.step()


def test_an_unknown_scene_is_told_with_the_form_of_generated_ones(simulation: Simulation) -> None:
    """They are in no list, because there are too many."""
    with pytest.raises(UnknownName) as caught:
        simulation.change_scene("kitchen")
    assert "; or generated:KIND:SEED, such as generated:kitchen:17, got 'kitchen'" in str(
        caught.value
    )
    with pytest.raises(UnknownName, match=r"did you mean 'room_01'\?\); or generated:KIND:SEED"):
        simulation.change_scene("rom_01")


def test_what_is_left_out_has_its_usual_value() -> None:
    with Simulation("optical", mode="lockstep", backend="native", height=30) as simulation:
        assert simulation.capture("depth")["depth"].shape == (30, 640)


def test_a_simulation_has_an_agent_of_a_lens() -> None:
    """As it is given; a size beside it is refused before anything is started."""
    lens = CameraIntrinsics(width=48, height=32, fx_px=40.0, fy_px=30.0, cx_offset_px=2.0)
    with Simulation("optical", mode="lockstep", backend="native", intrinsics=lens) as simulation:
        assert simulation.capture("depth").camera.intrinsics == lens
    with pytest.raises(InvalidRequest, match="width and height must be left out where intrinsics"):
        Simulation("optical", intrinsics=lens, width=48)


def test_a_size_and_an_agent_are_refused_together() -> None:
    """Before anything is started: they describe the same."""
    with pytest.raises(InvalidRequest, match="agent must be left out where width"):
        Simulation("optical", agent=AgentSpec(name="eye"), width=64)
    with pytest.raises(InvalidRequest, match="width must be an integer from 8 to 4096"):
        Simulation("optical", width=3)
