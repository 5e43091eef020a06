"""Collision shapes as geometries of MJCF."""

from __future__ import annotations

from collections.abc import Mapping
from xml.etree.ElementTree import Element, SubElement

from sailenv_ros.scene_export.mesh_files import hull_corners
from sailenv_ros.scene_export.mjcf_assets import MjcfAssets
from sailenv_ros.scene_export.xml_text import numbers
from sailenv_ros.types.model import (
    BoxShape,
    CollisionShape,
    ConvexShape,
    CylinderShape,
    SphereShape,
)
from sailenv_ros.world.body_creation import ROLLING_FRICTION

__all__ = ["add_shape"]


def add_shape(
    node: Element,
    shape: CollisionShape,
    assets: MjcfAssets,
    name: str,
    friction: float,
    labels: Mapping[str, str],
    *,
    rolls: bool,
) -> None:
    """Add a collision shape to a body.

    Parameters
    ----------
    node : Element
        Of the body.
    shape : CollisionShape
    assets : MjcfAssets
        Gets the hulls.
    name : str
    friction : float
        Two bodies have the product of theirs here and the greater of two in MuJoCo; what is written
        is right for two alike.
    labels : mapping of str to str
        Attributes that all geometries have.
    rolls : bool
        Whether it can roll and spin, which friction then brakes: of what moves.
    """
    entry = {"name": name, **labels}
    entry["friction"] = numbers((friction**2, ROLLING_FRICTION, ROLLING_FRICTION))
    if rolls:
        entry["condim"] = "6"
    if isinstance(shape, BoxShape):
        x, y, z, w = shape.orientation_xyzw
        entry |= {"type": "box", "size": numbers(shape.half_extents_m)}
        entry |= {"pos": numbers(shape.centre_m), "quat": numbers((w, x, y, z))}
    elif isinstance(shape, SphereShape):
        entry |= {"type": "sphere", "size": numbers((shape.radius_m,))}
        entry["pos"] = numbers(shape.centre_m)
    elif isinstance(shape, CylinderShape):
        size = (shape.radius_m, 0.5 * shape.height_m)
        entry |= {"type": "cylinder", "size": numbers(size), "pos": numbers(shape.centre_m)}
    elif isinstance(shape, ConvexShape):
        entry |= {"type": "mesh", "mesh": assets.hull(hull_corners(shape), name)}
    else:
        for number, corners in enumerate(shape.positions[shape.triangles]):
            plate = hull_corners(ConvexShape(points=corners))
            own = {"name": f"{name} {number}", "mesh": assets.hull(plate, name)}
            SubElement(node, "geom", {**entry, "type": "mesh", **own})
        return
    SubElement(node, "geom", entry)
