"""Leaves of doors that open and close: an object of its own, on a hinge.

A door's description and the frame of its wall in, looks, shapes and a joint out. The leaf's frame
is that of its door: the middle of the opening's foot in the wall's inner face, in the world's axes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from sailenv_ros.assets.rooms.doors import (
    closed_leaf_parts,
    hinge_point,
    leaf_box,
    opening_sense,
)
from sailenv_ros.assets.rooms.pieces import WallFrame, collision_of
from sailenv_ros.scene.spec_joints import JointSpec
from sailenv_ros.scene.spec_room import DoorSpec
from sailenv_ros.types.model import BoxShape, ModelPart

__all__ = ["DoorLeaf", "door_leaf"]

DENSITY_KG_M3 = 350.0
"""Density of a partly hollow wooden leaf: a door of 0.9 × 2.05 m weighs 23 kg."""

WIDEST_DEG = 115.0
"""Greatest opening angle of a leaf, unless its description opens it further [deg]."""

FRICTION_NM, DAMPING_NMS = 2.0, 1.0


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class DoorLeaf:
    """A leaf that moves.

    Attributes
    ----------
    parts : tuple of ModelPart
        As it is drawn while it is closed.
    shape : BoxShape
        What it collides as.
    mass_kg : float
    joint : JointSpec
    """

    parts: tuple[ModelPart, ...]
    shape: BoxShape
    mass_kg: float
    joint: JointSpec


def door_leaf(spec: DoorSpec, frame: WallFrame) -> DoorLeaf:
    """Return the leaf of a door; it opens with positive positions, into the room."""
    box = leaf_box(spec, frame)
    shape = collision_of(box)
    x, y, _ = hinge_point(spec, frame)
    volume = float(np.prod(np.subtract(box.high, box.low)))
    opened = math.radians(spec.open)
    joint = JointSpec(
        type="hinge",
        axis=(0.0, 0.0, opening_sense(spec, frame)),
        origin=(x, y, 0.0),
        limits=(0.0, max(math.radians(WIDEST_DEG), opened)),
        position=opened,
        friction=FRICTION_NM,
        damping=DAMPING_NMS,
    )
    return DoorLeaf(
        parts=closed_leaf_parts(spec, frame),
        shape=shape,
        mass_kg=DENSITY_KG_M3 * volume,
        joint=joint,
    )
