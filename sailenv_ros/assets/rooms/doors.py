"""Doors: lining, architraves, a panelled leaf that may stand open, handles.

Positions are relative to the middle of the opening's foot in the wall's inner face.
"""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.assets.rooms.pieces import Box, WallFrame, boxes_mesh, collision_of
from sailenv_ros.scene.spec_room import DoorSpec, DoorwaySpec
from sailenv_ros.types.model import BoxShape, Material, Mesh, ModelPart

__all__ = [
    "ARCHITRAVE_M",
    "closed_leaf_parts",
    "door_collision",
    "door_parts",
    "doorway_collision",
    "doorway_parts",
    "hinge_point",
    "leaf_box",
    "opening_sense",
]

ARCHITRAVE_M = 0.045
"""Width by which the frame covers the wall beside the opening [m]."""

_LINING_M = 0.03
_ARCHITRAVE_DEPTH_M = 0.015
_COVERS_LINING_M = 0.02
_GAP_M = 0.003
_FLOOR_GAP_M = 0.006
_THRESHOLD_M = 0.008
_LEAF_M = 0.04
_LEAF_INNER_M = 0.005
_HINGE_OUT_M = -0.01
_STILE_M = 0.115
_LEAST_BARRIER_M = 0.15
_HANDLE_UP_M = 1.03
_SUNK = 0.72

_METAL = Material(name="handle", base_colour=(0.60, 0.59, 0.57, 1.0), metallic=1.0, roughness=0.30)


def door_parts(spec: DoorSpec, frame: WallFrame) -> tuple[ModelPart, ...]:
    """Return frame, leaf and metal fittings; of one whose leaf moves, the frame alone."""
    fixed = ModelPart(mesh=boxes_mesh(_frame_boxes(spec, frame)), material=_paint(spec))
    return (fixed,) if spec.hinged else (fixed, *closed_leaf_parts(spec, frame, spec.open))


def closed_leaf_parts(
    spec: DoorSpec, frame: WallFrame, open_deg: float = 0.0
) -> tuple[ModelPart, ...]:
    """Return leaf and metal fittings, turned into the room by an angle [deg]."""
    red, green, blue = spec.colour
    spec = spec.model_copy(update={"open": open_deg})
    paint = _paint(spec)
    # What is sunk in gets less light than the renderer can know.
    shade = Material(
        name="door shade",
        base_colour=(_SUNK * red, _SUNK * green, _SUNK * blue, 1.0),
        roughness=0.7,
    )
    wood, fields, sunk, metal = _leaf(spec, frame)
    leaf = _turned(boxes_mesh(wood), spec, frame)
    panels = _turned(boxes_mesh(fields, chamfer_m=0.009), spec, frame)
    return (
        ModelPart(mesh=leaf, material=paint),
        ModelPart(mesh=panels, material=paint),
        ModelPart(mesh=_turned(boxes_mesh(sunk), spec, frame), material=shade),
        ModelPart(mesh=_turned(boxes_mesh(metal), spec, frame), material=_METAL),
    )


def _paint(spec: DoorSpec) -> Material:
    red, green, blue = spec.colour
    return Material(name="door paint", base_colour=(red, green, blue, 1.0), roughness=0.6)


def door_collision(spec: DoorSpec, frame: WallFrame) -> tuple[BoxShape, ...]:
    """Return the closed door as a thick box outwards from its leaf, an open one as it stands.

    One whose leaf moves is its lining alone.
    """
    half = spec.width / 2.0
    if spec.open == 0.0 and not spec.hinged:
        out = (_LEAF_INNER_M, max(frame.thickness_m, _LEAF_INNER_M + _LEAST_BARRIER_M))
        return (collision_of(frame.box((-half, half), out, (0.0, spec.height))),)
    out = (0.0, frame.thickness_m)
    lining = [
        frame.box((-half, -half + _LINING_M), out, (0.0, spec.height)),
        frame.box((half - _LINING_M, half), out, (0.0, spec.height)),
        frame.box((-half, half), out, (spec.height - _LINING_M, spec.height)),
    ]
    if spec.hinged:
        return tuple(collision_of(box) for box in lining)
    leaf = leaf_box(spec, frame)
    middle = (np.asarray(leaf.low) + np.asarray(leaf.high)) / 2.0
    x, y, z = _turned_points(middle, spec, frame).tolist()
    half_angle = _angle_rad(spec, frame) / 2.0
    turned = replace(
        collision_of(leaf),
        centre_m=(x, y, z),
        orientation_xyzw=(0.0, 0.0, math.sin(half_angle), math.cos(half_angle)),
    )
    return (*(collision_of(box) for box in lining), turned)


