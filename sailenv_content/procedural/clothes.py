"""Clothes and shoes that lie about."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from sailenv_content.procedural import forms
from sailenv_content.procedural.shapes import box, painted_part
from sailenv_ros.assets.meshes import RawMesh
from sailenv_ros.assets.model_files import RawPart

__all__ = ["cap", "folded_jeans", "folded_shirt", "slippers", "socks"]


def folded_shirt() -> list[RawPart]:
    """Return a folded polo shirt with its collar."""
    layers = _layers(0.24, 0.30, 3, 0.014, 41)
    parts = [painted_part(f"cloth {k}", m, "#7a2f38", roughness=0.95) for k, m in enumerate(layers)]
    top = 0.86 * 0.014 * 2 + 0.0135
    for side in (1.0, -1.0):
        wing = np.array(
            [(0.0, 0.0), (0.030, 0.012), (0.052, 0.050), (0.010, 0.072), (-0.016, 0.040)]
        )
        # Mirrored once, an outline goes the other way round.
        outline = wing * [-1.0, side] if side < 0 else (wing * [-1.0, 1.0])[::-1]
        flap = forms.moved(forms.slab(outline, 0.005, 0.002), (-0.085, 0.0, 0.0))
        parts.append(
            painted_part("collar cloth", forms.moved(flap, (0, 0, top)), "#8c3843", roughness=0.95)
        )
    placket = forms.moved(
        forms.slab(forms.rectangle(0.026, 0.105, 0.003), 0.0030, 0.0012),
        (-0.034, 0.0, top - 0.0006),
    )
    parts.append(painted_part("placket cloth", placket, "#6d2932", roughness=0.95))
    buttons = [
        forms.moved(
            forms.lathe(
                [(0.0, 0.0), (0.0050, 0.0), (0.0052, 0.0014), (0.0040, 0.0018), (0, 0.0012)], 18
            ),
            (x, 0.0, top + 0.0022),
        )
        for x in (-0.070, -0.035, 0.002)
    ]
    parts.append(painted_part("button", forms.merged(buttons), "#e9e2d6", roughness=0.3))
    return forms.standing(parts)


def folded_jeans() -> list[RawPart]:
    """Return folded jeans with a seam, a pocket and its stitches."""
    layers = _layers(0.26, 0.32, 4, 0.016, 43)
    parts = [
        painted_part(f"denim cloth {k}", m, "#2c4564", roughness=0.95) for k, m in enumerate(layers)
    ]
    top = 0.86 * 0.016 * 3 + 0.0160
    outline = np.array(
        [(0.055, 0.0), (0.035, 0.052), (-0.055, 0.056), (-0.055, -0.056), (0.035, -0.052)]
    )
    pocket = forms.moved(forms.slab(outline, 0.0035, 0.0014), (-0.02, 0.035, top - 0.0005))
    parts.append(painted_part("pocket cloth", pocket, "#314c6e", roughness=0.95))
    stitch = np.concatenate([0.94 * outline, 0.94 * outline[:1]])
    dashes = []
    for a, b in pairwise(stitch):
        count = max(2, int(np.linalg.norm(b - a) / 0.006))
        angle = float(np.degrees(np.arctan2(*(b - a)[::-1])))
        for k in range(count):
            x, y = a + (b - a) * (k + 0.5) / count
            dash = forms.moved(box((0.0036, 0.0009, 0.0006), (0, 0, 0)), (0, 0, 0), (0, 0, angle))
            dashes.append(forms.moved(dash, (x - 0.02, y + 0.035, top + 0.0031)))
    parts.append(painted_part("thread", forms.merged(dashes), "#c58a3e"))
    tag = forms.moved(
        forms.slab(forms.rectangle(0.045, 0.030, 0.002), 0.002, 0.0006),
        (-0.115, -0.06, top - 0.0003),
    )
    parts.append(painted_part("tag leather", tag, "#8a5a34"))
    return forms.standing(parts)


def socks() -> list[RawPart]:
    """Return a pair of socks rolled into a ball."""
    roll = forms.ellipsoid((0.046, 0.036, 0.031), (0.0, 0.0, 0.030), 28)
    points = roll.positions.copy()
    turn = np.arctan2(points[:, 2] - 0.030, points[:, 1])
    points *= (1.0 + 0.025 * np.sin(4.0 * turn + 40.0 * points[:, 0]))[:, None]
    ball = RawMesh(positions=points, uvs=roll.uvs, triangles=roll.triangles)
    parts = [painted_part("wool cloth", ball, "#5c6470", roughness=1.0)]
    for x, size in ((0.020, 0.0335), (0.034, 0.0255)):
        ring = forms.upright_ring((x, 0.0, 0.030), size, 0.86 * size)
        parts.append(
            painted_part(
                "cuff cloth",
                forms.tube(ring, 0.0042, sides=8, closed=True),
                "#b04a3a",
                roughness=1.0,
            )
        )
    mouth = forms.upright_ring((0.0425, 0.0, 0.030), 0.014, 0.011)
    parts.append(
        painted_part(
            "fold cloth", forms.tube(mouth, 0.0050, sides=8, closed=True), "#6b7482", roughness=1.0
        )
    )
    return forms.standing(parts)


def slippers() -> list[RawPart]:
    """Return a pair of felt slippers."""
    parts = []
    along = np.linspace(0.0, 1.0, 30)
    for side in (1.0, -1.0):
        wide = np.interp(
            along,
            [0, 0.05, 0.2, 0.42, 0.72, 0.93, 1],
            [0.004, 0.024, 0.032, 0.031, 0.044, 0.028, 0.004],
        )
        lean = side * -0.010 * np.sin(np.pi * along)
        x = -0.135 + 0.27 * along
        outline = np.concatenate(
            [np.stack([x, lean - wide], -1), np.stack([x, lean + wide], -1)[::-1]]
        )
        sole = forms.slab(outline, 0.012, 0.003)
        inlay = forms.moved(forms.slab(0.93 * outline, 0.004, 0.0015), (0.0, 0.0, 0.011))
        rings = []
        for k in range(12, 30):
            arch = np.linspace(0.0, np.pi, 17)
            high = np.interp(
                along[k], [0.40, 0.55, 0.8, 0.95, 1.0], [0.052, 0.058, 0.047, 0.026, 0.006]
            )
            rings.append(
                np.stack(
                    [
                        np.full(17, x[k]),
                        lean[k] - 1.03 * wide[k] * np.cos(arch),
                        0.006 + high * np.sin(arch) ** 0.8,
                    ],
                    -1,
                )
            )
        outer = np.array(rings)
        inner = outer * [1.0, 0.93, 0.95]
        upper = forms.loft(np.concatenate([inner[::-1], outer]), closed=False, caps=False)
        place = (0.0, side * 0.058, 0.0)
        turn = (0.0, 0.0, side * 4.0)
        for name, mesh, colour in (
            ("sole rubber", sole, "#2b2522"),
            ("inlay cloth", inlay, "#c7b9a2"),
            ("felt", upper, "#6a5b52"),
        ):
            double = {"double_sided": True} if name == "felt" else {}
            parts.append(
                painted_part(name, forms.moved(mesh, place, turn), colour, roughness=1.0, **double)
            )
        edge = forms.tube(outer[0], 0.0032, sides=8)
        parts.append(
            painted_part("hem cloth", forms.moved(edge, place, turn), "#a2472f", roughness=1.0)
        )
    return forms.standing(parts)


def cap() -> list[RawPart]:
    """Return a baseball cap."""
    turn = np.linspace(0.0, np.pi / 2, 14)
    crown = forms.lathe(
        np.stack([0.092 * np.cos(turn) ** 0.86, 0.115 * np.sin(turn) + 0.006], -1), 48
    )
    points = crown.positions * [1.12, 0.94, 1.0]
    crown = RawMesh(positions=points, uvs=crown.uvs, triangles=crown.triangles)
    around = np.linspace(np.radians(-66), np.radians(66), 29)
    edge = np.stack(
        [1.12 * 0.090 * np.cos(around), 0.94 * 0.092 * np.sin(around), np.full(29, 0.012)], -1
    )
    reach = 0.075 * np.cos(1.36 * around) ** 0.6
    rings = []
    for share in np.linspace(0.0, 1.0, 7):
        drop = 0.010 * np.sin(np.pi * share / 2) + 0.020 * (np.abs(around) / 1.15) ** 2 * share
        rings.append(edge + np.stack([reach * share, 0 * around, 0.004 - drop + 0.006], -1))
    under = [ring - [0, 0, 0.003] for ring in rings]
    visor = forms.loft(np.array([*under, *rings[::-1]]), closed=False, caps=False)
    seams = []
    for angle in np.arange(0, 180, 60) + 30:
        c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
        bow = np.linspace(0.02, np.pi - 0.02, 40)
        r = 0.0925 * np.sign(np.cos(bow)) * np.abs(np.cos(bow)) ** 0.86
        seams.append(
            forms.tube(
                np.stack([1.12 * r * c, 0.94 * r * s, 0.1157 * np.sin(bow) + 0.006], -1),
                0.0012,
                sides=6,
            )
        )
    knob = forms.ellipsoid((0.0075, 0.0075, 0.004), (0, 0, 0.122), 16)
    badge = forms.lathe([(0.0, 0.0), (0.020, 0.0), (0.020, 0.002), (0.0, 0.003)], 28)
    badge = forms.moved(forms.moved(badge, turn_deg=(0, 62, 0)), (0.0965, 0, 0.066))
    return forms.standing(
        [
            painted_part("crown cloth", crown, "#24405f", roughness=0.95),
            painted_part("visor cloth", visor, "#1c3049", roughness=0.95, double_sided=True),
            painted_part("seam", forms.merged(seams), "#1a2d45", roughness=0.95),
            painted_part("knob cloth", knob, "#1c3049", roughness=0.95),
            painted_part("badge", badge, "#d8d3c4", roughness=0.9),
        ]
    )


def _layers(width: float, depth: float, count: int, thick: float, seed: int) -> list[RawMesh]:
    """Return cloth folded over and over, each layer soft at its edges and a little uneven."""
    generator = np.random.default_rng(seed)
    made = []
    for k in range(count):
        w = width * (1.0 - 0.02 * generator.uniform(0, 1)) - 0.004 * k
        d = depth * (1.0 - 0.02 * generator.uniform(0, 1)) - 0.003 * k
        sheet = forms.slab(forms.rectangle(w, d, 0.018, 8), thick, 0.46 * thick, steps=5)
        points = sheet.positions.copy()
        wave = 0.10 * thick * np.sin(31.0 * points[:, 0] + k) * np.cos(27.0 * points[:, 1] - k)
        points[:, 2] += 0.86 * thick * k + wave * (points[:, 2] > 0.3 * thick)
        points[:, :2] += generator.uniform(-0.002, 0.002, 2)
        made.append(RawMesh(positions=points, uvs=sheet.uvs, triangles=sheet.triangles))
    return made
