"""Toys on wheels: trains with wagons, cars, vans, lorries that tip."""

from __future__ import annotations

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.materials import PieceMaterial, metal, paint, wood
from sailenv_content.families.parameters import Values
from sailenv_content.families.shaping import placed, swept, turned
from sailenv_content.families.toys import BLACK, GAY, blob

__all__ = ["car", "train"]


def _wheel(
    b: PieceBuilder, material: PieceMaterial, radius: float, at: tuple[float, float, float],
    wide: float = 0.012, hub: PieceMaterial | None = None,
) -> None:  # fmt: skip
    rows = [
        (0, 0),
        (radius - 0.002, 0),
        (radius, 0.002),
        (radius, wide - 0.002),
        (radius - 0.002, wide),
        (0, wide),
    ]
    mesh = placed(turned(rows, segments=24), (0.0, 0.0, -wide / 2))
    mesh = placed(mesh, turn_deg=(90.0, 0.0, 0.0))
    b.form(material, mesh, at)
    cap = placed(
        turned(
            [(0, 0), (0.4 * radius, 0), (0.3 * radius, wide + 0.006), (0, wide + 0.006)],
            segments=14,
        ),
        (0, 0, -wide / 2 - 0.003),
    )
    b.form(hub or metal("steel"), placed(cap, turn_deg=(90.0, 0, 0)), at, collides="none")


def train(b: PieceBuilder, v: Values) -> None:
    """Carve an engine with a chimney, and wagons with loads."""
    w, r = v.gauge, 0.2 * v.gauge
    long, gap = 1.55 * w, 0.22 * w
    x, deck = 0.0, 1.35 * r
    for number in range(int(v.wagons) + 1):
        mine = b.pick(*v.colours)
        b.box(v.timber, (long, w, 0.16 * w), (x, 0.0, deck), bevel=0.003)
        for sx in (-0.3, 0.3):
            for sy in (-1.0, 1.0):
                _wheel(b, b.pick(*v.colours), r, (x + sx * long, sy * (w / 2 + 0.004), r), 0.1 * w)
        top = deck + 0.08 * w
        if not number:
            boiler = placed(
                turned(
                    [
                        (0, 0),
                        (0.3 * w, 0.0),
                        (0.3 * w, 0.92 * w),
                        (0.24 * w, 0.97 * w),
                        (0, 0.97 * w),
                    ],
                    segments=28,
                ),
                turn_deg=(0, 90, 0),
            )
            b.form(mine, boiler, (x - 0.25 * w, 0.0, top + 0.3 * w))
            cab = (0.52 * w, 0.86 * w, 0.85 * w)
            b.box(b.pick(*v.colours), cab, (x - 0.48 * w, 0.0, top + cab[2] / 2), bevel=0.004)
            roof = (0.66 * w, w, 0.08 * w)
            b.box(v.timber, roof, (x - 0.48 * w, 0.0, top + cab[2] + 0.04 * w), bevel=0.006)
            for sy in (-1.0, 1.0):
                pane = (0.26 * w, 0.004, 0.26 * w)
                at = (x - 0.48 * w, sy * (0.43 * w + 0.0005), top + 0.55 * w)
                b.box(BLACK, pane, at, bevel=0.001, collides=False)
            stack = [(0, 0), (0.1 * w, 0), (0.09 * w, 0.2 * w), (0.15 * w, 0.34 * w), (0, 0.34 * w)]
            b.form(
                b.pick(*v.colours), turned(stack, segments=18), (x + 0.48 * w, 0.0, top + 0.57 * w)
            )
            dome = [(0, 0), (0.1 * w, 0), (0.09 * w, 0.1 * w), (0, 0.14 * w)]
            b.form(
                metal("brass"),
                turned(dome, segments=16),
                (x + 0.12 * w, 0, top + 0.58 * w),
                collides="none",
            )
        elif b.chance(0.5):
            for row in (-0.24, 0.24):
                for level in (0.0, 0.3):
                    rod = placed(
                        turned(
                            [(0, 0), (0.15 * w, 0), (0.15 * w, 1.3 * w), (0, 1.3 * w)], segments=16
                        ),
                        turn_deg=(0, 90, 0),
                    )
                    at = (
                        x - 0.65 * w,
                        (row if not level else 0.0) * w,
                        top + (0.16 + level * 0.9) * w,
                    )
                    if level and row > 0:
                        continue
                    b.form(wood("birch"), rod, at)
        else:
            side = 0.34 * w
            for sy in (-1.0, 1.0):
                b.box(mine, (long, 0.06 * w, side), (x, sy * 0.46 * w, top + side / 2), bevel=0.002)
            for sx in (-1.0, 1.0):
                b.box(
                    mine,
                    (0.06 * w, 0.86 * w, side),
                    (x + sx * 0.47 * long, 0.0, top + side / 2),
                    bevel=0.002,
                )
            for spot in range(4):
                c = 0.3 * w
                at = (x + (spot - 1.5) * 0.36 * w, b.between(-0.15, 0.15) * w, top + c / 2)
                turn = (0, 0, b.between(-8, 8))
                b.box(b.pick(*GAY), (c, c, c), at, turn=turn, bevel=0.002)
        x -= long + gap
        if number < v.wagons:
            hook = [(x + long / 2 + gap + 0.02, 0, deck), (x + long / 2 - 0.02, 0, deck)]
            b.form(metal("brass"), swept(hook, 0.05 * w, sides=8), collides="none")


