"""Jars, cans, a shaker, a teapot, a tray."""

from __future__ import annotations

import numpy as np

from sailenv_content.procedural import forms
from sailenv_content.procedural.prints import Sheet
from sailenv_content.procedural.shapes import painted_part, printed_part
from sailenv_ros.assets.model_files import RawPart

__all__ = ["can", "cookie_jar", "jam_jar", "shaker", "teapot", "tray"]


def jam_jar() -> list[RawPart]:
    """Return a jar of jam with a chequered lid and a label."""
    body = forms.lathe(
        [
            (0.0, 0.0),
            (0.029, 0.0),
            (0.033, 0.004),
            (0.034, 0.012),
            (0.034, 0.070),
            (0.030, 0.079),
            (0.029, 0.084),
            (0, 0.084),
        ],
        36,
    )
    lid = forms.lathe(
        [(0.031, 0.081), (0.0335, 0.082), (0.0335, 0.094), (0.031, 0.0965), (0.0, 0.0970)], 36
    )
    checks = Sheet(240, 120, (0.93, 0.92, 0.90))
    for column in range(24):
        for row in range(12):
            if (column + row) % 2:
                checks.box(
                    column / 24, row / 12, (column + 1) / 24, (row + 1) / 12, (0.72, 0.12, 0.14)
                )
    label = Sheet(360, 160, (0.94, 0.91, 0.82))
    label.box(0.03, 0.06, 0.97, 0.94, (0.45, 0.10, 0.14)).box(
        0.045, 0.10, 0.955, 0.90, (0.94, 0.91, 0.82)
    )
    label.text("Cherry Jam", 0.5, 0.36, 0.22, (0.40, 0.08, 0.12)).lines(
        0.3, 0.66, 0.74, 2, 0.12, (0.5, 0.45, 0.4)
    )
    turn = np.linspace(np.radians(-62), np.radians(62), 20)
    arc = np.stack([0.0343 * np.cos(turn), 0.0343 * np.sin(turn)], -1)
    rings = [np.c_[arc, np.full(20, z)] for z in (0.018, 0.062)]
    return forms.standing(
        [
            painted_part("jam", body, "#5a0d14", roughness=0.08),
            printed_part("lid", lid, checks.texture(), roughness=0.35),
            printed_part(
                "label", forms.loft(np.array(rings), closed=False, caps=False), label.texture()
            ),
        ]
    )


def cookie_jar() -> list[RawPart]:
    """Return a stoneware jar with a wooden lid."""
    body = forms.lathe(
        [
            (0.0, 0.0),
            (0.050, 0.0),
            (0.056, 0.005),
            (0.0575, 0.030),
            (0.0575, 0.105),
            (0.054, 0.120),
            (0.0515, 0.124),
            (0.048, 0.124),
            (0, 0.118),
        ],
        40,
    )
    band = forms.lathe([(0.0577, 0.050), (0.0581, 0.051), (0.0581, 0.078), (0.0577, 0.079)], 40)
    lid = forms.lathe(
        [(0.0, 0.118), (0.0530, 0.1242), (0.0530, 0.134), (0.0510, 0.137), (0.0, 0.138)], 40
    )
    knob = forms.lathe(
        [
            (0.006, 0.137),
            (0.006, 0.146),
            (0.012, 0.152),
            (0.013, 0.158),
            (0.009, 0.164),
            (0, 0.165),
        ],
        24,
    )
    return forms.standing(
        [
            painted_part("glaze ceramic", body, "#d9d2c2", roughness=0.2),
            painted_part("band ceramic", band, "#3d5a72"),
            painted_part("lid wood", lid, "#a9773f"),
            painted_part("knob wood", knob, "#9a6a36"),
        ]
    )


def can() -> list[RawPart]:
    """Return a can of lemonade."""
    body = forms.lathe(
        [
            (0.0255, 0.0),
            (0.0270, 0.002),
            (0.0327, 0.011),
            (0.0330, 0.014),
            (0.0330, 0.100),
            (0.0325, 0.103),
        ],
        36,
    )
    ends = forms.lathe([(0.0, 0.004), (0.021, 0.004), (0.0245, 0.0), (0.0262, 0.0005)], 36)
    top = forms.lathe(
        [
            (0.0325, 0.103),
            (0.0265, 0.1125),
            (0.0270, 0.1150),
            (0.0262, 0.1155),
            (0.0252, 0.1125),
            (0, 0.1122),
        ],
        36,
    )
    print_ = Sheet(600, 330, (0.85, 0.2, 0.1)).shade((0.95, 0.80, 0.15), (0.92, 0.62, 0.10))
    for x in (0.25, 0.75):
        print_.disc(x, 0.46, 0.30, (0.97, 0.95, 0.88)).disc(x, 0.46, 0.27, (0.20, 0.45, 0.22))
        print_.text("LIMO", x, 0.44, 0.15, (0.98, 0.94, 0.60)).text(
            "cool lemon", x, 0.58, 0.055, (0.95, 0.95, 0.9)
        )
    print_.lines(0.44, 0.3, 0.56, 9, 0.045, (0.5, 0.35, 0.1))
    tab = forms.moved(
        forms.slab(forms.rectangle(0.013, 0.024, 0.006), 0.0010, 0.0004), (0.004, 0.0, 0.1128)
    )
    return forms.standing(
        [
            printed_part(
                "print", forms.moved(body, turn_deg=(0, 0, 90)), print_.texture(), roughness=0.3
            ),
            painted_part("end alu", ends, "#b9bbbd"),
            painted_part("top alu", top, "#c0c2c4"),
            painted_part("tab alu", tab, "#a5a7aa"),
        ]
    )


