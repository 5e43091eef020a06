"""Office chairs: on five castors, with mesh, leather, shell or wooden seats."""

from __future__ import annotations

import numpy as np

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.family import Family, Style
from sailenv_content.families.materials import FABRICS, LEATHERS, PieceMaterial, metal, paint, wood
from sailenv_content.families.parameters import Choice, Span, Values
from sailenv_content.families.shaping import ribbon, swept, turned
from sailenv_content.families.upholstery import pad
from sailenv_content.procedural.forms import curve

__all__ = ["FAMILY"]


def _base(b: PieceBuilder, v: Values, height: float) -> None:
    """Add a star of five arms on castors, and a column."""
    steel = v.base
    black = paint("#1b1c1e", 0.5, 1100.0)
    for angle in np.arange(5) * 2 * np.pi / 5 + 0.3:
        c, s = float(np.cos(angle)), float(np.sin(angle))
        b.form(
            steel,
            swept(
                [(0.03 * c, 0.03 * s, 0.1), (0.29 * c, 0.29 * s, 0.075)], (0.026, 0.016), sides=10
            ),
        )
        wheel = [
            (0.0, -0.018),
            (0.024, -0.018),
            (0.027, -0.012),
            (0.027, 0.012),
            (0.024, 0.018),
            (0.0, 0.018),
        ]
        b.form(
            black,
            turned(wheel, segments=18),
            (0.29 * c, 0.29 * s, 0.027),
            turn=(90.0, 0.0, float(np.degrees(angle)) + 40.0),
        )
        b.form(
            black,
            swept([(0.29 * c, 0.29 * s, 0.045), (0.29 * c, 0.29 * s, 0.08)], 0.011, sides=8),
            collides="none",
        )
    b.form(black, swept([(0, 0, 0.09), (0, 0, 0.26)], 0.027, sides=16))
    b.form(metal("chrome"), swept([(0, 0, 0.24), (0, 0, height - 0.05)], 0.016, sides=14))
    b.box(black, (0.2, 0.15, 0.04), (0.0, 0.0, height - 0.045), bevel=0.008)
    b.form(
        black,
        swept(
            [(0.03, -0.06, height - 0.05), (0.03, -0.23, height - 0.055)], (0.006, 0.01), sides=8
        ),
        collides="none",
    )


def _arms(b: PieceBuilder, v: Values, material: PieceMaterial, z: float) -> None:
    if not v.arms:
        return
    for sy in (-1.0, 1.0):
        y = sy * (v.width / 2 + 0.035)
        line = [(0.0, sy * v.width * 0.3, z - 0.05), (0.0, y, z - 0.045), (0.0, y, z + 0.19)]
        b.form(material, swept(curve(line, 10), 0.016, sides=10), collides="none")
        pad(
            b,
            paint("#202124", 0.7, 400.0),
            (0.25, 0.07, 0.03),
            (0.01, y, z + 0.2),
            puff=0.004,
            radius=0.014,
        )


def _task(b: PieceBuilder, v: Values) -> None:
    """Make a padded seat and a narrow back on a curved bar."""
    z = v.height
    _base(b, v, z)
    black = paint("#1b1c1e", 0.5, 1100.0)
    pad(b, v.cover, (v.depth, v.width, 0.07), (0.02, 0.0, z), puff=0.014, radius=0.034)
    bar = curve(
        [
            (-0.05, 0, z - 0.05),
            (-v.depth / 2 - 0.03, 0, z - 0.03),
            (-v.depth / 2 - 0.07, 0, z + 0.1),
            (-v.depth / 2 - 0.08, 0, z + v.back * 0.7),
        ],
        16,
    )
    b.form(black, swept(bar, 0.019, sides=10), collides="none")
    pad(
        b,
        v.cover,
        (0.06, v.width * 0.9, v.back - 0.12),
        (-v.depth / 2 - 0.035, 0.0, z + 0.14 + (v.back - 0.12) / 2),
        puff=0.02,
        radius=0.029,
        turn=(0.0, -7.0, 0.0),
    )
    _arms(b, v, black, z)


def _mesh(b: PieceBuilder, v: Values) -> None:
    """Make a frame with a net between, a head rest for some."""
    z = v.height
    _base(b, v, z)
    black = paint("#24262a", 0.45, 1100.0)
    pad(b, v.cover, (v.depth, v.width, 0.06), (0.02, 0.0, z), puff=0.012, radius=0.029)
    x, w, top = -v.depth / 2 - 0.03, v.width * 0.46, v.back + 0.08
    ring = curve(
        [
            (x - 0.02, -w, z + 0.1),
            (x + 0.02, -w * 1.05, z + 0.35),
            (x - 0.06, -w * 0.9, z + top),
            (x - 0.06, w * 0.9, z + top),
            (x + 0.02, w * 1.05, z + 0.35),
            (x - 0.02, w, z + 0.1),
        ],
        40,
        closed=True,
    )
    b.form(black, swept(np.concatenate([ring, ring[:1]]), 0.013, sides=8), collides="none")
    net = paint("#3a3d42", 0.95, 100.0)
    low = np.linspace(0.1, top, 14)
    bow = x + 0.03 * np.sin(np.pi * low / top * 1.3) - 0.05 * (low / top) ** 2
    line = np.stack([bow, z + low], -1)
    b.form(net, ribbon(line, 2 * w, 0.004, dish=0.02, round_m=0.03), collides="none", volume=0.001)
    b.collide((0.03, 2 * w, top - 0.08), (x, 0.0, z + top / 2 + 0.05), (0.0, -6.0, 0.0))
    b.form(
        black,
        swept(
            curve([(-0.04, 0, z - 0.05), (x - 0.07, 0, z), (x - 0.07, 0, z + top * 0.6)], 12),
            0.02,
            sides=10,
        ),
        collides="none",
    )
    if v.head:
        pad(
            b,
            v.cover,
            (0.045, 0.27, 0.13),
            (x - 0.06, 0.0, z + top + 0.12),
            puff=0.012,
            radius=0.02,
            turn=(0.0, -10.0, 0.0),
        )
        b.form(
            black,
            swept([(x - 0.07, 0, z + top - 0.02), (x - 0.075, 0, z + top + 0.1)], 0.009, sides=8),
            collides="none",
        )
    _arms(b, v, black, z)