def car(b: PieceBuilder, v: Values) -> None:
    """Make a car, a van or a lorry with a tipping bed."""
    w, r = v.gauge, 0.24 * v.gauge
    long = {"car": 2.1, "van": 2.2, "lorry": 2.6}[v.body] * w
    for sx in (-0.31, 0.31):
        for sy in (-1.0, 1.0):
            _wheel(b, BLACK, r, (sx * long, sy * 0.44 * w, r), 0.2 * w, v.second)
    base = 1.6 * r if v.body == "lorry" else 0.9 * r
    if v.body == "lorry":
        b.box(BLACK, (long, 0.6 * w, 0.12 * w), (0.0, 0.0, base + 0.06 * w), bevel=0.003)
        b.box(
            v.paint,
            (0.62 * w, 0.96 * w, 0.85 * w),
            (long / 2 - 0.31 * w, 0, base + 0.55 * w),
            bevel=0.012,
        )
        _panes(b, (long / 2 - 0.31 * w, 0.62 * w, 0.96 * w), base + 0.72 * w, 0.3 * w)
        at = (-long / 2 + 0.02 * w, 0.0, base + 0.16 * w)
        with b.hinge("bed", "toy", at=at, axis=(0, -1, 0), opens_deg=45.0, friction=0.05):
            bed = (1.75 * w, 0.96 * w, 0.05 * w)
            x = -long / 2 + bed[0] / 2
            b.box(v.second, bed, (x, 0.0, base + 0.155 * w), bevel=0.002)
            for sy in (-1.0, 1.0):
                b.box(
                    v.second,
                    (bed[0], 0.06 * w, 0.36 * w),
                    (x, sy * 0.45 * w, base + 0.36 * w),
                    bevel=0.003,
                )
            front = (x + bed[0] / 2 - 0.03 * w, 0.0, base + 0.36 * w)
            b.box(v.second, (0.06 * w, 0.84 * w, 0.36 * w), front, bevel=0.003)
        return
    tall = 0.42 * w if v.body == "car" else 0.6 * w
    b.box(v.paint, (long, 0.98 * w, tall), (0, 0, base + tall / 2), bevel=0.09 * w)
    roof = 0.34 * w
    span = 0.52 * long if v.body == "car" else 0.8 * long
    x = -0.05 * long if v.body == "car" else -0.08 * long
    z = base + tall + roof / 2 - 0.012
    b.box(v.paint, (span, 0.86 * w, roof), (x, 0.0, z), bevel=0.02, top=(0.74, 0.86))
    glass_size = (0.93 * span, 0.868 * w, 0.62 * roof)
    b.box(BLACK, glass_size, (x, 0.0, z), bevel=0.006, top=(0.84, 0.92), collides=False)
    glass_size = (1.004 * span * 0.9, 0.6 * w, 0.6 * roof)
    b.box(
        BLACK,
        (0.955 * span, 0.62 * w, 0.6 * roof),
        (x, 0.0, z),
        bevel=0.006,
        top=(0.84, 0.96),
        collides=False,
    )
    for sx in (-1.0, 1.0):
        b.box(
            v.second,
            (0.05 * w, 0.9 * w, 0.1 * w),
            (sx * (long / 2 - 0.005), 0.0, base + 0.08 * w),
            bevel=0.005,
            collides=False,
        )
        for sy in (-1.0, 1.0):
            lamp = paint("#f4e6b4" if sx > 0 else "#a82a22", 0.2)
            at = (sx * (long / 2 - 0.004), sy * 0.33 * w, base + 0.62 * tall)
            blob(b, lamp, (0.04 * w, 0.08 * w, 0.08 * w), at, collides=False)


def _panes(b: PieceBuilder, cab: tuple[float, float, float], z: float, tall: float) -> None:
    x, long, wide = cab
    b.box(BLACK, (long + 0.002, 0.8 * wide, tall), (x + 0.001, 0, z), bevel=0.003, collides=False)
    b.box(BLACK, (0.7 * long, wide + 0.002, tall), (x, 0, z), bevel=0.003, collides=False)