def doorway_parts(spec: DoorwaySpec, frame: WallFrame) -> tuple[ModelPart, ...]:
    """Return the frame of an opening without a leaf: lining, and architraves on both faces."""
    red, green, blue = spec.colour
    paint = Material(name="door paint", base_colour=(red, green, blue, 1.0), roughness=0.6)
    half, top, thick = spec.width / 2.0, spec.height, frame.thickness_m
    boxes = _lining(half, top, thick, frame) + _architraves(half, top, thick, frame)
    return (ModelPart(mesh=boxes_mesh(boxes), material=paint),)


def doorway_collision(spec: DoorwaySpec, frame: WallFrame) -> tuple[BoxShape, ...]:
    """Return what the lining of a doorway collides as."""
    boxes = _lining(spec.width / 2.0, spec.height, frame.thickness_m, frame)
    return tuple(collision_of(box) for box in boxes)


def _lining(half: float, top: float, thick: float, frame: WallFrame) -> list[Box]:
    inside = half - _LINING_M
    sides = [sorted((sign * inside, sign * half)) for sign in (-1.0, 1.0)]
    boxes = [frame.box(side, (0.0, thick), (0.0, top)) for side in sides]
    return [*boxes, frame.box((-inside, inside), (0.0, thick), (top - _LINING_M, top))]


def _architraves(half: float, top: float, thick: float, frame: WallFrame) -> list[Box]:
    """Return what covers the joint between frame and wall, on both faces."""
    from_, to = half - _COVERS_LINING_M, half + ARCHITRAVE_M
    high = min(top + ARCHITRAVE_M, frame.height_m)
    boxes = []
    for out in ((-_ARCHITRAVE_DEPTH_M, 0.0), (thick, thick + _ARCHITRAVE_DEPTH_M)):
        boxes.append(frame.box((-to, to), out, (top - _COVERS_LINING_M, high)))
        boxes += [
            frame.box((sign * from_, sign * to), out, (0.0, top - _COVERS_LINING_M))
            for sign in (-1.0, 1.0)
        ]
    return boxes


def _frame_boxes(spec: DoorSpec, frame: WallFrame) -> list[Box]:
    """Return lining, stops and threshold behind the leaf, and architraves on both faces."""
    half, top, thick = spec.width / 2.0, spec.height, frame.thickness_m
    lining, stop = (0.0, thick), (_LEAF_INNER_M + _LEAF_M + 0.002, thick)
    inside, clear = half - _LINING_M, top - _LINING_M
    boxes = [frame.box((-inside, inside), lining, (clear, top))]
    boxes.append(frame.box((-inside, inside), stop, (clear - 0.014, clear + 0.004)))
    boxes.append(frame.box((-inside, inside), stop, (0.0, _THRESHOLD_M)))
    for sign in (-1.0, 1.0):
        boxes.append(frame.box((sign * inside, sign * half), lining, (0.0, top)))
        boxes.append(
            frame.box((sign * (inside - 0.014), sign * (inside + 0.004)), stop, (0.0, clear))
        )
    return [*boxes, *_architraves(half, top, thick, frame)]


def _hinge_sign(spec: DoorSpec, frame: WallFrame) -> float:
    """Return at which end along the wall the hinges are: 1 or -1."""
    (ax, ay, _), (ox, oy, _) = frame.along, frame.outward
    # Seen from inside, the right is outward x up.
    right = (oy * ax) - (ox * ay)
    return right if spec.hinge == "right" else -right


def _leaf_extent(spec: DoorSpec) -> tuple[float, float, float]:
    """Return half the leaf's width, its lower and its upper edge [m]."""
    return spec.width / 2.0 - _LINING_M - _GAP_M, _FLOOR_GAP_M, spec.height - _LINING_M - _GAP_M


def leaf_box(spec: DoorSpec, frame: WallFrame) -> Box:
    """Return the box of the closed leaf."""
    half, low, high = _leaf_extent(spec)
    return frame.box((-half, half), (_LEAF_INNER_M, _LEAF_INNER_M + _LEAF_M), (low, high))


