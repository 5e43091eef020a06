"""Walls with rectangular holes, floors, ceilings and skirting boards.

A wall's frame, its openings and surfaces in, models and collision shapes out. Faces around a
hole are cut along one grid, so that neighbours share their vertices and no gap shows.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise, product

import numpy as np

from sailenv_ros.assets.rooms.pieces import Box, Faces, WallFrame, collision_of
from sailenv_ros.assets.surfaces import Surface
from sailenv_ros.types.model import BoxShape, Material, Mesh, ModelPart

__all__ = ["Hole", "box_of_slab", "skirting_parts", "slab_part", "wall_collision", "wall_parts"]

Interval = tuple[float, float]

_OUTSIDE = Material(name="facade", base_colour=(0.55, 0.53, 0.49, 1.0), roughness=0.9)
_TOP_EDGE_M = 0.012


@dataclass(frozen=True, slots=True)
class Hole:
    """A rectangle that is cut out of a wall: from, to along it; from, to above the floor [m]."""

    along: Interval
    up: Interval


def wall_parts(
    frame: WallFrame, holes: Sequence[Hole], surface: Surface, behind: Surface | None = None
) -> tuple[ModelPart, ModelPart]:
    """Return the inside of a wall with the sides of its holes, and its outside.

    Where something is `behind` the wall its other side and its ends are made of that, too.
    """
    inner, outer = Faces(), Faces()
    across = np.asarray(frame.along)
    outward, thick = np.asarray(frame.outward), frame.thickness_m
    for along, up in _solid_cells(frame, holes):
        side, height = (along[1] - along[0]) * across, np.array([0.0, 0.0, up[1] - up[0]])
        inner.add(frame.point(along[0], 0.0, up[0]), side, height, -outward)
        outer.add(frame.point(along[0], thick, up[0]), side, height, outward)
    _add_reveals(inner, frame, holes)
    _add_ends(outer, frame, seen=behind is not None)
    return (
        ModelPart(mesh=inner.mesh(surface), material=surface.material),
        ModelPart(
            mesh=outer.mesh(behind), material=_OUTSIDE if behind is None else behind.material
        ),
    )


def wall_collision(frame: WallFrame, holes: Sequence[Hole]) -> tuple[BoxShape, ...]:
    """Return boxes that fill a wall but for its holes: columns between and strips above, below."""
    edges = _breaks(_extent(frame), [edge for hole in holes for edge in hole.along])
    boxes = []
    for along in pairwise(edges):
        middle = sum(along) / 2.0
        cut = sorted(hole.up for hole in holes if _within(middle, hole.along))
        for up in _rest((0.0, frame.height_m), cut):
            box = frame.box(along, (0.0, frame.thickness_m), up)
            boxes.append(collision_of(box))
    return tuple(boxes)


def slab_part(
    size_m: Interval,
    thickness_m: float,
    surface: Surface,
    *,
    up: bool,
    without: Sequence[Hole] = (),
) -> ModelPart:
    """Return a floor (`up`) or ceiling: its face at z = 0, and its other faces, in one material.

    What rectangles `without` cover (from, to along x; from, to along y) is left out of the face.
    """
    half_x, half_y = size_m[0] / 2.0, size_m[1] / 2.0
    facing = 1.0 if up else -1.0
    back = -facing * thickness_m
    x, y, z = np.eye(3)
    faces = Faces()
    columns = _breaks((-half_x, half_x), [edge for hole in without for edge in hole.along])
    rows = _breaks((-half_y, half_y), [edge for hole in without for edge in hole.up])
    for along, across in product(pairwise(columns), pairwise(rows)):
        middle = sum(along) / 2.0, sum(across) / 2.0
        if not any(_within(middle[0], h.along) and _within(middle[1], h.up) for h in without):
            side, other = (along[1] - along[0]) * x, (across[1] - across[0]) * y
            faces.add((along[0], across[0], 0.0), side, other, facing * z)
    faces.add((-half_x, -half_y, back), 2 * half_x * x, 2 * half_y * y, -facing * z)
    for sign in (-1.0, 1.0):
        faces.add((sign * half_x, -half_y, 0.0), 2 * half_y * y, back * z, sign * x)
        faces.add((-half_x, sign * half_y, 0.0), 2 * half_x * x, back * z, sign * y)
    return ModelPart(mesh=faces.mesh(surface), material=surface.material)


def skirting_parts(
    frame: WallFrame, gaps: Sequence[Interval], height_m: float, depth_m: float
) -> Iterator[tuple[Mesh, BoxShape]]:
    """Yield the boards along a wall between the gaps, and what they collide as.

    Positions are relative to the foot of the wall's middle. Boards run into the room's corners,
    where those of two walls meet in a mitre.
    """
    half = frame.length_m / 2.0
    round_m = min(_TOP_EDGE_M, height_m / 2.0, depth_m / 1.5)
    angles = np.linspace(0.0, np.pi / 2.0, 5)
    outline = [(-depth_m, 0.0)]
    outline += [
        (-depth_m + round_m * (1.0 - np.cos(a)), height_m - round_m * (1.0 - np.sin(a)))
        for a in angles
    ]
    outline.append((0.0, height_m))
    for along in _rest((-half, half), sorted(gaps)):
        # Collides as if it went on into the wall: thin boards let fast things through.
        box = frame.box(along, (-depth_m, frame.thickness_m - depth_m), (0.0, height_m))
        yield _board(frame, along, outline), collision_of(box)


def _board(frame: WallFrame, along: Interval, outline: Sequence[tuple[float, float]]) -> Mesh:
    faces = Faces()
    run = (along[1] - along[0]) * np.asarray(frame.along)
    for (out, up), (next_out, next_up) in pairwise(outline):
        start, end = frame.point(along[0], out, up), frame.point(along[0], next_out, next_up)
        slope = np.array([next_up - up, next_out - out]) / np.hypot(next_up - up, next_out - out)
        normal = -slope[0] * np.asarray(frame.outward) + np.array([0.0, 0.0, slope[1]])
        faces.add(start, run, end - start, normal)
    back = 0.0
    for place, sign in zip(along, (-1.0, 1.0), strict=True):
        for (out, up), (next_out, next_up) in pairwise(outline):
            corners = [(out, up), (next_out, next_up), (back, next_up), (back, up)]
            kept = list(dict.fromkeys(corners))
            if len(kept) >= 3 and next_up > up:
                points = [frame.point(place, *corner) for corner in kept]
                faces.polygon(points, sign * np.asarray(frame.along))
    return faces.mesh()


def _extent(frame: WallFrame) -> Interval:
    half = frame.length_m / 2.0 + frame.overhang_m
    return -half, half


def _grid(frame: WallFrame, holes: Sequence[Hole]) -> tuple[list[Interval], list[Interval]]:
    """Cut a wall's length and height at all edges of holes and at the room's corners."""
    half = frame.length_m / 2.0
    columns = _breaks(_extent(frame), [e for hole in holes for e in hole.along] + [-half, half])
    rows = _breaks((0.0, frame.height_m), [edge for hole in holes for edge in hole.up])
    return list(pairwise(columns)), list(pairwise(rows))


def _solid_cells(frame: WallFrame, holes: Sequence[Hole]) -> Iterator[tuple[Interval, Interval]]:
    """Yield the cells of the grid that lie in no hole."""
    for along, up in product(*_grid(frame, holes)):
        x, z = sum(along) / 2.0, sum(up) / 2.0
        if not any(_within(x, hole.along) and _within(z, hole.up) for hole in holes):
            yield along, up


def _add_reveals(faces: Faces, frame: WallFrame, holes: Sequence[Hole]) -> None:
    """Add the sides of all holes, cut along the grid as the faces beside them."""
    columns, rows = _grid(frame, holes)
    across, above = np.asarray(frame.along), np.eye(3)[2]
    depth = frame.thickness_m * np.asarray(frame.outward)
    for hole in holes:
        for up in rows:
            if _within(sum(up) / 2.0, hole.up):
                tall = (up[1] - up[0]) * above
                faces.add(frame.point(hole.along[0], 0.0, up[0]), depth, tall, across)
                faces.add(frame.point(hole.along[1], 0.0, up[0]), depth, tall, -across)
        for along in columns:
            if _within(sum(along) / 2.0, hole.along):
                wide = (along[1] - along[0]) * across
                faces.add(frame.point(along[0], 0.0, hole.up[1]), wide, depth, -above)
                if hole.up[0] > 0.0:  # a door stands on the floor, which runs on below the walls
                    faces.add(frame.point(along[0], 0.0, hole.up[0]), wide, depth, above)


def _within(place: float, extent: Interval) -> bool:
    return extent[0] < place < extent[1]


def _add_ends(faces: Faces, frame: WallFrame, *, seen: bool) -> None:
    low, high = _extent(frame)
    along, depth = np.asarray(frame.along), frame.thickness_m * np.asarray(frame.outward)
    tall = np.array([0.0, 0.0, frame.height_m])
    faces.add(frame.point(low, 0.0, frame.height_m), (high - low) * along, depth, (0.0, 0.0, 1.0))
    if seen or frame.overhang_m > 0.0:
        faces.add(frame.point(low, 0.0, 0.0), depth, tall, -along)
        faces.add(frame.point(high, 0.0, 0.0), depth, tall, along)


def _breaks(extent: Interval, edges: Sequence[float]) -> list[float]:
    """Sort the edges between two ends, without those that differ by less than a micrometre."""
    kept = [extent[0]]
    for edge in sorted(edges):
        if kept[-1] + 1e-6 < edge < extent[1] - 1e-6:
            kept.append(edge)
    return [*kept, extent[1]]


def _rest(extent: Interval, cut: Sequence[Interval]) -> Iterator[Interval]:
    """Yield what is left of an interval between sorted ones."""
    start = extent[0]
    for low, high in cut:
        if low - start > 1e-6:
            yield start, low
        start = max(start, high)
    if extent[1] - start > 1e-6:
        yield start, extent[1]


def box_of_slab(size_m: Interval, thickness_m: float, *, up: bool) -> Box:
    """Return the box of a floor or ceiling whose face lies at z = 0."""
    half_x, half_y = size_m[0] / 2.0, size_m[1] / 2.0
    low, high = (-thickness_m, 0.0) if up else (0.0, thickness_m)
    return Box((-half_x, -half_y, low), (half_x, half_y, high))
