"""Armchairs: boxy, wing, tub, lounge with a wooden frame, rolled."""

from __future__ import annotations

import numpy as np

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.family import Family, Style
from sailenv_content.families.joinery import four_legs, leg
from sailenv_content.families.kinds import sofa
from sailenv_content.families.materials import FABRICS, LEATHERS, WOODS, metal
from sailenv_content.families.parameters import Choice, Span, Values
from sailenv_content.families.shaping import ribbon, swept
from sailenv_content.families.upholstery import pad
from sailenv_content.procedural.forms import curve, loft, rectangle
from sailenv_ros.assets.meshes import RawMesh, smooth_mesh

__all__ = ["FAMILY"]


def _wing(b: PieceBuilder, v: Values) -> None:
    """Make a tall back with wings beside the head."""
    d, w, base = v.depth, v.seat + 2 * v.arm, v.legs
    pad(
        b,
        v.cover,
        (d - 0.08, v.seat, v.height - base - 0.11),
        (0.03, 0.0, (v.height - 0.11 + base) / 2),
        puff=0.0,
        radius=0.03,
    )
    with b.part("seat cushion", "pillow"):
        pad(b, v.cover, (d - 0.2, v.seat - 0.008, 0.13), (0.09, 0.0, v.height - 0.055), puff=0.022)
    top = v.back + 0.2
    pad(
        b,
        v.cover,
        (0.13, w - 0.06, top - base),
        (-d / 2 + 0.05, 0.0, (top + base) / 2),
        puff=0.02,
        turn=(0.0, -8.0, 0.0),
    )
    for sy in (-1.0, 1.0):
        y = sy * (w - v.arm) / 2
        pad(
            b,
            v.cover,
            (d - 0.05, v.arm, v.arm_height - base),
            (0.01, y, (v.arm_height + base) / 2),
            puff=0.01,
            radius=0.05,
        )
        pad(
            b,
            v.cover,
            (0.24, 0.07, top - v.arm_height),
            (-d / 2 + 0.13, y, (top + v.arm_height) / 2 - 0.01),
            puff=0.012,
            radius=0.033,
            turn=(0.0, -8.0, -sy * 8.0),
        )
    four_legs(b, v.frame, v.leg, d - 0.12, w - 0.1, base + 0.01, 0.042)


def _tub(b: PieceBuilder, v: Values) -> None:
    """Make one curved back that becomes the arms."""
    d, w, base = v.depth * 0.9, v.seat + 0.22, v.legs
    turns = np.linspace(0.32 * np.pi - np.pi / 2, 1.68 * np.pi - np.pi / 2, 27)
    lean = 0.5 + 0.5 * np.cos(np.linspace(-np.pi, np.pi, 27))
    tops = v.arm_height + (v.back - v.arm_height) * lean
    thick, rings = 0.1, []
    for angle, top in zip(turns + np.pi / 2, tops, strict=True):
        out = np.array([np.cos(angle), np.sin(angle)])
        section = rectangle(thick, top - base, 0.045, steps=4)
        reach = np.array([d / 2 - 0.06, w / 2 - 0.06])
        middle = out * reach
        ring = np.empty((len(section), 3))
        ring[:, :2] = middle + section[:, 1:] * out
        ring[:, 2] = (top + base) / 2 + section[:, 0]
        rings.append(ring)
    raw = loft(np.array(rings))
    uvs = np.stack([raw.uvs[:, 1] * 2.2, raw.uvs[:, 0] * 1.4], -1) / v.cover.tile_m
    mesh = smooth_mesh(RawMesh(positions=raw.positions, uvs=uvs, triangles=raw.triangles), 60.0)
    b.form(v.cover, mesh, collides="none")
    for angle, top in zip(turns[1::4] + np.pi / 2, tops[1::4], strict=True):
        at = (np.cos(angle) * (d / 2 - 0.06), np.sin(angle) * (w / 2 - 0.06), (top + base) / 2)
        b.collide((0.09, 0.26, top - base), at, (0.0, 0.0, float(np.degrees(angle))))
    pad(
        b,
        v.cover,
        (d - 0.17, w - 0.2, v.height - base - 0.1),
        (0.03, 0.0, (v.height - 0.1 + base) / 2),
        puff=0.0,
        radius=0.05,
    )
    with b.part("seat cushion", "pillow"):
        pad(
            b,
            v.cover,
            (d - 0.16, w - 0.19, 0.12),
            (0.05, 0.0, v.height - 0.05),
            puff=0.024,
            radius=0.055,
        )
    for sx in (-1.0, 1.0):
        for sy in (-1.0, 1.0):
            leg(b, v.frame, v.leg, sx * d * 0.3, sy * w * 0.3, base + 0.03, 0.036, splay=0.03)


