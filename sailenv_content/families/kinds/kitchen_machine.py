"""Machines on a worktop: toasters, kettles, coffee makers, mixers, blenders."""

from __future__ import annotations

import numpy as np

from sailenv_content.families.appliances import knob_row
from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.family import Family, Style
from sailenv_content.families.lathe import smooth_profile, vessel
from sailenv_content.families.materials import PieceMaterial, glass, metal, paint
from sailenv_content.families.parameters import Choice, Span, Values, Whole
from sailenv_content.families.shaping import extruded, placed, swept, turned
from sailenv_content.procedural.forms import curve, ellipsoid, rectangle
from sailenv_ros.assets.meshes import smooth_mesh

__all__ = ["FAMILY"]

BLACK = paint("#1a1b1d", 0.35, 900.0)
STEEL = metal("steel", 700.0)
PANE = glass("#dfe8e6", 0.08)


def _toaster(b: PieceBuilder, v: Values) -> None:
    """Make slots with toast in them, a lever that is pushed down, and a dial."""
    d, w, h = v.depth, v.width, v.height
    slots, wide = int(v.slots), 0.034
    base = 0.018
    b.box(BLACK, (0.92 * d, 0.92 * w, base), (0.0, 0.0, base / 2), bevel=0.004)
    # Walls and ribs around the slots: they are hollow.
    rib = (d - slots * wide) / (slots + 1)
    x = -d / 2
    end = 0.1 * w
    for number in range(slots + 1):
        at = (x + rib / 2, 0.0, base + (h - base) / 2)
        outer = number in (0, slots)
        b.box(
            v.body,
            (rib, w - 2 * end if not outer else w, h - base),
            at,
            bevel=0.012 if outer else 0.003,
        )
        x += rib + wide
    for sign in (-1.0, 1.0):
        size = (d - 2 * rib, end, h - base - 0.004)
        b.box(v.second, size, (0.0, sign * (w - end) / 2, base + size[2] / 2), bevel=0.006)
    b.box(BLACK, (d - rib, w - end, 0.004), (0.0, 0.0, base + 0.03), bevel=0.001)
    bread, crust = paint("#c98f4a", 0.95, 300.0), paint("#8a5a2a", 0.95, 300.0)
    if v.toast:
        for number in range(slots):
            at = -d / 2 + rib * (number + 1) + wide * (number + 0.5)
            slice_ = extruded(rectangle(0.62 * w, 0.1, 0.024, 6), 0.016, bevel=0.003)
            mesh = placed(placed(slice_, (0.0, 0.0, -0.008)), turn_deg=(0.0, 90.0, 0.0))
            with b.part("toast", "cake"):
                b.form(b.pick(bread, crust), mesh, (at, 0.0, h - 0.03), collides="none")
    y = w / 2
    with b.slide("lever", "handle", by=0.42 * h, axis=(0.0, 0.0, -1.0), friction=3.0):
        b.box(v.grip, (0.034, 0.022, 0.014), (0.0, y + 0.014, 0.8 * h), bevel=0.004)
    b.box(
        BLACK, (0.007, 0.002, 0.52 * h), (0.0, y + 0.0004, 0.56 * h), bevel=0.0008, collides=False
    )
    dial = turned([(0, 0), (0.016, 0), (0.014, 0.012), (0, 0.014)], segments=18)
    b.form(v.grip, dial, (0.0, y, 0.17 * h + base), turn=(-90.0, 0.0, 0.0), collides="none")


