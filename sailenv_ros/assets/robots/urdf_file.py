"""URDF, as xacro writes it, → links and joints.

Read by us and not by MuJoCo, so that the colours of mesh files are kept and MuJoCo can judge.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.assets.robots.mesh_paths import mesh_path
from sailenv_ros.assets.robots.raw_links import RawGeometry, RawJoint, RawLink
from sailenv_ros.assets.safe_xml import XmlNode
from sailenv_ros.errors import AssetError
from sailenv_ros.types.colour import linear_from_srgb
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.robots import Mimic, Mount, RobotJoint

__all__ = ["described", "mount_of", "read_urdf"]

Colour = tuple[float, float, float, float]

UNLIMITED_EFFORT = 1000.0
"""Effort of a joint whose file sets none [N m], [N]."""

UNLIMITED_SPEED = 100.0
LARGEST = 1e6

_TYPES: Mapping[str, Literal["hinge", "slide", "fixed"]] = {
    "revolute": "hinge",
    "continuous": "hinge",
    "prismatic": "slide",
    "fixed": "fixed",
}

_DRIVES: Mapping[Mount, re.Pattern[str]] = {
    "differential": re.compile(r"diff[-_]?drive|skid[-_]?steer", re.IGNORECASE),
    "mecanum": re.compile("mecanum", re.IGNORECASE),
    "ackermann": re.compile("ackermann", re.IGNORECASE),
}
"""Gazebo's plugins that drive a robot, by the names of their files, of all its generations."""

_OPTIONAL = re.compile(r"\$\(optenv\s+\w+\s*([^)]*)\)")


def read_urdf(root: XmlNode, path: Path) -> tuple[list[RawLink], list[RawJoint]]:
    """Return the links and joints of a URDF file.

    Parameters
    ----------
    root : XmlNode
        Its ``<robot>``.
    path : Path
        From which meshes are found.

    Raises
    ------
    AssetError
        If something of it is malformed or missing.
    """
    for node in root.walk():
        if node.tag.startswith("xacro:"):
            why = f"<{node.tag}> is not expanded yet; write the output of xacro"
            raise AssetError(node.place, why)
        # What xacro would put there where no variable says otherwise.
        for key, value in node.attributes.items():
            if "$(optenv" in value:
                node.attributes[key] = _OPTIONAL.sub(lambda found: found[1], value)
    colours = _colours(root)
    links = [_link(node, colours, path) for node in root.all("link")]
    joints = [_joint(node) for node in root.all("joint")]
    return links, joints


def mount_of(root: XmlNode) -> Mount:
    """Return how a robot stands: on wheels, if a plugin of Gazebo drives it so; else fixed."""
    files = [node.text("filename") for node in root.walk() if node.tag == "plugin"]
    turning = any(node.text("type") == "continuous" for node in root.all("joint"))
    driven = (
        mount for mount, words in _DRIVES.items() if any(words.search(file) for file in files)
    )
    return next(driven, "fixed") if turning else "fixed"


def described(text: str, path: Path) -> str:
    """Return the text of a URDF with full paths of the meshes that it names."""

    def full(found: re.Match[str]) -> str:
        named = found[2]
        try:
            return f"{found[1]}file://{mesh_path(named, path)}{found[3]}"
        except AssetError:
            return found[0]

    return re.sub(r'(<mesh\b[^>]*\bfilename=")([^"]*)(")', full, text)


def _colours(root: XmlNode) -> dict[str, Colour]:
    found: dict[str, Colour] = {}
    for node in root.walk():
        if node.tag == "material" and node.text("name"):
            colour = _colour(node)
            if colour is not None:
                found.setdefault(node.text("name"), colour)
    return found


def _colour(material: XmlNode) -> Colour | None:
    node = material.first("color")
    rgba = None if node is None else node.numbers("rgba", 4)
    if rgba is None:
        return None
    red, green, blue, alpha = (min(max(value, 0.0), 1.0) for value in rgba)
    red, green, blue = linear_from_srgb(np.array([red, green, blue])).tolist()
    return red, green, blue, alpha


def _link(node: XmlNode, colours: Mapping[str, Colour], path: Path) -> RawLink:
    mass, centre, tensor = 0.0, Pose(), np.zeros((3, 3))
    inertial = node.first("inertial")
    if inertial is not None:
        mass_node, inertia = inertial.first("mass"), inertial.first("inertia")
        mass = 0.0 if mass_node is None else mass_node.number("value", most=LARGEST)
        centre = _pose(inertial)
        if mass < 0.0:
            name = node.text("name")[:80]
            raise AssetError(
                node.place, f"the mass of link {name!r} must not be below 0, got {mass:g}"
            )
        if inertia is not None:
            tensor = _tensor(inertia)
            turn = centre.matrix()[:3, :3]
            tensor = turn @ tensor @ turn.T
    return RawLink(
        name=node.text("name"),
        drawn=[_geometry(one, colours, path) for one in node.all("visual")],
        collides=[_geometry(one, colours, path) for one in node.all("collision")],
        mass_kg=mass,
        centre_m=centre.position_m,
        tensor_kg_m2=tensor,
        friction=_contact(node, "lateral_friction", 10.0),
        spinning_friction=_contact(node, "spinning_friction", 1.0),
        place=node.place,
    )


