"""Objects that people carry and put down: glasses, keys, a wallet, a watch."""

from __future__ import annotations

import numpy as np

from sailenv_content.procedural import forms
from sailenv_content.procedural.prints import Sheet
from sailenv_content.procedural.shapes import box, painted_part, printed_part
from sailenv_ros.assets.meshes import RawMesh
from sailenv_ros.assets.model_files import RawPart

__all__ = ["glasses", "keys", "wallet", "wrist_watch"]


def glasses() -> list[RawPart]:
    """Return sunglasses that lie with open temples."""
    z, parts = 0.024, []
    for side in (1.0, -1.0):
        rim = forms.rectangle(0.050, 0.040, 0.017)
        # The outline's x becomes the height, its y the width.
        path = np.stack(
            [0.0035 * (rim[:, 1] / 0.025) ** 2 * -1.0, rim[:, 1] + side * 0.034, z + rim[:, 0]], -1
        )
        parts.append(
            painted_part("frame", forms.tube(path, 0.0018, sides=8, closed=True), "#1c1512")
        )
        lens = forms.slab(0.96 * rim, 0.0016, 0.0006)
        lens = forms.moved(lens, (0.0, 0.0, 0.0), (0.0, 90.0, 0.0))
        lens = forms.moved(lens, (-0.0015, side * 0.034, z))
        parts.append(painted_part("lens", lens, "#14110c", roughness=0.05))
        temple = forms.curve(
            [
                (-0.003, side * 0.061, z + 0.010),
                (-0.020, side * 0.068, z + 0.010),
                (-0.090, side * 0.067, z + 0.006),
                (-0.118, side * 0.064, z - 0.004),
                (-0.140, side * 0.060, z - 0.022),
            ],
            24,
        )
        radii = np.interp(np.arange(24), [0, 4, 16, 23], [0.0026, 0.0018, 0.0019, 0.0026])
        parts.append(painted_part("frame", forms.tube(temple, radii, sides=8), "#1c1512"))
    bridge = forms.curve(
        [(0.0, -0.010, z + 0.006), (0.004, 0.0, z + 0.010), (0.0, 0.010, z + 0.006)], 9
    )
    parts.append(painted_part("frame", forms.tube(bridge, 0.0018, sides=8), "#1c1512"))
    return forms.standing(parts)


def keys() -> list[RawPart]:
    """Return two keys and a fob on a ring."""
    ring = np.concatenate([0.0125 * forms.circle(28), np.full((28, 1), 0.004)], axis=1)
    parts = [painted_part("ring chrome", forms.tube(ring, 0.0010, sides=8, closed=True), "#b9b9bb")]
    for number, (angle, name, colour) in enumerate(
        ((200.0, "key brass", "#b28f42"), (245.0, "key steel", "#a9abad"))
    ):
        bow = forms.slab(forms.circle(24) * [0.0115, 0.0125], 0.0022, 0.0004)
        teeth = [
            box((0.0035, 0.0022, 0.0019), (0.021 + 0.0052 * k, -0.0036 - 0.0005 * (k % 2), 0.0011))
            for k in range(4)
        ]
        blade = box((0.032, 0.0062, 0.0020), (0.0265, 0.0, 0.0011))
        groove = box((0.030, 0.0012, 0.0022), (0.0270, 0.0008, 0.0011))
        shape = forms.moved(
            forms.merged([bow, blade, groove, *teeth]), (0.021, 0.0, 0.0022 * number)
        )
        parts.append(painted_part(name, forms.moved(shape, turn_deg=(0.0, 0.0, angle)), colour))
    fob = forms.slab(forms.capsule_outline(0.052, 0.024), 0.008, 0.003)
    leather = forms.moved(forms.moved(fob, (0.040, 0.0, 0.0)), turn_deg=(0.0, 0.0, 70.0))
    parts.append(painted_part("fob hide", leather, "#6d2f1b", roughness=0.6))
    return forms.standing(parts)


