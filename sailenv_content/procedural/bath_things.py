"""Objects of a washbasin: toothpaste, soap, a hair drier, a sponge."""

from __future__ import annotations

import numpy as np

from sailenv_content.procedural import forms
from sailenv_content.procedural.prints import Sheet
from sailenv_content.procedural.shapes import box, painted_part, printed_part
from sailenv_ros.assets.model_files import RawPart

__all__ = ["hair_drier", "soap", "sponge", "toothpaste"]


def toothpaste() -> list[RawPart]:
    """Return a tube of toothpaste that lies on its side."""
    rings = []
    for x, wide, tall in (
        (-0.075, 0.0270, 0.0009),
        (-0.066, 0.0270, 0.0010),
        (-0.064, 0.0268, 0.0030),
        (-0.03, 0.0240, 0.0105),
        (0.01, 0.0205, 0.0155),
        (0.045, 0.0185, 0.0172),
        (0.050, 0.0160, 0.0155),
        (0.053, 0.0080, 0.0080),
    ):
        turn = np.linspace(0, 2 * np.pi, 36, endpoint=False)
        rings.append(
            np.stack([np.full(36, x), wide * np.cos(turn), 0.0175 + tall * np.sin(turn)], -1)
        )
    skin = (
        Sheet(640, 320, (0.94, 0.95, 0.96))
        .box(0, 0.42, 1, 0.60, (0.13, 0.42, 0.66))
        .box(0, 0.60, 1, 0.64, (0.85, 0.20, 0.2))
    )
    cap = forms.lathe(
        [(0.0, 0.0), (0.0105, 0.0), (0.0105, 0.002), (0.0098, 0.020), (0.0, 0.0205)], 24
    )
    cap = forms.moved(cap, (0.052, 0.0, 0.0175), (0.0, 90.0, 0.0))
    return forms.standing(
        [
            printed_part("tube", forms.loft(np.array(rings)), skin.texture(), roughness=0.3),
            painted_part("cap plastic", cap, "#e6e8ea"),
        ]
    )


def soap() -> list[RawPart]:
    """Return a bar of soap in a dish."""
    dish = forms.slab(forms.rectangle(0.085, 0.120, 0.030), 0.006, 0.002)
    rim = forms.rectangle(0.085, 0.120, 0.030)
    path = np.c_[0.96 * rim, np.full(len(rim), 0.010)]
    bar = forms.moved(
        forms.slab(forms.rectangle(0.052, 0.080, 0.020), 0.024, 0.009, steps=6),
        (0, 0, 0.006),
        (0, 0, 8),
    )
    return forms.standing(
        [
            painted_part("dish ceramic", dish, "#e4e4e0"),
            painted_part("rim ceramic", forms.tube(path, 0.0055, sides=12, closed=True), "#e4e4e0"),
            painted_part("soap", bar, "#a9bf8f", roughness=0.35),
        ]
    )


def hair_drier() -> list[RawPart]:
    """Return a hair drier that lies on its side."""
    barrel = forms.lathe(
        [
            (0.0, -0.085),
            (0.026, -0.085),
            (0.034, -0.078),
            (0.039, -0.050),
            (0.038, -0.010),
            (0.031, 0.060),
            (0.029, 0.085),
            (0.027, 0.085),
            (0.026, 0.070),
            (0, 0.068),
        ],
        40,
    )
    barrel = forms.moved(barrel, turn_deg=(0.0, 90.0, 0.0))
    nozzle = []
    for x, wide, tall in (
        (0.083, 0.0295, 0.0295),
        (0.100, 0.029, 0.024),
        (0.135, 0.036, 0.008),
        (0.138, 0.036, 0.007),
    ):
        turn = np.linspace(0, 2 * np.pi, 32, endpoint=False)
        nozzle.append(np.stack([np.full(32, x), tall * np.cos(turn), wide * np.sin(turn)], -1))
    handle = forms.tube(
        forms.curve(
            [
                (-0.030, -0.025, 0.0),
                (-0.034, -0.070, 0.0),
                (-0.046, -0.120, 0.0),
                (-0.052, -0.140, 0.0),
            ],
            24,
        ),
        np.interp(np.arange(24), [0, 5, 18, 22, 23], [0.0205, 0.0180, 0.0165, 0.0150, 0.0100]),
        sides=20,
    )
    cord = forms.tube(
        forms.curve(
            [
                (-0.052, -0.138, 0.0),
                (-0.066, -0.175, -0.012),
                (-0.03, -0.215, -0.034),
                (0.03, -0.205, -0.0355),
                (0.05, -0.165, -0.0355),
                (0.09, -0.150, -0.0355),
            ],
            50,
        ),
        0.0032,
        sides=8,
    )
    grille = [
        forms.moved(
            forms.lathe(
                [(r, 0.0), (r + 0.0016, 0.0), (r + 0.0016, 0.003), (r, 0.003), (r, 0.0)], 28
            ),
            (-0.0885, 0, 0),
            (0, 90, 0),
        )
        for r in (0.005, 0.011, 0.017, 0.023)
    ]
    switch = (
        box((0.012, 0.004, 0.010), (-0.0225, -0.070, 0.0)),
        box((0.010, 0.004, 0.010), (-0.026, -0.090, 0.0)),
    )
    return forms.standing(
        [
            painted_part("shell plastic", barrel, "#2b2c33"),
            painted_part("nozzle plastic", forms.loft(np.array(nozzle)), "#141416"),
            painted_part("grip plastic", handle, "#2b2c33"),
            painted_part("cord rubber", cord, "#161617"),
            painted_part("grille metal", forms.merged(grille), "#77797d"),
            painted_part("switch plastic", forms.merged(list(switch)), "#b5485c"),
        ]
    )


def sponge() -> list[RawPart]:
    """Return a washing-up sponge with its rough side up."""
    body = forms.slab(forms.rectangle(0.062, 0.100, 0.006), 0.026, 0.004)
    scour = forms.moved(
        forms.slab(forms.rectangle(0.062, 0.100, 0.006), 0.009, 0.002), (0.0, 0.0, 0.0255)
    )
    return forms.standing(
        [
            painted_part("foam", body, "#dcbf3f", roughness=1.0),
            painted_part("scourer", scour, "#3f6e45", roughness=1.0),
        ]
    )
