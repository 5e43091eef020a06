"""Free space beside arithmetic: what a body of a radius touches, and ways around it."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sailenv_ros.errors import InvalidRequest, InvalidState
from sailenv_ros.space import FREE, OCCUPIED, UNKNOWN, FreeSpace
from sailenv_ros.space.free_space import BodySize
from sailenv_ros.space.grid import map_free_space
from sailenv_ros.space.outlines import Solid, outlines_between, solids_of
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.model import BoxShape, ConvexShape, CylinderShape, SphereShape, TriangleShape

ONE = (1.0, 1.0, 1.0)
FLOOR = BoxShape(half_extents_m=(2.0, 1.5, 0.1), centre_m=(0.0, 0.0, -0.1))
BODY = BodySize(height_m=1.0, radius_m=0.2, resolution_m=0.05, step_m=0.05)


def solids(*shapes: object, pose: Pose | None = None) -> list[Solid]:
    matrix = (pose or Pose()).matrix()
    return list(solids_of(shapes, ONE, matrix))  # type: ignore[arg-type]  # shapes of any kind


def middles(space: FreeSpace) -> tuple[np.ndarray, np.ndarray]:
    rows, columns = np.indices(space.cells.shape)
    x, y = space.origin_m
    side = space.resolution_m
    return x + (columns + 0.5) * side, y + (rows + 0.5) * side


def around_a_box() -> tuple[FreeSpace, tuple[np.ndarray, np.ndarray], np.ndarray]:
    """A map around a box, the middles of its cells, and how far they are from the box [m]."""
    box = BoxShape(half_extents_m=(0.33, 0.21, 0.4), centre_m=(0.21, -0.13, 0.4))
    space = map_free_space(solids(FLOOR, box), BODY)
    x, y = middles(space)
    beside = np.hypot(
        np.maximum(np.abs(x - 0.21) - 0.33, 0.0), np.maximum(np.abs(y + 0.13) - 0.21, 0.0)
    )
    return space, (x, y), beside


def test_a_box_keeps_the_radius_free_around_it() -> None:
    """A cell is occupied just if its middle is nearer to the box than the radius."""
    space, _, beside = around_a_box()
    assert np.array_equal(space.cells == OCCUPIED, beside < 0.2)
    assert np.array_equal(space.cells == FREE, beside >= 0.2)


def test_clearance_is_never_more_than_there_is() -> None:
    """And at most two diagonals of a cell less."""
    space, (x, y), beside = around_a_box()
    low, high = np.array([x.min(), y.min()]), np.array([x.max(), y.max()])
    edge = np.minimum.reduce([x - low[0], high[0] - x, y - low[1], high[1] - y])
    room = np.minimum(beside - BODY.radius_m, edge)
    found = space.clearance_m[space.free]
    assert (found <= room[space.free] + 1e-6).all()
    assert (found >= room[space.free] - 2.0 * np.sqrt(2.0) * BODY.resolution_m).all()
    assert (space.clearance_m[~space.free] == 0.0).all()


def test_a_turned_box_is_turned_in_the_map() -> None:
    """In its own axes the distances are those of the box that is not turned."""
    box = BoxShape(half_extents_m=(0.5, 0.1, 0.4))
    pose = Pose.from_rpy_deg((0.3, 0.2, 0.4), (0.0, 0.0, 31.0))
    space = map_free_space([*solids(FLOOR), *solids(box, pose=pose)], BODY)
    x, y = middles(space)
    a = math.radians(31.0)
    u = np.cos(a) * (x - 0.3) + np.sin(a) * (y - 0.2)
    v = -np.sin(a) * (x - 0.3) + np.cos(a) * (y - 0.2)
    beside = np.hypot(np.maximum(np.abs(u) - 0.5, 0.0), np.maximum(np.abs(v) - 0.1, 0.0))
    assert np.array_equal(space.cells == OCCUPIED, beside < 0.2)


def test_a_table_is_free_for_who_fits_below() -> None:
    """Its top at 0.7 m is in the way of a body of 1 m, and not of one of 0.6 m."""
    top = BoxShape(half_extents_m=(0.5, 0.5, 0.02), centre_m=(0.0, 0.0, 0.72))
    tall = map_free_space(solids(FLOOR, top), BODY)
    low = map_free_space(solids(FLOOR, top), BodySize(height_m=0.6, radius_m=0.2))
    assert not tall.is_free((0.0, 0.0))
    assert low.is_free((0.0, 0.0))


def test_a_rug_is_stepped_over_and_a_sill_is_not() -> None:
    """Up to the step, and not beyond it."""
    rug = BoxShape(half_extents_m=(0.5, 0.5, 0.01), centre_m=(-1.0, 0.0, 0.01))
    sill = BoxShape(half_extents_m=(0.5, 0.5, 0.04), centre_m=(1.0, 0.0, 0.04))
    space = map_free_space(solids(FLOOR, rug, sill), BODY)
    assert space.is_free((-1.0, 0.0))
    assert not space.is_free((1.0, 0.0))


def test_no_cell_is_infinitely_far_away() -> None:
    """Not even where the number of cells to it is larger than any number."""
    space = map_free_space(solids(FLOOR), BODY)
    for place in ((1.7e308, 0.0), (0.0, -1.7e308)):
        assert space.cell_of(place) is None


def test_where_there_is_no_floor_nothing_is_known() -> None:
    """Between two floors there is a gap, which no body crosses."""
    left = BoxShape(half_extents_m=(0.5, 1.0, 0.1), centre_m=(-1.0, 0.0, -0.1))
    right = BoxShape(half_extents_m=(0.5, 1.0, 0.1), centre_m=(1.0, 0.0, -0.1))
    space = map_free_space(solids(left, right), BODY)
    assert space.cells[space.cell_of((0.0, 0.0))] == UNKNOWN
    assert set(np.unique(space.cells).tolist()) == {UNKNOWN, FREE}
    assert not space.reachable((-1.0, 0.0), (1.0, 0.0))
    with pytest.raises(InvalidRequest, match="reachable from the start"):
        space.path((-1.0, 0.0), (1.0, 0.0))


def test_a_ball_is_as_wide_as_the_band_sees_it() -> None:
    """A ball whose middle is above the body reaches down into it as a smaller circle."""
    (outline,) = outlines_between(solids(SphereShape(radius_m=0.5, centre_m=(1, 2, 1.3))), 0.0, 1.0)
    radii = np.hypot(*(outline - (1.0, 2.0)).T)
    assert np.all(radii >= 0.4 - 1e-12)  # 3-4-5: 0.3 above the band
    assert radii.max() <= 0.4 * 1.0013


def test_a_lying_cylinder_is_cut_where_the_band_ends() -> None:
    """Of a cylinder along x at height 1.3 m the band up to 1 m sees a strip of half its width."""
    pose = Pose.from_rpy_deg((0.0, 0.0, 1.3), (0.0, 90.0, 0.0))
    lying = solids(CylinderShape(radius_m=0.5, height_m=2.0), pose=pose)
    (outline,) = outlines_between(lying, 0.0, 1.0)
    low, high = outline.min(axis=0), outline.max(axis=0)
    np.testing.assert_allclose([low[0], high[0]], [-1.0, 1.0], atol=1e-9)
    assert 0.4 - 1e-3 <= high[1] <= 0.4 * 1.003
    assert low[1] == pytest.approx(-high[1])


def test_thin_triangles_are_in_the_way() -> None:
    """A wall of two upright triangles has no inside, and stops a body all the same."""
    wall = TriangleShape(
        positions=np.array([(0, -1.5, 0), (0, 1.5, 0), (0, 1.5, 2), (0, -1.5, 2.0)]),
        triangles=np.array([(0, 1, 2), (0, 2, 3)], np.int32),
    )
    space = map_free_space(solids(FLOOR, wall), BODY)
    x, _ = middles(space)
    assert np.array_equal(space.cells == OCCUPIED, np.abs(x) < 0.2)
    assert not space.reachable((-1.0, 0.0), (1.0, 0.0))


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), low=st.floats(-0.8, 0.4), thick=st.floats(0.05, 1.0))
def test_outlines_hold_the_points_of_the_hull_in_the_band(
    seed: int, low: float, thick: float
) -> None:
    """Every mixture of the corners whose height is in the band lies within the outline."""
    random = np.random.default_rng(seed)
    points = random.normal(size=(12, 3)) * 0.5
    found = outlines_between(solids(ConvexShape(points=points)), low, low + thick)
    mixed = random.dirichlet(np.full(12, 0.3), size=400) @ points
    mixed = mixed[(mixed[:, 2] > low) & (mixed[:, 2] < low + thick)]
    if not found:
        assert not len(mixed)
        return
    (outline,) = found
    ahead = np.roll(outline, -1, axis=0) - outline
    beside = mixed[:, None, :2] - outline[None]
    left = ahead[None, :, 0] * beside[..., 1] - ahead[None, :, 1] * beside[..., 0]
    assert (left >= -1e-9).all()


def room_with_a_wall() -> FreeSpace:
    """A floor of 4 × 3 m with a wall across its middle that leaves 1 m at the northern end."""
    wall = BoxShape(half_extents_m=(0.05, 1.0, 1.0), centre_m=(0.0, -0.5, 1.0))
    return map_free_space(solids(FLOOR, wall), BODY)


def test_a_way_goes_around_the_wall() -> None:
    """It is made of free cells, begins and ends where asked, and is nearly the taut string."""
    space = room_with_a_wall()
    start, goal = (-1.013, -1.021), (1.0, -1.0, 5.0)
    way = space.path(start, goal)
    assert way[0].tolist() == [*start, 0.0]
    assert way[-1].tolist() == [1.0, -1.0, 0.0]
    for a, b in itertools.pairwise(way):
        for share in np.linspace(0.0, 1.0, 200):
            assert space.is_free(a + share * (b - a))
    length = np.linalg.norm(np.diff(way, axis=0), axis=1).sum()
    # A string around the wall's end: from each place to the circle around a corner, and along it.
    taut = 0.1
    for x, y in (start, goal[:2]):
        across, down = abs(x) - 0.05, y - 0.5
        far = math.hypot(across, down)
        bent = math.pi / 2 + math.atan2(-down, across) - math.acos(0.2 / far)
        taut += math.sqrt(far**2 - 0.2**2) + 0.2 * bent
    assert taut - 0.01 < length < 1.03 * taut
    steps = space.distances_m(start)[space.cell_of(goal)]
    assert length <= steps + 0.1


def test_a_straight_way_is_straight() -> None:
    """Nothing in between: the start and the goal alone; the same place twice is a way as well."""
    space = room_with_a_wall()
    assert len(space.path((-1.5, 1.0), (1.5, 1.2))) == 2
    assert space.path((1.0, 1.0), (1.0, 1.0)).tolist() == [[1.0, 1.0, 0.0]] * 2


def test_corners_are_not_cut() -> None:
    """Two obstacles that touch at a corner leave no path between them."""
    cells = np.array([[0, 100], [100, 0]], np.int8)
    space = FreeSpace(cells=cells, origin_m=(0.0, 0.0), body=BODY)
    assert not space.reachable((0.01, 0.01), (0.09, 0.09))
    assert space.regions.max() == 2


def test_who_stands_in_a_wall_is_told() -> None:
    """A place that is not free is refused, with what would be."""
    space = room_with_a_wall()
    with pytest.raises(InvalidRequest, match="start must be a place in free space"):
        space.path((0.0, -0.5), (1.0, 0.0))
    with pytest.raises(InvalidRequest, match="goal must be a place in free space"):
        space.path((1.0, 0.0), (9.0, 0.0))


def test_random_poses_come_from_name_and_seed() -> None:
    """The same again for the same, other ones for others, all over the region and level."""
    space = room_with_a_wall()
    first = space.random_pose("robot", seed=3)
    assert space.random_pose("robot", seed=3) == first
    others = [space.random_pose(f"robot {n}", seed=3) for n in range(200)]
    assert len({pose.position_m for pose in others}) > 150
    assert all(space.is_free(pose.position_m) for pose in others)
    assert all(pose.rpy_deg[:2] == pytest.approx((0.0, 0.0)) for pose in others)
    xs = np.array([pose.position_m[0] for pose in others])
    assert (xs < 0).any()
    assert (xs > 0).any()
    assert space.random_pose("robot", seed=4) != first


def test_random_poses_stay_where_there_is_a_way() -> None:
    """In the largest region, or in that of a place."""
    wall = BoxShape(half_extents_m=(0.05, 1.5, 1.0), centre_m=(0.5, 0.0, 1.0))
    space = map_free_space(solids(FLOOR, wall), BODY)
    for number in range(40):
        assert space.random_pose(str(number)).position_m[0] < 0.5
        assert space.random_pose(str(number), reachable_from=(1.5, 0.0)).position_m[0] > 0.5


def test_a_full_room_has_no_pose() -> None:
    """Nothing is free: said, not searched for ever."""
    block = BoxShape(half_extents_m=(2.0, 1.5, 1.0), centre_m=(0.0, 0.0, 1.0))
    with pytest.raises(InvalidState, match="no place is free"):
        map_free_space(solids(FLOOR, block), BODY).random_pose()


def test_nothing_at_all_is_an_empty_map() -> None:
    """No floor, no cells."""
    assert map_free_space([], BODY).cells.size == 0


def test_a_map_that_is_too_fine_is_refused() -> None:
    """With the resolution that would do."""
    vast = BoxShape(half_extents_m=(100.0, 100.0, 0.1), centre_m=(0.0, 0.0, -0.1))
    posts = [
        BoxShape(half_extents_m=(1, 1, 1), centre_m=(s * 90.0, s * 90.0, 1.0)) for s in (-1, 1)
    ]
    with pytest.raises(InvalidRequest, match=r"resolution_m must be at least 0\.0"):
        map_free_space(solids(vast, *posts), BODY)


@pytest.mark.parametrize(
    "wrong", [{"height_m": 0.0}, {"radius_m": -1.0}, {"step_m": 2.0}, {"resolution_m": math.nan}]
)
def test_bodies_that_cannot_be_are_refused(wrong: dict[str, float]) -> None:
    """Each in a sentence that names what is wrong."""
    with pytest.raises(InvalidRequest, match=next(iter(wrong))):
        BodySize(**wrong)


def test_distances_to_several_places_are_those_to_the_nearest() -> None:
    space = map_free_space(
        solids(FLOOR, BoxShape(half_extents_m=(0.1, 0.8, 0.5), centre_m=(0.0, 0.3, 0.5))), BODY
    )
    cells = [tuple(cell) for cell in np.argwhere(space.regions == 1)[[3, 400, -5]].tolist()]
    goals = np.zeros(space.cells.shape, bool)
    for cell in cells:
        goals[cell] = True
    goals |= space.cells == OCCUPIED  # which count for nothing
    each = [space.distances_m(space.position_of(*cell)) for cell in cells]
    assert (space.distances_to_m(goals) == np.minimum.reduce(each)).all()
    with pytest.raises(InvalidRequest, match="free"):
        space.distances_to_m(space.cells == OCCUPIED)