def _contact(link: XmlNode, tag: str, most: float) -> float | None:
    """Return a number of a link's contact, as Bullet's URDF has it; None if it is not there."""
    contact = link.first("contact")
    node = None if contact is None else contact.first(tag)
    return None if node is None else min(abs(node.number("value")), most)


def _tensor(node: XmlNode) -> NDArray[np.float64]:
    xx, xy, xz, yy, yz, zz = (
        node.number(key, most=LARGEST) for key in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
    )
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def _geometry(node: XmlNode, colours: Mapping[str, Colour], path: Path) -> RawGeometry:
    pose, geometry = _pose(node), node.first("geometry")
    shape = None if geometry is None or not geometry.children else geometry.children[0]
    if shape is None:
        raise AssetError(node.place, f"a <{node.tag}> has no geometry")
    material = node.first("material")
    colour = None
    if material is not None:
        colour = _colour(material) or colours.get(material.text("name"))
    if shape.tag == "mesh":
        scale = shape.numbers("scale", 3) or [1.0, 1.0, 1.0]
        return RawGeometry(
            kind="mesh",
            pose=pose,
            file=mesh_path(shape.text("filename"), path, shape.place),
            scale=(scale[0], scale[1], scale[2]),
            colour=colour,
        )
    if shape.tag == "box":
        size = tuple(shape.numbers("size", 3) or ())
    elif shape.tag in ("cylinder", "capsule"):
        size = (shape.number("radius"), shape.number("length"))
    elif shape.tag == "sphere":
        size = (shape.number("radius"),)
    else:
        known = "box, sphere, cylinder, capsule or mesh"
        raise AssetError(shape.place, f"geometry must be a {known}, got <{shape.tag[:40]}>")
    if not size or not all(1e-6 <= value <= 100.0 for value in size):
        raise AssetError(
            shape.place, f"sizes of <{shape.tag}> must be from 1e-6 to 100 m, got {size}"
        )
    kind = shape.tag
    return RawGeometry(kind=kind, size=size, pose=pose, colour=colour)  # type: ignore[arg-type]  # one of the kinds, as checked


def _joint(node: XmlNode) -> RawJoint:
    name, kind = node.text("name"), node.text("type")
    if kind not in _TYPES:
        accepted = "revolute, continuous, prismatic or fixed"
        raise AssetError(
            node.place, f"type of joint {name[:80]!r} must be {accepted}, got {kind[:40]!r}"
        )
    ends = []
    for tag in ("parent", "child"):
        end = node.first(tag)
        if end is None or not end.text("link"):
            raise AssetError(node.place, f"joint {name[:80]!r} has no {tag}")
        ends.append(end.text("link"))
    limit, dynamics, axis = node.first("limit"), node.first("dynamics"), node.first("axis")
    direction = (axis.numbers("xyz", 3) if axis is not None else None) or [1.0, 0.0, 0.0]
    if kind != "fixed" and not np.linalg.norm(direction) > 1e-9:
        raise AssetError(node.place, f"the axis of joint {name[:80]!r} must not be all 0")
    limits = None
    if kind in ("revolute", "prismatic"):
        if limit is None:
            raise AssetError(node.place, f"joint {name[:80]!r} is {kind} and has no <limit>")
        limits = (limit.number("lower", most=1e4), limit.number("upper", most=1e4))
        if limits[0] > limits[1]:
            shown = f"lower={limits[0]:g} upper={limits[1]:g}"
            accepted = "two numbers, the lower one first"
            raise AssetError(
                limit.place, f"limits of joint {name[:80]!r} must be {accepted}, got {shown}"
            )
    effort, speed = (
        (0.0 if limit is None else abs(limit.number(key, most=1e12)))
        for key in ("effort", "velocity")
    )
    mimic = node.first("mimic")
    return RawJoint(
        parent=ends[0],
        child=ends[1],
        place=node.place,
        joint=RobotJoint(
            name=name,
            type=_TYPES[kind],
            parent_from_rest=_pose(node),
            axis=(direction[0], direction[1], direction[2]),
            limits=limits,
            effort=min(effort or UNLIMITED_EFFORT, LARGEST),
            speed=min(speed or UNLIMITED_SPEED, UNLIMITED_SPEED),
            damping=0.0 if dynamics is None else min(abs(dynamics.number("damping")), LARGEST),
            friction=0.0 if dynamics is None else min(abs(dynamics.number("friction")), LARGEST),
            mimic=None
            if mimic is None
            else Mimic(
                joint=mimic.text("joint"),
                multiplier=mimic.number("multiplier", 1.0, most=1e4),
                offset=mimic.number("offset", 0.0, most=1e4),
            ),
        ),
    )


def _pose(node: XmlNode) -> Pose:
    """Return the pose of an element's origin."""
    origin = node.first("origin")
    if origin is None:
        return Pose()
    x, y, z = origin.numbers("xyz", 3) or (0.0, 0.0, 0.0)
    rpy = origin.numbers("rpy", 3) or (0.0, 0.0, 0.0)
    try:
        return Pose.from_rpy_deg((x, y, z), np.degrees(rpy))
    except ValueError as problem:
        raise AssetError(origin.place, f"a place is too far away: {problem}") from None
