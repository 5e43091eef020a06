"""The flesh on an animal's bones: solids that a mesh is made of, each on its joint."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_content.animals.anatomy import TAIL_JOINTS, Anatomy
from sailenv_content.animals.solids import Body, Solid, ellipsoid, loft, tube

__all__ = ["EYE", "NOSE", "body_of", "grid_of"]

Doubles = NDArray[np.float64]

_TRUNK = {
    "cat": (
        (-0.68, 0.72, 0.90, 0.075),
        (-0.58, 0.62, 0.95, 0.120),
        (-0.42, 0.575, 0.975, 0.145),
        (-0.20, 0.54, 0.985, 0.160),
        (0.05, 0.485, 0.965, 0.172),
        (0.25, 0.455, 0.955, 0.168),
        (0.42, 0.465, 0.970, 0.150),
        (0.55, 0.52, 0.950, 0.125),
        (0.62, 0.60, 0.92, 0.095),
    ),
    "dog": (
        (-0.58, 0.74, 0.93, 0.070),
        (-0.50, 0.66, 0.975, 0.115),
        (-0.36, 0.64, 0.985, 0.130),
        (-0.18, 0.60, 0.975, 0.140),
        (0.04, 0.51, 0.970, 0.165),
        (0.22, 0.455, 0.985, 0.172),
        (0.36, 0.45, 1.005, 0.155),
        (0.48, 0.50, 0.985, 0.130),
        (0.55, 0.58, 0.94, 0.100),
    ),
}
"""Rows of x, the lowest z, the highest z and half the width, over the height of the withers."""

EYE = {
    "cat": ((0.74, 0.205, 0.145), 0.100, 24.0),
    "dog": ((0.50, 0.155, 0.175), 0.066, 28.0),
}
"""Middle of the left eye from the head's joint, its radius, over the head's length; how far it
looks outwards [deg]."""

NOSE = {"cat": (0.985, 0.0, 0.005), "dog": (1.0, 0.0, 0.015)}
"""Tip of the nose from the head's joint, over the head's length."""


def body_of(anatomy: Anatomy) -> Body:
    """Return the solids of an animal."""
    solids = [*_trunk(anatomy), *_tail(anatomy)]
    for side in "LR":
        solids += [*_fore_leg(anatomy, side), *_hind_leg(anatomy, side)]
    solids += _cat_head(anatomy) if anatomy.look.kind == "cat" else _dog_head(anatomy)
    return Body(tuple(solids))


def grid_of(anatomy: Anatomy, body: Body) -> tuple[Doubles, Doubles, Doubles]:
    """Return the places of a grid around a body, closer together at the head and the paws [m]."""
    unit = anatomy.unit
    low = np.min([solid.low for solid in body.solids], axis=0)
    high = np.max([solid.high for solid in body.solids], axis=0)
    coarse, fine = 0.041 * unit, 0.0178 * unit
    chin = float(anatomy["head"][2]) - 0.33 * anatomy.head_m
    neck = float(anatomy["head"][0]) + 0.1 * anatomy.head_m
    across = np.arange(0.5 * fine, high[1] + fine, fine)
    return (
        _spaced(low[0], high[0], coarse, (neck, high[0] + fine), fine),
        np.concatenate([-across[::-1], across]),
        np.concatenate([
            _spaced(-0.045 * unit, 0.13 * unit, fine, (0.0, 0.0), fine)[:-1],
            _spaced(0.13 * unit, high[2], coarse, (chin, high[2] + fine), fine),
        ]),
    )  # fmt: skip


def _spaced(
    low: float, high: float, step: float, closer: tuple[float, float], fine: float
) -> Doubles:
    """Return places from low to high, closer together within a span."""
    found = [low]
    while found[-1] < high:
        found.append(found[-1] + (fine if closer[0] <= found[-1] < closer[1] else step))
    return np.array(found)


def _trunk(anatomy: Anatomy) -> list[Solid]:
    look, unit = anatomy.look, anatomy.unit
    rows = unit * np.array(_TRUNK[look.kind]) * [look.length, 1.0, 1.0, look.girth]
    # A stout animal hangs lower, a slender one is tucked up.
    rows[1:-1, 1] -= unit * 0.12 * (look.girth - 1.0)
    rows[:, 1] = np.maximum(rows[:, 1], 0.2 * unit)
    thick = {"cat": (0.165, 0.125, 0.115), "dog": (0.19, 0.150, 0.125)}[look.kind]
    neck = [unit * part * (0.4 + 0.6 * look.girth) for part in thick]
    first, second, head = (anatomy[name] for name in ("neck01", "neck02", "head"))
    base = first + unit * np.array([-0.10, 0.0, -0.06])
    nape = head + anatomy.head_m * np.array([0.25, 0.0, 0.02])
    chest = first + unit * np.array([-0.06, 0.0, -0.20])
    return [
        loft("trunk", rows, (0.05 * unit, 0.06 * unit), 0.05 * unit),
        ellipsoid("spine03", chest, unit * np.array([0.105, 0.10, 0.13]), 0.09 * unit),
        tube("neck01", [base, second], neck[:2], 0.12 * unit, 0.92),
        tube("neck02", [second, nape], neck[1:], 0.06 * unit, 0.95),
    ]


def _tail(anatomy: Anatomy) -> list[Solid]:
    look, unit = anatomy.look, anatomy.unit
    places = [anatomy[f"tail{number:02d}"] for number in range(1, TAIL_JOINTS + 1)]
    places.append(places[-1] + 0.9 * (places[-1] - places[-2]))
    shares = np.linspace(0.0, 1.0, len(places))
    if look.kind == "cat":
        radii = np.interp(shares, [0.0, 0.15, 0.9, 1.0], [0.070, 0.052, 0.045, 0.030])
    else:
        radii = np.interp(shares, [0.0, 0.2, 0.6, 1.0], [0.075, 0.058, 0.050, 0.022])
    radii = unit * radii * look.tail_width
    return [
        tube(f"tail{n + 1:02d}", places[n : n + 2], radii[n : n + 2].tolist(),
             (0.07 if n == 0 else 0.01) * unit)
        for n in range(TAIL_JOINTS)
    ]  # fmt: skip


def _fore_leg(anatomy: Anatomy, side: str) -> list[Solid]:
    look, unit = anatomy.look, anatomy.unit
    wide = unit * look.legs * (1.0 if look.kind == "cat" else 0.98)
    top, shoulder, elbow, wrist, paw = (
        anatomy[f"{name}.{side}"]
        for name in ("shoulder", "upperarm", "forearm", "wrist", "forepaw")
    )
    inwards = np.array([0.0, -1.0 if side == "L" else 1.0, 0.0])
    up = np.array([0.0, 0.0, 0.015 * unit])
    return [
        tube(f"shoulder.{side}", [top + 0.05 * unit * inwards, shoulder],
             [0.075 * wide, 0.105 * wide], 0.07 * unit, 0.62),
        tube(f"upperarm.{side}", [shoulder, elbow], [0.100 * wide, 0.082 * wide],
             0.05 * unit, 0.72),
        tube(f"forearm.{side}", [elbow + up, 0.5 * (elbow + wrist), wrist],
             [0.072 * wide, 0.055 * wide, 0.043 * wide], 0.03 * unit, 0.88),
        tube(f"wrist.{side}", [wrist, paw], [0.045 * wide, 0.046 * wide], 0.015 * unit),
        *_paw(anatomy, f"forepaw.{side}", paw, wide),
    ]  # fmt: skip


def _hind_leg(anatomy: Anatomy, side: str) -> list[Solid]:
    look, unit = anatomy.look, anatomy.unit
    wide = unit * look.legs * (1.0 if look.kind == "cat" else 1.02)
    hip, knee, hock, paw = (
        anatomy[f"{name}.{side}"] for name in ("thigh", "shank", "hock", "hindpaw")
    )
    rump = hip + unit * np.array([-0.06, 0.0, 0.02])
    ham = 0.5 * (rump + knee) + unit * np.array([-0.04, 0.0, 0.0])
    calf = knee + 0.35 * (hock - knee) + unit * np.array([-0.015, 0.0, -0.01])
    return [
        tube(f"thigh.{side}", [rump, ham, knee],
             [0.150 * wide, 0.145 * wide, 0.085 * wide], 0.07 * unit, 0.56),
        tube(f"shank.{side}", [knee, calf, hock], [0.080 * wide, 0.072 * wide, 0.040 * wide],
             0.04 * unit, 0.75),
        tube(f"hock.{side}", [hock, paw], [0.042 * wide, 0.044 * wide], 0.015 * unit, 0.9),
        *_paw(anatomy, f"hindpaw.{side}", paw, wide),
    ]  # fmt: skip


def _paw(anatomy: Anatomy, joint: str, paw: Doubles, wide: float) -> list[Solid]:
    unit = anatomy.unit
    # They reach a little below the floor, where the mesh is cut off flat.
    pad = np.array([paw[0] + 0.012 * unit, paw[1], 0.036 * unit])
    found = [ellipsoid(joint, pad, [0.075 * wide, 0.062 * wide, 0.048 * unit], 0.02 * unit)]
    for place, ahead in ((-0.045, 0.035), (-0.016, 0.062), (0.016, 0.062), (0.045, 0.035)):
        at = np.array([paw[0] + ahead * wide, paw[1] + place * wide, 0.030 * unit])
        found.append(ellipsoid(joint, at, [0.042 * wide, 0.021 * wide, 0.039 * unit], 0.006 * unit))
    return found


class _Head:
    """Solids of a head, in lengths of it from its joint."""

    def __init__(self, anatomy: Anatomy) -> None:
        self._at, self._size = anatomy["head"], anatomy.head_m

    def bulb(
        self, x: float, y: float, z: float, sizes: tuple[float, float, float], blend: float,
        *, removes: bool = False,
    ) -> list[Solid]:  # fmt: skip
        """Return an ellipsoid, and its mirror image if it is beside the middle."""
        sides = (y, -y) if y else (0.0,)
        return [
            ellipsoid("head", self._at + self._size * np.array([x, side, z]),
                      self._size * np.array(sizes), blend * self._size, removes=removes)
            for side in sides
        ]  # fmt: skip

    def bar(
        self,
        places: list[tuple[float, float, float]],
        radii: list[float],
        blend: float,
        flat: float,
    ) -> list[Solid]:
        """Return a tube in the middle."""
        at = [self._at + self._size * np.array(place) for place in places]
        return [tube("head", at, [r * self._size for r in radii], blend * self._size, flat)]

    def eyes(self, kind: str) -> list[Solid]:
        """Return what is carved out for the eyes."""
        (x, y, z), radius, _ = EYE[kind]
        return self.bulb(x, y, z, (radius * 1.02,) * 3, 0.05, removes=True)


def _cat_head(anatomy: Anatomy) -> list[Solid]:
    head, muzzle = _Head(anatomy), 0.14 * (anatomy.look.muzzle - 1.0)
    return [
        *head.bulb(0.40, 0.0, 0.16, (0.44, 0.37, 0.34), 0.10),
        *head.bulb(0.50, 0.19, -0.03, (0.30, 0.24, 0.23), 0.12),
        *head.bulb(0.52, 0.0, -0.12, (0.30, 0.20, 0.16), 0.10),
        *head.bar([(0.62, 0, 0.20), (0.93 + muzzle, 0, 0.015)], [0.15, 0.062], 0.10, 1.05),
        *head.bulb(0.86 + muzzle, 0.078, -0.075, (0.125, 0.105, 0.085), 0.06),
        *head.bulb(0.82 + muzzle, 0.0, -0.155, (0.12, 0.095, 0.075), 0.04),
        *head.bulb(0.965 + muzzle, 0.0, 0.012, (0.045, 0.058, 0.036), 0.02),
        *head.bulb(0.66, 0.175, 0.245, (0.13, 0.13, 0.07), 0.08),
        *head.eyes("cat"),
    ]


def _dog_head(anatomy: Anatomy) -> list[Solid]:
    head, long = _Head(anatomy), 0.5 * (anatomy.look.muzzle - 1.0)
    return [
        *head.bulb(0.27, 0.0, 0.13, (0.31, 0.255, 0.23), 0.08),
        *head.bulb(0.33, 0.12, 0.03, (0.26, 0.16, 0.18), 0.10),
        *head.bar([(0.45, 0, 0.07), (0.72 + 0.6 * long, 0, 0.015), (0.93 + long, 0, -0.005)],
                  [0.165, 0.112, 0.092], 0.09, 0.98),
        *head.bar([(0.42, 0, -0.07), (0.70 + 0.6 * long, 0, -0.095), (0.86 + long, 0, -0.095)],
                  [0.125, 0.085, 0.062], 0.05, 1.0),
        *head.bulb(0.80 + long, 0.050, -0.055, (0.14, 0.062, 0.070), 0.05),
        *head.bulb(0.972 + long, 0.0, 0.030, (0.055, 0.064, 0.050), 0.02),
        *head.bulb(0.46, 0.115, 0.225, (0.10, 0.09, 0.055), 0.07),
        *head.eyes("dog"),
    ]  # fmt: skip
