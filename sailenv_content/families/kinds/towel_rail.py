"""Rails for towels: a bar, a ring, two arms that swing, a rack with a shelf, hooks."""

from __future__ import annotations

import numpy as np

from sailenv_content.families.bedding import draped
from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.draping import hanging, straight
from sailenv_content.families.family import Family, Style
from sailenv_content.families.materials import PieceMaterial, fabric, metal, wood
from sailenv_content.families.parameters import Choice, Span, Values
from sailenv_content.families.shaping import cushion, placed, swept, turned

__all__ = ["FAMILY"]


def _plate(b: PieceBuilder, v: Values, y: float, z: float, out: float) -> None:
    """Add a round plate on the wall with an arm out of it."""
    rows = [(0, 0), (0.026, 0), (0.026, 0.005), (0.012, 0.01), (0.01, 0.02), (0, 0.02)]
    b.form(v.metal, turned(rows, segments=22), (0.0, y, z), turn=(0.0, 90.0, 0.0))
    b.form(v.metal, swept([(0.01, y, z), (out, y, z)], 0.007, sides=12))


def _towel(
    b: PieceBuilder, cloth: PieceMaterial, x: float, y: float, z: float, wide: float, hang: float
) -> None:
    """Lay a towel over a rod along y at a height."""
    with b.part("towel", "towel"):
        mesh = draped(b, wide, 0.024, hang=hang, thick=0.007, puff=0.002, tile_m=0.03)
        b.form(cloth, placed(mesh, turn_deg=(0.0, 0.0, 90.0)), (x, y, z + 0.004), collides="none")
        b.collide((0.05, wide, hang), (x, y, z - hang / 2))


def _bar(b: PieceBuilder, v: Values) -> None:
    """Hold one bar or two on two arms."""
    w, z = v.width, v.hang + 0.03
    for row in range(v.bars):
        x, up = 0.07 + 0.075 * row, z + 0.055 * (v.bars - 1 - row)
        for sign in (-1.0, 1.0):
            _plate(b, v, sign * w / 2, up, x)
        b.form(v.metal, swept([(x, -w / 2 - 0.008, up), (x, w / 2 + 0.008, up)], 0.009, sides=14))
    for cloth, share in ((v.cloth, -0.24), (v.second, 0.24)):
        if share < 0 or v.two:
            x = 0.07 + 0.075 * (v.bars - 1)
            _towel(b, cloth, x, share * w, z + 0.009, 0.4 * w, v.hang * b.between(0.75, 1.0))


def _ring(b: PieceBuilder, v: Values) -> None:
    """Hang a ring from a stub; it swings."""
    r, z = v.radius, v.hang + 2.0 * v.radius
    _plate(b, v, 0.0, z + 0.012, 0.05)
    at = (0.05, 0.0, z + 0.012)
    with b.hinge("ring", "handle", at=at, axis=(0, 1, 0), opens_deg=40.0, friction=0.05):
        turn = np.linspace(0, 2 * np.pi, 41)
        path = np.stack([np.full(41, 0.05), r * np.sin(turn), z - r + r * np.cos(turn)], -1)
        b.form(v.metal, swept(path, 0.005, sides=8), collides="none")
        b.collide((0.012, 2 * r, 0.012), (0.05, 0.0, z - 2 * r))
        low = z - 2 * r + 0.004
        with b.part("towel", "towel"):
            for x, reach in ((0.063, 0.95), (0.041, 0.85)):
                rows = straight(low - reach * v.hang, low, 0.0, 1.7 * r, 9)
                rows[:, 2] = np.linspace(1.9 * r, 1.0 * r, 9)
                mesh = hanging(
                    rows, folds=3, depth=0.011, top_depth=0.014, thick=0.006, tile_m=0.03,
                    phase=b.between(0, 6),
                )  # fmt: skip
                b.form(v.cloth, mesh, (x, 0.0, 0.0), collides="none")


def _arms(b: PieceBuilder, v: Values) -> None:
    """Hinge arms on one post, which swing aside, with a towel on each."""
    z, reach = v.hang + 0.06, 0.36
    b.box(v.metal, (0.014, 0.04, 0.19), (0.007, 0.0, z + 0.02), bevel=0.004)
    b.form(v.metal, swept([(0.03, 0, z - 0.06), (0.03, 0, z + 0.1)], 0.009, sides=14))
    for number in range(v.arms):
        up = z - 0.03 + 0.045 * number
        yaw = (number - (v.arms - 1) / 2) * 26.0
        at = (0.03, 0.0, up)
        with (
            b.hinge(
                f"arm {number + 1}", "handle", at=at, axis=(0, 0, 1), opens_deg=40.0, friction=0.2
            ),
            b.frame(at, yaw),
        ):
            b.form(v.metal, swept([(0.012, 0, 0), (reach, 0, 0)], 0.006, sides=12))
            tip = turned([(0, 0), (0.01, 0), (0.01, 0.008), (0, 0.01)], segments=14)
            b.form(v.metal, tip, (reach, 0, 0), turn=(0, 90, 0), collides="none")
            if number % 2 == 0 or v.two:
                with b.part("towel", "towel"):
                    cloth = (v.cloth, v.second)[number % 2]
                    long = v.hang * b.between(0.75, 0.95)
                    mesh = draped(b, 0.22, 0.016, hang=long, thick=0.006, puff=0.001, tile_m=0.03)
                    b.form(cloth, mesh, (0.2, 0.0, 0.009), collides="none")