def _kettle(b: PieceBuilder, v: Values) -> None:
    """Make an electric kettle on its plate, with a lid on a hinge."""
    r, h = v.radius, v.tall
    plate = [(0, 0), (1.1 * r, 0), (1.1 * r, 0.012), (r, 0.018), (0, 0.018)]
    b.form(BLACK, turned(plate, segments=36))
    z = 0.02
    rows = smooth_profile(
        np.array([(r, 0), (0.98 * r, 0.3 * h), (v.neck * r, 0.9 * h), (v.neck * r, h)]), 16
    )
    body = v.body if not v.see_through else PANE
    b.form(body, vessel(rows, wall=0.003, floor=0.006, segments=40), (0.0, 0.0, z), volume=2e-4)
    if v.see_through:
        foot = [(0, -0.001), (1.012 * r, -0.001), (1.012 * r, 0.03), (0, 0.03)]
        b.form(v.body, turned(foot, segments=36), (0, 0, z), collides="none", volume=1e-4)
        water = smooth_profile([(0.955 * r, 0.032), (0.93 * r, 0.3 * h), (0.9 * r, 0.45 * h)], 6)
        drink = turned(np.concatenate([[(0, 0.032)], water, [(0, 0.45 * h)]]), segments=30)
        b.form(glass("#9fc3d6", 0.35), drink, (0, 0, z), collides="none", volume=1e-4)
    n = v.neck * r
    spout = np.array([(n - 0.006, 0, 0.8 * h), (n + 0.018, 0, 0.92 * h), (n + 0.034, 0, 0.98 * h)])
    b.form(
        v.body, swept(spout + np.array([0, 0, z]), (0.018, 0.014, 0.008), sides=14), collides="none"
    )
    bow = curve(
        [
            (-n, 0, 0.94 * h),
            (-n - 0.05, 0, h),
            (-r - 0.06, 0, 0.6 * h),
            (-r - 0.03, 0, 0.18 * h),
            (-0.95 * r, 0, 0.16 * h),
        ],
        18,
    )
    with b.part("handle", "handle"):
        b.form(BLACK, swept(bow + np.array([0, 0, z]), 0.0105, sides=12))
    at = (-n, 0.0, z + h + 0.004)
    with b.hinge("lid", "lid", at=at, axis=(0, -1, 0), opens_deg=80.0, friction=0.03, damping=0.02):
        lid = [
            (0, 0.002),
            (n - 0.001, 0.002),
            (n, 0.007),
            (0.4 * n, 0.016),
            (0.1 * n, 0.017),
            (0.14 * n, 0.028),
            (0, 0.03),
        ]
        b.form(v.second, turned(lid, segments=32), (0, 0, z + h))


def _coffee(b: PieceBuilder, v: Values) -> None:
    """Make a filter machine with a jug, or one of steel that presses the coffee."""
    d, w, h = v.depth, v.width, v.height
    if v.press:
        b.box(v.body, (0.55 * d, w, h), (-0.225 * d, 0.0, h / 2), bevel=0.014)
        b.box(v.body, (d, w, 0.06), (0.0, 0.0, 0.03), bevel=0.008)
        b.box(STEEL, (0.4 * d, 0.86 * w, 0.006), (0.26 * d, 0.0, 0.062), bevel=0.001)
        for number in range(7):
            bar = (0.36 * d, 0.006, 0.002)
            b.box(
                BLACK, bar, (0.26 * d, (number - 3) * 0.1 * w, 0.0655), bevel=0.0005, collides=False
            )
        b.box(v.body, (0.42 * d, w, 0.28 * h), (0.28 * d, 0.0, 0.86 * h), bevel=0.012)
        head = turned([(0, 0), (0.036, 0), (0.036, 0.04), (0, 0.04)], segments=28)
        b.form(metal("chrome"), head, (0.26 * d, 0.0, 0.72 * h - 0.038))
        at = (0.26 * d, 0.0, 0.72 * h - 0.042)
        with b.hinge("filter", "handle", at=at, axis=(0, 0, 1), opens_deg=50.0, friction=0.3):
            cup = turned([(0, 0), (0.033, 0), (0.033, 0.016), (0, 0.016)], segments=24)
            b.form(metal("chrome"), cup, (at[0], 0, at[2] - 0.018))
            grip = [(at[0] + 0.03, 0, at[2] - 0.01), (at[0] + 0.15, 0, at[2] - 0.022)]
            b.form(v.grip, swept(grip, (0.008, 0.013), sides=12))
        pipe = np.array(
            [
                (0.2 * d, -0.42 * w, 0.72 * h),
                (0.26 * d, -0.45 * w, 0.62 * h),
                (0.26 * d, -0.45 * w, 0.36 * h),
            ]
        )
        b.form(metal("chrome"), swept(pipe, 0.0045, sides=10), collides="none")
        knob_row(b, v.grip, 0.49 * d, 0.88 * h, [-0.3 * w, 0.3 * w], radius=0.016)
        return
    b.box(v.body, (0.36 * d, w, h), (-0.32 * d, 0.0, h / 2), bevel=0.012)
    b.box(v.body, (d, w, 0.035), (0.0, 0.0, 0.0175), bevel=0.008)
    b.box(v.body, (0.62 * d, w, 0.3 * h), (0.17 * d, 0.0, 0.85 * h), bevel=0.012)
    hot = turned([(0, 0), (0.36 * w, 0), (0.36 * w, 0.003), (0, 0.003)], segments=28)
    b.form(BLACK, hot, (0.18 * d, 0, 0.0348), collides="none")
    r, tall = 0.36 * w, 0.52 * h
    rows = smooth_profile(
        [
            (0.9 * r, 0),
            (r, 0.3 * tall),
            (0.9 * r, 0.7 * tall),
            (0.62 * r, 0.95 * tall),
            (0.66 * r, tall),
        ],
        18,
    )
    x, z = 0.18 * d, 0.0385
    with b.part("jug", "jar"):
        b.form(PANE, vessel(rows, wall=0.003, floor=0.005, segments=32), (x, 0, z), volume=1e-4)
        high = 0.5 * tall
        inner = [
            (np.interp(t, rows[:, 1], rows[:, 0]) - 0.004, t) for t in np.linspace(0.006, high, 6)
        ]
        brew = turned([(0, 0.006), *inner, (0, high)], segments=28)
        b.form(paint("#2a160c", 0.1, 1000.0), brew, (x, 0, z), collides="none", volume=1e-4)
        bow = curve(
            [
                (0.66 * r, 0, 0.93 * tall),
                (r + 0.03, 0, 0.86 * tall),
                (r + 0.026, 0, 0.4 * tall),
                (0.98 * r, 0, 0.3 * tall),
            ],
            14,
        )
        b.form(BLACK, swept(bow + np.array([x, 0, z]), 0.007, sides=10), collides="none")
    at = (-0.472 * d, 0.0, h + 0.0005)
    with b.hinge("lid", "lid", at=at, axis=(0, -1, 0), opens_deg=85.0, friction=0.05, damping=0.02):
        b.box(v.second, (0.9 * d, 0.92 * w, 0.012), (-0.02 * d, 0.0, h + 0.007), bevel=0.004)
    b.box(v.grip, (0.004, 0.022, 0.03), (0.481 * d, 0.3 * w, 0.8 * h), bevel=0.002, collides=False)


