"""Forks and spoons, and what is served with one: a slice of cake, a cup of tea."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import PchipInterpolator

from sailenv_content.procedural import forms
from sailenv_content.procedural.shapes import painted_part
from sailenv_ros.assets.meshes import RawMesh
from sailenv_ros.assets.model_files import RawPart

__all__ = ["cake_plate", "dinner_fork", "dinner_spoon", "tea_cup"]

STEEL = "#d9d9d8"
TINES = 4
HANDLE = ((0.0, 0.0072), (0.012, 0.0098), (0.045, 0.0078), (0.085, 0.0046), (0.122, 0.0034))
"""Half the width of a handle [m] by the way from its end [m]."""

PLATE = (
    (0.0, 0.0), (0.058, 0.0), (0.062, 0.002), (0.075, 0.010), (0.104, 0.0175),
    (0.1055, 0.0190), (0.103, 0.0200), (0.076, 0.0125), (0.064, 0.0060), (0.0, 0.0055),
)  # fmt: skip
SAUCER = (
    (0.0, 0.0), (0.042, 0.0), (0.045, 0.0015), (0.058, 0.009), (0.080, 0.0150),
    (0.0812, 0.0163), (0.079, 0.0172), (0.058, 0.0115), (0.046, 0.0050), (0.0, 0.0045),
)  # fmt: skip
"""Radius and height of their skins [m], from below outwards and back over the top."""


def dinner_fork() -> list[RawPart]:
    """Return a fork that lies with its tines up, towards x."""
    return forms.standing([painted_part("fork steel", _fork(), STEEL, roughness=0.14)])


def dinner_spoon() -> list[RawPart]:
    """Return a spoon that lies, its bowl up, towards x."""
    return forms.standing([painted_part("spoon steel", _spoon(), STEEL, roughness=0.14)])


def cake_plate() -> list[RawPart]:
    """Return a slice of layered cake on a plate, with a fork on the plate's rim."""
    plate = forms.lathe(PLATE, 72)
    parts = [painted_part("plate ceramic", plate, "#f1efe9")]
    layers = (
        ("sponge 1", 0.0, 0.018, "#5b3218"), ("cream 1", 0.018, 0.024, "#f3e6cb"),
        ("sponge 2", 0.024, 0.042, "#5b3218"), ("cream 2", 0.042, 0.048, "#f3e6cb"),
        ("icing", 0.048, 0.054, "#3a1c0e"),
    )  # fmt: skip
    place, turn = (0.050, 0.012, 0.0055), (0.0, 0.0, 172.0)
    for name, low, high, colour in layers:
        grow = 0.0006 if name == "icing" else 0.0
        wedge = forms.slab(_wedge(0.098, 34.0, grow), high - low, 0.0015)
        parts.append(
            painted_part(
                name,
                forms.moved(forms.moved(wedge, (0.0, 0.0, low)), place, turn),
                colour,
                roughness=0.75,
            )
        )
    path = forms.curve(
        [
            (0.010 * (1 - t) * np.cos(13 * t), 0.010 * (1 - t) * np.sin(13 * t), 0.013 * t)
            for t in np.linspace(0.0, 1.0, 40)
        ],
        70,
    )
    swirl = forms.moved(
        forms.tube(path, np.linspace(0.0046, 0.0030, 70), sides=10), (0.078, 0.0, 0.058)
    )
    cherry = forms.ellipsoid((0.0085, 0.0085, 0.0080), (0.078, 0.0, 0.0765), 20)
    parts.append(
        painted_part("whipped cream", forms.moved(swirl, place, turn), "#fbf4e6", roughness=0.6)
    )
    parts.append(
        painted_part("cherry", forms.moved(cherry, place, turn), "#a3101c", roughness=0.15)
    )
    fork = forms.moved(
        forms.moved(_fork(0.86), (-0.110, 0.0, 0.0)), (0.0, -0.048, 0.0), (0.0, 0.0, 6.0)
    )
    fork = _laid(fork, PLATE)
    parts.append(painted_part("fork steel", fork, STEEL, roughness=0.14))
    return forms.standing(parts)


def tea_cup() -> list[RawPart]:
    """Return a cup of tea on its saucer, with a spoon."""
    saucer = forms.lathe(SAUCER, 64)
    cup = forms.lathe(
        [
            (0.0, 0.0), (0.022, 0.0), (0.0235, 0.003), (0.022, 0.006), (0.033, 0.020),
            (0.0405, 0.042), (0.0430, 0.062), (0.0424, 0.0628), (0.0413, 0.0620), (0.0388, 0.042),
            (0.0312, 0.021), (0.015, 0.0095), (0.0, 0.0085),
        ],
        56,
    )  # fmt: skip
    handle = forms.tube(
        forms.curve(
            [(0.0, 0.0385, 0.052), (0.0, 0.056, 0.054), (0.0, 0.064, 0.042), (0.0, 0.055, 0.028),
             (0.0, 0.036, 0.024)],
            28,
        ),
        0.0031,
        sides=12,
    )  # fmt: skip
    lift = (-0.006, 0.0, 0.0048)
    tea = forms.moved(
        forms.slab(0.0412 * forms.circle(48), 0.0008), (lift[0], 0.0, lift[2] + 0.0535)
    )
    china = forms.merged([saucer, forms.moved(forms.merged([cup, handle]), lift)])
    spoon = _laid(forms.moved(_spoon(0.70), (-0.085, -0.056, 0.0), (0.0, 0.0, -4.0)), SAUCER)
    return forms.standing(
        [
            painted_part("china ceramic", china, "#f3f2ee"),
            painted_part("tea", tea, "#4a1d08", roughness=0.05),
            painted_part("spoon steel", spoon, STEEL, roughness=0.14),
        ]
    )


