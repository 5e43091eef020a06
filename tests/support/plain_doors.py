"""Doors, drawers and flaps of plain boxes, whose motion arithmetic knows."""

from __future__ import annotations

from typing import Any

from sailenv_ros.scene.spec import JointSpec
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.model import BoxShape
from sailenv_ros.world.placement import JointPlacement, Placement
from tests.support.simple_solids import placed, solid

__all__ = ["DOOR_INERTIA", "DOOR_KG", "DOOR_SIZE", "SCENE", "door", "joined"]

DOOR_SIZE = (0.8, 0.04, 2.0)
DOOR_KG = 20.0

DOOR_INERTIA = DOOR_KG * ((DOOR_SIZE[0] ** 2 + DOOR_SIZE[1] ** 2) / 12.0 + 0.4**2)
"""About a vertical axis at its narrow side [kg m²]."""

SCENE = """
version: 1
gravity: [0, 0, -9.81]
objects:
  - {name: cabinet, asset: cube, static: true, position: [2, 0, 0.5], rotation: [0, 0, 90]}
  - name: door
    asset: cube
    position: [0.6, 0, 0]
    scale: [0.05, 0.8, 1]
    mass: 10
    joint: {type: hinge, parent: cabinet, origin: [0, 0.4, 0], limits: [0, 1.5], friction: 0.5}
  - name: knob
    asset: cube
    position: [0.1, -0.3, 0]
    scale: 0.05
    joint: {type: fixed, parent: door}
  - name: drawer
    asset: cube
    position: [-0.6, 0, 0]
    scale: [0.5, 0.3, 0.3]
    mass: 4
    joint: {type: slide, parent: cabinet, axis: [-1, 0, 0], limits: [0, 0.4], friction: 5}
agents:
  - {name: eye, position: [-1, 1, 1.2], rotation: [0, 12, -18], following: false}
"""


def joined(
    name: str, spec: dict[str, Any], pose: Pose | None = None, parent: str = "", **keys: Any
) -> Placement:
    """A box on a joint; pose is that at the joint's position 0, in its parent's frame."""
    pose = pose or Pose()
    joint = JointPlacement(
        spec=JointSpec.model_validate(spec), parent=parent, parent_from_rest=pose
    )
    return placed(name, pose=pose, joint=joint, **keys)


def door(name: str = "door", **keys: Any) -> Placement:
    """A door of 0.8 × 0.04 × 2 m around its origin, hinged at x = -0.4, without friction."""
    half = (DOOR_SIZE[0] / 2.0, DOOR_SIZE[1] / 2.0, DOOR_SIZE[2] / 2.0)
    spec = {"type": "hinge", "origin": [-0.4, 0, 0], "friction": 0.0, **keys.pop("spec", {})}
    return joined(name, spec, asset=solid(BoxShape(half_extents_m=half)), mass_kg=DOOR_KG, **keys)
