"""Pots and pans: with a lid and two handles, a long handle, a frying pan, a casserole, a kettle."""

from __future__ import annotations

import numpy as np

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.family import Family, Style
from sailenv_content.families.hollows import vessel_walls
from sailenv_content.families.lathe import smooth_profile, vessel
from sailenv_content.families.materials import glass, metal, paint, wood
from sailenv_content.families.parameters import Choice, Span, Values
from sailenv_content.families.shaping import swept, turned
from sailenv_content.procedural.forms import curve

__all__ = ["FAMILY"]


def _body(b: PieceBuilder, v: Values) -> None:
    rows = smooth_profile(np.array(v.profile) * (v.radius, v.height), 18)
    mesh = vessel(rows, wall=v.wall, floor=1.5 * v.wall, segments=44)
    b.form(v.material, mesh, collides="none")
    vessel_walls(b, rows, wall=v.wall, floor=1.5 * v.wall)


def _lid(b: PieceBuilder, v: Values, *, rise: float = 0.12) -> None:
    """Add a lid that is lifted, with a knob."""
    r, z = v.radius * v.profile[-1][0], v.height + 0.3 * v.wall + 0.002
    with b.slide("lid", "lid", by=0.15, axis=(0.0, 0.0, 1.0), friction=0.2, damping=1.0):
        t = 0.003
        dome = rise * r
        arc = np.linspace(0.0, np.pi / 2, 7)
        outer = [(r * 0.98 * np.cos(a), z + t + dome * np.sin(a)) for a in arc]
        inner = [(r * 0.96 * np.cos(a), z + (dome - t) * np.sin(a)) for a in arc]
        rows = [
            (0.0, inner[-1][1]),
            *inner[-2::-1],
            (r, z),
            (r + 0.002, z + 0.5 * t),
            (r, z + t),
            *outer[:-1],
            (0.0, outer[-1][1]),
        ]
        b.form(v.cover, turned(rows, segments=40))
        top = z + t + dome
        knob = [
            (0, 0),
            (0.008, 0),
            (0.007, 0.012),
            (0.02, 0.018),
            (0.021, 0.026),
            (0.012, 0.031),
            (0, 0.032),
        ]
        with b.part("handle", "handle"):
            b.form(v.knob, turned(knob, segments=22), (0.0, 0.0, top - 0.001))


def _stock(b: PieceBuilder, v: Values) -> None:
    """Make a pot with two loops and a lid."""
    _body(b, v)
    for yaw in (90.0, 270.0):
        with b.frame(yaw_deg=yaw), b.part("handle", "handle"):
            x, z, half = v.radius, 0.78 * v.height, 0.3 * v.radius
            out = x + 0.035
            path = curve(
                [
                    (0.955 * x, -half, z),
                    (out - 0.008, -0.8 * half, z),
                    (out, 0, z),
                    (out - 0.008, 0.8 * half, z),
                    (0.955 * x, half, z),
                ],
                14,
            )
            b.form(v.grip, swept(path, 0.005, sides=10))
    _lid(b, v)


def _casserole(b: PieceBuilder, v: Values) -> None:
    """Make a heavy pot whose lid and loops are of its own enamel."""
    _stock(b, Values({**v.all, "cover": v.material, "grip": v.material}))


def _long(b: PieceBuilder, v: Values, length: float, z: float, tilt: float) -> None:
    """Add a long handle that rises away from the pot."""
    x = v.radius * 0.97
    with b.part("handle", "handle"):
        neck = [(x, 0, z), (x + 0.05, 0, z + 0.3 * tilt)]
        b.form(metal("steel"), swept(neck, 0.006, sides=10), collides="none")
        grip = [
            (x + 0.04, 0, z + 0.25 * tilt),
            (x + 0.5 * length, 0, z + 0.6 * tilt),
            (x + length, 0, z + tilt),
        ]
        b.form(v.grip, swept(curve(grip, 8), np.linspace(0.009, 0.012, 8), sides=12))


def _sauce(b: PieceBuilder, v: Values) -> None:
    """Make a pot with one long handle and a lid."""
    _body(b, v)
    _long(b, v, 0.19, 0.75 * v.height, 0.03)
    _lid(b, v)


def _frying(b: PieceBuilder, v: Values) -> None:
    """Make a flat pan with a long handle."""
    _body(b, v)
    _long(b, v, 0.22, 0.75 * v.height, 0.045)


