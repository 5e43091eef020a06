"""Chairs without arms: slats, spindles, bent shells, upholstery, cantilevers, ladders."""

from __future__ import annotations

import numpy as np

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.family import Family, Style
from sailenv_content.families.joinery import four_legs, leg
from sailenv_content.families.materials import FABRICS, LEATHERS, WOODS, metal, paint, wood
from sailenv_content.families.parameters import Choice, Span, Values, Whole
from sailenv_content.families.shaping import cushion, extruded, ribbon, swept
from sailenv_content.procedural.forms import curve, rectangle

__all__ = ["FAMILY"]


def _seat_pad(b: PieceBuilder, v: Values, z: float, d: float, w: float) -> None:
    if v.pad is not None:
        mesh = cushion((d, w, 0.03), radius=0.014, puff=0.012, tile_m=v.pad.tile_m)
        b.form(v.pad, mesh, (0.0, 0.0, z + 0.013))


def _frame(b: PieceBuilder, v: Values, back_h: float) -> tuple[float, float]:
    """Add four legs with rails below the seat; the back ones go up and lean. Returns x and lean."""
    d, w, h, t = v.depth, v.width, v.height, v.thick
    front_x, back_x = d / 2 - t / 2, -d / 2 + t / 2
    for sy in (-1.0, 1.0):
        y = sy * (w / 2 - t / 2)
        leg(b, v.material, v.leg, front_x, y, h - 0.02, t)
        b.box(
            v.material,
            (t * 0.8, t * 0.8, h),
            (back_x - 0.02, y, h / 2),
            top=(1.25, 1.25),
            lean=(0.04, 0.0),
            bevel=0.004,
        )
        b.box(
            v.material,
            (t, t, back_h),
            (back_x - v.lean / 2, y, h + back_h / 2),
            top=(0.8, 0.8),
            lean=(-v.lean, 0.0),
            bevel=0.004,
        )
        b.box(v.material, (d - 2 * t, 0.02, 0.055), (0.0, y, h - 0.05))
    for x in (front_x, back_x):
        b.box(v.material, (0.02, w - 2 * t, 0.055), (x, 0.0, h - 0.05))
    outline = rectangle(w + 0.01, d + 0.01, 0.025)
    b.form(
        v.material, extruded(outline, 0.02, bevel=0.006, tile_m=v.material.tile_m), (0, 0, h - 0.02)
    )
    return back_x, v.lean


def _dining(b: PieceBuilder, v: Values) -> None:
    """Make upright slats, or a ladder of cross pieces."""
    back_h = v.back
    x, lean = _frame(b, v, back_h)
    h, w = v.height, v.width - 2 * v.thick

    def at(share: float) -> float:
        return x - lean * share

    b.box(
        v.material,
        (0.022, w, 0.075),
        (at(0.93), 0.0, h + 0.92 * back_h),
        turn=(0, -lean * 120, 0),
        bevel=0.006,
    )
    if v.kind == "slats":
        b.box(v.material, (0.02, w, 0.035), (at(0.2), 0.0, h + 0.2 * back_h))
        low, high = 0.2 * back_h, 0.9 * back_h
        tilt = -np.degrees(np.arctan(lean / back_h))
        for y in np.linspace(-1, 1, v.count + 2)[1:-1] * w / 2:
            b.box(
                v.material,
                (0.012, 0.03, high - low),
                (at(0.55), y, h + (low + high) / 2),
                turn=(0, tilt, 0),
            )
    else:
        for share in np.linspace(0.25, 0.68, max(2, v.count - 2)):
            b.box(
                v.material,
                (0.018, w, 0.05),
                (at(share), 0.0, h + share * back_h),
                turn=(0, -lean * 120, 0),
                bevel=0.005,
            )
    if v.rungs:
        for sy in (-1.0, 1.0):
            b.box(
                v.material,
                (v.depth - 0.05, 0.016, 0.022),
                (0, sy * (v.width / 2 - v.thick / 2), 0.16),
            )
        b.box(v.material, (0.016, v.width - 0.05, 0.022), (0.02, 0, 0.16))
    _seat_pad(b, v, h, v.depth - 0.03, v.width - 0.03)


