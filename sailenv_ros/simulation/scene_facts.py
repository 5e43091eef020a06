"""Facts of a world beside its frames: what touches, lies in what, stands open, is made of what."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.frame.language.material_words import material_word
from sailenv_ros.frame.language.scene_facts import Gap, Opening, SceneFacts
from sailenv_ros.simulation.core import SimulationCore
from sailenv_ros.space.free_space import BodySize
from sailenv_ros.space.outlines import Solid
from sailenv_ros.space.solid_distances import MOST_CORNERS, solids_overlap
from sailenv_ros.types.labels import ROOM_PARTS
from sailenv_ros.types.snapshot import DrawnInstance, WorldSnapshot
from sailenv_ros.world.bodies import Body
from sailenv_ros.world.crowd import solids_of_body
from sailenv_ros.world.gaps import gaps
from sailenv_ros.world.world import World

__all__ = ["NEAR_M", "ROBOTS", "scene_facts"]

NEAR_M = 0.05
"""Distance up to which gaps between objects are told [m]."""

ROBOTS = tuple(BodySize(height_m=1.0, radius_m=radius) for radius in (0.15, 0.3, 0.45))
"""Robots whose free space is mapped."""

LEAST_ENCLOSED = 5

_SIDES = np.vstack([np.eye(3), -np.eye(3)])


def scene_facts(core: SimulationCore) -> SceneFacts:
    """Return what is known of the scene as it stands now; takes up to some seconds.

    ``simulation.read(scene_facts)`` asks a `Simulation`, which stands still meanwhile.
    """
    world = core.world
    snapshot = world.snapshot()
    whole = _wholes(snapshot)
    return SceneFacts(
        sim_time_ns=snapshot.sim_time_ns,
        gaps=_gaps(world, whole),
        enclosed=dict(_enclosed(world, snapshot, whole)),
        openings=_openings(world, whole),
        materials=_materials(snapshot.contents.instances, whole),
        spaces=tuple(core.space.free_space(robot) for robot in ROBOTS),
    )


def _wholes(snapshot: WorldSnapshot) -> Mapping[int, int]:
    """Return the object that each instance is a part of, or its own id."""
    parents = {one.instance.id: one.instance.parent for one in snapshot.contents.instances}

    def whole(id_: int) -> int:
        while parents.get(parents[id_]) is not None:
            id_ = parents[id_]
        return id_

    return {id_: whole(id_) for id_ in parents}


def _gaps(world: World, whole: Mapping[int, int]) -> dict[tuple[int, int], Gap]:
    found: dict[tuple[int, int], Gap] = {}

    def of_rooms(first: Body, second: Body) -> bool:
        return all("room" in body.placement.asset.tags for body in (first, second))

    for gap in gaps(world, NEAR_M, of_rooms):
        first, second = whole[gap.first], whole[gap.second]
        known = found.get((first, second))
        if first != second and (known is None or gap.gap_m < known.gap_m):
            found[first, second] = Gap(gap_m=gap.gap_m, rise=gap.rise)
            found[second, first] = Gap(gap_m=gap.gap_m, rise=-gap.rise)
    return found


def _enclosed(
    world: World, snapshot: WorldSnapshot, whole: Mapping[int, int]
) -> Iterator[tuple[tuple[int, int], int]]:
    """Yield inner and outer objects, and how many of six directions meet the outer one."""
    boxes = {
        one.instance.id: _Box(one, pose)
        for one, pose in zip(snapshot.contents.instances, snapshot.world_from_body, strict=True)
        if whole[one.instance.id] == one.instance.id
        and one.outside is None
        and one.instance.category not in ROOM_PARTS
    }
    bodies: dict[int, list[Body]] = {}
    for id_, body in world.numbered_bodies:
        bodies.setdefault(whole[id_], []).append(body)
    solids: dict[int, list[Solid]] = {}
    for (inner, own), (outer, box) in itertools.permutations(boxes.items(), 2):
        if own.volume_m3 >= box.volume_m3 or not box.has(own.middle):
            continue
        if outer not in solids:
            made = (solid for body in bodies[outer] for solid in solids_of_body(body))
            solids[outer] = [one for one in made if len(one.points) <= MOST_CORNERS]
        below = own.middle - (0.0, 0.0, box.reach_m)
        if not _meets(own.middle, below, solids[outer]):
            continue
        ends = own.middle + _SIDES @ box.turn.T * box.reach_m
        met = sum(_meets(own.middle, end, solids[outer]) for end in ends)
        if met >= LEAST_ENCLOSED:
            yield (inner, outer), met


class _Box:
    """The box around an object: its middle, axes and half sides in the world."""

    def __init__(self, drawn: DrawnInstance, pose: NDArray[np.float64]) -> None:
        low, high = np.asarray(drawn.instance.low_m), np.asarray(drawn.instance.high_m)
        self.turn = pose[:3, :3]
        self.middle = self.turn @ (0.5 * (low + high)) + pose[:3, 3]
        self.half = 0.5 * (high - low)
        self.volume_m3 = float((high - low).prod())
        self.reach_m = float(np.linalg.norm(high - low))

    def has(self, point: NDArray[np.float64]) -> bool:
        """Return whether a point of the world is inside."""
        return bool((np.abs(self.turn.T @ (point - self.middle)) <= self.half).all())


def _meets(start: NDArray[np.float64], end: NDArray[np.float64], solids: Sequence[Solid]) -> bool:
    line = Solid(np.stack([start, end]))
    return any(solids_overlap(line, solid) for solid in solids)


def _openings(world: World, whole: Mapping[int, int]) -> dict[int, Opening]:
    found: dict[int, Opening] = {}
    for joint in world.joints():
        far = joint.high if abs(joint.high) > abs(joint.low) else joint.low
        if 0.0 < abs(far) < np.inf:
            found[joint.id] = Opening(
                whole=whole[joint.id],
                position=joint.position,
                share=joint.position / far,
            )
    return found


def _materials(
    instances: Sequence[DrawnInstance], whole: Mapping[int, int]
) -> dict[int, dict[str, float]]:
    """Return the shares of each object's surface, its parts' too, by words for materials."""
    areas: dict[int, dict[str, float]] = {}
    for drawn in instances:
        own = areas.setdefault(whole[drawn.instance.id], {})
        for part in drawn.model.parts:
            # What was painted keeps the names of what it was.
            word = "" if drawn.instance.painted else material_word(part.material.name)
            points = part.mesh.positions * np.asarray(drawn.scale)
            a, b, c = (points[part.mesh.triangles[:, k]] for k in range(3))
            area = 0.5 * float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum())
            own[word] = own.get(word, 0.0) + area
    return {
        id_: {word: area / sum(own.values()) for word, area in own.items()}
        for id_, own in areas.items()
        if sum(own.values()) > 0.0
    }
