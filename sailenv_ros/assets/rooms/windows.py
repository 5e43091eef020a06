"""Windows: frame, casements with glass, handle, sills; and curtains.

A window's entry and its wall's frame in, parts and collision shapes out. Positions are relative
to the foot of the wall below the opening's middle.
"""

from __future__ import annotations

import math

import numpy as np

from sailenv_ros.assets.rooms.pieces import Box, WallFrame, boxes_mesh, collision_of
from sailenv_ros.scene.spec_room import CurtainSpec, WindowSpec
from sailenv_ros.types.model import BoxShape, Material, Mesh, ModelPart

__all__ = ["curtain_parts", "window_collision", "window_parts"]

_SET_BACK_M = 0.03
_FRAME_DEPTH_M = 0.07
_FRAME_M = 0.045
_SASH_M = 0.065
_SASH_DEPTH_M = 0.06
_SASH_PROUD_M = 0.012
_CASEMENT_M = 0.8
_BOARD_M = 0.025
_BOARD_OUT_M = 0.05
_EAR_M = 0.04
_LEAST_BARRIER_M = 0.15

_METAL = Material(name="handle", base_colour=(0.62, 0.61, 0.59, 1.0), metallic=1.0, roughness=0.32)
_GLASS = Material(
    name="glass",
    base_colour=(0.93, 0.96, 0.95, 0.03),
    roughness=0.05,
    alpha="blend",
    double_sided=True,
)


def window_parts(spec: WindowSpec, frame: WallFrame) -> tuple[ModelPart, ...]:
    """Return frame and sill, handles, and the panes as a part of their own."""
    wood = [*_frame_bars(spec, frame)]
    panes: list[Box] = []
    handles: list[Box] = []
    for left, right in _lights(spec):
        bars, pane = _sash(frame, left, right, spec.sill + _FRAME_M, _top(spec) - _FRAME_M)
        wood += bars
        panes.append(pane)
        handles += _handle(spec, frame, left, right)
    wood += _sill_boards(spec, frame)
    red, green, blue = spec.colour
    paint = Material(name="window paint", base_colour=(red, green, blue, 1.0), roughness=0.55)
    return (
        ModelPart(mesh=boxes_mesh(wood), material=paint),
        ModelPart(mesh=boxes_mesh(handles), material=_METAL),
        ModelPart(mesh=boxes_mesh(panes), material=_GLASS),
    )


def window_collision(spec: WindowSpec, frame: WallFrame) -> tuple[BoxShape, ...]:
    """Return the closed window from its frame's inner face outwards, and the board before it."""
    inner = _frame_out(frame)[0]
    half = spec.width / 2.0
    outer = max(frame.thickness_m, inner + _LEAST_BARRIER_M)
    barrier = frame.box((-half, half), (inner, outer), (spec.sill, _top(spec)))
    return tuple(collision_of(box) for box in (barrier, *_sill_boards(spec, frame)))


def curtain_parts(window: WindowSpec, frame: WallFrame) -> tuple[ModelPart, ...]:
    """Return a pair of curtains beside a window, and their rod."""
    spec = window.curtains or CurtainSpec()
    rod_up = min(_top(window) + 0.12, frame.height_m - 0.05)
    # Beside a corner there is less room for them.
    free = frame.length_m / 2.0 - 0.03
    reach = window.width / 2.0 + 0.28
    left, right = max(-reach, -free - window.at), min(reach, free - window.at)
    hung = 0.34 + spec.drawn * (window.width / 2.0)
    low = 0.02 if window.sill > 0.05 else 0.005
    sheets = [
        _cloth(frame, (left + 0.03, left + 0.03 + hung), (low, rod_up - 0.02), 0.3),
        _cloth(frame, (right - 0.03 - hung, right - 0.03), (low, rod_up - 0.02), 1.7),
    ]
    red, green, blue = spec.colour
    cloth = Material(
        name="curtain", base_colour=(red, green, blue, 1.0), roughness=0.95, double_sided=True
    )
    rod = [
        frame.box((left, right), (-0.109, -0.091), (rod_up - 0.009, rod_up + 0.009)),
        *(
            frame.box((at - 0.02, at + 0.02), (-0.12, -0.08), (rod_up - 0.02, rod_up + 0.02))
            for at in (left, right)
        ),
        *(
            frame.box((at - 0.006, at + 0.006), (-0.1, 0.0), (rod_up - 0.006, rod_up + 0.006))
            for at in (left + 0.05, right - 0.05)
        ),
    ]
    return (
        *(ModelPart(mesh=sheet, material=cloth) for sheet in sheets),
        ModelPart(mesh=boxes_mesh(rod, chamfer_m=0.006), material=_METAL),
    )


def _top(spec: WindowSpec) -> float:
    return spec.sill + spec.height


def _frame_out(frame: WallFrame) -> tuple[float, float]:
    outer = frame.thickness_m - _SET_BACK_M
    return outer - _FRAME_DEPTH_M, outer


def _lights(spec: WindowSpec) -> list[tuple[float, float]]:
    """Return where each casement's hole in the frame begins and ends along the wall."""
    count = spec.casements or max(1, math.ceil(spec.width / _CASEMENT_M - 1e-9))
    inner = spec.width - (count + 1) * _FRAME_M
    starts = [-spec.width / 2.0 + _FRAME_M + i * (inner / count + _FRAME_M) for i in range(count)]
    return [(start, start + inner / count) for start in starts]


