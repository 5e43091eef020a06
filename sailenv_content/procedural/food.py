"""Fruit and a doughnut."""

from __future__ import annotations

import numpy as np

from sailenv_content.procedural import forms
from sailenv_content.procedural.prints import Sheet
from sailenv_content.procedural.shapes import Vector3, painted_part, printed_part
from sailenv_ros.assets.meshes import RawMesh
from sailenv_ros.assets.model_files import RawPart

__all__ = ["apple", "banana", "donut", "lemon", "orange", "pear"]


def apple() -> list[RawPart]:
    """Return a red apple with its stem."""
    turn = np.linspace(-np.pi / 2, np.pi / 2, 25)
    radius = 0.039 * np.cos(turn) ** 0.82
    height = 0.035 * np.sin(turn) + 0.034
    height -= 0.013 * np.exp(-((radius / 0.011) ** 2)) * np.sign(np.sin(turn))
    profile = np.stack([radius * (1.0 + 0.06 * np.sin(turn)), height], -1)
    profile[[0, -1], 0] = 0.0
    body = forms.lathe(profile, 32)
    skin = Sheet(512, 256, (0.62, 0.10, 0.09)).shade((0.80, 0.62, 0.22), (0.55, 0.07, 0.08))
    generator = np.random.default_rng(5)
    for x in generator.uniform(0, 1, 420):
        y = float(generator.uniform(0.20, 0.42))
        shade = float(generator.uniform(0.0, 0.16))
        reach = float(generator.uniform(0.2, 0.45))
        skin.line((x, y), (x + 0.003, y + reach), 0.005, (0.62 + shade, 0.16 + shade, 0.11))
    for x, y in generator.uniform((0, 0.2), (1, 1), (260, 2)):
        skin.disc(float(x), float(y), 0.004, (0.80, 0.55, 0.36))
    stem = forms.tube(
        forms.curve([(0, 0, 0.052), (0.001, 0, 0.066), (0.006, 0.002, 0.078)], 8), 0.0014, sides=7
    )
    return forms.standing(
        [
            printed_part("skin", body, skin.texture(), roughness=0.3),
            painted_part("stem", stem, "#4a3520"),
        ]
    )


def orange() -> list[RawPart]:
    """Return an orange."""
    skin = _speckled(512, ((0.93, 0.55, 0.10), (0.90, 0.47, 0.06)), 900, 3)
    turn = np.linspace(-np.pi / 2, np.pi / 2, 21)
    profile = np.stack([0.038 * np.cos(turn), 0.036 * np.sin(turn) + 0.036], -1)
    profile[-1, 1] -= 0.002
    profile[[0, -1], 0] = 0.0
    navel = forms.lathe([(0.0035, 0.0700), (0.0028, 0.0712), (0.0, 0.0714)], 10)
    return forms.standing(
        [
            printed_part("peel", forms.lathe(profile, 32), skin.texture(), roughness=0.45),
            painted_part("navel", navel, "#5f6b2f"),
        ]
    )


def lemon() -> list[RawPart]:
    """Return a lemon that lies on its side."""
    along = np.linspace(-1.0, 1.0, 23)
    radius = 0.0265 * (1.0 - np.abs(along) ** 2.6) ** 0.62 + 0.0042 * np.exp(
        -(((np.abs(along) - 0.96) / 0.05) ** 2)
    )
    profile = np.stack([radius, 0.042 * along], -1)
    profile[[0, -1], 0] = 0.0
    skin = _speckled(512, ((0.93, 0.82, 0.18), (0.90, 0.76, 0.12)), 700, 8)
    body = forms.moved(forms.lathe(profile, 28), turn_deg=(0.0, 90.0, 0.0))
    return forms.standing([printed_part("peel", body, skin.texture(), roughness=0.4)])


def banana() -> list[RawPart]:
    """Return a banana that lies on its side."""
    bend = np.linspace(np.radians(-58), np.radians(58), 26)
    path = np.stack([0.098 * np.cos(bend), 0.098 * np.sin(bend), np.zeros(26)], -1)
    along = np.linspace(0.0, 1.0, 26)
    radius = 0.0175 * np.sin(np.pi * np.clip(0.06 + 0.88 * along, 0, 1)) ** 0.55
    radius = np.where(
        along > 0.86, np.interp(along, [0.86, 0.93, 1.0], [0.0125, 0.0062, 0.0050]), radius
    )
    radius = np.where(along < 0.05, np.interp(along, [0.0, 0.05], [0.004, 0.0085]), radius)
    body = forms.tube(path, radius, sides=10)
    skin = Sheet(256, 512, (0.90, 0.76, 0.20)).shade((0.62, 0.66, 0.24), (0.91, 0.75, 0.19))
    generator = np.random.default_rng(11)
    for x, y in generator.uniform((0, 0.15), (1, 0.95), (110, 2)):
        skin.disc(float(x), float(y), float(generator.uniform(0.002, 0.006)), (0.45, 0.30, 0.12))
    skin.box(0, 0.0, 1, 0.03, (0.28, 0.20, 0.10)).box(0, 0.97, 1, 1, (0.18, 0.13, 0.08))
    return forms.standing([printed_part("peel", body, skin.texture(), roughness=0.5)])


