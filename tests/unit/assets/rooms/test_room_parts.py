"""Rooms: parts, exact places, closed geometry, collision shapes that fill what is solid."""

from __future__ import annotations

import itertools
import math
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from sailenv_ros.assets import load_categories
from sailenv_ros.assets.rooms import RoomPart, room_parts
from sailenv_ros.scene.spec_room import RoomSpec
from sailenv_ros.types.model import BoxShape

WINDOW = {"type": "window", "wall": "north", "at": 0.4, "width": 1.4, "height": 1.3, "sill": 0.9}
DOOR = {"type": "door", "wall": "east", "at": -0.8, "width": 0.9, "height": 2.05}
WALLS = ("north", "east", "south", "west")
OUTWARD = {"north": (0, 1, 0), "east": (1, 0, 0), "south": (0, -1, 0), "west": (-1, 0, 0)}


def room(**keys: Any) -> dict[str, RoomPart]:
    keys.setdefault("size", [4.4, 3.6, 2.6])
    keys.setdefault("openings", [WINDOW, DOOR])
    parts = room_parts(RoomSpec.model_validate(keys))
    return {part.asset.display_name: part for part in parts}


def triangles(part: RoomPart, number: int | None = None) -> NDArray[np.float64]:
    """(M, 3, 3) corners in the world of all triangles, or of one of the model's parts."""
    chosen = part.asset.model.parts if number is None else [part.asset.model.parts[number]]
    corners = [p.mesh.positions[p.mesh.triangles].astype(float) for p in chosen]
    return np.concatenate(corners) + np.asarray(part.position_m)


