"""Shoe racks: slatted tiers, a bench with shoes below, flaps that tip, a low chest; with shoes."""

from __future__ import annotations

import numpy as np

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.cabinets import CABINET_MATERIALS, cabinet_body, divided, outer_doors
from sailenv_content.families.family import Family, Style
from sailenv_content.families.fronts import CLEARANCE_M, front_panel, handle
from sailenv_content.families.hardware import FLAP_CLOSE
from sailenv_content.families.hollow import Box
from sailenv_content.families.joinery import shelf
from sailenv_content.families.materials import FABRICS, WOODS, metal, paint
from sailenv_content.families.parameters import Choice, Span, Values, Whole
from sailenv_content.families.shaping import swept
from sailenv_content.families.upholstery import pad
from sailenv_content.procedural.forms import loft
from sailenv_ros.assets.meshes import smooth_mesh
from sailenv_ros.types.model import Mesh

__all__ = ["FAMILY"]

LEATHERS = ("#2a2320", "#5b3a24", "#e6e2d8", "#31415c", "#7a2f2f", "#8a8d90", "#9a7a52")


def _shoe(high: float) -> Mesh:
    """Return a shoe 0.27 m long, its toe at +x, open at its ankle by a hollow."""
    x = np.array([-0.13, -0.125, -0.09, -0.03, 0.03, 0.08, 0.12, 0.135])
    half = np.array([0.018, 0.03, 0.035, 0.033, 0.042, 0.044, 0.03, 0.012])
    top = np.array([0.8, 1.0, 1.0, 0.92, 0.66, 0.5, 0.4, 0.3]) * high
    turn = np.linspace(0.0, 2 * np.pi, 16, endpoint=False)
    rings = np.empty((len(x), 16, 3))
    rings[..., 0] = x[:, None]
    rings[..., 1] = half[:, None] * np.sign(np.cos(turn)) * np.abs(np.cos(turn)) ** 0.7
    up = 0.5 + 0.5 * np.sign(np.sin(turn)) * np.abs(np.sin(turn)) ** 0.7
    rings[..., 2] = 0.012 + (top[:, None] - 0.012) * up
    return smooth_mesh(loft(rings), 50.0)


def _shoes(b: PieceBuilder, room: Box, *, full: float = 0.75) -> None:
    """Stand pairs of shoes side by side, their toes to the front."""
    if room.size[0] < 0.25:
        return
    y = float(room.low[1]) + 0.06
    while y + 0.14 < room.high[1]:
        high = min(b.between(0.07, 0.12), float(room.size[2]) - 0.02)
        if b.chance(full) and high > 0.05:
            upper = paint(b.pick(*LEATHERS), 0.5, 250.0)
            sole = paint(b.pick("#e6e2d8", "#2a2623", "#8a6a42"), 0.7, 400.0)
            mesh = _shoe(high)
            with b.part("shoes", "shoe"):
                for side in (0.0, 0.1):
                    at = (float(room.middle[0]), y + side, float(room.low[2]) + 0.001)
                    b.form(upper, mesh, at, collides="none", volume=3e-4)
                    b.box(
                        sole,
                        (0.262, 0.074, 0.014),
                        (at[0], at[1], at[2] + 0.007),
                        bevel=0.005,
                        collides=False,
                    )
        y += 0.215


def _tiers(b: PieceBuilder, v: Values) -> None:
    """Make tiers of slats or rods between two frames."""
    d, w, h = 0.3, v.width, v.height
    for sy in (-1.0, 1.0):
        for sx in (-1.0, 1.0):
            b.box(v.frame, (0.022, 0.022, h), (sx * (d / 2 - 0.011), sy * (w / 2 - 0.011), h / 2))
        b.box(v.frame, (d - 0.044, 0.02, 0.02), (0.0, sy * (w / 2 - 0.011), h - 0.012))
    step = (h - 0.08) / v.rows
    for number in range(v.rows):
        z = 0.08 + number * step
        for k in range(5):
            x = (k + 0.5) / 5 * (d - 0.02) - (d - 0.02) / 2
            if v.rods:
                b.form(
                    v.material,
                    swept([(x, -w / 2 + 0.01, z), (x, w / 2 - 0.01, z)], 0.006, sides=8),
                    collides="none",
                )
            else:
                b.box(v.material, (0.04, w - 0.022, 0.012), (x, 0.0, z), collides=False)
        b.collide((d - 0.02, w - 0.02, 0.012), (0.0, 0.0, z))
        _shoes(b, Box((-d / 2, -w / 2 + 0.02, z + 0.007), (d / 2, w / 2 - 0.02, z + step)))
    if v.lid:
        b.box(v.material, (d, w, 0.018), (0.0, 0.0, h + 0.009))


def _bench(b: PieceBuilder, v: Values) -> None:
    """Make a seat with a cushion above one or two shelves."""
    d, w, h = 0.34, v.width, 0.42
    b.box(v.material, (d, w, 0.026), (0.0, 0.0, h - 0.013), bevel=0.004)
    for sy in (-1.0, 1.0):
        b.box(v.material, (d - 0.02, 0.024, h - 0.026), (0.0, sy * (w / 2 - 0.02), (h - 0.026) / 2))
    for number in range(v.shelves):
        z = 0.07 + number * 0.17
        b.box(v.material, (d - 0.03, w - 0.066, 0.018), (0.0, 0.0, z))
        high = 0.15 if v.shelves == 2 else 0.3
        _shoes(b, Box((-d / 2, -w / 2 + 0.05, z + 0.01), (d / 2 - 0.02, w / 2 - 0.05, z + high)))
    pad(b, v.cloth, (d - 0.02, w - 0.03, 0.05), (0.0, 0.0, h + 0.025), puff=0.012, radius=0.02)


