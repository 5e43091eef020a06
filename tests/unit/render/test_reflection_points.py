"""From where rooms are looked at for what is mirrored, and which instance uses which point."""

from __future__ import annotations

import numpy as np

from sailenv_ros.render.scene.reflection_map import view_point
from sailenv_ros.render.scene.reflection_points import APART_M, MOST, ReflectionPoints
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.lights import Light
from tests.support.baked import GRID, baked
from tests.support.tiny_scenes import Thing, box_mesh, model_of, snapshot_of

METAL = model_of(box_mesh((0.2, 0.2, 0.2)), metallic=1.0, roughness=0.2)
MATT = model_of(box_mesh((0.2, 0.2, 0.2)), metallic=0.0, roughness=0.8)
WALL = model_of(box_mesh((0.1, 8.0, 3.0)), metallic=0.0, roughness=0.8)
MIDDLE = view_point(GRID)[0]


def chosen(things: list[Thing]) -> tuple[ReflectionPoints, list[int]]:
    snapshot = snapshot_of(things, lights=(), baked=baked({}, []))
    points = ReflectionPoints()
    points.choose(snapshot)
    table = points.table(snapshot)
    return points, table[snapshot.contents.instance_ids].tolist()


def test_a_room_without_metal_has_its_middle() -> None:
    """And all things use it; what is large has a point there of its own."""
    points, used = chosen([Thing(MATT, Pose((3.0, 0.0, 0.0))), Thing(WALL, Pose((4.0, 0.0, 0.0)))])
    np.testing.assert_allclose(points.points, [MIDDLE, MIDDLE])
    assert used == [1, 0]


def test_metal_has_a_point_before_it() -> None:
    """Nearer to the middle of the room; what is beside it uses it too, walls do not."""
    at = np.array([3.0, 2.0, 0.5])
    beside = Thing(MATT, Pose((3.2, 1.8, 0.5)))
    points, used = chosen(
        [Thing(METAL, Pose(tuple(at))), beside, Thing(WALL, Pose((3.3, 2.0, 0.5)))]
    )
    assert len(points.points) == 3
    towards = points.points[2] - at
    assert 0.1 < np.linalg.norm(towards) < 0.3
    assert towards @ (MIDDLE - at) > 0.99 * np.linalg.norm(towards) * np.linalg.norm(MIDDLE - at)
    assert used == [2, 2, 0]


def test_what_lies_close_behind_an_area_light_mirrors_no_lamps() -> None:
    """As what is large; what lies before it, beside it or far behind it has the nearest point."""
    panel = Light(
        name="window", type="area", position_m=(4.0, 0.0, 0.0), direction=(-1.0, 0.0, 0.0),
        width_m=1.6, height_m=1.2,
    )  # fmt: skip
    places = [(4.1, 0.5, 0.1), (3.9, 0.5, 0.1), (4.1, 2.5, 0.1), (4.1, 0.5, 2.1)]
    points = ReflectionPoints()
    for lights in ((panel,), ()):
        things = [Thing(METAL, Pose(place)) for place in places]
        snapshot = snapshot_of(things, lights=lights, baked=baked({}, []))
        points.choose(snapshot)
        used = points.table(snapshot)[snapshot.contents.instance_ids]
        assert (used == 0).tolist() == [bool(lights), False, False, False]


def test_points_are_few_and_apart() -> None:
    """Of twenty pieces of metal in pairs, the ends of the row come first."""
    row = [Thing(METAL, Pose((x, -3.0, y))) for x in np.linspace(-4, 4, 10) for y in (0.0, 0.1)]
    points, used = chosen(row)
    assert len(points.points) == MOST
    places = points.points[1:]
    distances = np.linalg.norm(places[:, None] - places, axis=-1)
    assert distances[~np.eye(len(places), dtype=bool)].min() > APART_M
    assert all(one == other for one, other in zip(used[::2], used[1::2], strict=True))


def test_what_moves_changes_its_point() -> None:
    """The table is another array then, and the same one as long as nothing changes."""
    things = [Thing(METAL, Pose((3.0, 2.0, 0.5))), Thing(METAL, Pose((-3.0, -2.0, 0.5)))]
    points, used = chosen(things)
    assert sorted(used) == [2, 3]
    snapshot = snapshot_of(things, lights=(), baked=baked({}, []))
    table = points.table(snapshot)
    assert points.table(snapshot) is table
    swapped = [Thing(METAL, things[1].pose), Thing(METAL, things[0].pose)]
    moved = points.table(snapshot_of(swapped, lights=(), baked=baked({}, [])))
    assert moved[snapshot.contents.instance_ids].tolist() == used[::-1]
