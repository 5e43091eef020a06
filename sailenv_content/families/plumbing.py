"""Plumbing: taps with levers that turn, sinks that are hollow."""

from __future__ import annotations

from typing import Literal

import numpy as np

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.hardware import clicks
from sailenv_content.families.hollow import Box
from sailenv_content.families.materials import PieceMaterial, paint
from sailenv_content.families.shaping import swept, turned
from sailenv_content.procedural.forms import curve, loft, rectangle
from sailenv_ros.assets.meshes import RawMesh, smooth_mesh
from sailenv_ros.types.model import Mesh

__all__ = ["TapKind", "drain", "sink_basin", "tap", "tub"]

TapKind = Literal["arc", "straight", "pillar"]


def tap(
    b: PieceBuilder,
    material: PieceMaterial,
    x: float,
    y: float,
    z: float,
    *,
    kind: TapKind = "arc",
    reach: float = 0.2,
    rise: float = 0.25,
) -> None:
    """Add a tap that stands on a height and pours towards +x; its lever turns.

    Parameters
    ----------
    reach, rise : float
        How far forward and how high its spout goes [m].
    """
    place = np.array([x, y, z])
    foot = [(0, 0), (0.026, 0), (0.026, 0.006), (0.02, 0.01), (0.02, 0.055), (0, 0.055)]
    with b.part("tap", "tap"):
        b.form(material, turned(foot, segments=20), (x, y, z))
        if kind == "straight":
            path = np.array([(0, 0, 0.04), (0, 0, rise), (reach, 0, rise), (reach, 0, rise - 0.02)])
        else:
            top = rise - 0.4 * reach
            bend = curve(
                [
                    (0, 0, top),
                    (0.14 * reach, 0, top + 0.27 * reach),
                    (0.5 * reach, 0, rise),
                    (0.86 * reach, 0, top + 0.27 * reach),
                    (reach, 0, top - 0.05 * reach),
                ],
                14,
            )
            path = np.concatenate([[(0, 0, 0.04)], bend])
        b.form(material, swept(path + place, 0.011, sides=12), collides="none")
        end = path[-1] + place
        tip = np.array([[0, 0, 0.004], [0, 0, -0.012]]) + end
        b.form(paint("#3a3c3f", 0.4), swept(tip, 0.0095, sides=12), collides="none")
    if kind == "pillar":
        for sign, name in ((1.0, "left knob"), (-1.0, "right knob")):
            at = (x, y + sign * 0.09, z)
            b.form(material, turned([(r * 0.9, 0.8 * h) for r, h in foot], segments=18), at)
            with b.hinge(
                name,
                "handle",
                at=at,
                axis=(0.0, 0.0, 1.0),
                opens_deg=180.0,
                detents=clicks(0.4, 90.0),
            ):
                for turn in (0.0, 90.0):
                    bar = (0.06, 0.011, 0.011)
                    knob = (at[0], at[1], z + 0.052)
                    b.box(material, bar, knob, turn=(0, 0, turn), bevel=0.004, collides=False)
                b.collide((0.05, 0.05, 0.012), (at[0], at[1], z + 0.053))
        return
    with b.hinge(
        "lever",
        "handle",
        at=(x, y, z + 0.035),
        axis=(0, -1.0, 0),
        opens_deg=35.0,
        detents=clicks(0.4, 17.5),  # shut, half for saving, and full
    ):
        stub = [(x, y - 0.018, z + 0.035), (x, y - 0.045, z + 0.035)]
        b.form(material, swept(stub, 0.012, sides=12), collides="none")
        grip = [(x, y - 0.036, z + 0.035), (x + 0.085, y - 0.036, z + 0.045)]
        b.form(material, swept(grip, (0.006, 0.0045), sides=10))


def sink_basin(
    b: PieceBuilder, material: PieceMaterial, room: Box, *, wall: float = 0.004, rim: float = 0.012
) -> None:
    """Add a basin: a floor and four walls around a hollow, a drain, and a rim on its top."""
    size, middle = room.size, room.middle
    floor = (size[0] + 2 * wall, size[1] + 2 * wall, wall)
    b.box(material, floor, (middle[0], middle[1], room.low[2] - wall / 2))
    for sign in (-1.0, 1.0):
        at = (middle[0] + sign * (size[0] + wall) / 2, middle[1], middle[2])
        b.box(material, (wall, size[1] + 2 * wall, size[2]), at, bevel=0.001)
        at = (middle[0], middle[1] + sign * (size[1] + wall) / 2, middle[2])
        b.box(material, (size[0], wall, size[2]), at, bevel=0.001)
    if rim:
        high = room.high[2] + 0.0015
        for sign in (-1.0, 1.0):
            at = (middle[0] + sign * (size[0] + rim) / 2, middle[1], high)
            b.box(material, (rim, size[1] + 2 * rim, 0.003), at, bevel=0.001, collides=False)
            at = (middle[0], middle[1] + sign * (size[1] + rim) / 2, high)
            b.box(material, (size[0], rim, 0.003), at, bevel=0.001, collides=False)
    drain(b, float(middle[0]), float(middle[1]), float(room.low[2]))


def drain(b: PieceBuilder, x: float, y: float, z: float) -> None:
    """Add the ring and the grid of a drain on a floor."""
    rows = [(0, 0), (0.036, 0), (0.036, 0.002), (0.028, 0.003), (0.02, 0.0005), (0, 0.0005)]
    b.form(paint("#8e9194", 0.25), turned(rows, segments=20), (x, y, z), collides="none")


def tub(
    size: tuple[float, float, float],
    *,
    wall: float,
    floor: float,
    radius: float,
    taper: float = 0.0,
    slope: float = 0.04,
    tile_m: float = 1.0,
) -> Mesh:
    """Return a tub with round corners, open at its top, its base at z = 0.

    Parameters
    ----------
    size : (3,) tuple of float
        Along x, y, z [m].
    wall, floor : float
        Thickness of its rim and height of its inner floor [m].
    radius : float
        Of its corners seen from above [m].
    taper, slope : float
        By how much it is narrower on each side at its base, outside and inside [m].
    """
    depth, width, height = size
    bend = min(0.05, 0.3 * (height - floor))
    insets = [(taper + 0.01, 0.0), (taper, 0.01), (0.004, height - 0.02), (0.0, height - 0.008)]
    insets += [(0.006, height), (wall - 0.006, height), (wall, height - 0.008)]
    for turn in np.linspace(0.0, np.pi / 2.0, 6):
        low = height - floor - bend
        drop = floor + bend * (1.0 - np.sin(turn))
        insets.append(
            (wall + slope * low / max(height - floor, 1e-6) + bend * (1 - np.cos(turn)), drop)
        )
    rings = []
    for inset, z in insets:
        corner = max(radius - 0.6 * inset, 0.012)
        flat = rectangle(width - 2 * inset, depth - 2 * inset, corner, 8)
        rings.append(np.c_[flat, np.full(len(flat), z)])
    raw = loft(np.array(rings))
    uvs = raw.positions[:, :2] / tile_m + raw.positions[:, [2]] * (0.0, 1.0) / tile_m
    return smooth_mesh(RawMesh(positions=raw.positions, uvs=uvs, triangles=raw.triangles), 40.0)