def _spindle(b: PieceBuilder, v: Values) -> None:
    """Make a solid seat with splayed turned legs and a bow of thin spindles."""
    d, w, h = v.depth, v.width, v.height
    outline = rectangle(w, d, 0.17, steps=10)
    b.form(
        v.material,
        extruded(outline, 0.035, bevel=0.014, tile_m=v.material.tile_m),
        (0, 0, h - 0.035),
    )
    for sx in (-1.0, 1.0):
        for sy in (-1.0, 1.0):
            leg(b, v.material, v.leg, sx * d * 0.3, sy * w * 0.3, h - 0.03, 0.04, splay=0.055)
    for sy in (-1.0, 1.0):
        b.form(
            v.material,
            swept([(d * 0.36, sy * w * 0.36, 0.17), (-d * 0.36, sy * w * 0.36, 0.17)], 0.009),
        )
    b.form(v.material, swept([(0, -w * 0.36, 0.17), (0, w * 0.36, 0.17)], 0.009))
    turns = np.linspace(0.0, np.pi, 15)
    half, tall = w * 0.43, v.back
    if v.kind == "bow":
        ys, zs = -half * np.cos(turns), h + tall * np.clip(np.sin(turns), 0.0, 1.0) ** 0.6
    else:
        ys, zs = np.linspace(-half, half, 15), np.full(15, h + tall * 0.92)
    xs = -d * 0.36 - 0.16 * np.clip(zs - h, 0, None) / tall * 0.9 - 0.02 * np.sin(turns)
    rail = np.stack([xs, ys, zs], -1)
    b.form(v.material, swept(rail, 0.012 if v.kind == "bow" else 0.016, sides=12), collides="none")
    b.collide((0.03, 2 * half, tall), (-d * 0.36 - 0.08, 0, h + tall / 2), (0, -8.0, 0))
    inner = np.linspace(-1, 1, v.count + 2)[1:-1]
    for share in inner:
        y = share * half * 0.8
        foot = (-d * 0.38, y * 0.85, h - 0.01)
        place = int(np.argmin(np.abs(ys - y) + (zs < h + 0.4 * tall) * 9.0))
        head = (float(xs[place]), float(ys[place]), float(zs[place]))
        b.form(v.material, swept([foot, head], (0.008, 0.006), sides=8), collides="none")
    if v.kind == "comb":
        for sy in (-1.0, 1.0):
            foot, head = (-d * 0.36, sy * half * 0.9, h - 0.01), (xs[0], sy * half * 0.95, zs[0])
            b.form(v.material, swept([foot, head], 0.013, sides=10), collides="none")


def _shell(b: PieceBuilder, v: Values) -> None:
    """Make one bent shell on thin legs."""
    d, w, h = v.depth, v.width, v.height
    line = curve(
        [
            (d / 2, 0, h - 0.03),
            (d * 0.2, 0, h - 0.012),
            (-d * 0.28, 0, h - 0.03),
            (-d * 0.46, 0, h + 0.05),
            (-d * 0.55, 0, h + 0.22),
            (-d * 0.62, 0, h + v.back),
        ],
        26,
    )[:, [0, 2]]
    share = np.linspace(0, 1, 26)
    widths = w * (
        0.9 + 0.1 * np.sin(np.pi * share) - v.waist * np.exp(-(((share - 0.55) / 0.12) ** 2))
    )
    mesh = ribbon(
        line[::-1], widths[::-1], 0.011, dish=-v.dish, round_m=v.round, tile_m=v.material.tile_m
    )
    b.form(v.material, mesh, collides="none", volume=0.004)
    b.collide((d * 0.95, w * 0.92, 0.02), (0, 0, h - 0.02))
    b.collide((0.02, w * 0.85, v.back - 0.05), (-d * 0.56, 0, h + v.back / 2 + 0.02), (0, -10, 0))
    for sx in (-1.0, 1.0):
        for sy in (-1.0, 1.0):
            leg(b, v.frame, v.leg, sx * d * 0.25, sy * w * 0.27, h - 0.04, v.thick, splay=0.075)
    if v.leg == "metal":
        for sx in (-1.0, 1.0):
            b.form(
                v.frame,
                swept(
                    [(sx * d * 0.25, -w * 0.27, h - 0.062), (sx * d * 0.25, w * 0.27, h - 0.062)],
                    0.009,
                ),
            )
    else:
        b.box(v.frame, (d * 0.5, 0.03, 0.02), (0, w * 0.27, h - 0.068))
        b.box(v.frame, (d * 0.5, 0.03, 0.02), (0, -w * 0.27, h - 0.068))


def _upholstered(b: PieceBuilder, v: Values) -> None:
    """Make seat and back of foam, on wooden or metal legs."""
    d, w, h = v.depth, v.width, v.height
    b.form(
        v.cover,
        cushion((d, w, 0.085), radius=0.035, puff=0.014, tile_m=v.cover.tile_m),
        (0, 0, h - 0.045),
    )
    tilt = -v.tilt
    mesh = cushion((0.055, w * v.narrow, v.back), radius=0.027, puff=0.012, tile_m=v.cover.tile_m)
    x = -d / 2 + 0.01 - np.sin(np.radians(v.tilt)) * v.back / 2
    b.form(v.cover, mesh, (x, 0, h + v.back / 2 - 0.02), turn=(0, tilt, 0))
    four_legs(b, v.frame, v.leg, d - 0.05, w - 0.04, h - 0.075, v.thick, splay=v.splay)
    if v.leg in ("metal", "hairpin"):
        b.box(v.frame, (d * 0.8, w * 0.8, 0.012), (0, 0, h - 0.081))
    if v.piped:
        for sy in (-1.0, 1.0):
            b.form(
                v.cover,
                swept(
                    [
                        (d / 2 - 0.03, sy * (w / 2 - 0.01), h - 0.02),
                        (-d / 2 + 0.04, sy * (w / 2 - 0.01), h - 0.02),
                    ],
                    0.005,
                    tile_m=0.06,
                ),
                collides="none",
            )


