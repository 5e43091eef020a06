"""Tools of a desk: a calculator, a stapler, tape, a ruler, lever arch files."""

from __future__ import annotations

import numpy as np

from sailenv_content.procedural import forms
from sailenv_content.procedural.prints import Sheet
from sailenv_content.procedural.shapes import box, painted_part, printed_part
from sailenv_ros.assets.model_files import RawPart

__all__ = ["binder", "calculator", "ruler", "stapler", "tape_roll"]


def calculator() -> list[RawPart]:
    """Return a pocket calculator."""
    body = forms.slab(forms.rectangle(0.078, 0.140, 0.008), 0.013, 0.004)
    screen = Sheet(280, 90, (0.66, 0.71, 0.62)).text("1248.50", 0.62, 0.55, 0.5, (0.1, 0.12, 0.1))
    parts = [
        painted_part("body plastic", body, "#3a3d42"),
        printed_part(
            "display",
            forms.moved(forms.panel(0.018, 0.060, 0.0), (-0.046, 0, 0.0134)),
            screen.texture(),
            roughness=0.1,
        ),
    ]
    for row in range(5):
        for column in range(4):
            is_last = column == 3
            colour = "#d9772b" if is_last and row == 4 else "#5c6067" if is_last else "#e6e5e0"
            key = forms.slab(forms.rectangle(0.0125, 0.0105, 0.002), 0.0045, 0.0012)
            place = (-0.020 + 0.0168 * row, -0.0255 + 0.017 * column, 0.0115)
            parts.append(painted_part("key plastic", forms.moved(key, place), colour))
    return forms.standing(parts)


def stapler() -> list[RawPart]:
    """Return a desk stapler."""
    base = forms.slab(forms.rectangle(0.036, 0.140, 0.010), 0.010, 0.003)
    side = np.array(
        [
            (-0.066, 0.018),
            (-0.066, 0.044),
            (-0.040, 0.052),
            (0.020, 0.047),
            (0.064, 0.036),
            (0.070, 0.030),
            (0.066, 0.024),
        ]
    )
    rings = []
    for y, size in (
        (-0.0165, 0.86),
        (-0.0150, 0.96),
        (-0.0110, 1.0),
        (0.0110, 1.0),
        (0.0150, 0.96),
        (0.0165, 0.86),
    ):
        middle = side.mean(axis=0)
        rings.append(
            np.stack(
                [
                    (side * size + middle * (1 - size))[:, 0],
                    np.full(len(side), y),
                    (side * size + middle * (1 - size))[:, 1],
                ],
                -1,
            )
        )
    handle = forms.loft(np.array(rings))
    magazine_box = box((0.124, 0.018, 0.010), (0.002, 0.0, 0.0165))
    hinge = forms.moved(
        forms.lathe([(0.006, -0.019), (0.006, 0.019)], 20), (-0.058, 0, 0.028), (90, 0, 0)
    )
    plate = forms.moved(
        forms.slab(forms.rectangle(0.016, 0.016, 0.004), 0.002), (0.052, 0.0, 0.0098)
    )
    return forms.standing(
        [
            painted_part("base plastic", base, "#26282c"),
            painted_part("handle plastic", handle, "#a3201f"),
            painted_part("rail metal", magazine_box, "#a8abae"),
            painted_part("hinge metal", hinge, "#8d9093"),
            painted_part("plate metal", plate, "#b7b9bb"),
        ]
    )


def tape_roll() -> list[RawPart]:
    """Return a roll of adhesive tape that lies flat."""
    tape = forms.lathe(
        [(0.0405, 0.0), (0.050, 0.0), (0.050, 0.024), (0.0405, 0.024), (0.0405, 0.0)], 40
    )
    core = forms.lathe(
        [(0.0380, 0.0002), (0.0405, 0.0002), (0.0405, 0.0238), (0.0380, 0.0238), (0.0380, 0.0002)],
        40,
    )
    tab = forms.curve([(0.0500, 0.000, 0.012), (0.0495, 0.012, 0.012), (0.054, 0.028, 0.012)], 8)
    rings = [[np.add(p, (0, 0, s)) for s in (-0.012, 0.012)] for p in tab]
    strip = forms.loft(np.array(rings), closed=False, caps=False)
    return forms.standing(
        [
            painted_part("tape", tape, "#c9a35e", roughness=0.3),
            painted_part("core cardboard", core, "#b6a386"),
            painted_part("tape end", strip, "#cfae72", roughness=0.3),
        ]
    )


def ruler() -> list[RawPart]:
    """Return a wooden ruler of 30 cm."""
    scale = Sheet(1240, 128, (0.80, 0.62, 0.38))
    for mm in range(301):
        x = (5.0 + mm) / 310.0
        tall = 0.42 if mm % 10 == 0 else 0.30 if mm % 5 == 0 else 0.18
        scale.line((x, 0.0), (x, tall), 0.012, (0.12, 0.09, 0.07))
        if mm % 10 == 0 and mm:
            scale.text(str(mm // 10), x, 0.62, 0.17, (0.12, 0.09, 0.07))
    body = forms.slab(forms.rectangle(0.310, 0.032, 0.002), 0.0034, 0.0006)
    return forms.standing(
        [
            painted_part("body wood", body, "#c79e60"),
            printed_part(
                "scale", forms.panel(0.0316, 0.3096, 0.0036), scale.texture(), roughness=0.4
            ),
        ]
    )


def binder(colour: str = "#27476e") -> list[RawPart]:
    """Return a lever arch file that stands, its back along x."""
    label = Sheet(110, 300, (0.93, 0.93, 0.90)).text("2024", 0.5, 0.2, 0.10, (0.15, 0.15, 0.17))
    label.lines(0.2, 0.42, 0.8, 4, 0.11, (0.45, 0.45, 0.47))
    boards = [box((0.285, 0.0028, 0.318), (0.0, side * 0.0376, 0.159)) for side in (1.0, -1.0)]
    spine = box((0.0028, 0.078, 0.318), (0.1428, 0.0, 0.159))
    tag = forms.moved(forms.panel(0.150, 0.054, 0.0), turn_deg=(0.0, 90.0, 0.0))
    ring = forms.upright_ring((0.1446, 0.0, 0.05), 0.011, 0.011)
    return forms.standing(
        [
            painted_part("board", forms.merged([*boards, spine]), colour, roughness=0.55),
            painted_part(
                "pages paper", box((0.262, 0.060, 0.300), (-0.006, 0.0, 0.156)), "#e3e0d8"
            ),
            printed_part(
                "label", forms.moved(tag, (0.1446, 0.0, 0.215)), label.texture(), roughness=0.7
            ),
            painted_part("eyelet metal", forms.tube(ring, 0.0018, sides=8, closed=True), "#aaacae"),
            painted_part(
                "hole", forms.ellipsoid((0.0006, 0.0100, 0.0100), (0.1443, 0.0, 0.05)), "#101010"
            ),
        ]
    )
