"""What pushes the streams of continual optical flow: bounds, speeds, seeds."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from sailenv_ros.cli.main import main
from sailenv_ros.dataset.streams import STREAMS
from sailenv_ros.dataset.streams.forces import FurnitureForces, LaptopForces, RoamingForces
from sailenv_ros.scene.loader import load_scene
from sailenv_ros.simulation import Simulation
from sailenv_ros.types.geometry import Pose, look_at

Vectors = NDArray[np.float64]

ROAMING_EYE_M = (-1.9, 0.6, 1.81)
ROAMING_TARGET_M = (1.6, 0.0, 0.87)


ROAMED = """
version: 1
room: {size: [5.2, 4.2, 2.7]}
mover:
  name: ball
  position: [-1.9, 0.6, 1.81]
  keep_looking_at: {point: [1.6, 0, 0.87]}
  body: {mass: 0.125, radius: 0.1, drag: 0.0005, restitution: 0.4, gravity: false}
objects:
  - {name: bed, asset: cube, position: [1.4, 0.3, 0.5], mass: 20}
  - {name: lamp, asset: cube, scale: 0.3, position: [0.3, 1.4, 0.15], mass: 20}
  - {name: box, asset: cube, scale: 0.3, position: [-0.3, 0.3, 0.15], mass: 20}
  - {name: side table, asset: cube, scale: 0.5, position: [0.6, -1.2, 0.25], mass: 20}
"""


def roam(path: Path, seed: int, frames: int) -> tuple[Vectors, Vectors, Vectors]:
    """Return places, the way that is looked and velocities of stream C's camera at each frame."""
    path.write_text(ROAMED)
    forces = RoamingForces(seed)
    seen = []
    with Simulation(path, mode="lockstep", seed=seed, backend="native") as simulation:
        for number in range(1, frames):
            forces.apply(simulation, number)
            simulation.step(10)
            pose = simulation.get_mover_pose()
            velocity, _ = simulation.get_mover_velocity()
            seen.append((pose.position_m, pose.matrix()[:3, 0], velocity))
    places, forward, velocities = (np.asarray(values) for values in zip(*seen, strict=True))
    return places, forward, velocities


def test_the_camera_roams_the_room_and_looks_at_its_point(tmp_path: Path) -> None:
    """It stays within the walls, and is never faster than pushes and falling things make it."""
    places, forward, velocities = roam(tmp_path / "scene.yaml", 0, 300)
    assert (np.abs(places[:, :2]) <= np.array([2.6, 2.1]) - 0.1 + 1e-3).all()
    assert ((places[:, 2] >= 0.1 - 1e-3) & (places[:, 2] <= 2.6 + 1e-3)).all()
    way = np.array([1.6, 0.0, 0.87]) - places
    np.testing.assert_allclose(forward, way / np.linalg.norm(way, axis=1, keepdims=True), atol=1e-9)
    fastest = RoamingForces.FAST_M_S + RoamingForces.IMPULSES_N_S[1] / 0.125
    assert np.linalg.norm(velocities, axis=1).max() < fastest
    assert np.ptp(places, axis=0).max() > 0.3
    # The first pushes: slow for 20 frames, then one of the impulses along an axis.
    pushed = velocities[RoamingForces.SLOW_FRAMES - 1]
    low, high = np.array(RoamingForces.IMPULSES_N_S) / 0.125
    assert low <= np.abs(pushed).max() <= high
    assert np.count_nonzero(pushed) == 1
    assert not velocities[: RoamingForces.SLOW_FRAMES - 2].any()


def test_seeds_decide(tmp_path: Path) -> None:
    track = [roam(tmp_path / "scene.yaml", seed, 60)[0] for seed in (3, 3, 4)]
    assert track[0].tobytes() == track[1].tobytes()
    assert not np.array_equal(track[0], track[2])


@pytest.mark.parametrize("which", ["a", "b", "c"])
def test_scenes_begin_as_their_pushers_do(which: str) -> None:
    """The camera's pose is that of the published program, and all names are there."""
    kind = STREAMS[f"colof_{which}"]
    assert (kind.lap_frames, kind.rate_hz) == (90_000, 25.0)
    scene = load_scene(kind.scene)
    agent = scene.agents[0]
    names = {thing.name: thing for thing in scene.objects}
    if which == "a":
        laptop = names[LaptopForces.NAME]
        expected = look_at(LaptopForces.EYE_M, laptop.pose.position_m)
    else:
        assert not any(names[name].static for name in FurnitureForces.NAMES)
        expected = look_at(ROAMING_EYE_M, ROAMING_TARGET_M)
        assert agent.vertical_fov == 96.0
    if which == "c":
        mover = scene.all_movers[0]
        assert (mover.position, agent.following) == (ROAMING_EYE_M, True)
        assert mover.keep_looking_at is not None
        assert mover.keep_looking_at.point == ROAMING_TARGET_M
        assert mover.body is not None
        body = mover.body
        assert (body.mass, body.drag, body.restitution) == (0.125, 5e-4, 0.4)
        assert not body.gravity
        return
    assert agent.position is not None
    assert agent.rotation is not None
    pose = Pose.from_rpy_deg(agent.position, agent.rotation)
    np.testing.assert_allclose(pose.matrix(), expected.matrix(), atol=2e-3)


SCENE = """
version: 1
gravity: [0, 0, 0]
agents:
  - {name: camera, width: 16, height: 16, following: false, position: [0, 0, 0.995]}
objects:
  - {name: laptop, asset: cube, scale: 0.2, mass: 1, position: [0.915, -0.067, 0.829]}
"""


def test_the_laptop_is_kept_in_bounds(tmp_path: Path) -> None:
    """It moves all the time, in the plane before the camera, which looks at it."""
    path = tmp_path / "scene.yaml"
    path.write_text(SCENE)
    forces = LaptopForces(1)
    places = []
    with Simulation(path, mode="lockstep", backend="native") as simulation:
        for number in range(1, 400):
            forces.apply(simulation, number)
            simulation.step(10)
            places.append(simulation.get_object("laptop").pose.position_m)
        looked = np.asarray(simulation.get_pose().matrix())[:3, 0]
    track = np.asarray(places)
    margin = 0.1
    assert (track[:, 1:] > LaptopForces.LEAST_M - margin).all()
    assert (track[:, 1:] < LaptopForces.MOST_M + margin).all()
    np.testing.assert_allclose(track[:, 0], 0.915, atol=1e-6)
    assert np.linalg.norm(np.diff(track, axis=0), axis=1)[10:].max() > 0.001
    way = track[-2] - LaptopForces.EYE_M
    np.testing.assert_allclose(looked, way / np.linalg.norm(way), atol=1e-3)


def test_the_command_knows_three(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["stream", "colof", "--which", "d", "-o", str(tmp_path / "x")])
    assert "invalid choice" in capsys.readouterr().err
