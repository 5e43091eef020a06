"""Camera poses in each frame of a clip, from a recipe's camera and the scene as it stands.

Every kind of camera is one function, in `TRACKS`. A pose is that of the camera's body (x forward,
y left, z up) in the world.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.dataset.recipe_cameras import (
    AnyCamera,
    FixedCamera,
    MountedCamera,
    OrbitCamera,
    Range,
    RuleCamera,
    WalkCamera,
)
from sailenv_ros.dataset.recipe_choices import AGENT_PREFIX
from sailenv_ros.errors import InvalidRequest, InvalidState, NoFreeSpace
from sailenv_ros.scene.randomise.selectors import Selector, is_meant
from sailenv_ros.simulation.script.rule_places import look_lens
from sailenv_ros.simulation.synchronous import SynchronousSimulation
from sailenv_ros.space.free_space import FreeSpace
from sailenv_ros.types.geometry import Pose, look_at

__all__ = ["Track", "place_cameras", "track_of", "turning"]

ATTEMPTS = 200
"""Places that are tried before a camera has none."""

WALKS = 24
"""Walks that are looked at for one that shows enough; then the best of them is taken."""

LOOK_EVERY_S = 0.5

BODY_HEAD_M = 0.1
"""Room above a camera's eye [m]."""

LOOK_AHEAD_M = 0.6
"""A walker faces the place where it is so much later [m]."""

Track: TypeAlias = Sequence[Pose]
"""A pose for each frame of a clip."""

Times: TypeAlias = NDArray[np.float64]
"""(T,) since the clip's first frame [s]."""

Vector3: TypeAlias = NDArray[np.float64]


def track_of(
    camera: Any, scene: SynchronousSimulation, times_s: Times, random: np.random.Generator
) -> Track:
    """Return where a camera of a recipe is at each time.

    Parameters
    ----------
    camera : FixedCamera, WalkCamera or OrbitCamera
    scene : SynchronousSimulation
        Is asked for free space, for rays and for its objects, as they are now.
    times_s : (T,) float64
        Since the first frame [s].
    random : Generator

    Raises
    ------
    NoFreeSpace
        If there is none by the recipe's rules.
    """
    return TRACKS[type(camera)](camera, scene, times_s, random)


def turning(start: Pose, camera: RuleCamera, times_s: Times, random: np.random.Generator) -> Track:
    """Return the poses of a camera that turns about the vertical where it stands."""
    roll, pitch, yaw = start.rpy_deg
    turn = _within(camera.turn, random)
    if turn == 0.0:
        return [start] * len(times_s)
    return [
        Pose.from_rpy_deg(start.position_m, (roll, pitch, yaw + turn * time)) for time in times_s
    ]


def _fixed(
    camera: FixedCamera, scene: SynchronousSimulation, times_s: Times, random: np.random.Generator
) -> Track:
    return [camera.pose_at(camera.position)] * len(times_s)


def _walk(
    camera: WalkCamera, scene: SynchronousSimulation, times_s: Times, random: np.random.Generator
) -> Track:
    space = _space(camera, scene)
    if camera.filled == 0.0:
        return _walk_in(space, camera, times_s, random)
    view = scene.view_scene(look_lens(camera.intrinsics))
    looks = _looks(times_s)
    best: tuple[float, Track] = (-1.0, ())
    for _ in range(WALKS):
        track = _walk_in(space, camera, times_s, random)
        least = 1.0
        for number in looks:
            least = min(least, view.filled(track[number]))
            if least <= best[0]:
                break
        else:
            best = least, track
        if best[0] >= camera.filled:
            break
    return best[1]


def _walk_in(
    space: FreeSpace, camera: WalkCamera, times_s: Times, random: np.random.Generator
) -> Track:
    height = _within(camera.eye_height, random)
    pitch, speed = _within(camera.pitch, random), _within(camera.speed, random)
    needed_m = speed * float(times_s[-1])
    corners = [np.asarray(_random_eye(camera, space, random))]
    length = 0.0
    while length <= needed_m:
        goal = _random_eye(camera, space, random)
        way = space.path(corners[-1], goal)
        length += float(np.linalg.norm(np.diff(way[:, :2], axis=0), axis=1).sum())
        corners += list(way[1:])
        if len(corners) > ATTEMPTS * 100:
            raise NoFreeSpace("no path of that length")
    path = np.array(corners)
    path[:, 2] = space.body.floor_m + height
    return _along(path, speed * times_s, pitch)


def _looks(times_s: Times) -> list[int]:
    """Return the numbers of frames at which a walk is looked at, the first and the last too."""
    count = 1 + math.ceil(float(times_s[-1] - times_s[0]) / LOOK_EVERY_S)
    return sorted(set(np.linspace(0, len(times_s) - 1, count).round().astype(int).tolist()))


def _orbit(
    camera: OrbitCamera, scene: SynchronousSimulation, times_s: Times, random: np.random.Generator
) -> Track:
    for _ in range(ATTEMPTS):
        target = None
        if camera.point is not None:
            middle = np.asarray(camera.point)
        else:
            target = _target(camera.object or (), scene, random)
            middle = target.middle
        away, turn = _within(camera.distance, random), _within(camera.turn, random)
        elevation = math.radians(_within(camera.elevation, random))
        azimuth = float(random.uniform(-math.pi, math.pi))
        angles = azimuth + np.radians(turn) * times_s
        flat, up = math.cos(elevation) * away, np.full_like(angles, math.sin(elevation) * away)
        ways = np.stack([flat * np.cos(angles), flat * np.sin(angles), up], axis=1)
        if _in_sight(scene, middle, middle + ways, target):
            return [look_at(eye, middle) for eye in middle + ways]
    sought = camera.point if camera.object is None else _told(camera.object)
    raise NoFreeSpace(f"no free sight of {sought}")