def _kettle(b: PieceBuilder, v: Values) -> None:
    """Make a kettle with a spout, a bow above it, and a lid."""
    _body(b, v)
    r, h = v.radius, v.height
    spout = curve([(0.8 * r, 0, 0.45 * h), (1.25 * r, 0, 0.62 * h), (1.5 * r, 0, 0.95 * h)], 10)
    b.form(v.material, swept(spout, np.linspace(0.22 * r, 0.1 * r, 10), sides=16))
    top = float(np.array(v.profile)[-1, 0]) * r
    with b.part("handle", "handle"):
        turn = np.linspace(0.15, np.pi - 0.15, 14)
        bow = [(0.82 * r * np.cos(t), 0.0, 0.86 * h + 0.75 * r * np.sin(t) ** 0.8) for t in turn]
        b.form(metal("steel"), swept(bow, 0.005, sides=10), collides="none")
        b.form(v.grip, swept(bow[4:-4], 0.011, sides=12))
    with b.part("lid", "lid"):
        z = h + 0.3 * v.wall + 0.002
        cap = [(0, z), (top, z), (top, z + 0.003), (0.6 * top, z + 0.012), (0, z + 0.014)]
        b.form(v.cover, turned(cap, segments=32))
        with b.part("handle", "handle"):
            knob = [(0, 0), (0.006, 0), (0.011, 0.01), (0.007, 0.017), (0, 0.018)]
            b.form(v.knob, turned(knob, segments=18), (0.0, 0.0, z + 0.0125))


_STEEL, _COPPER = metal("steel"), metal("copper")
_ENAMELS = tuple(
    paint(c, 0.18, 3500.0)
    for c in ("#a8231c", "#2f4a6c", "#d9762f", "#3f5a4a", "#e9e4d8", "#26282b")
)
_BLACK = paint("#1d1e20", 0.5, 1200.0)
_STRAIGHT = ((0.94, 0.0), (1.0, 0.05), (1.0, 1.0))
_SHARED = {
    "radius": Span(0.1, 0.14),
    "height": Span(0.11, 0.18),
    "wall": 0.003,
    "profile": _STRAIGHT,
    "material": Choice(_STEEL, _STEEL, _COPPER, metal("alu")),
    "cover": Choice(_STEEL, glass("#dfe8e6", 0.08)),
    "grip": Choice(_STEEL, _BLACK, wood("beech"), metal("brass")),
    "knob": Choice(_STEEL, _BLACK, wood("beech")),
}

FAMILY = Family(
    name="pot",
    category="pot",
    least_m=(0.12, 0.12, 0.03),
    most_m=(0.6, 0.5, 0.4),
    styles={
        "stock": Style(_stock, {**_SHARED, "grip": Choice(_STEEL, metal("brass"))}),
        "sauce": Style(_sauce, {**_SHARED, "radius": Span(0.075, 0.1), "height": Span(0.08, 0.11)}),
        "frying": Style(
            _frying,
            {
                **_SHARED,
                "radius": Span(0.11, 0.15),
                "height": Span(0.04, 0.055),
                "profile": ((0.74, 0.0), (0.8, 0.06), (0.9, 0.4), (1.0, 1.0)),
                "material": Choice(_BLACK, _STEEL, _COPPER, paint("#2b2c2e", 0.75, 4500.0)),
            },
        ),
        "casserole": Style(
            _casserole,
            {
                **_SHARED,
                "wall": 0.005,
                "height": Span(0.09, 0.13),
                "profile": ((0.88, 0.0), (0.97, 0.1), (1.0, 0.4), (1.0, 1.0)),
                "material": Choice(*_ENAMELS),
                "knob": Choice(_STEEL, metal("brass"), _BLACK),
            },
        ),
        "kettle": Style(
            _kettle,
            {
                **_SHARED,
                "radius": Span(0.085, 0.105),
                "height": Span(0.12, 0.16),
                "profile": ((0.92, 0.0), (1.0, 0.08), (0.98, 0.4), (0.8, 0.75), (0.48, 1.0)),
                "material": Choice(_STEEL, _COPPER, *_ENAMELS),
                "cover": Choice(_STEEL, _COPPER, *_ENAMELS[:3]),
                "grip": Choice(_BLACK, wood("beech"), wood("walnut")),
            },
            "kettle",
        ),
    },
)