def _mixer(b: PieceBuilder, v: Values) -> None:
    """Make a mixer whose head tilts back over a bowl."""
    d, w, h = v.long, v.width * 0.8, v.height * 1.5
    plate = extruded(rectangle(w, d, 0.06, 8), 0.03, bevel=0.008)
    b.form(v.body, plate)
    b.box(v.body, (0.24 * d, 0.62 * w, 0.62 * h), (-0.34 * d, 0.0, 0.33 * h), bevel=0.02)
    r, x = 0.43 * w, 0.17 * d
    rows = smooth_profile(
        [(0.55 * r, 0), (0.8 * r, 0.1 * h), (r, 0.3 * h), (1.02 * r, 0.42 * h)], 16
    )
    with b.part("bowl", "bowl"):
        b.form(
            v.bowl,
            vessel(rows, wall=0.003, floor=0.006, segments=40),
            (x, 0.0, 0.031),
            collides="none",
            volume=2e-4,
        )
        b.collide((1.2 * r, 1.2 * r, 0.012), (x, 0.0, 0.04))
        for number in range(10):
            turn = 36.0 * number
            c, s = np.cos(np.radians(turn)), np.sin(np.radians(turn))
            at = (x + 0.86 * r * c, 0.86 * r * s, 0.031 + 0.2 * h)
            b.collide((0.006, 0.56 * r, 0.4 * h), at, (0.0, 0.0, turn))
    at = (-0.36 * d, 0.0, 0.68 * h)
    with b.hinge("head", "mixer", at=at, axis=(0, -1, 0), opens_deg=50.0, friction=1.0):
        head = smooth_mesh(ellipsoid((0.48 * d, 0.36 * w, 0.17 * h), (0, 0, 0), 26))
        b.form(v.body, head, (-0.02 * d, 0.0, 0.81 * h))
        hub = turned([(0, 0), (0.03, 0), (0.028, 0.012), (0, 0.014)], segments=22)
        b.form(metal("chrome"), hub, (0.452 * d, 0.0, 0.81 * h), turn=(0, 90, 0), collides="none")
        stripe = turned([(0, 0), (0.012, 0), (0.01, 0.1 * h), (0, 0.1 * h)], segments=16)
        b.form(metal("chrome"), stripe, (x, 0, 0.58 * h), collides="none")
        for turn in np.linspace(0, np.pi, 4)[:-1]:
            t = np.linspace(0, np.pi, 17)
            out = 0.42 * r * np.sin(t) ** 0.8
            path = np.stack(
                [x + out * np.cos(turn), out * np.sin(turn), 0.58 * h - 0.34 * h * t / np.pi], -1
            )
            b.form(STEEL, swept(path, 0.0016, sides=5), collides="none", volume=1e-6)
            path[:, :2] = 2 * np.array([x, 0.0]) - path[:, :2]
            b.form(STEEL, swept(path, 0.0016, sides=5), collides="none", volume=1e-6)
    with b.hinge(
        "speed", "handle", at=(-0.34 * d, -0.31 * w, 0.5 * h), axis=(0, 1, 0), opens_deg=120.0,
        friction=0.03,
    ):  # fmt: skip
        knob = turned([(0, 0), (0.018, 0), (0.015, 0.016), (0, 0.018)], segments=18)
        b.form(metal("chrome"), knob, (-0.34 * d, -0.312 * w, 0.5 * h), turn=(90, 0, 0))


