"""Flat mirrors show what stands before them, seen from where the eye would be behind them.

A snapshot and a camera come in; which mirrors are seen and from where each is to be drawn once
more go out. `mirror_pictures` puts into the picture what was drawn. Every back end draws with it.
Knows no graphics library.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.rays.mirror_faces import CATEGORY, MirrorFace, mirror_face, mirror_faces
from sailenv_ros.types.camera import Camera
from sailenv_ros.types.geometry import BODY_FROM_OPTICAL, Pose
from sailenv_ros.types.model import Material, Model, ModelPart
from sailenv_ros.types.snapshot import SceneContents, WorldSnapshot

__all__ = ["NEAR_PLANE_M", "FlatMirrors", "SeenMirror", "Window", "material_shown"]

Window: TypeAlias = tuple[slice, slice]
"""Rows and columns of a picture."""

MOST = 2
"""Mirrors in one picture: the largest; others mirror the room as other surfaces do."""

LEAST_PX = 64
"""A mirror whose rectangle covers less of the picture is skipped."""

NEAR_PLANE_M = 4e-3
"""Pixels this near to the mirror's plane belong to it; its frame stands out further."""

PARALLEL_EYE_M = 1e6
"""Where rays are parallel, the side that is seen of a mirror is as from so far behind."""

BEHIND_M = 0.02
"""Objects that reach less far before the plane are not mirrored: walls, and the mirror."""


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class SeenMirror:
    """A mirror in a picture.

    Attributes
    ----------
    instance_id : int
    normal : (3,) float64
        Unit, world frame, towards the eye.
    point : (3,) float64
        Of its plane, world frame [m].
    tint : (3,) float32
        Linear share of the light that it mirrors.
    window : Window
        Around it.
    camera : Camera
        What it shows is this camera's picture, left and right exchanged.
    only : (N,) bool
        Which instances are before its plane.
    """

    instance_id: int
    normal: NDArray[np.float64]
    point: NDArray[np.float64]
    tint: NDArray[np.float32]
    window: Window
    camera: Camera
    only: NDArray[np.bool_]


class FlatMirrors:
    """The flat mirrors of the scene that is shown."""

    def __init__(self) -> None:
        self._contents: SceneContents | None = None
        self._faces: list[tuple[int, int, MirrorFace]] = []
        self._corners = np.zeros((0, 8, 3))
        self._of_model: dict[tuple[int, str], tuple[Model, tuple[MirrorFace, ...]]] = {}

    def show(self, contents: SceneContents) -> None:
        """Find the mirrors of a scene."""
        if contents is self._contents:
            return
        before, self._contents = self._contents, contents
        if before is not None and before.instances is contents.instances:
            return
        models = {}
        self._faces = []
        for row, drawn in enumerate(contents.instances):
            category = drawn.instance.category
            key = id(drawn.model), category
            known = self._of_model.get(key)
            found = models[key] = known or (drawn.model, mirror_faces(drawn.model, category))
            scale = np.asarray(drawn.scale)
            self._faces += [
                (
                    row,
                    drawn.instance.id,
                    replace(face, low=face.low * scale, high=face.high * scale),
                )
                for face in found[1]
            ]
        self._of_model = models
        if self._faces:
            bounds = np.array([d.model.bounds() * np.asarray(d.scale) for d in contents.instances])
            at = np.array(list(np.ndindex(2, 2, 2)))
            self._corners = bounds[:, at, [0, 1, 2]]

    def seen(self, snapshot: WorldSnapshot, camera: Camera) -> list[SeenMirror]:
        """Return the mirrors that a camera may see, the largest first."""
        self.show(snapshot.contents)
        found = []
        for row, instance_id, face in self._faces:
            mirror = self._seen(snapshot, camera, row, instance_id, face)
            if mirror is not None:
                rows, columns = mirror.window
                found.append(((rows.stop - rows.start) * (columns.stop - columns.start), mirror))
        found.sort(key=lambda entry: -entry[0])
        return [mirror for _, mirror in found[:MOST]]

    def _seen(
        self, snapshot: WorldSnapshot, camera: Camera, row: int, instance_id: int, face: MirrorFace
    ) -> SeenMirror | None:
        pose = snapshot.world_from_body[row]
        eye = camera.world_from_camera[:3, 3]
        if camera.intrinsics.is_parallel:
            eye = eye - PARALLEL_EYE_M * camera.world_from_camera[:3, 2]
        middle = (face.low + face.high) / 2.0
        side = 1.0 if (np.linalg.inv(pose) @ [*eye, 1.0])[face.axis] > middle[face.axis] else -1.0
        front = face.high[face.axis] if side > 0.0 else face.low[face.axis]
        middle[face.axis] = front
        normal, point = side * pose[:3, face.axis], pose[:3, :3] @ middle + pose[:3, 3]
        if float(normal @ (eye - point)) < NEAR_PLANE_M:
            return None
        window = _window(camera, pose, face, front)
        if window is None:
            return None
        corners = np.einsum("nij,nkj->nki", snapshot.world_from_body[:, :3, :3], self._corners)
        corners += snapshot.world_from_body[:, None, :3, 3]
        only = ((corners - point) @ normal).max(axis=1) > BEHIND_M
        only[row] = False
        return SeenMirror(
            instance_id=instance_id,
            normal=normal,
            point=point,
            tint=face.tint,
            window=window,
            camera=_behind(camera, normal, point),
            only=only,
        )