def _tipping(b: PieceBuilder, v: Values) -> None:
    """Make a flat chest whose fronts tip forward with the shoes behind them."""
    d, w, h = 0.22, v.width, 0.42 * v.flaps + 0.08
    t = 0.018
    for sy in (-1.0, 1.0):
        b.box(v.scheme[0], (d - 0.02, t, h - t), (-0.01, sy * (w - t) / 2, (h - t) / 2))
    b.box(v.scheme[2], (d, w, t), (0.0, 0.0, h - t / 2))
    b.box(v.scheme[0], (0.006, w - 2 * t, h - t), (-d / 2 + 0.003, 0.0, (h - t) / 2))
    b.box(v.scheme[0], (d - 0.03, w - 2 * t, t), (-0.01, 0.0, 0.05))
    fronts = Box((d / 2 - 0.019, -w / 2, 0.062), (d / 2, w / 2, h - t)).inset(CLEARANCE_M)
    for number, panel in enumerate(fronts.rows([1.0] * v.flaps, CLEARANCE_M)):
        at = (float(panel.high[0]), 0.0, float(panel.low[2]))
        axis = (0.0, 1.0, 0.0)
        with b.hinge(
            f"flap {number + 1}",
            "door",
            at=at,
            axis=axis,
            opens_deg=32.0,
            friction=0.6,
            soft_close=FLAP_CLOSE,
        ):
            front_panel(b, v.scheme[1], v.front, panel)
            inner = w - 2 * t - 0.03
            for z, deep in ((0.03, 0.1), (0.2, 0.075)):
                size = (deep, inner, 0.008)
                place = (float(panel.low[0]) - deep / 2, 0.0, float(panel.low[2]) + z)
                b.box(v.inner, size, place)
                with b.part("shoes", "shoe"):
                    mesh = _shoe(0.07)
                    for k in range(int(inner / 0.1)):
                        if b.chance(0.8):
                            y = -inner / 2 + 0.06 + 0.1 * k
                            upper = paint(LEATHERS[(k // 2 + number) % 7], 0.5, 250.0)
                            spot = (place[0] - 0.5 * deep + 0.035, y, place[2] + 0.14)
                            b.form(
                                upper,
                                mesh,
                                spot,
                                turn=(0.0, 82.0, 0.0),
                                collides="none",
                                volume=3e-4,
                            )
            z = float(panel.high[2]) - 0.05
            handle(b, v.metal, v.handle, float(panel.high[0]), 0.0, z)


def _closed(b: PieceBuilder, v: Values) -> None:
    """Make a cabinet on legs with two doors, and shoes on its shelves."""
    inside, fronts = cabinet_body(b, v)
    for room in divided(b, v.inner, inside, [1.0, 1.0]):
        for number, row in enumerate(room.rows([1.0] * v.rows, 0.018)):
            if number:
                shelf(b, v.inner, room, float(row.low[2]), setback=0.03)
            _shoes(b, row.within((0.0, 0.0, 0.0), (0.03, 0.0, 0.0)))
    right, left = fronts.columns([1.0, 1.0], CLEARANCE_M)
    outer_doors(b, v, right, left)


_SHARED = {
    "width": Span(0.6, 1.0),
    "height": Span(0.4, 0.9),
    "material": Choice(*WOODS, paint("#e9e6df")),
    "frame": Choice(*WOODS, metal("#232326"), metal("#e6e4de")),
}

FAMILY = Family(
    name="shoe_rack",
    category="shelf",
    least_m=(0.18, 0.5, 0.3),
    most_m=(0.5, 1.3, 1.5),
    styles={
        "slats": Style(
            _tiers,
            {
                **_SHARED,
                "rows": Whole(2, 4),
                "height": Span(0.45, 0.85),
                "rods": False,
                "lid": Choice(True, False),
            },
        ),
        "rods": Style(
            _tiers,
            {
                **_SHARED,
                "rows": Whole(2, 4),
                "height": Span(0.45, 0.85),
                "rods": True,
                "lid": False,
                "material": Choice(metal("chrome"), metal("#232326"), metal("#e6e4de")),
                "frame": Choice(metal("#232326"), metal("#e6e4de"), *WOODS[:3]),
            },
        ),
        "bench": Style(
            _bench,
            {
                **_SHARED,
                "width": Span(0.8, 1.15),
                "shelves": Whole(1, 2),
                "cloth": Choice(*FABRICS),
            },
        ),
        "tipping": Style(
            _tipping,
            {
                **CABINET_MATERIALS,
                "width": Span(0.6, 0.9),
                "flaps": Whole(2, 3),
                "front": Choice("flat", "shaker", "louvre"),
                "handle": Choice("knob", "cup", "edge"),
            },
        ),
        "closed": Style(
            _closed,
            {
                **CABINET_MATERIALS,
                "depth": Span(0.36, 0.4),
                "width": Span(0.8, 1.1),
                "height": Span(0.6, 1.0),
                "legs": Span(0.08, 0.16),
                "rows": Whole(3, 4),
                "front": Choice("flat", "louvre", "grooved"),
            },
            "cabinet",
        ),
    },
)
