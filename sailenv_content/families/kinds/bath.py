"""Baths: built in, oval, on claw feet, of wood; a shower cabin with a door of glass."""

from __future__ import annotations

import numpy as np

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.family import Family, Style
from sailenv_content.families.hardware import MAGNET
from sailenv_content.families.hollows import tub_walls, vessel_walls
from sailenv_content.families.lathe import closed_ring, scaled, smooth_profile, vessel
from sailenv_content.families.materials import WOODS, glass, metal, paint, wood
from sailenv_content.families.parameters import Choice, Span, Values
from sailenv_content.families.plumbing import drain, tap, tub
from sailenv_content.families.shaping import swept, turned
from sailenv_content.procedural.forms import curve

__all__ = ["FAMILY"]

ENAMEL = paint("#f3f1ec", 0.1, 1200.0)


def _built(b: PieceBuilder, v: Values) -> None:
    """Make a tub with straight sides of tiles or boards; one lies along y."""
    d, w, h = v.depth, v.length, v.height
    mesh = tub((d, w, h - 0.1), wall=v.rim, floor=0.05, radius=0.03, slope=0.07)
    b.form(ENAMEL, mesh, (0.0, 0.0, 0.1), collides="none", volume=0.03)
    tub_walls(b, (d, w, h - 0.1), wall=v.rim, floor=0.05, slope=0.07, at=(0.0, 0.0, 0.1))
    for sx in (-1.0, 1.0):
        b.box(
            v.side,
            (0.012, w - 0.02, h - 0.03),
            (sx * (d / 2 - 0.004), 0.0, (h - 0.03) / 2),
            bevel=0.001,
        )
    for sy in (-1.0, 1.0):
        b.box(
            v.side,
            (d - 0.02, 0.012, h - 0.03),
            (0.0, sy * (w / 2 - 0.004), (h - 0.03) / 2),
            bevel=0.001,
        )
    if v.screen:
        size = (0.008, 0.75, 1.4)
        at = (d / 2 - 0.04, -w / 2 + 0.4, h + 0.7)
        with b.part("screen", "shower"):
            b.box(glass(), size, at, bevel=0.002)
            b.box(v.metal, (0.02, 0.02, 1.4), (at[0], -w / 2 + 0.02, at[2]))
    drain(b, 0.0, -0.3 * w, 0.151)
    with b.frame((0.0, -w / 2 + 0.05, 0.0), 90.0):
        tap(b, v.metal, 0.0, 0.0, h - 0.001, kind=v.spout, reach=0.14, rise=0.16)


def _stand_tap(b: PieceBuilder, v: Values, x: float, y: float) -> None:
    """Add a tap that stands on the floor beside the tub."""
    with b.frame((x, y, 0.0), v.tap_yaw):
        foot = [(0, 0), (0.05, 0), (0.05, 0.008), (0.02, 0.014), (0, 0.014)]
        b.form(v.metal, turned(foot, segments=24))
        b.form(v.metal, swept([(0, 0, 0.01), (0, 0, 0.8)], 0.017, sides=14))
        tap(b, v.metal, 0.0, 0.0, 0.8, kind="straight", reach=0.2, rise=0.14)


def _oval_tub(b: PieceBuilder, v: Values, low: float, *, rolled: bool) -> None:
    r, tall = v.depth / 2, v.height - low
    shape = [(0.62, 0.0), (0.78, 0.04), (0.9, 0.45), (1.0, 1.0)]
    if not v.waist and not rolled:
        shape = [(0.8, 0.0), (0.86, 0.04), (0.95, 0.5), (1.0, 1.0)]
    rows = smooth_profile(np.array(shape) * (r, tall), 20)
    stretch = (1.0, v.length / v.depth, 1.0)
    b.form(
        v.outside,
        scaled(vessel(rows, wall=0.028, floor=0.05, segments=56), stretch),
        (0, 0, low),
        collides="none",
        volume=0.03,
    )
    vessel_walls(b, rows, wall=0.029, floor=0.055, at=(0, 0, low), oval=stretch[1], sectors=14)
    inside = rows[rows[:, 1] > 0.1 * tall] - np.array([0.0285, 0.0])
    inside[-1, 1] += 0.001
    lining = closed_ring([*inside, *(inside[::-1] - np.array([0.001, 0.0]))], segments=56)
    b.form(ENAMEL, scaled(lining, stretch), (0, 0, low), collides="none", volume=0.002)
    ground = float(inside[0, 0]) * 1.001
    disc = [
        (0, 0.052),
        (ground, 0.052),
        (ground, 0.1 * tall + 0.01),
        (ground * 0.9, 0.056),
        (0, 0.055),
    ]
    b.form(
        ENAMEL,
        scaled(turned(disc, segments=56), stretch),
        (0, 0, low),
        collides="none",
        volume=0.002,
    )
    if rolled:
        turn = np.linspace(0.0, 2 * np.pi, 10, endpoint=False)
        rim = [(r - 0.004 + 0.022 * np.cos(t), tall + 0.012 + 0.018 * np.sin(t)) for t in turn]
        b.form(
            ENAMEL,
            scaled(closed_ring(rim, segments=56), stretch),
            (0, 0, low),
            collides="none",
            volume=0.004,
        )