def _blender(b: PieceBuilder, v: Values) -> None:
    """Stand a jug of glass on a motor, with a lid."""
    r, h = v.radius * 0.95, v.tall * 1.7
    base = 0.32 * h
    rows = smooth_profile([(1.15 * r, 0), (1.12 * r, 0.3 * base), (0.72 * r, base)], 14)
    foot = turned(np.concatenate([[(0, 0)], rows, [(0, base)]]), segments=36)
    b.form(v.body, foot)
    knob_row(b, v.grip, 1.15 * r, 0.28 * base, [0.0], radius=0.018)
    tall = h - base
    z = base + 0.002
    jug = smooth_profile(
        [(0.62 * r, 0), (0.7 * r, 0.2 * tall), (0.92 * r, 0.8 * tall), (0.95 * r, tall)], 16
    )
    b.form(PANE, vessel(jug, wall=0.003, floor=0.01, segments=36), (0, 0, z), volume=2e-4)
    blades = turned([(0, 0), (0.012, 0), (0.008, 0.02), (0, 0.022)], segments=12)
    b.form(STEEL, blades, (0, 0, z + 0.01), collides="none")
    for turn in (0.0, 90.0):
        b.box(
            STEEL,
            (0.8 * r, 0.012, 0.0015),
            (0, 0, z + 0.03),
            turn=(12.0, 0, turn),
            bevel=0.0004,
            collides=False,
        )
    bow = curve(
        [
            (-0.93 * r, 0, 0.92 * tall),
            (-1.45 * r, 0, 0.86 * tall),
            (-1.35 * r, 0, 0.3 * tall),
            (-0.74 * r, 0, 0.22 * tall),
        ],
        14,
    )
    with b.part("handle", "handle"):
        b.form(PANE, swept(bow + np.array([0, 0, z]), 0.008, sides=10))
    with b.slide("lid", "lid", by=0.15, axis=(0, 0, 1), friction=3.0, damping=1.0):
        lid = [
            (0, 0),
            (0.97 * r, 0),
            (0.97 * r, 0.014),
            (0.4 * r, 0.02),
            (0.36 * r, 0.034),
            (0, 0.036),
        ]
        b.form(v.second, turned(lid, segments=32), (0, 0, h + 0.006))


_BODIES: tuple[PieceMaterial, ...] = (
    STEEL,
    *(
        paint(c, 0.2, 700.0)
        for c in ("#e9e6df", "#1d1f22", "#8a2f2a", "#9fb8b0", "#d8c9a3", "#2f4257")
    ),
)
_SHARED = {
    "width": Span(0.2, 0.27),
    "depth": Span(0.17, 0.21),
    "height": Span(0.18, 0.21),
    "radius": Span(0.07, 0.08),
    "tall": Span(0.19, 0.23),
    "body": Choice(*_BODIES),
    "second": Choice(*_BODIES[:3], BLACK),
    "grip": Choice(BLACK, metal("chrome"), metal("brass")),
}

FAMILY = Family(
    name="kitchen_machine",
    category="coffee maker",
    least_m=(0.12, 0.1, 0.12),
    most_m=(0.5, 0.4, 0.5),
    styles={
        "toaster": Style(
            _toaster, {**_SHARED, "slots": Whole(2, 2), "toast": Choice(True, False)}, "toaster"
        ),
        "kettle": Style(
            _kettle,
            {**_SHARED, "neck": Span(0.66, 0.92), "see_through": Choice(True, False, False)},
            "kettle",
        ),
        "coffee": Style(
            _coffee,
            {
                **_SHARED,
                "press": Choice(True, False),
                "depth": Span(0.24, 0.28),
                "height": Span(0.31, 0.36),
                "width": Span(0.19, 0.25),
            },
        ),
        "mixer": Style(
            _mixer,
            {
                **_SHARED,
                "long": Span(0.32, 0.36),
                "width": Span(0.26, 0.29),
                "bowl": Choice(STEEL, metal("chrome")),
            },
            "mixer",
        ),
        "blender": Style(_blender, _SHARED, "blender"),
    },
)