def material_shown(part: ModelPart, category: str) -> Material:
    """Return a part's material, silvered if it is the flat metal of a mirror."""
    face = mirror_face(0, part, category) if category == CATEGORY else None
    if face is None:
        return part.material
    red, green, blue = (float(channel) for channel in face.tint)
    return replace(part.material, base_colour=(red, green, blue, 1.0), roughness=0.0)


def _window(
    camera: Camera, pose: NDArray[np.float64], face: MirrorFace, front: float
) -> Window | None:
    """Return the part of the picture that may show a face; None if it shows too little of it.

    Through a lens that bends straight lines all of it.
    """
    corners = np.array(list(np.ndindex(2, 2, 2)))[::1]
    points = np.where(corners, face.high, face.low)
    points[:, face.axis] = front
    world = points @ pose[:3, :3].T + pose[:3, 3]
    seen = world @ camera.camera_from_world[:3, :3].T + camera.camera_from_world[:3, 3]
    lens = camera.intrinsics
    if not (lens.is_pinhole or lens.is_parallel):
        return slice(0, lens.height), slice(0, lens.width)
    ahead = seen[:, 2] > lens.near_m
    if not ahead.any():
        return None
    low, high = np.zeros(2), np.array([lens.width, lens.height], float)
    if ahead.all():
        at = lens.project(seen)
        low = np.clip(np.floor(at.min(axis=0)) - 1.0, low, high)
        high = np.clip(np.ceil(at.max(axis=0)) + 2.0, low, high)
    size = high - low
    if size.prod() < LEAST_PX:
        return None
    return slice(int(low[1]), int(high[1])), slice(int(low[0]), int(high[0]))


def _behind(camera: Camera, normal: NDArray[np.float64], point: NDArray[np.float64]) -> Camera:
    """Return the camera mirrored at a plane; its x axis is turned round, so that it stays one."""
    mirror = np.eye(4)
    mirror[:3, :3] -= 2.0 * np.outer(normal, normal)
    mirror[:3, 3] = 2.0 * float(normal @ point) * normal
    world_from_camera = mirror @ camera.world_from_camera @ np.diag([-1.0, 1.0, 1.0, 1.0])
    pose = Pose.from_matrix(world_from_camera @ np.linalg.inv(BODY_FROM_OPTICAL))
    return replace(camera, pose=pose, intrinsics=camera.intrinsics.mirrored())