def pear() -> list[RawPart]:
    """Return a pear that stands."""
    profile = forms.curve(
        [
            (0.006, 0, 0.002),
            (0.024, 0, 0.004),
            (0.037, 0, 0.026),
            (0.034, 0, 0.048),
            (0.021, 0, 0.070),
            (0.0165, 0, 0.085),
            (0.009, 0, 0.096),
            (0.002, 0, 0.097),
        ],
        26,
    )[:, [0, 2]]
    skin = _speckled(512, ((0.66, 0.62, 0.20), (0.72, 0.66, 0.25)), 600, 21)
    stem = forms.tube(
        forms.curve([(0, 0, 0.093), (0.001, 0, 0.106), (0.008, 0, 0.118)], 8), 0.0016, sides=7
    )
    return forms.standing(
        [
            printed_part("skin", forms.lathe(profile, 32), skin.texture(), roughness=0.45),
            painted_part("stem", stem, "#46341f"),
        ]
    )


def donut() -> list[RawPart]:
    """Return a doughnut with icing and sprinkles."""
    ring = np.concatenate([0.029 * forms.circle(48), np.zeros((48, 1))], axis=1)
    dough = forms.tube(ring, 0.0185, sides=20, closed=True)
    flat = dough.positions * [1.0, 1.0, 0.86]
    dough = RawMesh(positions=flat, uvs=dough.uvs, triangles=dough.triangles)
    turn = np.linspace(0.0, 2.0 * np.pi, 64, endpoint=False)
    rings = []
    for angle in np.linspace(np.radians(-12), np.radians(192), 14):
        # The icing's edge runs down unevenly.
        drip = 0.16 * np.sin(5 * turn) + 0.09 * np.sin(11 * turn + 1.0)
        lean = np.pi / 2 + (angle - np.pi / 2) * (1.0 + drip * np.abs(angle - np.pi / 2) / 2.2)
        out, up = 0.0193 * np.cos(lean), 0.0193 * np.sin(lean) * 0.88
        rings.append(np.stack([(0.029 + out) * np.cos(turn), (0.029 + out) * np.sin(turn), up], -1))
    icing = forms.loft(np.array(rings), caps=False)
    generator = np.random.default_rng(17)
    colours = ("#e8d24a", "#5aa0d8", "#f4f2ee", "#63b86a")
    sprinkles: dict[str, list[RawMesh]] = {colour: [] for colour in colours}
    for k in range(44):
        around, lean = generator.uniform(0, 2 * np.pi), generator.uniform(0.6, 2.54)
        radius = 0.029 + 0.0196 * np.cos(lean)
        place = (radius * np.cos(around), radius * np.sin(around), 0.0196 * 0.88 * np.sin(lean))
        rod = forms.ellipsoid((0.0026, 0.0008, 0.0008), (0, 0, 0), 8)
        tilt = 90.0 - np.degrees(lean)
        bent = forms.moved(rod, turn_deg=(0, 0, float(generator.uniform(0, 180))))
        bent = forms.moved(bent, turn_deg=(0.0, float(tilt), 0.0))
        bent = forms.moved(bent, turn_deg=(0.0, 0.0, float(np.degrees(around))))
        sprinkles[colours[k % 4]].append(forms.moved(bent, place))
    return forms.standing(
        [
            painted_part("dough", dough, "#b9793d", roughness=0.8),
            painted_part("icing", icing, "#cf6f93", roughness=0.3),
            *(
                painted_part("sprinkle", forms.merged(own), colour)
                for colour, own in sprinkles.items()
            ),
        ]
    )


def _speckled(size: int, colours: tuple[Vector3, Vector3], spots: int, seed: int) -> Sheet:
    """Return a skin that goes from one colour to another with small spots."""
    skin = Sheet(size, size // 2, colours[0]).shade(*colours)
    generator = np.random.default_rng(seed)
    for x, y, shade in generator.uniform((0, 0.05, -0.06), (1, 0.95, 0.06), (spots, 3)):
        base = np.array(colours[0]) * (1 - y) + np.array(colours[1]) * y
        red, green, blue = np.clip(base + shade, 0, 1).tolist()
        skin.disc(float(x), float(y), float(generator.uniform(0.004, 0.012)), (red, green, blue))
    return skin