def place_cameras(
    cameras: Sequence[AnyCamera],
    tracks: Mapping[str, Track | None],
    number: int,
    scene: SynchronousSimulation,
) -> None:
    """Bring the agents of a recipe's cameras to where they are in a frame of a clip.

    Parameters
    ----------
    cameras : sequence of AnyCamera
    tracks : mapping of str to Track or None
        By the cameras' names; None for one that an agent's mover or another camera has.
    number : int
        Of the frame in the clip; in the first one the cameras are there without having moved.
    scene : SynchronousSimulation
    """
    for camera in cameras:
        track = tracks[camera.name]
        if track is not None:
            name = f"{AGENT_PREFIX}{camera.name}"
            scene.set_pose(track[number], teleport=number == 0, agent=name)
    for camera in cameras:  # now that those are where they are which carry others
        if isinstance(camera, MountedCamera):
            carrier = scene.get_agent_pose(agent=f"{AGENT_PREFIX}{camera.on}").pose
            pose, name = carrier.carried(camera.extrinsics), f"{AGENT_PREFIX}{camera.name}"
            scene.set_pose(pose, teleport=number == 0, agent=name)


TRACKS: Mapping[type, Callable[..., Track]] = MappingProxyType(
    {
        FixedCamera: _fixed,
        WalkCamera: _walk,
        OrbitCamera: _orbit,
    }
)


# -- places ------------------------------------------------------------------------------------


def _within(ends: Range, random: np.random.Generator) -> float:
    return float(random.uniform(*ends)) if ends[0] < ends[1] else ends[0]


def _space(camera: WalkCamera, scene: SynchronousSimulation) -> FreeSpace:
    try:
        return scene.free_space(camera.eye_height[1] + BODY_HEAD_M, camera.clearance)
    except InvalidState as problem:
        raise NoFreeSpace(str(problem)) from None


def _random_eye(camera: WalkCamera, space: FreeSpace, random: np.random.Generator) -> Vector3:
    try:
        pose = space.random_pose(seed=int(random.integers(2**63)))
    except InvalidState as problem:
        raise NoFreeSpace(str(problem)) from None
    x, y, floor_m = pose.position_m
    return np.array([x, y, floor_m + _within(camera.eye_height, random)])


def _along(path: NDArray[np.float64], distances_m: Times, pitch_deg: float) -> Track:
    """Return poses at distances along a path, each facing where the way goes a little later."""
    steps = np.diff(path, axis=0)
    lengths = np.linalg.norm(steps, axis=1)
    kept = np.append(True, lengths > 0.0)
    path, at = path[kept], np.append(0.0, np.cumsum(lengths[lengths > 0.0]))

    def places(distances: Times) -> NDArray[np.float64]:
        return np.stack([np.interp(distances, at, path[:, axis]) for axis in range(3)], axis=1)

    eyes, ahead = places(distances_m), places(np.minimum(distances_m + LOOK_AHEAD_M, at[-1]))
    behind = places(np.maximum(np.minimum(distances_m, at[-1] - LOOK_AHEAD_M), 0.0))
    ways = ahead - behind
    yaws = np.degrees(np.arctan2(ways[:, 1], ways[:, 0]))
    return [
        Pose.from_rpy_deg(eye, (0.0, pitch_deg, yaw)) for eye, yaw in zip(eyes, yaws, strict=True)
    ]


# -- objects -----------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _Target:
    """An object to be seen: its middle in the world [m], and the ids of it and its parts."""

    middle: Vector3
    ids: tuple[int, ...]


def _target(
    selectors: Sequence[Selector], scene: SynchronousSimulation, random: np.random.Generator
) -> _Target:
    """Return one of the objects that are meant; a name that none has may be a category."""
    instances = scene.info.instances
    meant: set[int] = set()
    for selector in selectors:
        met = {one.id for one in instances if is_meant(selector, one.name, one.category)}
        meant |= met or {one.id for one in instances if one.category == selector}
    chosen = [one for one in instances if one.id in meant]
    if not chosen:
        raise NoFreeSpace(f"no object and no category {_told(selectors)} in the scene")
    one = chosen[int(random.integers(len(chosen)))]
    try:
        body = scene.get_object(one.id)
    except InvalidRequest:  # a part of a model, which is where its object is
        body = scene.get_object(one.parent)
    x, y, z = 0.5 * (np.asarray(one.low_m) + np.asarray(one.high_m))
    middle = (body.pose.matrix() @ (x, y, z, 1.0))[:3]
    ids = (one.id, *(other.id for other in instances if other.parent == one.id))
    return _Target(middle, ids)


def _told(selectors: Sequence[Selector]) -> str:
    return ", ".join(repr(one) if isinstance(one, str) else str(one) for one in selectors)


def _in_sight(
    scene: SynchronousSimulation, middle: Vector3, eyes: NDArray[np.float64], target: _Target | None
) -> bool:
    """Return whether from all these places a point is seen, or the object around it."""
    hits = scene.cast_rays(eyes, middle - eyes)
    if target is None:
        return bool((hits.distances_m >= np.linalg.norm(middle - eyes, axis=1)).all())
    return bool(np.isin(hits.instance_ids, target.ids).all())
