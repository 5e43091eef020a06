"""Brushes and combs, for teeth and hair."""

from __future__ import annotations

import dataclasses

import numpy as np

from sailenv_content.procedural import forms
from sailenv_content.procedural.shapes import box, painted_part
from sailenv_ros.assets.meshes import RawMesh
from sailenv_ros.assets.model_files import RawPart

__all__ = ["comb", "hairbrush", "toothbrush", "toothbrush_cup"]


def toothbrush(colour: str = "#2f7fb8") -> list[RawPart]:
    """Return a toothbrush that lies on its side, its bristles along x."""
    return forms.standing(_brush(colour))


def _brush(colour: str, mark: str = "") -> list[RawPart]:
    """Return a toothbrush along x, bristles up; `mark` ends the names of its materials."""
    path = forms.curve(
        [
            (-0.095, 0, 0.004),
            (-0.060, 0, 0.0055),
            (-0.01, 0, 0.0045),
            (0.03, 0, 0.0055),
            (0.062, 0, 0.004),
            (0.095, 0, 0.004),
        ],
        40,
    )
    along = np.linspace(0, 1, 40)
    wide = np.interp(
        along, [0, 0.04, 0.3, 0.55, 0.72, 0.80, 0.96, 1.0], [3.0, 5.0, 6.4, 5.2, 2.6, 5.4, 5.6, 3.6]
    )
    tall = np.interp(
        along, [0, 0.04, 0.3, 0.55, 0.72, 0.80, 1.0], [2.4, 3.6, 4.4, 3.8, 2.2, 2.2, 2.0]
    )
    turn = np.linspace(0, 2 * np.pi, 14, endpoint=False)
    rings = np.stack(
        [
            p + np.stack([0 * turn, 1e-3 * w * np.cos(turn), 1e-3 * t * np.sin(turn)], -1)
            for p, w, t in zip(path, wide, tall, strict=True)
        ]
    )
    tufts = [
        forms.lathe([(0.0, 0.0), (0.00125, 0.0), (0.00135, 0.0105), (0.0, 0.0108)], 8)
        for _ in range(27)
    ]
    places = [(0.066 + 0.0034 * (k // 3), 0.0034 * (k % 3 - 1), 0.0055) for k in range(27)]
    edge = [
        forms.moved(t, p)
        for k, (t, p) in enumerate(zip(tufts, places, strict=True))
        if (k // 3) % 3
    ]
    core = [
        forms.moved(t, p)
        for k, (t, p) in enumerate(zip(tufts, places, strict=True))
        if not (k // 3) % 3
    ]
    grip = [
        forms.ellipsoid((0.010, 0.0066, 0.0046), (x, 0.0, 0.0052), 14) for x in (-0.050, -0.030)
    ]
    return [
        painted_part(f"body plastic{mark}", forms.loft(rings), "#eef0f1"),
        painted_part(f"grip rubber{mark}", forms.merged(grip), colour),
        painted_part(f"bristles{mark}", forms.merged(edge), "#f5f6f5", roughness=0.8),
        painted_part(f"coloured bristles{mark}", forms.merged(core), colour, roughness=0.8),
    ]


def toothbrush_cup() -> list[RawPart]:
    """Return a tumbler with two toothbrushes."""
    cup = forms.lathe(
        [
            (0.0, 0.0),
            (0.030, 0.0),
            (0.033, 0.003),
            (0.037, 0.098),
            (0.036, 0.100),
            (0.0345, 0.098),
            (0.0310, 0.006),
            (0, 0.006),
        ],
        36,
    )
    parts = [painted_part("cup ceramic", cup, "#c9d6d2", roughness=0.2)]
    for number, (lean, around, colour) in enumerate(
        ((17.0, 30.0, "#c2413b"), (-15.0, 75.0, "#2f8f6b")), 1
    ):
        for piece in _brush(colour, f" {number}"):
            upright = forms.moved(piece.mesh, (0.094, 0.0, -0.004), (0.0, 0.0, 0.0))
            upright = forms.moved(upright, turn_deg=(0.0, -90.0, 0.0))
            placed = forms.moved(upright, (0.017 * np.sign(-lean), 0.0, 0.0105), (0.0, lean, 0.0))
            turned = forms.moved(placed, turn_deg=(0.0, 0.0, around))
            parts.append(dataclasses.replace(piece, mesh=turned))
    return forms.standing(parts)


def hairbrush() -> list[RawPart]:
    """Return a paddle hairbrush that lies on its back."""
    head = forms.moved(
        forms.slab(forms.capsule_outline(0.110, 0.070, 16), 0.012, 0.005), (0.055, 0.0, 0.0)
    )
    handle = forms.tube(
        forms.curve(
            [(0.012, 0, 0.006), (-0.025, 0, 0.0065), (-0.07, 0, 0.0075), (-0.112, 0, 0.006)], 24
        ),
        np.interp(np.arange(24), [0, 4, 14, 20, 23], [0.0140, 0.0085, 0.0105, 0.0100, 0.0050]),
        sides=14,
    )
    flat = handle.positions * [1.0, 1.0, 0.72]
    handle = RawMesh(positions=flat, uvs=handle.uvs, triangles=handle.triangles)
    cushion = forms.moved(
        forms.slab(forms.capsule_outline(0.094, 0.056, 16), 0.005, 0.0024), (0.055, 0, 0.0105)
    )
    pins = []
    for x in np.arange(0.018, 0.094, 0.0085):
        for y in np.arange(-0.021, 0.022, 0.0070):
            if ((x - 0.055) / 0.045) ** 2 + (y / 0.027) ** 2 < 1.0:
                pins.append(
                    forms.moved(
                        forms.lathe(
                            [
                                (0.0, 0.0),
                                (0.0007, 0.0),
                                (0.0005, 0.013),
                                (0.0011, 0.0142),
                                (0, 0.0152),
                            ],
                            6,
                        ),
                        (x, y, 0.0145),
                    )
                )
    return forms.standing(
        [
            painted_part("head wood", head, "#6b3f22", roughness=0.35),
            painted_part("handle wood", handle, "#6b3f22", roughness=0.35),
            painted_part("cushion rubber", cushion, "#c9b8a4"),
            painted_part("pins", forms.merged(pins), "#1d1a18"),
        ]
    )


def comb() -> list[RawPart]:
    """Return a comb."""
    teeth = [
        box(
            (0.0014 if k < 26 else 0.0009, 0.027, 0.0026),
            (-0.086 + 0.0036 * k if k < 26 else 0.0062 + 0.0024 * (k - 26), -0.008, 0.0016),
        )
        for k in range(58)
    ]
    spine = forms.moved(
        forms.slab(forms.rectangle(0.012, 0.186, 0.005), 0.0036, 0.0014), (0.0, 0.0105, 0.0)
    )
    ends = [box((0.006, 0.027, 0.003), (s * 0.0895, -0.008, 0.0016)) for s in (1.0, -1.0)]
    return forms.standing(
        [
            painted_part(
                "horn plastic", forms.merged([spine, *teeth, *ends]), "#3d2414", roughness=0.25
            )
        ]
    )