def area(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    crossed = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return 0.5 * np.asarray(np.linalg.norm(crossed, axis=1))


def inner_face(part: RoomPart, wall: str) -> NDArray[np.float64]:
    """The triangles in the plane of a wall's inner face of a room of 4.4 by 3.6 m."""
    axis = 1 if wall in ("north", "south") else 0
    plane = (2.2, 1.8)[axis] * sum(OUTWARD[wall])
    corners = triangles(part, 0)
    return corners[np.abs(corners[:, :, axis] - plane).max(axis=1) < 1e-6]


def boxes(part: RoomPart) -> NDArray[np.float64]:
    """(N, 2, 3) corners of the collision boxes in the world."""
    found = []
    for shape in part.asset.collision:
        assert isinstance(shape, BoxShape)
        centre = np.asarray(shape.centre_m) + part.position_m
        found.append([centre - shape.half_extents_m, centre + shape.half_extents_m])
    return np.asarray(found)


def test_a_room_has_these_objects_in_this_order() -> None:
    names = ["floor", "ceiling", *(f"{wall} wall" for wall in WALLS), "skirting"]
    curtained = {**WINDOW, "curtains": True}
    parts = room(openings=[DOOR, curtained, {**WINDOW, "wall": "west"}])
    assert list(parts) == [*names, "window 1", "window 2", "door 1", "curtains 1"]


def test_every_part_has_a_category_of_the_fixed_table() -> None:
    table = load_categories()
    parts = room(openings=[{**WINDOW, "curtains": True}, DOOR])
    kinds = {name: table.named(part.asset.category).id for name, part in parts.items()}
    assert kinds["floor"] == 52
    assert kinds["ceiling"] == 53
    assert {kinds[f"{wall} wall"] for wall in WALLS} == {51}
    assert (kinds["window 1"], kinds["door 1"], kinds["skirting"]) == (54, 55, 56)
    assert kinds["curtains 1"] == 57


def test_ceiling_and_skirting_may_be_left_out() -> None:
    assert {"ceiling", "skirting"}.isdisjoint(room(ceiling=False, skirting=False))


def test_an_equal_description_gives_the_same_objects() -> None:
    """A scene that is reset uploads nothing anew."""
    assert room()["floor"] is room()["floor"]


def test_inner_faces_lie_at_the_size_that_was_given() -> None:
    parts = room(openings=[])
    for wall in WALLS:
        corners = inner_face(parts[f"{wall} wall"], wall)
        assert area(corners).sum() >= (4.4 if wall in ("north", "south") else 3.6) * 2.6 - 1e-6
    assert np.isclose(triangles(parts["floor"])[:, :, 2].max(), 0.0, atol=1e-7)
    assert np.isclose(triangles(parts["ceiling"])[:, :, 2].min(), 2.6, atol=1e-6)


def test_openings_are_cut_exactly() -> None:
    """What is left of an inner face is its area without the opening's, with no overlap."""
    parts = room()
    north = area(inner_face(parts["north wall"], "north")).sum()
    assert north == pytest.approx((4.4 + 2 * 0.2) * 2.6 - 1.4 * 1.3, abs=1e-5)
    east = area(inner_face(parts["east wall"], "east")).sum()
    assert east == pytest.approx(3.6 * 2.6 - 0.9 * 2.05, abs=1e-5)


@pytest.mark.parametrize("wall", WALLS)
def test_faces_share_their_vertices(wall: str) -> None:
    """No vertex of the inner side lies within another triangle's edge: nothing shows through."""
    openings = [{**WINDOW, "wall": wall, "at": -0.5}, {**DOOR, "wall": wall, "at": 1.0}]
    openings.append({**WINDOW, "wall": wall, "at": -1.45, "width": 0.4, "sill": 1.2})
    corners = triangles(room(openings=openings)[f"{wall} wall"], 0)
    points = np.unique(corners.reshape(-1, 3).round(6), axis=0)
    starts, ends = corners.reshape(-1, 3), np.roll(corners, -1, axis=1).reshape(-1, 3)
    for point in points:
        along = ends - starts
        share = ((point - starts) * along).sum(axis=1) / (along**2).sum(axis=1)
        away = np.linalg.norm(starts + share[:, None] * along - point, axis=1)
        inside = (share > 1e-4) & (share < 1 - 1e-4) & (away < 1e-5)
        # The reveals' own edges into the depth meet those of the face only at their ends.
        assert not inside.any()


@pytest.mark.parametrize("wall", WALLS)
def test_faces_look_where_their_normals_point(wall: str) -> None:
    openings = [
        {**WINDOW, "wall": wall, "at": -0.9, "curtains": True},
        {**DOOR, "wall": wall, "at": 1.0, "open": 30.0},
    ]
    parts = room(openings=openings)
    for part in parts.values():
        for piece in part.asset.model.parts:
            corners = piece.mesh.positions[piece.mesh.triangles].astype(float)
            crossed = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
            normals = piece.mesh.normals[piece.mesh.triangles].mean(axis=1)
            assert ((crossed * normals).sum(axis=1) > 0).all()


def test_walls_face_into_the_room() -> None:
    for wall in WALLS:
        piece = room(openings=[])[f"{wall} wall"].asset.model.parts[0]
        np.testing.assert_allclose(piece.mesh.normals @ OUTWARD[wall], -1.0, atol=1e-6)


def test_a_pattern_has_its_real_size_on_a_wall() -> None:
    """White tiles repeat every 1.2 m to the right, as seen from inside, and upwards."""
    for wall, right in zip(WALLS, [(1, 0, 0), (0, -1, 0), (-1, 0, 0), (0, 1, 0)], strict=True):
        mesh = room(walls="white_tiles", openings=[])[f"{wall} wall"].asset.model.parts[0].mesh
        np.testing.assert_allclose(mesh.uvs[:, 0], mesh.positions @ right / 1.2, atol=1e-6)
        np.testing.assert_allclose(mesh.uvs[:, 1], mesh.positions[:, 2] / 1.2, atol=1e-6)


def test_boards_may_be_turned() -> None:
    """Turned by 90 degrees, the pattern's own x runs along the room's y."""
    parts = room(floor={"material": "oak_planks", "turn": 90}, openings=[])
    mesh = parts["floor"].asset.model.parts[0].mesh
    top = mesh.normals[:, 2] > 0.5
    np.testing.assert_allclose(mesh.uvs[top, 0], mesh.positions[top, 1] / 2.4, atol=1e-6)
    np.testing.assert_allclose(mesh.uvs[top, 1], -mesh.positions[top, 0] / 1.2, atol=1e-6)


def test_a_pane_is_a_part_of_its_own_and_see_through() -> None:
    window = room()["window 1"].asset.model
    glass = [part for part in window.parts if part.material.alpha == "blend"]
    assert len(glass) == 1
    assert {part.material.name for part in window.parts} >= {"glass", "handle", "window paint"}


@pytest.mark.parametrize(("width", "casements"), [(0.6, 1), (0.8, 1), (1.4, 2), (2.5, 4)])
def test_wide_windows_have_more_casements(width: float, casements: int) -> None:
    """One for each 0.8 m; each has a pane."""
    one, many = (
        room(openings=[{**WINDOW, "at": 0.0, "width": w}])["window 1"].asset.model.parts[2]
        for w in (0.6, width)
    )
    assert len(many.mesh.triangles) == casements * len(one.mesh.triangles)


def test_collision_boxes_fill_the_walls_and_leave_the_openings() -> None:
    """A point in a wall is in a box unless it lies in an opening (tried on a grid)."""
    for wall, opening in (("north wall", WINDOW), ("east wall", DOOR)):
        low, high = np.moveaxis(boxes(room()[wall]), 1, 0)
        axis = 0 if wall == "north wall" else 1
        out = 1.8 if wall == "north wall" else 2.2
        sill = float(opening.get("sill", 0.0))  # type: ignore[arg-type]
        for along, up in itertools.product(
            np.linspace(-1.79, 1.79, 41), np.linspace(0.01, 2.59, 27)
        ):
            point = np.full(3, out + 0.1)
            point[axis], point[2] = along, up
            solid = ((point > low) & (point < high)).all(axis=1).any()
            beside = abs(along - float(opening["at"])) > float(opening["width"]) / 2  # type: ignore[arg-type]
            above = not sill < up < sill + float(opening["height"])  # type: ignore[arg-type]
            assert solid == (beside or above)


def test_what_holds_things_in_is_at_least_15_cm_thick() -> None:
    """Floor, ceiling, walls, closed windows and doors, outwards from the inner face."""
    parts = room(thickness=0.15)
    for name in ("floor", "ceiling", *(f"{wall} wall" for wall in WALLS), "door 1"):
        assert (np.diff(boxes(parts[name]), axis=1).min(axis=2) >= 0.15 - 1e-9).all()
    assert np.diff(boxes(parts["window 1"])[:1], axis=1).min() >= 0.15 - 1e-9


def test_boxes_of_the_corner_walls_meet() -> None:
    """The corners outside the inner rectangle are solid too."""
    found = np.concatenate([boxes(part) for part in room(openings=[]).values()])
    for x, y in itertools.product((-2.3, 2.3), (-1.9, 1.9)):
        inside = ((found[:, 0] < (x, y, 1.0)) & (found[:, 1] > (x, y, 1.0))).all(axis=1)
        assert inside.any()


@pytest.mark.parametrize("wall", WALLS)
@pytest.mark.parametrize("hinge", ["left", "right"])
@pytest.mark.parametrize("angle", [0.0, 35.0, 90.0, 170.0])
def test_a_leaf_turns_into_the_room_about_its_hinges(wall: str, hinge: str, angle: float) -> None:
    """The free edge is where its circle about the hinges has it; the hinged edge stays."""
    door = {**DOOR, "wall": wall, "at": 0.0, "open": angle, "hinge": hinge}
    part = room(openings=[door])["door 1"]
    right = np.cross(OUTWARD[wall], (0, 0, 1))
    to_free = right if hinge == "left" else -right
    inwards = -np.asarray(OUTWARD[wall], float)
    leaf = part.asset.model.parts[1].mesh.positions.astype(float)
    closed = room(openings=[{**door, "open": 0.0}])["door 1"].asset.model.parts[1].mesh.positions
    axis = -to_free * (0.45 - 0.03) + inwards * 0.01
    at, turn = closed - axis, math.radians(angle)
    along, deep = at @ to_free, at @ inwards
    expected = (
        np.outer(along * math.cos(turn) - deep * math.sin(turn), to_free)
        + np.outer(along * math.sin(turn) + deep * math.cos(turn), inwards)
        + axis * [1, 1, 0]
        + np.outer(at[:, 2], (0, 0, 1))
    )
    np.testing.assert_allclose(leaf, expected, atol=1e-6)


def test_an_open_leaf_collides_where_it_is_seen() -> None:
    part = room(openings=[{**DOOR, "open": 70.0}])["door 1"]
    shape = part.asset.collision[-1]
    assert isinstance(shape, BoxShape)
    leaf = part.asset.model.parts[1].mesh.positions.astype(float)
    x, y, z, w = shape.orientation_xyzw
    assert (x, y) == (0.0, 0.0)
    angle = 2.0 * math.atan2(z, w)
    back = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
    local = leaf - shape.centre_m
    local[:, :2] = local[:, :2] @ back
    np.testing.assert_allclose(np.abs(local).max(axis=0), shape.half_extents_m, atol=1e-5)


def test_skirting_stops_at_doors_and_runs_below_windows() -> None:
    parts = room()
    corners = triangles(parts["skirting"]).reshape(-1, 3)
    assert corners[:, 2].max() == pytest.approx(0.09, abs=1e-6)
    east = corners[corners[:, 0] > 2.2 - 0.0151][:, 1]
    half = 0.45 + 0.045
    assert not ((east > -0.8 - half + 1e-6) & (east < -0.8 + half - 1e-6)).any()
    found = boxes(parts["skirting"])
    below_window = (found[:, 0] <= (0.4, 1.8, 0.05)) & (found[:, 1] >= (0.4, 1.79, 0.05))
    assert below_window.all(axis=1).any()
    in_door = (found[:, 0] < (2.195, -0.8, 0.05)) & (found[:, 1] > (2.195, -0.8, 0.05))
    assert not in_door.all(axis=1).any()


def test_curtains_stay_in_a_corner() -> None:
    """Those of a window at the wall's end do not reach through the wall beside it."""
    window = {**WINDOW, "at": 1.5, "curtains": {"drawn": 0.5}}
    corners = triangles(room(openings=[window])["curtains 1"]).reshape(-1, 3)
    assert corners[:, 0].max() < 2.2
    assert corners[:, 1].max() <= 1.8
    assert corners[:, 2].min() > 0.0


INNER = {"name": "inner wall", "start": [0.5, -1.8], "end": [0.5, 1.8], "thickness": 0.12}


def test_a_wall_inside_is_a_closed_box_with_a_hole_for_the_doorway() -> None:
    wall = room(partitions=[{**INNER, "doorways": [{"at": 0.4}]}])["inner wall"]
    faces = np.concatenate([triangles(wall, 0), triangles(wall, 1)])
    # Both sides without the doorway of 0.9 by 2.05 m.
    for x in (0.44, 0.56):
        side = faces[np.abs(faces[:, :, 0] - x).max(axis=1) < 1e-6]
        assert area(side).sum() == pytest.approx(3.6 * 2.6 - 0.9 * 2.05)
    low, high = faces.min(axis=(0, 1)), faces.max(axis=(0, 1))
    assert np.allclose(low, (0.44, -1.8, 0.0))
    assert np.allclose(high, (0.56, 1.8, 2.6))


def test_a_wall_inside_collides_but_for_its_doorway() -> None:
    wall = room(partitions=[{**INNER, "doorways": [{"at": 0.4}]}])["inner wall"]
    for y, z, solid in ((0.4, 1.0, False), (0.4, 2.3, True), (-1.0, 1.0, True), (0.4, 2.04, True)):
        place = np.array([0.5, y, z]) - wall.position_m
        hit = [
            bool((np.abs(place - shape.centre_m) <= shape.half_extents_m).all())
            for shape in wall.asset.collision
            if isinstance(shape, BoxShape)
        ]
        assert any(hit) is solid


def test_a_part_of_the_floor_takes_the_place_of_the_floor() -> None:
    bath = {"name": "bath floor", "start": [0.5, -1.8], "end": [2.2, 1.8], "surface": "stone_tiles"}
    parts = room(floors=[bath])
    faces = [triangles(parts[name]) for name in ("floor", "bath floor")]
    tops = [f[np.abs(f[:, :, 2]).max(axis=1) < 1e-6] for f in faces]
    whole = (4.4 + 0.4) * (3.6 + 0.4)
    assert area(tops[1]).sum() == pytest.approx(1.7 * 3.6)
    assert area(tops[0]).sum() == pytest.approx(whole - 1.7 * 3.6)
    assert parts["bath floor"].asset.collision == ()


def test_the_skirting_goes_along_both_sides_of_a_wall_inside() -> None:
    plain, divided = (
        len(room(**keys)["skirting"].asset.collision) for keys in ({}, {"partitions": [INNER]})
    )
    assert divided == plain + 2
