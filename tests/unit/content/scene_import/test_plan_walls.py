"""Walls of plans beside arithmetic: closed solids, openings of their size, corners that meet."""

from __future__ import annotations

import math

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from sailenv_content.scene_import.plan_slabs import inside, slab
from sailenv_content.scene_import.plan_walls import Opening, PlanWall, WallSolid, wall_solid


def wall(
    start: tuple[float, float],
    end: tuple[float, float],
    thickness: float = 0.2,
    rise: tuple[float, float] = (2.5, 2.5),
) -> PlanWall:
    return PlanWall(
        start=np.array(start), end=np.array(end), thickness_m=thickness, low_m=0.0, rise_m=rise
    )


def solid_of(line: PlanWall, *openings: Opening) -> WallSolid:
    made = wall_solid(line, openings)
    assert made is not None
    return made


def whole(solid: WallSolid) -> trimesh.Trimesh:
    meshes = [
        trimesh.Trimesh(mesh.positions, mesh.triangles, process=False)
        for mesh in (solid.left, solid.right, solid.rest)
    ]
    joined = trimesh.util.concatenate(meshes)
    joined.merge_vertices(merge_tex=True, merge_norm=True)
    return joined


def hull_volume(solid: WallSolid) -> float:
    return sum(trimesh.convex.convex_hull(hull.points).volume for hull in solid.hulls)


def test_a_wall_with_a_door_and_a_window_is_closed() -> None:
    """The volume is that of the box without the holes, and the convex pieces fill it."""
    door = Opening(along_m=(0.5, 1.4), height_m=(0.0, 2.1))
    window = Opening(along_m=(2.0, 3.2), height_m=(0.9, 2.2))
    solid = solid_of(wall((0, 0), (4, 0)), door, window)
    mesh = whole(solid)
    expected = 0.2 * (4.0 * 2.5 - 0.9 * 2.1 - 1.2 * 1.3)
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    assert mesh.volume == pytest.approx(expected)
    assert hull_volume(solid) == pytest.approx(expected)


@settings(max_examples=30, deadline=None)
@given(
    turn=st.floats(0.0, 6.2),
    holes=st.lists(
        st.tuples(st.floats(-1, 6), st.floats(0.01, 3), st.floats(-1, 3), st.floats(0.01, 2)),
        max_size=4,
    ),
    rise=st.tuples(st.floats(1.0, 4.0), st.floats(1.0, 4.0)),
)
def test_walls_are_closed_whatever_is_cut_out(
    turn: float, holes: list[tuple[float, float, float, float]], rise: tuple[float, float]
) -> None:
    """Overlapping holes, holes beyond the ends, a sloping top, any direction."""
    end = (5.0 * math.cos(turn), 5.0 * math.sin(turn))
    openings = [Opening(along_m=(a, a + w), height_m=(b, b + h)) for a, w, b, h in holes]
    solid = wall_solid(wall((0, 0), end, 0.25, rise), openings)
    if solid is None:
        return
    mesh = whole(solid)
    assert mesh.volume > 0.0
    assert mesh.volume == pytest.approx(hull_volume(solid), rel=1e-6, abs=1e-9)


def test_joined_walls_meet_at_their_corner() -> None:
    """Two walls at a right angle share the line through their inner and outer corner."""
    first, second = wall((0, 0), (4, 0)), wall((4, 0), (4, 3))
    first.after, second.before = second, first
    one, two = (whole(solid_of(line)) for line in (first, second))
    for corner in ((3.9, 0.1), (4.1, -0.1)):
        for mesh in (one, two):
            away = np.linalg.norm(mesh.vertices[:, :2] - corner, axis=1)
            assert away.min() == pytest.approx(0.0, abs=1e-9)
    # Together they fill the corner once: 4 × 0.2 and 3 × 0.2, the square at the corner shared.
    assert one.volume + two.volume == pytest.approx(2.5 * 0.2 * 7.0)


def test_walls_that_were_drawn_towards_each_other_meet_too() -> None:
    """The second begins elsewhere and ends at the corner."""
    first, second = wall((0, 0), (4, 0)), wall((4, 3), (4, 0), 0.4)
    first.after, second.after = second, first
    total = sum(whole(solid_of(line)).volume for line in (first, second))
    assert total == pytest.approx(2.5 * (4.0 * 0.2 + 3.0 * 0.4))


def test_walls_that_go_straight_on_end_where_they_are_drawn() -> None:
    """No mitre, which would be without end."""
    first, second = wall((0, 0), (4, 0)), wall((4, 0), (8, 0.01))
    first.after, second.before = second, first
    assert whole(solid_of(first)).volume == pytest.approx(2.5 * 0.8)


def test_a_wall_that_is_all_door_is_none() -> None:
    """Nothing is left of it."""
    assert wall_solid(wall((0, 0), (1, 0)), [Opening(along_m=(-1, 2), height_m=(-1, 3))]) is None
    assert wall_solid(wall((0, 0), (0, 0)), []) is None


def test_slabs_are_closed_and_filled() -> None:
    """An L, either way round: volume of mesh and pieces; its top faces up."""
    outline = np.array([(0, 0), (3, 0), (3, 1), (1, 1), (1, 2), (0, 2)], float)
    for points in (outline, outline[::-1]):
        mesh, hulls = slab(points, -0.1, 0.0)
        solid = trimesh.Trimesh(mesh.positions, mesh.triangles, process=False)
        solid.merge_vertices(merge_tex=True, merge_norm=True)
        assert solid.is_watertight
        assert solid.volume == pytest.approx(0.4)
        pieces = [trimesh.convex.convex_hull(hull.points).volume for hull in hulls]
        assert sum(pieces) == pytest.approx(0.4)
    assert inside(outline, np.array([0.5, 1.5]))
    assert not inside(outline, np.array([2.0, 1.5]))