def _lounge(b: PieceBuilder, v: Values) -> None:
    """Make a bent frame that one sees, seat and back cushions in it."""
    d, w, h = v.depth, v.seat + 0.12, v.height - 0.1
    for sy in (-1.0, 1.0):
        y = sy * (w / 2 - 0.02)
        if v.bent:
            line = curve(
                [
                    (d / 2, y, 0.0),
                    (d / 2 - 0.03, y, h * 0.6),
                    (d / 2 - 0.12, y, v.arm_height),
                    (0.0, y, v.arm_height + 0.015),
                    (-d / 2 + 0.05, y, v.arm_height - 0.05),
                    (-d / 2, y, 0.0),
                ],
                30,
            )
            b.form(v.frame, swept(line, 0.019, sides=12, tile_m=v.frame.tile_m), collides="none")
            b.collide((d - 0.1, 0.04, 0.03), (0.0, y, v.arm_height))
            b.collide((0.04, 0.04, v.arm_height), (d / 2 - 0.03, y, v.arm_height / 2))
            b.collide((0.04, 0.04, v.arm_height), (-d / 2 + 0.02, y, v.arm_height / 2))
        else:
            for sx in (-1.0, 1.0):
                leg(b, v.frame, "tapered", sx * (d / 2 - 0.06), y, v.arm_height - 0.01, 0.036)
            b.box(v.frame, (d, 0.06, 0.026), (0.0, y, v.arm_height), bevel=0.009)
        b.box(
            v.frame, (d - 0.1, 0.022, 0.06), (0.0, y - sy * 0.012, h - 0.03), turn=(0.0, 4.0, 0.0)
        )
    for x in (d / 2 - 0.09, -d / 2 + 0.12):
        b.box(v.frame, (0.03, w - 0.06, 0.05), (x, 0.0, h - 0.04))
    pad(
        b, v.cover, (d - 0.12, v.seat, 0.12), (0.05, 0.0, h + 0.05), puff=0.02, turn=(0.0, 4.0, 0.0)
    )
    tall = v.back - h + 0.05
    pad(
        b,
        v.cover,
        (0.11, v.seat, tall),
        (-d / 2 + 0.05, 0.0, h + tall / 2 + 0.02),
        puff=0.025,
        turn=(0.0, -19.0, 0.0),
    )
    for z in (h + 0.1, h + tall * 0.85):
        b.box(
            v.frame,
            (0.02, w - 0.06, 0.05),
            (-d / 2 + 0.06 - (z - h) * 0.34, 0.0, z),
            turn=(0.0, -19.0, 0.0),
        )


def _shell(b: PieceBuilder, v: Values) -> None:
    """Make one wide shell with cushions, on a star or a wire base."""
    d, w, h = v.depth, v.seat + 0.16, v.height - 0.06
    line = curve(
        [
            (d / 2, 0, h + 0.01),
            (d * 0.2, 0, h - 0.02),
            (-d * 0.25, 0, h - 0.05),
            (-d * 0.42, 0, h + 0.04),
            (-d * 0.52, 0, h + 0.25),
            (-d * 0.6, 0, h + v.back - 0.35),
        ],
        24,
    )[:, [0, 2]]
    share = np.linspace(0, 1, 24)
    mesh = ribbon(
        line[::-1],
        (w * (0.94 + 0.06 * np.sin(np.pi * share)))[::-1],
        0.016,
        dish=-0.07,
        round_m=0.12,
        tile_m=v.frame.tile_m,
    )
    b.form(v.frame, mesh, collides="none", volume=0.008)
    b.collide((d * 0.9, w * 0.9, 0.04), (0.0, 0.0, h - 0.03))
    b.collide((0.04, w * 0.8, v.back - 0.4), (-d * 0.53, 0.0, h + 0.28), (0.0, -12.0, 0.0))
    pad(b, v.cover, (d * 0.8, w * 0.8, 0.08), (0.03, 0.0, h + 0.025), puff=0.02, radius=0.035)
    pad(
        b,
        v.cover,
        (0.08, w * 0.76, v.back - 0.47),
        (-d * 0.44, 0.0, h + 0.3),
        puff=0.02,
        radius=0.035,
        turn=(0.0, -15.0, 0.0),
    )
    if v.star:
        steel = metal("chrome")
        b.form(steel, swept([(-0.02, 0, 0.06), (-0.02, 0, h - 0.05)], 0.024, sides=16))
        for angle in np.arange(5) * 2 * np.pi / 5:
            tip = (0.3 * np.cos(angle), 0.3 * np.sin(angle), 0.018)
            b.form(steel, swept([(-0.02, 0, 0.075), tip], (0.022, 0.014), sides=10))
    else:
        for sx in (-1.0, 1.0):
            for sy in (-1.0, 1.0):
                leg(
                    b, v.frame, "splayed", sx * d * 0.24, sy * w * 0.26, h - 0.06, 0.036, splay=0.09
                )


_SHARED = {
    "seat": Span(0.52, 0.62),
    "depth": Span(0.74, 0.86),
    "height": Span(0.41, 0.46),
    "back": Span(0.76, 0.9),
    "arm_height": Span(0.54, 0.64),
    "cover": Choice(*FABRICS, *LEATHERS),
    "frame": Choice(*WOODS),
}
_WHOLE = {
    **_SHARED,
    "seats": 1,
    "soft": Choice(0.0, 0.5),
    "loose": Span(0.0, 0.4),
    "legs": Span(0.07, 0.15),
}

FAMILY = Family(
    name="armchair",
    category="chair",
    least_m=(0.6, 0.55, 0.65),
    most_m=(1.1, 1.15, 1.2),
    styles={
        "boxy": Style(
            sofa.boxy,
            {
                **_WHOLE,
                "arm": Span(0.11, 0.2),
                "edge": Span(0.03, 0.06),
                "leg": Choice("block", "round", "metal"),
            },
        ),
        "rolled": Style(
            sofa.rolled, {**_WHOLE, "arm": Span(0.16, 0.2), "skirt": Choice(True, False)}
        ),
        "wing": Style(
            _wing,
            {
                **_SHARED,
                "arm": Span(0.1, 0.14),
                "legs": Span(0.12, 0.18),
                "leg": Choice("tapered", "turned"),
            },
        ),
        "tub": Style(_tub, {**_SHARED, "legs": Span(0.1, 0.18), "leg": Choice("splayed", "metal")}),
        "lounge": Style(_lounge, {**_SHARED, "bent": Choice(True, False)}),
        "shell": Style(_shell, {**_SHARED, "star": Choice(True, False)}),
    },
)