def wallet() -> list[RawPart]:
    """Return a folded leather wallet."""
    leaf = forms.slab(forms.rectangle(0.112, 0.092, 0.006), 0.008, 0.0030)
    upper = forms.moved(
        forms.slab(forms.rectangle(0.112, 0.091, 0.006), 0.008, 0.0030), (0.001, 0.0, 0.0086)
    )
    fold = forms.tube([(-0.0445, y, 0.0085) for y in (-0.053, 0.0, 0.053)], 0.0078, sides=14)
    bills = box((0.086, 0.104, 0.0016), (0.002, 0.0, 0.0083))
    stitches = [
        box((0.0006, 0.0030, 0.0006), (0.042, y, 0.0168)) for y in np.arange(-0.050, 0.051, 0.005)
    ]
    return forms.standing(
        [
            *(painted_part("hide", m, "#4a2b1a", roughness=0.55) for m in (leaf, upper, fold)),
            painted_part("bills paper", bills, "#9fb09a"),
            painted_part("thread", forms.merged(stitches), "#a98f6a"),
        ]
    )


def wrist_watch() -> list[RawPart]:
    """Return a wrist watch, its strap closed to a loop, lying on its side of the strap."""
    dial = Sheet(256, 256, (0.94, 0.93, 0.89)).disc(0.5, 0.5, 0.48, (0.07, 0.10, 0.17))
    for hour in range(12):
        a = np.radians(30.0 * hour)
        ends = [(0.5 + r * np.sin(a), 0.5 - r * np.cos(a)) for r in (0.34, 0.42)]
        dial.line(ends[0], ends[1], 0.03, (0.92, 0.92, 0.9))
    dial.line((0.5, 0.5), (0.62, 0.36), 0.035, (0.95, 0.95, 0.93))
    dial.line((0.5, 0.5), (0.36, 0.29), 0.025, (0.95, 0.95, 0.93))
    case = forms.lathe(
        [
            (0.0, 0.0),
            (0.0175, 0.0),
            (0.0195, 0.003),
            (0.0195, 0.007),
            (0.0175, 0.0095),
            (0.0165, 0.0095),
            (0.0165, 0.0088),
            (0, 0.0088),
        ],
        40,
    )
    face = forms.moved(forms.panel(0.033, 0.033, 0.0), (0.0, 0.0, 0.0091))
    crown = forms.moved(
        forms.lathe([(0.0022, 0.0), (0.0025, 0.003), (0.0, 0.003)], 14), turn_deg=(0, 90, 0)
    )
    parts = [
        painted_part("case steel", case, "#b5b6b8"),
        printed_part("dial", _round(face, 0.0165), dial.texture(), roughness=0.1),
        painted_part("crown steel", forms.moved(crown, (0.019, 0.0, 0.005)), "#b5b6b8"),
    ]
    turn = np.linspace(np.radians(118), np.radians(422), 40)
    radius_y, radius_z = 0.0265, 0.0225
    middle = np.stack([np.zeros(40), radius_y * np.cos(turn), radius_z * np.sin(turn) - 0.018], -1)
    rings = []
    for k, centre in enumerate(middle):
        out = np.array([0.0, np.cos(turn[k]), np.sin(turn[k])])
        half = 0.0092
        rings.append(
            [
                centre + out * t + np.array([w, 0, 0])
                for w, t in ((-half, -0.0012), (half, -0.0012), (half, 0.0012), (-half, 0.0012))
            ]
        )
    parts.append(painted_part("strap hide", forms.loft(np.array(rings)), "#3a2416", roughness=0.65))
    lying = [forms.moved_part(p, turn_deg=(0.0, 68.0, 0.0)) for p in parts]
    return forms.standing(lying)


def _round(face: RawMesh, radius: float) -> RawMesh:
    """Cut a square panel round."""
    height = float(face.positions[0, 2])
    ring = forms.circle(40)
    positions = np.concatenate([[[0.0, 0.0, height]], np.c_[radius * ring, np.full(40, height)]])
    # As `panel`: the picture's top lies towards -x.
    uvs = np.stack([0.5 + 0.5 * positions[:, 1] / radius, 0.5 - 0.5 * positions[:, 0] / radius], -1)
    k = np.arange(40)
    triangles = np.stack([np.zeros(40, np.int64), 1 + k, 1 + (k + 1) % 40], -1)
    return RawMesh(positions=positions, uvs=uvs, triangles=triangles)