def _cantilever(b: PieceBuilder, v: Values) -> None:
    """Bend a steel tube from the floor to the back, seat and back hung into it."""
    d, w, h, r = v.depth, v.width, v.height, 0.0125
    for sy in (-1.0, 1.0):
        y = sy * (w / 2 - r)
        points = [
            (-d / 2, y, r),
            (d / 2 - 0.06, y, r),
            (d / 2, y, r + 0.05),
            (d / 2 + 0.01, y, h - 0.08),
            (d / 2 - 0.05, y, h - 0.02),
            (-d / 2 + 0.06, y, h - 0.025),
            (-d / 2 + 0.005, y, h + 0.04),
            (-d / 2 - 0.07, y, h + v.back),
        ]
        path = _rounded(np.array(points), 0.05)
        b.form(v.frame, swept(path, r, sides=12), collides="none", volume=0.0006)
        b.collide((d, 2 * r, 2 * r), (0, y, r))
        b.collide((2 * r, 2 * r, h - 0.05), (d / 2, y, h / 2))
    b.form(v.frame, swept([(-d / 2, -w / 2 + r, r), (-d / 2, w / 2 - r, r)], r))
    b.form(
        v.cover,
        cushion((d - 0.06, w - 0.01, 0.026), radius=0.012, puff=0.006, tile_m=v.cover.tile_m),
        (0, 0, h - 0.01),
    )
    mesh = cushion((0.024, w - 0.01, 0.19), radius=0.011, puff=0.006, tile_m=v.cover.tile_m)
    b.form(v.cover, mesh, (-d / 2 - 0.045, 0, h + v.back - 0.12), turn=(0, -11, 0))


def _rounded(points: np.ndarray, radius: float) -> np.ndarray:
    """Return a path with its corners rounded [m]."""
    path = [points[0]]
    for a, p, c in zip(points, points[1:], points[2:], strict=False):
        before, after = a - p, c - p
        reach = min(radius, 0.45 * np.linalg.norm(before), 0.45 * np.linalg.norm(after))
        start = p + before / np.linalg.norm(before) * reach
        end = p + after / np.linalg.norm(after) * reach
        path += [
            (1 - t) ** 2 * start + 2 * t * (1 - t) * p + t**2 * end for t in np.linspace(0, 1, 6)
        ]
    return np.array([*path, points[-1]])


_PAD = Choice(None, None, *FABRICS)
_METAL = Choice(metal("chrome"), metal("#232326"), metal("brass"), metal("#e6e4de"))
_SEAT = {"depth": Span(0.40, 0.46), "width": Span(0.40, 0.48), "height": Span(0.44, 0.47)}

FAMILY = Family(
    name="chair",
    category="chair",
    least_m=(0.38, 0.36, 0.7),
    most_m=(0.75, 0.62, 1.15),
    styles={
        "dining": Style(
            _dining,
            {
                **_SEAT,
                "back": Span(0.38, 0.52),
                "thick": Span(0.034, 0.042),
                "lean": Span(0.05, 0.1),
                "kind": Choice("slats", "ladder"),
                "count": Whole(3, 7),
                "leg": Choice("square", "tapered"),
                "rungs": Choice(True, False),
                "material": Choice(*WOODS, paint("#e8e4da"), paint("#33373b")),
                "pad": _PAD,
            },
        ),
        "spindle": Style(
            _spindle,
            {
                **_SEAT,
                "back": Span(0.4, 0.52),
                "kind": Choice("bow", "comb"),
                "count": Whole(5, 8),
                "leg": Choice("turned", "splayed"),
                "material": Choice(*WOODS, paint("#2d3134"), paint("#8c9a86")),
            },
        ),
        "shell": Style(
            _shell,
            {
                **_SEAT,
                "back": Span(0.33, 0.42),
                "waist": Span(0.0, 0.35),
                "dish": Span(0.0, 0.03),
                "round": Span(0.03, 0.1),
                "leg": Choice("splayed", "metal"),
                "thick": Span(0.024, 0.034),
                "material": Choice(
                    *(
                        paint(c, 0.35)
                        for c in ("#e9e6df", "#2a2c2f", "#c9a227", "#5d7b78", "#b5523b", "#8a939a")
                    ),
                    wood("oak"),
                    wood("walnut"),
                ),
                "frame": Choice(wood("beech"), wood("oak"), metal("#232326"), metal("chrome")),
            },
        ),
        "upholstered": Style(
            _upholstered,
            {
                **_SEAT,
                "back": Span(0.38, 0.5),
                "tilt": Span(6.0, 13.0),
                "narrow": Span(0.85, 1.0),
                "leg": Choice("tapered", "splayed", "metal"),
                "thick": Span(0.026, 0.036),
                "splay": Span(0.0, 0.04),
                "cover": Choice(*FABRICS, *LEATHERS),
                "frame": Choice(*WOODS[:3], metal("#232326"), metal("brass")),
                "piped": Choice(True, False),
            },
        ),
        "cantilever": Style(
            _cantilever,
            {
                **_SEAT,
                "back": Span(0.33, 0.42),
                "frame": _METAL,
                "cover": Choice(*LEATHERS, *FABRICS[:4]),
            },
        ),
    },
)
