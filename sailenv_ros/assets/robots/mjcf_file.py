"""MJCF → links and joints, as MuJoCo tells of them from a process of its own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.assets.meshes import RawMesh
from sailenv_ros.assets.robots.raw_links import RawGeometry, RawJoint, RawLink
from sailenv_ros.assets.robots.read_apart import checked_tree, read_apart
from sailenv_ros.errors import AssetError
from sailenv_ros.extras import need
from sailenv_ros.types.colour import linear_from_srgb
from sailenv_ros.types.geometry import Pose, invert
from sailenv_ros.types.robots import Mimic, Mount, RobotJoint

__all__ = ["MjcfContent", "read_mjcf"]

Doubles = NDArray[np.float64]

# MuJoCo's numbers, which its files fix.
_FREE, _BALL, _SLIDE, _HINGE = 0, 1, 2, 3
_SPHERE, _CAPSULE, _ELLIPSOID, _CYLINDER, _BOX, _MESH = 2, 3, 4, 5, 6, 7

MIDDLE_RAD = 1.5
"""Farthest that the middle hinge of a ball joint turns: at a right angle the others are one."""

LIGHTEST_KG = 1e-3
"""Mass of what is between two joints of one body."""

UNLIMITED_EFFORT, UNLIMITED_SPEED = 1000.0, 100.0


@dataclass(frozen=True, eq=False, kw_only=True)
class MjcfContent:
    """Content of a file: its one robot.

    Attributes
    ----------
    links : list of RawLink
    joints : list of RawJoint
    mount : {'fixed', 'free'}
    start : dict of str to float
        Positions of joints at the start that are not 0.
    """

    links: list[RawLink] = field(default_factory=list)
    joints: list[RawJoint] = field(default_factory=list)
    mount: Mount = "fixed"
    start: dict[str, float] = field(default_factory=dict)


def read_mjcf(path: Path) -> MjcfContent:
    """Return the links and joints of a MJCF file; what belongs to its world is left out.

    Several bodies on the world are one robot, whose first link is the world. A ball joint is three
    hinges about x, y and z, of which the middle one does not reach a right angle.

    Raises
    ------
    AssetError
        If it is malformed, or holds several robots of which one moves freely.
    MissingPackage
        If MuJoCo is not installed.
    """
    need("mujoco", "reading MJCF")
    tree = checked_tree(path)
    read, arrays = read_apart(path)
    bodies: list[dict[str, Any]] = read["bodies"]
    places = {node.text("name"): node.place for node in tree.walk() if node.tag == "body"}
    for body in bodies:
        body["place"] = places.get(body["name"], "")
    roots = [number for number, body in enumerate(bodies) if number and body["parent"] == 0]
    if not roots:
        raise AssetError(path.name, "its world holds no body, and a robot is one at least")
    frees = [number for number in roots if _is_free(bodies[number])]
    if frees and len(roots) > 1:
        why = f"its world holds {len(roots)} bodies, of which this one moves freely"
        raise AssetError(
            bodies[frees[0]]["place"] or path.name,
            f"{why}; a robot is one with all that it carries",
        )
    followers = {one["joint"]: one for one in read["followers"] if one["joint"]}
    geoms: dict[int, list[Mapping[str, Any]]] = {}
    for geom in read["geoms"]:
        geoms.setdefault(geom["body"], []).append(geom)
    content = MjcfContent(mount="free" if frees else "fixed")
    names = {number: body["name"] or f"body {number}" for number, body in enumerate(bodies)}
    if not frees and (len(roots) > 1 or bodies[roots[0]]["joints"]):
        content.links.append(RawLink(name="world"))
        names[0] = "world"
    for number, body in enumerate(bodies):
        if number == 0:
            continue
        joints = [one for joint in body["joints"] for one in _plain_joints(joint, names[number])]
        own = geoms.get(number, [])
        content.links.append(_link(names[number], body, own, arrays))
        if names[body["parent"]] in {link.name for link in content.links}:
            _add_joints(content, names[body["parent"]], names[number], body, joints, followers)
    return content


def _is_free(body: Mapping[str, Any]) -> bool:
    return any(joint["type"] == _FREE for joint in body["joints"])


def _plain_joints(joint: Mapping[str, Any], body: str) -> list[Mapping[str, Any]]:
    """Return the hinges and slides of which a joint is made; none of one that is free."""
    if joint["type"] == _FREE:
        return []
    if joint["type"] != _BALL:
        return [joint]
    w, x, y, z = joint["start_quat_wxyz"]
    turn = Pose(orientation_xyzw=(x, y, z, w)).matrix()[:3, :3]
    starts = (
        np.arctan2(-turn[1, 2], turn[2, 2]),
        np.arcsin(np.clip(turn[0, 2], -1.0, 1.0)),
        np.arctan2(-turn[0, 1], turn[0, 0]),
    )
    most = joint["range"][1] if joint["limited"] else np.inf
    name = joint["name"] or f"{body} ball"
    hinges: list[Mapping[str, Any]] = []
    for letter, axis, start in zip("xyz", np.eye(3).tolist(), starts, strict=True):
        reach = min(most, MIDDLE_RAD) if letter == "y" else most
        hinge = {"name": f"{name} {letter}", "type": _HINGE, "axis": axis, "start": float(start)}
        hinge |= {"limited": bool(np.isfinite(reach)), "range": [-reach, reach], "reference": 0.0}
        hinges.append({**joint, **hinge})
    return hinges


def _add_joints(
    content: MjcfContent,
    parent: str,
    child: str,
    body: Mapping[str, Any],
    joints: Sequence[Mapping[str, Any]],
    followers: Mapping[str, Mapping[str, Any]],
) -> None:
    """Join a body to its parent: fixed, by one joint, or by several one after another."""
    rest = _pose(body["rest_position"], body["rest_quat_wxyz"])
    if not joints:
        fixed = RobotJoint(name=f"{child} fixed", parent_from_rest=rest)
        content.joints.append(
            RawJoint(parent=parent, child=child, joint=fixed, place=body["place"])
        )
        return
    for number, joint in enumerate(joints, 1):
        last = number == len(joints)
        below = child if last else f"{child} {number}"
        if not last:
            content.links.append(
                RawLink(name=below, mass_kg=LIGHTEST_KG, tensor_kg_m2=np.eye(3) * 1e-6)
            )
        made = _joint(joint, rest, followers, f"{child} joint {number}")
        content.joints.append(RawJoint(parent=parent, child=below, joint=made, place=body["place"]))
        if joint["start"]:
            content.start[made.name] = float(joint["start"])
        parent, rest = below, Pose()


def _joint(
    joint: Mapping[str, Any], rest: Pose, followers: Mapping[str, Mapping[str, Any]], name: str
) -> RobotJoint:
    low, high = (value - joint["reference"] for value in joint["range"])
    follows = followers.get(joint["name"])
    x, y, z = joint["axis"]
    ox, oy, oz = joint["origin"]
    slides = joint["type"] == _SLIDE
    return RobotJoint(
        name=joint["name"] or name,
        type="slide" if slides else "hinge",
        parent_from_rest=rest,
        axis=(x, y, z),
        origin_m=(0.0, 0.0, 0.0) if slides else (ox, oy, oz),
        limits=(low, high) if joint["limited"] else None,
        effort=joint["effort"] or UNLIMITED_EFFORT,
        speed=UNLIMITED_SPEED,
        damping=joint["damping"],
        friction=joint["friction"],
        mimic=None
        if follows is None
        else Mimic(
            joint=follows["leader"], multiplier=follows["multiplier"], offset=follows["offset"]
        ),
    )


def _link(
    name: str,
    body: Mapping[str, Any],
    geoms: Sequence[Mapping[str, Any]],
    arrays: Mapping[str, Doubles],
) -> RawLink:
    here = invert(_pose(body["position"], body["quat_wxyz"]).matrix())
    made = [(geom, _geometry(geom, here, arrays)) for geom in geoms]
    drawn = [one for geom, one in made if one and geom["drawn"] and geom["rgba"][3] > 0.0]
    axes = _pose((0.0, 0.0, 0.0), body["axes_wxyz"]).matrix()[:3, :3]
    x, y, z = body["centre"]
    return RawLink(
        name=name,
        drawn=drawn or [one for _, one in made if one],
        collides=[one for geom, one in made if one and geom["collides"]],
        mass_kg=body["mass"],
        centre_m=(x, y, z),
        tensor_kg_m2=axes @ np.diag(body["moments"]) @ axes.T,
        place=body["place"],
    )


def _geometry(
    geom: Mapping[str, Any], body_from_world: Doubles, arrays: Mapping[str, Doubles]
) -> RawGeometry | None:
    """Return a geometry in its body's frame; None for kinds that no robot is made of."""
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = np.array(geom["matrix"]).reshape(3, 3), geom["position"]
    pose = Pose.from_matrix(body_from_world @ matrix)
    kind, (a, b, c) = geom["type"], geom["size"]
    red, green, blue, alpha = (min(max(float(v), 0.0), 1.0) for v in geom["rgba"])
    red, green, blue = linear_from_srgb(np.array([red, green, blue])).tolist()
    shine = min(max(float(geom["shininess"]), 0.0), 1.0)
    look: dict[str, Any] = {
        "pose": pose,
        "colour": (red, green, blue, alpha),
        "roughness": 0.9 - 0.7 * shine,
    }
    if kind == _BOX:
        return RawGeometry(kind="box", size=(2 * a, 2 * b, 2 * c), **look)
    if kind == _SPHERE:
        return RawGeometry(kind="sphere", size=(a,), **look)
    if kind == _ELLIPSOID:
        return RawGeometry(kind="ellipsoid", size=(a, b, c), **look)
    if kind == _CYLINDER:
        return RawGeometry(kind="cylinder", size=(a, 2 * b), **look)
    if kind == _CAPSULE:
        return RawGeometry(kind="capsule", size=(a, 2 * b), **look)
    if kind == _MESH and f"vertices_{geom['mesh']}" in arrays:
        points = arrays[f"vertices_{geom['mesh']}"]
        mesh = RawMesh(
            positions=points,
            uvs=np.zeros((len(points), 2)),
            triangles=arrays[f"faces_{geom['mesh']}"].astype(np.int64),
        )
        return RawGeometry(kind="mesh", mesh=mesh, **look)
    return None


def _pose(position: Sequence[float], quat_wxyz: Sequence[float]) -> Pose:
    w, x, y, z = quat_wxyz
    px, py, pz = position
    return Pose((px, py, pz), (x, y, z, w))