def _oval(b: PieceBuilder, v: Values) -> None:
    """Make an oval tub that stands free."""
    _oval_tub(b, v, 0.0, rolled=False)
    drain(b, 0.0, 0.0, 0.056)
    _stand_tap(b, v, -v.depth / 2 - 0.1, 0.0)


def _claw(b: PieceBuilder, v: Values) -> None:
    """Make a tub with a rolled rim on four bowed feet."""
    low = 0.14
    _oval_tub(b, v, low, rolled=True)
    drain(b, 0.0, 0.0, low + 0.056)
    for sx in (-1.0, 1.0):
        for sy in (-1.0, 1.0):
            x, y = sx * 0.24 * v.depth, sy * 0.27 * v.length
            path = curve(
                [
                    (x, y, low + 0.06),
                    (x + sx * 0.06, y + sy * 0.05, low),
                    (x + sx * 0.045, y + sy * 0.04, 0.06),
                    (x + sx * 0.075, y + sy * 0.06, 0.022),
                ],
                12,
            )
            b.form(v.metal, swept(path, np.linspace(0.034, 0.018, 12), sides=12))
            ball = [(0, 0), (0.02, 0.006), (0.028, 0.024), (0.02, 0.042), (0, 0.048)]
            b.form(v.metal, turned(ball, segments=16), (x + sx * 0.08, y + sy * 0.062, 0.0))
    _stand_tap(b, v, -v.depth / 2 - 0.1, 0.0)


def _wooden(b: PieceBuilder, v: Values) -> None:
    """Make a deep tub of upright staves with two hoops of metal."""
    r, h = v.depth / 2, v.height + 0.1
    rows = [(r * 0.94, 0.0), (r, h)]
    stretch = (1.0, v.stretch, 1.0)
    mesh = vessel(
        rows, wall=0.035, floor=0.08, segments=v.staves, tile_m=v.timber.tile_m, crease_deg=8.0
    )
    b.form(v.timber, scaled(mesh, stretch), collides="none", volume=0.06)
    vessel_walls(b, rows, wall=0.035, floor=0.08, oval=v.stretch, sectors=12, bands=1)
    for share in (0.2, 0.8):
        x = r * (0.94 + 0.06 * share) + 0.003
        z = share * h
        hoop = closed_ring(
            [(x - 0.004, z), (x, z), (x, z + 0.035), (x - 0.004, z + 0.035)], segments=v.staves
        )
        b.form(v.metal, scaled(hoop, stretch), collides="none", volume=2e-4)
    drain(b, 0.0, 0.0, 0.081)
    _stand_tap(b, v, -r - 0.1, 0.0)


