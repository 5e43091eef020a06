"""Links and joints of a file → one tree of links that can move, or a sentence why it cannot."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from sailenv_ros.assets.robots.link_assets import box_tensor, collision_of, drawn_parts
from sailenv_ros.assets.robots.raw_links import RawJoint, RawLink
from sailenv_ros.errors import AssetError
from sailenv_ros.types.geometry import Pose, invert
from sailenv_ros.types.inertia import Inertia
from sailenv_ros.types.model import Asset, Model
from sailenv_ros.types.robots import RobotFrame, RobotJoint, RobotLink, RobotModel

__all__ = ["MOST_LINKS", "assembled"]

MOST_LINKS = 120
"""Links of one robot; the engine takes no more joints in one body."""

MOST_IN_FILE = 2000
DEFAULT_FRICTION = 0.5
LIGHTEST_KG = 1e-4
"""Mass of a link that has none and is fixed to one that has."""


def assembled(
    name: str, links: Sequence[RawLink], joints: Sequence[RawJoint], *, file: str, key: str
) -> RobotModel:
    """Join the links of a file.

    Parameters
    ----------
    name : str
        Of the robot.
    links, joints
        As the file has them.
    file : str
        Its name, for errors.
    key : str
        Beginning of the names of the links' assets.

    Raises
    ------
    AssetError
        If they are not one tree, too many, or have no mass where they move.
    """
    if not links or len(links) > MOST_IN_FILE:
        raise AssetError(file, f"it has {len(links)} links, and 1 to {MOST_IN_FILE} are accepted")
    by_name = {link.name: link for link in links}
    _check_names(links, joints, by_name, file)
    above = {joint.child: joint for joint in joints}
    order = _ordered(links, joints, above, file)
    kept, frames, rests = _kept(order, by_name, above)
    if len(kept) > MOST_LINKS:
        raise AssetError(
            by_name[kept[MOST_LINKS]].place or file,
            f"it has {len(kept)} links, and {MOST_LINKS} are accepted",
        )
    _check_masses(kept, by_name, rests, file)
    _check_mimics(kept, rests, {name: joint.place or file for name, joint in above.items()})
    made = tuple(
        RobotLink(
            name=one,
            parent=rests[one][0],
            joint=rests[one][1],
            asset=_asset(by_name[one], f"{key}#{one}", file),
            friction=_friction(by_name[one]),
            spinning_friction=by_name[one].spinning_friction or 0.0,
        )
        for one in kept
    )
    if not any(link.asset.model.parts for link in made):
        raise AssetError(file, "nothing of it can be seen; a link with a geometry is needed")
    return RobotModel(name=name, links=made, frames=tuple(frames))


def _friction(link: RawLink) -> float:
    return DEFAULT_FRICTION if link.friction is None else link.friction


def _check_names(
    links: Sequence[RawLink],
    joints: Sequence[RawJoint],
    by_name: Mapping[str, RawLink],
    file: str,
) -> None:
    if len(by_name) < len(links):
        first = next(a for a in links if by_name[a.name] is not a)
        place = by_name[first.name].place or file
        raise AssetError(place, f"two links have the name {first.name[:80]!r}; one is accepted")
    named: set[str] = set()
    children: set[str] = set()
    for joint in joints:
        name, place = joint.joint.name, joint.place or file
        if name in named:
            raise AssetError(place, f"two joints have the name {name[:80]!r}; one is accepted")
        named.add(name)
        for end in (joint.parent, joint.child):
            if end not in by_name:
                shown = f"joint {name[:80]!r} joins link {end[:80]!r}"
                raise AssetError(place, f"{shown}, which is not there")
        if joint.child in children:
            why = f"link {joint.child[:80]!r} hangs on two joints; robots are trees, without loops"
            raise AssetError(place, why)
        children.add(joint.child)


def _ordered(
    links: Sequence[RawLink],
    joints: Sequence[RawJoint],
    above: Mapping[str, RawJoint],
    file: str,
) -> list[str]:
    roots = [link.name for link in links if link.name not in above]
    if not roots:
        raise AssetError(
            joints[0].place or file, "its joints form a loop; robots are trees, with one first link"
        )
    if len(roots) > 1:
        shown = ", ".join(repr(one[:40]) for one in roots[:4])
        place = next(link.place for link in links if link.name == roots[1]) or file
        raise AssetError(
            place, f"it has {len(roots)} links that hang on nothing ({shown}); one is accepted"
        )
    below: dict[str, list[str]] = {}
    for joint in joints:
        below.setdefault(joint.parent, []).append(joint.child)
    order = [roots[0]]
    for one in order:  # which grows meanwhile
        order += below.get(one, [])
    if len(order) < len(links):
        reached = set(order)
        looped = next(link for link in links if link.name not in reached)
        why = f"joints form a loop at link {looped.name[:80]!r}; robots are trees"
        raise AssetError(looped.place or file, why)
    return order


def _kept(
    order: Sequence[str], by_name: Mapping[str, RawLink], above: Mapping[str, RawJoint]
) -> tuple[list[str], list[RobotFrame], dict[str, tuple[str, RobotJoint]]]:
    """Return the links that become bodies, the others as frames, and parents with joints.

    A link without geometry and mass on a fixed joint is only a place. A first link of that kind
    gives way to the one that is fixed to it.
    """
    first = order[0]
    while True:
        below = [one for one in order if one in above and above[one].parent == first]
        if not _is_empty(by_name[first]) or len(below) != 1:
            break
        if above[below[0]].joint.type != "fixed":
            break
        first = below[0]
    kept: list[str] = []
    frames: list[RobotFrame] = []
    rests: dict[str, tuple[str, RobotJoint]] = {}
    places: dict[str, tuple[str, Pose]] = {first: (first, Pose())}
    climbing, pose = first, np.eye(4)
    while climbing in above:  # those above the new first one
        joint = above[climbing]
        pose = pose @ invert(joint.joint.parent_from_rest.matrix())
        climbing = joint.parent
        places[climbing] = (first, Pose.from_matrix(pose))
        frames.append(RobotFrame(name=climbing, link=first, pose=places[climbing][1]))
    for one in order:
        if one == first:
            kept.append(one)
            rests[one] = ("", RobotJoint())
            continue
        if one in places:
            continue
        joint = above[one]
        carrier, offset = places[joint.parent]
        rest = joint.joint.parent_from_rest
        if offset != Pose():
            rest = Pose.from_matrix(offset.matrix() @ rest.matrix())
        if joint.joint.type == "fixed" and _is_empty(by_name[one]):
            places[one] = (carrier, rest)
            frames.append(RobotFrame(name=one, link=carrier, pose=rest))
        else:
            kept.append(one)
            places[one] = (one, Pose())
            rests[one] = (carrier, replace(joint.joint, parent_from_rest=rest))
    return kept, frames, rests


def _is_empty(link: RawLink) -> bool:
    return not link.drawn and not link.collides and link.mass_kg <= 0.0


def _check_masses(
    kept: Sequence[str],
    by_name: Mapping[str, RawLink],
    rests: Mapping[str, tuple[str, RobotJoint]],
    file: str,
) -> None:
    """Refuse what moves without a mass, alone and with all that is fixed to it."""
    group: dict[str, str] = {}
    masses: dict[str, float] = {}
    for one in kept:
        parent, joint = rests[one]
        group[one] = group[parent] if parent and joint.type == "fixed" else one
        masses[group[one]] = masses.get(group[one], 0.0) + by_name[one].mass_kg
    for one in kept:
        if rests[one][1].type != "fixed" and masses[group[one]] <= 0.0:
            name = rests[one][1].name[:80]
            why = f"link {one[:80]!r} moves on joint {name!r} and has no <inertial>"
            place = by_name[one].place or file
            raise AssetError(place, f"{why}; a mass above 0 is needed")


def _check_mimics(
    kept: Sequence[str],
    rests: Mapping[str, tuple[str, RobotJoint]],
    places: Mapping[str, str],
) -> None:
    joints = {rests[one][1].name: rests[one][1] for one in kept}
    for child in kept:
        joint = rests[child][1]
        if joint.mimic is None:
            continue
        leader = joints.get(joint.mimic.joint)
        if leader is None or leader.type == "fixed" or leader.mimic is not None or leader is joint:
            shown = f"joint {joint.name[:80]!r} follows {joint.mimic.joint[:80]!r}"
            raise AssetError(
                places[child], f"{shown}, which must be a joint that moves and follows none"
            )


def _asset(link: RawLink, name: str, file: str) -> Asset:
    parts = drawn_parts(link.drawn, file)
    collision = collision_of(link.collides)
    mass = link.mass_kg
    tensor = link.tensor_kg_m2
    if mass <= 0.0:
        mass, tensor = LIGHTEST_KG, np.zeros((3, 3))
    if not tensor.any():
        points = [part.mesh.positions for part in parts] or [np.full((2, 3), 0.01)]
        tensor = box_tensor(np.concatenate(points), mass)
    inertia = Inertia.of_tensor(tensor)
    if min(inertia.moments_kg_m2) < -1e-9:
        shown = ", ".join(f"{value:.3g}" for value in inertia.moments_kg_m2)
        raise AssetError(
            link.place or file,
            f"the inertia of link {link.name[:80]!r} has moments below 0 ({shown})",
        )
    least = 1e-9
    x, y, z = (max(value, least) for value in inertia.moments_kg_m2)
    return Asset(
        name=name,
        display_name=name,
        category="robot",
        model=Model(name=name, parts=parts),
        collision=collision,
        mass_kg=mass,
        centre_of_mass_m=link.centre_m,
        inertia=replace(inertia, moments_kg_m2=(x, y, z)),
        opens=True,  # lit as what moves
    )