def _laid(mesh: RawMesh, profile: ArrayLike) -> RawMesh:
    """Return what lies on a plate as it comes to rest there: its middle as low as it gets."""
    points = np.asarray(profile, np.float64)
    top = points[int(points[:, 0].argmax()) :][::-1]
    best, low = mesh, np.inf
    for pitch in np.linspace(-15.0, 15.0, 301):
        turned = forms.moved(mesh, turn_deg=(0.0, pitch, 0.0))
        x, y, z = turned.positions.T
        under = np.interp(np.hypot(x, y), top[:, 0], top[:, 1], right=0.0)
        lift = float((under - z).max()) + 1e-4
        if lift + z.mean() < low:
            best, low = forms.moved(turned, (0.0, 0.0, lift)), lift + float(z.mean())
    return best


def _wedge(length: float, angle_deg: float, grow: float) -> forms.Floats:
    """Return the outline of a slice of a round cake, its tip at the origin, towards x."""
    turn = np.radians(np.linspace(-angle_deg / 2.0, angle_deg / 2.0, 14))
    arc = (length + grow) * np.stack([np.cos(turn), np.sin(turn)], axis=-1)
    return np.concatenate([[(-grow, 0.0)], arc])


def _fork(scale: float = 1.0) -> RawMesh:
    """Return a fork 196 mm long that begins at the origin, along x."""
    shoulder = (*HANDLE, (0.132, 0.0056), (0.142, 0.0105), (0.150, 0.0122))
    heights = PchipInterpolator(
        [0.0, 0.03, 0.09, 0.125, 0.150, 0.172, 0.196],
        [0.0030, 0.0028, 0.0100, 0.0125, 0.0045, 0.0026, 0.0100],
    )
    at = np.linspace(0.0, 0.150, 52)
    body = _bar(at, _smooth(shoulder)(at), heights(at), 0.0013)
    tines = []
    for number in range(TINES):
        y = (number - (TINES - 1) / 2.0) * 0.0066
        at = np.linspace(0.146, 0.196, 22)
        half = np.interp(at, [0.146, 0.150, 0.188, 0.196], [0.0024, 0.0022, 0.0015, 0.0006])
        tines.append(forms.moved(_bar(at, half, heights(at), 0.0011), (0.0, y, 0.0)))
    return _scaled(forms.merged([body, *tines]), scale)


def _spoon(scale: float = 1.0) -> RawMesh:
    """Return a spoon 195 mm long that begins at the origin, along x."""
    heights = PchipInterpolator(
        [0.0, 0.03, 0.09, 0.124, 0.134], [0.0030, 0.0028, 0.0120, 0.0140, 0.0128]
    )
    at = np.linspace(0.0, 0.134, 46)
    handle = _bar(at, _smooth((*HANDLE, (0.134, 0.0046)))(at), heights(at), 0.0013)
    turn = np.linspace(0.0, 2.0 * np.pi, 44, endpoint=False)
    length, width, depth, sheet = 0.032, 0.0205, 0.0125, 0.0010
    # An egg, its wide end ahead: the rim at 1, the deepest place at 0.
    edge = np.stack(
        [length * np.cos(turn), width * np.sin(turn) * (1.0 + 0.13 * np.cos(turn))], axis=-1
    )
    shares = np.sin(np.linspace(0.04, np.pi / 2.0, 14))
    rings = []
    for share, side in [(s, -1.0) for s in shares] + [(s, 1.0) for s in shares[::-1]]:
        z = depth * (share**2.6 - 1.0) + (sheet if side > 0.0 else 0.0)
        flat = edge * (share - (0.012 if side > 0.0 else 0.0))
        rings.append(np.concatenate([flat, np.full((len(turn), 1), z)], axis=-1))
    bowl = forms.moved(forms.loft(rings), (0.1635, 0.0, 0.0128))
    return _scaled(forms.merged([handle, bowl]), scale)


def _smooth(widths: ArrayLike) -> PchipInterpolator:
    at, half = np.asarray(widths, np.float64).T
    return PchipInterpolator(at, half)


def _bar(at: forms.Floats, half: forms.Floats, heights: forms.Floats, thick: float) -> RawMesh:
    """Return a flat bar along x with soft edges, by half widths, heights and half its thickness."""
    ring = forms.circle(14)
    section = np.sign(ring) * np.abs(ring) ** 0.55
    rings = np.empty((len(at), len(ring), 3))
    rings[..., 0] = at[:, None]
    rings[..., 1] = half[:, None] * section[:, 0]
    rings[..., 2] = heights[:, None] + thick * section[:, 1]
    return forms.loft(rings)


def _scaled(mesh: RawMesh, scale: float) -> RawMesh:
    return RawMesh(positions=scale * mesh.positions, uvs=mesh.uvs, triangles=mesh.triangles)