def _leaf(spec: DoorSpec, frame: WallFrame) -> tuple[list[Box], list[Box], list[Box], list[Box]]:
    """Return the closed leaf's stiles and rails, raised fields, sunk panels, and the fittings."""
    half, low, high = _leaf_extent(spec)
    out = (_LEAF_INNER_M, _LEAF_INNER_M + _LEAF_M)
    stile = min(_STILE_M, half / 2.0)
    inner = half - stile
    height = high - low
    rails = [
        (low, low + 0.10 * height),
        (low + 0.42 * height, low + 0.51 * height),
        (high - stile, high),
    ]
    wood = [frame.box((sign * inner, sign * half), out, (low, high)) for sign in (-1.0, 1.0)]
    wood += [frame.box((-inner, inner), out, rail) for rail in rails]
    thin, field = (out[0] + 0.013, out[1] - 0.013), (out[0] + 0.004, out[1] - 0.004)
    fields, sunk = [], []
    for below, above in pairwise(rails):
        up = (below[1], above[0])
        sunk.append(
            frame.box((-inner - 0.005, inner + 0.005), thin, (up[0] - 0.005, up[1] + 0.005))
        )
        margin = 0.035
        fields.append(
            frame.box((-inner + margin, inner - margin), field, (up[0] + margin, up[1] - margin))
        )
    return wood, fields, sunk, _fittings(spec, frame, half, out)


def _fittings(spec: DoorSpec, frame: WallFrame, half: float, out: tuple[float, float]) -> list[Box]:
    """Return plates, necks and levers on both faces, and the knuckles of the hinges."""
    sign = -_hinge_sign(spec, frame)
    at = sign * (half - 0.06)
    up = min(_HANDLE_UP_M, 0.5 * spec.height)
    metal = []
    for face, outward in ((out[0], -1.0), (out[1], 1.0)):
        plate, neck = face + outward * 0.007, face + outward * 0.05
        metal += [
            frame.box((at - 0.02, at + 0.02), (face, plate), (up - 0.16, up + 0.06)),
            frame.box((at - 0.009, at + 0.009), (face, neck), (up - 0.009, up + 0.009)),
            frame.box(
                (at + sign * 0.010, at - sign * 0.125),
                (neck - outward * 0.009, neck + outward * 0.009),
                (up - 0.010, up + 0.010),
            ),
        ]
    edge = -sign * (half + _GAP_M)
    for share in (0.12, 0.5, 0.88):
        middle = share * spec.height
        metal.append(
            frame.box(
                (edge - 0.006, edge + 0.006), (-0.016, -0.004), (middle - 0.045, middle + 0.045)
            )
        )
    return metal


def _turned(mesh: Mesh, spec: DoorSpec, frame: WallFrame) -> Mesh:
    """Turn a part of the leaf about its hinges."""
    if spec.open == 0.0:
        return mesh
    turn = _turn(spec, frame)
    return Mesh(
        positions=_turned_points(mesh.positions.astype(np.float64), spec, frame).astype(np.float32),
        normals=(mesh.normals @ turn.T).astype(np.float32),
        uvs=mesh.uvs,
        triangles=mesh.triangles,
    )


def _turned_points(
    points: NDArray[np.float64], spec: DoorSpec, frame: WallFrame
) -> NDArray[np.float64]:
    axis = hinge_point(spec, frame)
    turned: NDArray[np.float64] = (points - axis) @ _turn(spec, frame).T + axis
    return turned


def hinge_point(spec: DoorSpec, frame: WallFrame) -> NDArray[np.float64]:
    """Return (3,) the foot of the hinges' axis [m]."""
    half = _leaf_extent(spec)[0] + _GAP_M
    return frame.point(_hinge_sign(spec, frame) * half, _HINGE_OUT_M, 0.0)


def _turn(spec: DoorSpec, frame: WallFrame) -> NDArray[np.float64]:
    angle = _angle_rad(spec, frame)
    cosine, sine = math.cos(angle), math.sin(angle)
    return np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])


def _angle_rad(spec: DoorSpec, frame: WallFrame) -> float:
    """Return the angle about the vertical that swings the leaf into the room."""
    return opening_sense(spec, frame) * math.radians(spec.open)


def opening_sense(spec: DoorSpec, frame: WallFrame) -> float:
    """Return the sense about the vertical in which the leaf opens into the room: 1 or -1."""
    leaf = -_hinge_sign(spec, frame) * np.asarray(frame.along)
    inwards = -np.asarray(frame.outward)
    return math.copysign(1.0, leaf[0] * inwards[1] - leaf[1] * inwards[0])
