"""Free space and rays of a running simulation: as things stand, and as the views show them."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator

import numpy as np
import pytest

from sailenv_ros import Simulation
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.space import FreeSpace
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.geometry import look_at

SMALL = {"height_m": 0.5, "radius_m": 0.15}


@pytest.fixture(scope="module")
def simulation() -> Iterator[Simulation]:
    eye = AgentSpec(
        name="eye",
        intrinsics=CameraIntrinsics(width=64, height=48),
        following=False,
        rate_hz=0.0,
        pose=look_at((-4.0, 1.0, 2.0), (0.0, 0.0, 0.5)),
    )
    with Simulation("optical", mode="lockstep", agent=eye) as simulation:
        yield simulation


def test_the_map_follows_what_moves(simulation: Simulation) -> None:
    """An object is in the way where it is put, and no more when it is gone."""
    simulation.reset()
    before = simulation.free_space(**SMALL)
    pose = simulation.random_pose("box", **SMALL)
    x, y, _ = pose.position_m
    simulation.spawn_object("cube", (x, y, 0.25), scale=0.5, object_name="in the way")
    assert not simulation.free_space(**SMALL).is_free((x, y))
    simulation.despawn_object("in the way")
    after = simulation.free_space(**SMALL)
    assert np.array_equal(after.cells, before.cells)
    assert after.origin_m == before.origin_m


def test_the_bounds_hold_all_that_is_drawn(simulation: Simulation) -> None:
    """A cube turned by 45 degrees reaches half its diagonal beyond its centre."""
    simulation.reset()
    low, high = simulation.scene_bounds()
    assert all(one < other for one, other in zip(low, high, strict=True))
    position = (high[0] + 3.0, low[1] - 2.0, high[2] + 1.0)
    simulation.spawn_object(
        "cube", position, (0.0, 0.0, 45.0), scale=0.5, object_name="far", remove_dynamics=True
    )
    reach = 0.25 * math.sqrt(2.0)
    wider = simulation.scene_bounds()
    assert wider[0] == pytest.approx((low[0], position[1] - reach, low[2]), abs=1e-9)
    assert wider[1] == pytest.approx((position[0] + reach, high[1], position[2] + 0.25), abs=1e-9)
    simulation.despawn_object("far")
    assert simulation.scene_bounds() == (low, high)


def test_listeners_are_told_of_maps(simulation: Simulation) -> None:
    """Until they end it."""
    told: list[FreeSpace] = []
    end = simulation.on_free_space(told.append)
    space = simulation.free_space(**SMALL)
    end()
    simulation.free_space(radius_m=0.2)
    assert len(told) == 1
    assert told[0] is space


def test_a_way_keeps_clear_of_everything(simulation: Simulation) -> None:
    """Upright rays along the way meet nothing but the floor."""
    a, b = (simulation.random_pose(name, **SMALL) for name in ("a", "b"))
    way = simulation.find_path(a.position_m, b.position_m, **SMALL)
    points = np.concatenate(
        [p + np.linspace(0, 1, 50)[:, None] * (q - p) for p, q in itertools.pairwise(way)]
    )
    floor = next(i.id for i in simulation.info.instances if i.category == "floor")
    down = simulation.cast_rays(points + np.array((0.0, 0.0, 0.5)), (0.0, 0.0, -1.0))
    assert set(down.instance_ids.tolist()) == {floor}
    np.testing.assert_allclose(down.distances_m, 0.5, atol=1e-6)
    np.testing.assert_allclose(down.normals, [(0.0, 0.0, 1.0)] * len(points), atol=1e-9)


def test_rays_through_pixels_meet_what_pixels_show(simulation: Simulation) -> None:
    """Instance and depth of every pixel that is no edge, and the normal of flat surfaces."""
    frame = simulation.capture(["depth", "instance", "normals"])
    camera = frame.camera
    height, width = frame["depth"].shape
    v, u = np.indices((height, width)).reshape(2, -1)
    rays = np.stack([u, v, np.ones(u.size)], axis=1) @ np.linalg.inv(camera.intrinsics.K).T
    matrix = camera.world_from_camera
    cast = simulation.cast_rays(matrix[:3, 3], rays @ matrix[:3, :3].T)
    same = cast.instance_ids == frame["instance"].reshape(-1)
    assert same.mean() > 0.995
    met = same & (cast.instance_ids > 0)
    depth = cast.distances_m / np.linalg.norm(rays, axis=1)
    np.testing.assert_allclose(depth[met], frame["depth"].reshape(-1)[met], rtol=1e-4)
    floor = next(i.id for i in simulation.info.instances if i.category == "floor")
    flat = met & (cast.instance_ids == floor)
    shown = frame["normals"].reshape(-1, 3)[flat] @ matrix[:3, :3].T
    np.testing.assert_allclose(cast.normals[flat], shown, atol=1e-5)
    np.testing.assert_allclose(
        cast.points_m[met],
        matrix[:3, 3] + cast.distances_m[met, None] * _unit(rays @ matrix[:3, :3].T)[met],
        atol=1e-9,
    )


def _unit(rows: np.ndarray) -> np.ndarray:
    return np.asarray(rows / np.linalg.norm(rows, axis=1, keepdims=True))


def test_rays_that_meet_nothing_say_so(simulation: Simulation) -> None:
    """Into the sky, or not as far as the floor."""
    up = simulation.cast_rays((0.0, 0.0, 50.0), (0.0, 0.0, 2.0))
    assert up.instance_ids.tolist() == [0]
    assert np.isinf(up.distances_m).all()
    assert np.isnan(up.points_m).all()
    short = simulation.cast_rays((0.0, 0.0, 50.0), (0.0, 0.0, -1.0), max_distance_m=20.0)
    assert short.instance_ids.tolist() == [0]
    assert simulation.cast_rays(np.zeros((0, 3)), np.zeros((0, 3))).points_m.shape == (0, 3)


@pytest.mark.parametrize(
    ("origins", "directions", "sentence"),
    [
        ((0, 0, 0), (0, 0, 0), "directions must be directions of a length above 0"),
        ((0, 0), (0, 0, 1), "origins must be"),
        (np.zeros((2, 3)), np.ones((3, 3)), "number of directions must be as many"),
        ((0, 0, np.nan), (0, 0, 1), "origins must be"),
    ],
)
def test_rays_that_are_none_are_refused(
    simulation: Simulation, origins: object, directions: object, sentence: str
) -> None:
    """In one sentence."""
    with pytest.raises(InvalidRequest, match=sentence):
        simulation.cast_rays(origins, directions)  # type: ignore[arg-type]  # wrong on purpose