def _shower(b: PieceBuilder, v: Values) -> None:
    """Make a cabin: a tray, walls of glass at two sides, a door of glass that turns."""
    s, h = v.cabin, v.tall
    tray = tub((s, s, 0.1), wall=0.04, floor=0.06, radius=0.02, slope=0.02)
    b.form(ENAMEL, tray, collides="none", volume=0.01)
    tub_walls(b, (s, s, 0.1), wall=0.04, floor=0.06, slope=0.02)
    drain(b, 0.0, 0.0, 0.061)
    pane = glass(v.tint, 0.06)
    wall, edge = s / 2 - 0.02, 0.1
    mid = (h + edge) / 2
    with b.part("pane", "shower"):
        b.box(pane, (s - 0.05, 0.008, h - edge - 0.01), (0.0, wall, mid - 0.005), bevel=0.002)
    for x, y in ((wall, wall), (wall, -wall), (-wall, wall)):
        b.box(v.metal, (0.022, 0.022, h - edge), (x, y, mid))
    for x, y, size in (
        (wall, 0.0, (0.022, s - 0.06, 0.025)),
        (0.0, wall, (s - 0.06, 0.022, 0.025)),
    ):
        b.box(v.metal, size, (x, y, h - 0.0125))
    at = (wall + 0.006, -wall + 0.016, mid)
    axis = (0.0, 0.0, -1.0)
    with b.hinge("door", "door", at=at, axis=axis, opens_deg=95.0, friction=0.4, detents=MAGNET):
        leaf = s - 0.04 - 0.05
        b.box(pane, (0.008, leaf, h - edge - 0.06), (wall, 0.0, mid - 0.005), bevel=0.002)
        with b.part("handle", "handle"):
            y = leaf / 2 - 0.06
            bar = [(wall + 0.045, y, mid - 0.15), (wall + 0.045, y, mid + 0.15)]
            b.form(v.metal, swept(bar, 0.009, sides=12))
            for z in (mid - 0.12, mid + 0.12):
                stub = [(wall, y, z), (wall + 0.045, y, z)]
                b.form(v.metal, swept(stub, 0.006, sides=8), collides="none")
    back = -wall
    with b.part("shower head", "shower"):
        rod = curve(
            [(back, 0, 0.9), (back, 0, 1.9), (back + 0.08, 0, 2.02), (back + 0.3, 0, 2.0)], 24
        )
        b.form(v.metal, swept(rod, 0.01, sides=10), collides="none")
        head = [(0, -0.02), (v.head, -0.02), (v.head, -0.008), (0.02, 0.0), (0, 0.0)]
        b.form(v.metal, turned(head, segments=32), (back + 0.3, 0.0, 1.995))
    with b.frame((back, 0.0, 1.0)):
        body = [(0, -0.12), (0.02, -0.12), (0.022, -0.1), (0.022, 0.1), (0.02, 0.12), (0, 0.12)]
        b.form(
            v.metal, turned(body, segments=18), (0.03, 0.0, 0.0), turn=(90, 0, 0), collides="none"
        )


_SHARED = {
    "depth": Span(0.7, 0.8),
    "length": Span(1.6, 1.8),
    "height": Span(0.54, 0.6),
    "waist": Choice(True, False),
    "metal": Choice(metal("chrome"), metal("brass"), metal("#26272a")),
    "outside": Choice(
        ENAMEL,
        ENAMEL,
        *(paint(c, 0.3, 1200.0) for c in ("#2b2d30", "#3f5a4a", "#2f4257", "#b98f74")),
    ),
    "tap_yaw": 0.0,
}

FAMILY = Family(
    name="bath",
    category="bathtub",
    least_m=(0.65, 0.75, 0.5),
    most_m=(1.3, 2.0, 2.3),
    styles={
        "built_in": Style(
            _built,
            {
                **_SHARED,
                "rim": Span(0.06, 0.08),
                "side": Choice(
                    *(paint(c, 0.25) for c in ("#e9e7e2", "#7f9a93", "#33475a", "#b98f74")),
                    wood("oak"),
                    wood("teak"),
                ),
                "screen": Choice(True, False),
                "spout": Choice("arc", "straight", "pillar"),
            },
        ),
        "oval": Style(_oval, _SHARED),
        "claw_foot": Style(
            _claw,
            {
                **_SHARED,
                "height": Span(0.58, 0.64),
                "metal": Choice(metal("brass"), metal("chrome"), metal("bronze")),
            },
        ),
        "wooden": Style(
            _wooden,
            {
                **_SHARED,
                "depth": Span(0.8, 1.0),
                "stretch": Choice(1.0, 1.25),
                "staves": Choice(28, 36),
                "timber": Choice(*WOODS),
            },
        ),
        "shower": Style(
            _shower,
            {
                **_SHARED,
                "cabin": Span(0.8, 1.0),
                "tall": Span(2.05, 2.12),
                "head": Span(0.08, 0.13),
                "tint": Choice("#dfe8e6", "#b9c6c9", "#8d9a96"),
            },
            "shower",
        ),
    },
)
