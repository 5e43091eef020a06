"""Bones of a cat or a dog: where its joints are at rest, by a row of numbers.

Lengths are shares of the height of the withers. Places are from the floor between the feet.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sailenv_content.animals.looks import AnimalLook

__all__ = ["SPINE", "TAIL_JOINTS", "Anatomy", "anatomy_of"]

Doubles = NDArray[np.float64]
Place = tuple[float, float, float]

TAIL_JOINTS = 7

SPINE = ("root", "spine01", "spine02", "spine03")


@dataclass(frozen=True, slots=True)
class _Kind:
    """Measures of a kind: of the trunk from the back to the front, of the head, of the legs."""

    trunk: tuple[Place, Place, Place, Place]
    neck: tuple[Place, Place]
    head: Place
    head_length: float
    tail: Place
    tail_length: float
    fore: tuple[Place, Place, Place, Place, Place]
    hind: tuple[Place, Place, Place, Place]


_FORE = ("shoulder", "upperarm", "forearm", "wrist", "forepaw")
_HIND = ("thigh", "shank", "hock", "hindpaw")

_KINDS = {
    "cat": _Kind(
        trunk=((-0.50, 0, 0.84), (-0.26, 0, 0.88), (0.04, 0, 0.86), (0.34, 0, 0.84)),
        neck=((0.55, 0, 0.84), (0.70, 0, 0.97)),
        head=(0.80, 0, 1.07),
        head_length=0.40,
        tail=(-0.66, 0, 0.84),
        tail_length=1.10,
        fore=(
            (0.42, 0.10, 0.90),
            (0.58, 0.125, 0.64),
            (0.44, 0.135, 0.47),
            (0.49, 0.125, 0.15),
            (0.535, 0.125, 0.045),
        ),
        hind=(
            (-0.50, 0.10, 0.72),
            (-0.37, 0.145, 0.47),
            (-0.62, 0.13, 0.235),
            (-0.535, 0.125, 0.045),
        ),
    ),
    "dog": _Kind(
        trunk=((-0.46, 0, 0.88), (-0.24, 0, 0.90), (0.04, 0, 0.88), (0.30, 0, 0.86)),
        neck=((0.47, 0, 0.90), (0.60, 0, 1.06)),
        head=(0.69, 0, 1.18),
        head_length=0.47,
        tail=(-0.57, 0, 0.88),
        tail_length=0.75,
        fore=(
            (0.365, 0.09, 0.93),
            (0.525, 0.12, 0.68),
            (0.375, 0.125, 0.53),
            (0.42, 0.115, 0.16),
            (0.465, 0.115, 0.04),
        ),
        hind=(
            (-0.45, 0.09, 0.76),
            (-0.32, 0.135, 0.51),
            (-0.555, 0.12, 0.26),
            (-0.465, 0.115, 0.04),
        ),
    ),
}


@dataclass(frozen=True, eq=False, slots=True)
class Anatomy:
    """Bones of one animal.

    Attributes
    ----------
    look : AnimalLook
    joints : dict of str to (str, (3,) float64)
        Parent, empty for the root, and place of each joint [m].
    head_m : float
        Length of the head from the neck to the nose [m].
    """

    look: AnimalLook
    joints: dict[str, tuple[str, Doubles]]
    head_m: float

    def __getitem__(self, name: str) -> Doubles:
        return self.joints[name][1]

    @property
    def unit(self) -> float:
        """Height of the withers [m]."""
        return self.look.height


def anatomy_of(look: AnimalLook) -> Anatomy:
    """Return the bones of an animal."""
    kind, unit = _KINDS[look.kind], look.height
    joints: dict[str, tuple[str, Doubles]] = {}

    def add(name: str, parent: str, place: Doubles) -> str:
        joints[name] = (parent, unit * place)
        return name

    def longer(place: Place) -> Doubles:
        return np.array([look.length * place[0], place[1], place[2]])

    parent = ""
    for name, place in zip(SPINE, kind.trunk, strict=True):
        parent = add(name, parent, longer(place))
    front = longer(kind.trunk[3]) - np.array(kind.trunk[3])
    base = np.array(kind.neck[0])
    add("neck01", "spine03", base + front)
    for name, parent, place in (
        ("neck02", "neck01", kind.neck[1]),
        ("head", "neck02", kind.head),
    ):
        add(name, parent, base + front + look.neck * (np.array(place) - base))
    head = joints["head"][1] / unit
    size = kind.head_length * look.head
    add("nose", "head", head + size * np.array([1.0, 0.0, 0.0]))
    for side, sign in (("L", 1.0), ("R", -1.0)):
        add(f"ear.{side}", "head", head + size * np.array(_EARS[look.kind]) * [1.0, sign, 1.0])
    add("belly", "spine02", longer((0.36, 0.0, 0.55)))
    back = longer(kind.trunk[0]) - np.array(kind.trunk[0])
    parent, at = "root", np.array(kind.tail) + back
    for number in range(TAIL_JOINTS):
        parent = add(f"tail{number + 1:02d}", parent, at)
        # It leaves the back with the back's slope, rises, and curls towards its tip.
        share = number / (TAIL_JOINTS - 1)
        angle = look.tail_up * min(1.0, 0.25 + 3.0 * share) + look.tail_curl * max(share - 0.3, 0.0)
        rise = np.radians(angle)
        step = kind.tail_length * look.tail / TAIL_JOINTS
        at = at + step * np.array([-np.cos(rise), 0.0, np.sin(rise)])
    for side, sign in (("L", 1.0), ("R", -1.0)):
        parent = "spine03"
        for name, place in zip(_FORE, kind.fore, strict=True):
            at = np.array(place) * [1.0, sign, 1.0] + front
            parent = add(f"{name}.{side}", parent, at)
        parent = "root"
        for name, place in zip(_HIND, kind.hind, strict=True):
            at = np.array(place) * [1.0, sign, 1.0] + back
            parent = add(f"{name}.{side}", parent, at)
    return Anatomy(look=look, joints=joints, head_m=size * unit)


_EARS = {"cat": (0.40, 0.27, 0.42), "dog": (0.25, 0.19, 0.235)}
"""Where ears begin, from the head's joint, over the head's length."""