def shaker() -> list[RawPart]:
    """Return a salt shaker of glazed ceramic with a steel top."""
    body = forms.lathe(
        [(0.0, 0.0), (0.021, 0.0), (0.0225, 0.003), (0.019, 0.030), (0.0165, 0.052), (0, 0.052)], 30
    )
    top = forms.lathe(
        [(0.0172, 0.050), (0.0178, 0.052), (0.0178, 0.062), (0.013, 0.070), (0.0, 0.073)], 30
    )
    holes = [
        forms.ellipsoid(
            (0.0011, 0.0011, 0.0006), (0.0058 * np.cos(a), 0.0058 * np.sin(a), 0.0719), 8
        )
        for a in np.linspace(0, 2 * np.pi, 6, endpoint=False)
    ]
    return forms.standing(
        [
            painted_part("glaze ceramic", body, "#e3e0d8"),
            painted_part("top steel", top, "#b7b9bb"),
            painted_part(
                "hole",
                forms.merged([*holes, forms.ellipsoid((0.0011, 0.0011, 0.0006), (0, 0, 0.073), 8)]),
                "#151515",
            ),
        ]
    )


def teapot() -> list[RawPart]:
    """Return a teapot of glazed stoneware."""
    profile = forms.curve(
        [
            (0.045, 0, 0.0),
            (0.060, 0, 0.010),
            (0.080, 0, 0.050),
            (0.074, 0, 0.085),
            (0.050, 0, 0.106),
            (0.040, 0, 0.110),
        ],
        26,
    )[:, [0, 2]]
    body = forms.lathe(np.concatenate([[[0.0, 0.0]], profile, [[0.0, 0.108]]]), 44)
    lid = forms.lathe(
        [
            (0.0415, 0.110),
            (0.0420, 0.113),
            (0.032, 0.121),
            (0.012, 0.1255),
            (0.0065, 0.128),
            (0.0065, 0.131),
            (0.0115, 0.136),
            (0.0110, 0.143),
            (0.006, 0.146),
            (0, 0.1465),
        ],
        36,
    )
    spout = forms.tube(
        forms.curve(
            [(0.066, 0, 0.040), (0.096, 0, 0.056), (0.112, 0, 0.090), (0.132, 0, 0.108)], 22
        ),
        np.interp(np.arange(22), [0, 6, 16, 21], [0.022, 0.017, 0.0105, 0.0100]),
        sides=16,
    )
    handle = forms.tube(
        forms.curve(
            [
                (-0.066, 0, 0.088),
                (-0.098, 0, 0.100),
                (-0.122, 0, 0.080),
                (-0.114, 0, 0.046),
                (-0.074, 0, 0.030),
            ],
            28,
        ),
        0.0075,
        sides=12,
    )
    opening = forms.moved(
        forms.lathe([(0.0075, 0.0), (0.0, 0.0006)], 18), (0.1325, 0, 0.1085), (0, 52, 0)
    )
    return forms.standing(
        [
            painted_part("glaze ceramic", m, "#2f5a5c", roughness=0.15)
            for m in (body, lid, spout, handle)
        ]
        + [painted_part("opening", opening, "#0c1414")]
    )


def tray() -> list[RawPart]:
    """Return a wooden serving tray with handles."""
    board = forms.slab(forms.rectangle(0.42, 0.28, 0.018), 0.010, 0.002)
    outline = np.c_[forms.rectangle(0.42, 0.28, 0.018), np.zeros(28)]
    inner = outline * [0.935, 0.955, 1.0]
    low, high = np.array([0.0, 0.0, 0.004]), np.array([0.0, 0.0, 0.045])
    wall = forms.loft(
        np.array([outline + low, outline + high, inner + high, inner + low]), caps=False
    )
    grips = [
        forms.tube(
            forms.curve(
                [
                    (-0.045, s * 0.205, 0.043),
                    (-0.040, s * 0.207, 0.070),
                    (0.040, s * 0.207, 0.070),
                    (0.045, s * 0.205, 0.043),
                ],
                24,
            ),
            0.0058,
            sides=10,
        )
        for s in (1.0, -1.0)
    ]
    return forms.standing(
        [
            painted_part("board wood", board, "#9c6b3a"),
            painted_part("wall wood", wall, "#8a5c30"),
            *(painted_part("grip metal", grip, "#3a3a3c") for grip in grips),
        ]
    )