def _executive(b: PieceBuilder, v: Values) -> None:
    """Make a tall padded back in sections."""
    z = v.height
    _base(b, v, z)
    pad(
        b,
        v.cover,
        (v.depth + 0.03, v.width + 0.03, 0.11),
        (0.02, 0.0, z + 0.01),
        puff=0.026,
        radius=0.05,
    )
    x, each = -v.depth / 2 - 0.02, (v.back + 0.2) / 3
    for number in range(3):
        at = (x - 0.02 - 0.035 * number, 0.0, z + 0.1 + (number + 0.5) * each)
        pad(
            b,
            v.cover,
            (0.1, (v.width + 0.02) * (1.0 - 0.07 * number), each - 0.004),
            at,
            puff=0.02,
            radius=0.045,
            turn=(0.0, -9.0, 0.0),
        )
    frame = metal("chrome") if v.arms else metal("#1f2022")
    for sy in (-1.0, 1.0):
        y = sy * (v.width / 2 + 0.045)
        line = curve(
            [
                (0.16, sy * v.width * 0.42, z - 0.03),
                (0.2, y, z + 0.06),
                (0.13, y, z + 0.22),
                (-0.05, y, z + 0.23),
                (x, sy * v.width * 0.47, z + 0.2),
            ],
            22,
        )
        b.form(frame, swept(line, 0.014, sides=10), collides="none")
        pad(b, v.cover, (0.22, 0.05, 0.03), (0.03, y, z + 0.245), puff=0.006, radius=0.014)


def _shell(b: PieceBuilder, v: Values) -> None:
    """Make a bent shell of wood or plastic on castors."""
    z = v.height
    _base(b, v, z)
    d = v.depth
    line = curve(
        [
            (d / 2 + 0.01, 0, z - 0.02),
            (d * 0.2, 0, z),
            (-d * 0.3, 0, z - 0.015),
            (-d * 0.46, 0, z + 0.07),
            (-d * 0.54, 0, z + 0.25),
            (-d * 0.6, 0, z + v.back * 0.85),
        ],
        24,
    )[:, [0, 2]]
    share = np.linspace(0, 1, 24)
    widths = v.width * (1.0 - 0.25 * np.exp(-(((share - 0.5) / 0.12) ** 2)))
    b.form(
        v.shell,
        ribbon(line[::-1], widths[::-1], 0.012, dish=-0.02, round_m=0.07, tile_m=v.shell.tile_m),
        collides="none",
        volume=0.004,
    )
    b.collide((d * 0.95, v.width * 0.9, 0.03), (0.0, 0.0, z - 0.015))
    b.collide(
        (0.02, v.width * 0.8, v.back * 0.7), (-d * 0.55, 0.0, z + v.back * 0.5), (0.0, -9.0, 0.0)
    )
    if v.arms:
        pad(
            b,
            v.cover,
            (d * 0.82, v.width * 0.8, 0.03),
            (0.02, 0.0, z + 0.016),
            puff=0.008,
            radius=0.014,
        )


_SHARED = {
    "height": Span(0.44, 0.5),
    "depth": Span(0.43, 0.48),
    "width": Span(0.45, 0.5),
    "back": Span(0.46, 0.58),
    "arms": Choice(True, False),
    "cover": Choice(*FABRICS[:6], *LEATHERS, paint("#222326", 0.9, 80.0)),
    "base": Choice(metal("chrome"), metal("#1f2022"), metal("#e4e3df")),
}

FAMILY = Family(
    name="office_chair",
    category="chair",
    least_m=(0.5, 0.45, 0.75),
    most_m=(0.85, 0.8, 1.4),
    styles={
        "task": Style(_task, _SHARED),
        "mesh": Style(_mesh, {**_SHARED, "head": Choice(True, False)}),
        "executive": Style(_executive, {**_SHARED, "cover": Choice(*LEATHERS, *FABRICS[:3])}),
        "shell": Style(
            _shell,
            {
                **_SHARED,
                "shell": Choice(
                    wood("oak"),
                    wood("walnut"),
                    wood("beech"),
                    paint("#e9e6df"),
                    paint("#2a2c2f"),
                    paint("#5d7b78"),
                ),
            },
        ),
    },
)
