"""What pushes the streams of continual optical flow: bounds, speeds, seeds."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sailenv_ros.cli.main import main
from sailenv_ros.geometry import Pose, look_at
from sailenv_ros.scene.loader import load_scene
from sailenv_ros.simulation import Simulation
from sailenv_ros.streams import STREAMS
from sailenv_ros.streams.pushers import FRAME_S, FurniturePusher, LaptopPusher, RoamingPusher


def test_the_camera_stays_in_its_box_and_looks_at_its_point() -> None:
    """It bounces with a share of its speed, is never faster than pushes make it, and moves."""
    pusher = RoamingPusher(0)
    places, before = [], RoamingPusher.EYE_M
    for number in range(1, 3000):
        pose = pusher.pose_after(number)
        place = np.asarray(pose.position_m)
        assert (place >= RoamingPusher.LEAST_M).all()
        assert (place <= RoamingPusher.MOST_M).all()
        forward = pose.matrix()[:3, 0]
        way = np.asarray(RoamingPusher.TARGET_M) - place
        np.testing.assert_allclose(forward, way / np.linalg.norm(way), atol=1e-9)
        speed = np.linalg.norm(place - before) / FRAME_S
        fastest = RoamingPusher.FAST_M_S + RoamingPusher.IMPULSES_N_S[1] / RoamingPusher.MASS_KG
        assert speed <= fastest + 1e-9
        places.append(place)
        before = place
    assert np.ptp(places, axis=0).min() > 0.1


def test_seeds_decide() -> None:
    def track(seed: int) -> list[tuple[float, ...]]:
        pusher = RoamingPusher(seed)
        return [tuple(pusher.pose_after(number).position_m) for number in range(1, 200)]

    assert track(3) == track(3)
    assert track(3) != track(4)


@pytest.mark.parametrize("which", ["a", "b", "c"])
def test_scenes_begin_as_their_pushers_do(which: str) -> None:
    """The camera's pose is the one that is pushed on from, and all names are there."""
    kind = STREAMS[f"colof_{which}"]
    assert (kind.lap_frames, kind.rate_hz) == (90_000, 25.0)
    scene = load_scene(kind.scene)
    agent = scene.agents[0]
    names = {thing.name: thing for thing in scene.objects}
    if which == "a":
        laptop = names[LaptopPusher.NAME]
        expected = look_at(LaptopPusher.EYE_M, laptop.pose.position_m)
    else:
        assert not any(names[name].static for name in FurniturePusher.NAMES)
        expected = look_at(RoamingPusher.EYE_M, RoamingPusher.TARGET_M)
        assert agent.vertical_fov == 96.0
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
    pusher = LaptopPusher(1)
    places = []
    with Simulation(path, mode="lockstep", backend="tiny") as simulation:
        for number in range(1, 400):
            pusher.push(simulation, number)
            simulation.step(10)
            places.append(simulation.get_object("laptop").pose.position_m)
        looked = np.asarray(simulation.get_pose().matrix())[:3, 0]
    track = np.asarray(places)
    margin = 0.1
    assert (track[:, 1:] > LaptopPusher.LEAST_M - margin).all()
    assert (track[:, 1:] < LaptopPusher.MOST_M + margin).all()
    np.testing.assert_allclose(track[:, 0], 0.915, atol=1e-6)
    assert np.linalg.norm(np.diff(track, axis=0), axis=1)[10:].max() > 0.001
    way = track[-2] - LaptopPusher.EYE_M
    np.testing.assert_allclose(looked, way / np.linalg.norm(way), atol=1e-3)


def test_the_command_knows_three(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["stream", "colof", "--which", "d", "-o", str(tmp_path / "x")])
    assert "invalid choice" in capsys.readouterr().err