def _rack(b: PieceBuilder, v: Values) -> None:
    """Lay folded towels on a shelf of rods, over a bar."""
    w, z, d = v.width, v.hang + 0.15, 0.22
    for sign in (-1.0, 1.0):
        y = sign * w / 2
        path = [
            (0.0, y, z),
            (d, y, z),
            (d + 0.02, y, z - 0.03),
            (0.09, y, z - 0.11),
            (0.0, y, z - 0.12),
        ]
        b.form(v.metal, swept(path, 0.007, sides=10))
    for number in range(5):
        x = 0.03 + number * (d - 0.03) / 4
        b.form(v.metal, swept([(x, -w / 2, z), (x, w / 2, z)], 0.005, sides=10))
    low = z - 0.11
    b.form(v.metal, swept([(0.09, -w / 2, low), (0.09, w / 2, low)], 0.007, sides=12))
    _towel(b, v.cloth, 0.09, b.between(-0.1, 0.1) * w, low + 0.007, 0.5 * w, v.hang)
    with b.part("towels", "towel"):
        top = z + 0.006
        for _ in range(v.pile):
            thick = b.between(0.035, 0.05)
            cloth = b.pick(v.cloth, v.second)
            size = (d - 0.03, 0.5 * w * b.between(0.94, 1.0), thick)
            mesh = cushion(size, radius=0.016, puff=0.003, tile_m=0.03, steps=6)
            b.form(cloth, mesh, (d / 2 + 0.01, 0.0, top + thick / 2), collides="none")
            top += 0.94 * thick
        b.collide((d - 0.03, 0.5 * w, top - z), (d / 2 + 0.01, 0.0, (top + z) / 2))


def _hooks(b: PieceBuilder, v: Values) -> None:
    """Hang towels from hooks on a board."""
    w, z = v.width, v.hang + 0.04
    b.box(v.board, (0.02, w, 0.09), (0.01, 0.0, z + 0.03), bevel=0.004)
    count = v.count
    for number in range(count):
        y = (number - (count - 1) / 2) * w / count
        path = [
            (0.02, y, z + 0.045),
            (0.05, y, z + 0.02),
            (0.066, y, z + 0.03),
            (0.068, y, z + 0.055),
        ]
        b.form(v.metal, swept(path, 0.0055, sides=10))
        if b.chance(0.75) or number == 0:
            cloth = b.pick(v.cloth, v.second)
            with b.part("towel", "towel"):
                low, high = z - v.hang * b.between(0.75, 0.98), z + 0.032
                rows = straight(low, high, y, 0.1, 11)
                share = np.linspace(0, 1, 11)
                rows[:, 2] = 0.3 * w / count * (1.6 - 1.4 * share**2) + 0.02
                mesh = hanging(
                    rows, folds=3, depth=0.018, top_depth=0.01, thick=0.007, tile_m=0.03,
                    phase=b.between(0, 6),
                )  # fmt: skip
                b.form(cloth, mesh, (0.052, 0.0, 0.0), collides="none")
                b.collide((0.03, 0.08, high - low), (0.052, y, (low + high) / 2))


_TOWELS = tuple(
    fabric(c)
    for c in (
        "#efece4",
        "#8fa0a8",
        "#b9a892",
        "#566273",
        "#a8715c",
        "#7f8f7a",
        "#d9b9a6",
        "#3f5a5c",
    )
)
_SHARED = {
    "width": Span(0.5, 0.7),
    "hang": Span(0.34, 0.5),
    "metal": Choice(metal("chrome"), metal("brass"), metal("#26272a"), metal("steel")),
    "cloth": Choice(*_TOWELS),
    "second": Choice(*_TOWELS),
    "two": Choice(True, False),
}

FAMILY = Family(
    name="towel_rail",
    category="towel",
    least_m=(0.04, 0.08, 0.2),
    most_m=(0.5, 0.9, 0.9),
    styles={
        "bar": Style(_bar, {**_SHARED, "bars": Choice(1, 2)}),
        "ring": Style(_ring, {**_SHARED, "radius": Span(0.075, 0.095)}),
        "arms": Style(_arms, {**_SHARED, "arms": Choice(2, 3)}),
        "rack": Style(_rack, {**_SHARED, "pile": Choice(2, 3, 4)}),
        "hooks": Style(
            _hooks,
            {
                **_SHARED,
                "count": Choice(3, 4),
                "board": Choice(wood("oak"), wood("walnut"), wood("birch")),
            },
        ),
    },
)