def _frame_bars(spec: WindowSpec, frame: WallFrame) -> list[Box]:
    out, half, up = _frame_out(frame), spec.width / 2.0, (spec.sill, _top(spec))
    bars = [
        frame.box((-half, half), out, (up[0], up[0] + _FRAME_M)),
        frame.box((-half, half), out, (up[1] - _FRAME_M, up[1])),
        frame.box((-half, -half + _FRAME_M), out, up),
    ]
    # To the right of each casement stands a mullion, or the frame's other side.
    bars += [frame.box((right, right + _FRAME_M), out, up) for _, right in _lights(spec)]
    return bars


def _sash(
    frame: WallFrame, left: float, right: float, low: float, high: float
) -> tuple[list[Box], Box]:
    """Return a casement's bars, which overlap the frame by a rebate, and its pane."""
    inner = _frame_out(frame)[0] - _SASH_PROUD_M
    out, rebate = (inner, inner + _SASH_DEPTH_M), 0.012
    left, right, low, high = left - rebate, right + rebate, low - rebate, high + rebate
    wide = _SASH_M + rebate
    bars = [
        frame.box((left, left + wide), out, (low, high)),
        frame.box((right - wide, right), out, (low, high)),
        frame.box((left + wide, right - wide), out, (low, low + wide)),
        frame.box((left + wide, right - wide), out, (high - wide, high)),
    ]
    middle = inner + _SASH_DEPTH_M / 2.0
    pane = frame.box(
        (left + wide - 0.008, right - wide + 0.008),
        (middle - 0.012, middle + 0.012),
        (low + wide - 0.008, high - wide + 0.008),
    )
    return bars, pane


def _handle(spec: WindowSpec, frame: WallFrame, left: float, right: float) -> list[Box]:
    """Return the handle on the stile that is nearer to the window's middle."""
    inner = _frame_out(frame)[0] - _SASH_PROUD_M
    at = right - _SASH_M / 2.0 if (left + right) / 2.0 <= 1e-6 else left + _SASH_M / 2.0
    up = spec.sill + spec.height * 0.45
    return [
        frame.box((at - 0.014, at + 0.014), (inner - 0.008, inner), (up - 0.035, up + 0.035)),
        frame.box(
            (at - 0.008, at + 0.008), (inner - 0.04, inner - 0.006), (up - 0.008, up + 0.008)
        ),
        frame.box((at - 0.010, at + 0.010), (inner - 0.05, inner - 0.034), (up - 0.12, up + 0.012)),
    ]


def _sill_boards(spec: WindowSpec, frame: WallFrame) -> list[Box]:
    """Return the board in the niche with its nosing before the wall, and the drip sill outside."""
    if spec.sill < 0.05:
        return []
    half, (inner, outer) = spec.width / 2.0, _frame_out(frame)
    up = (spec.sill, spec.sill + _BOARD_M)
    return [
        frame.box((-half, half), (-0.004, inner), up),
        frame.box((-half - _EAR_M, half + _EAR_M), (-_BOARD_OUT_M, 0.0), up),
        frame.box((-half, half), (outer, frame.thickness_m + 0.03), (up[0], up[0] + 0.012)),
    ]


def _cloth(
    frame: WallFrame, along: tuple[float, float], up: tuple[float, float], phase: float
) -> Mesh:
    """Make a hanging sheet in folds that open a little towards its foot."""
    folds = max(3, round((along[1] - along[0]) / 0.075))
    share, fall = np.meshgrid(np.linspace(0.0, 1.0, 16 * folds + 1), np.linspace(0.0, 1.0, 13))
    turn = 2.0 * np.pi * folds * share + phase
    wander = 0.5 * np.sin(2.3 * fall + 5.0 * share + phase) * fall
    depth = (0.022 + 0.012 * fall) * (1.0 + 0.35 * np.sin(7.0 * share + phase))
    out = -0.1 + depth * np.sin(turn + wander) + 0.006 * np.sin(2.0 * turn + 3.0 * fall)
    place = along[0] + (along[1] - along[0]) * share
    height = up[1] - (up[1] - up[0]) * fall
    local = np.stack([place, np.minimum(out, -0.03), height], axis=-1)
    basis = np.stack([frame.along, frame.outward, (0.0, 0.0, 1.0)])
    points = local @ basis
    across, down = np.gradient(points, axis=1), np.gradient(points, axis=0)
    normals = np.cross(across, down)
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    # The front is what the room sees.
    inwards = np.sign(-(normals @ np.asarray(frame.outward)).mean())
    rows, columns = share.shape
    first = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).reshape(-1)
    square = np.array([[0, columns, 1], [1, columns, columns + 1]])
    triangles = (first[:, None, None] + square).reshape(-1, 3)
    flat = points.reshape(-1, 3)
    a, b, c = (flat[triangles[0, corner]] for corner in range(3))
    if np.dot(np.cross(b - a, c - a), inwards * normals[0, 0]) < 0.0:
        triangles = triangles[:, ::-1]
    return Mesh(
        positions=flat.astype(np.float32),
        normals=(inwards * normals).reshape(-1, 3).astype(np.float32),
        uvs=np.stack([place, height], axis=-1).reshape(-1, 2).astype(np.float32),
        triangles=triangles.astype(np.uint32),
    )
