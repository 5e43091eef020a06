"""A scene's drawn bodies in a PyBullet world of their own, for PyBullet's renderers to draw.

Scene contents and snapshots come in; PyBullet's bodies stand where a camera sees them. Places are
camera coordinates computed in double precision, so single precision is not spent on the distance
from the world's origin. Nothing here collides or weighs anything.
"""

from __future__ import annotations

import logging
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from sailenv_ros.types.colour import srgb_from_linear
from sailenv_ros.types.model import Material, Model, ModelPart, Texture
from sailenv_ros.types.snapshot import SceneContents, WorldSnapshot
from sailenv_ros.world.bullet import BulletClient

__all__ = ["BulletBodies"]

_log = logging.getLogger(__name__)

EYE_FROM_OPTICAL: NDArray[np.float64] = np.diag([1.0, -1.0, -1.0, 1.0])
"""(4, 4) PyBullet's eye axes (x right, y up, z backward) from the optical frame's."""
EYE_FROM_OPTICAL.flags.writeable = False

CHUNK_TRIANGLES = 30_000
"""PyBullet refuses meshes of more than 131072 vertices: larger ones are cut into several bodies."""

_Key = tuple[int, tuple[float, float, float]]


class BulletBodies:
    """The bodies of one PyBullet client."""

    def __init__(self, client: BulletClient) -> None:
        self._client = client
        self._contents: SceneContents | None = None
        self._bodies: list[list[int]] = []
        self._keys: list[_Key] = []
        self._kept: list[Model] = []
        self._textures: dict[int, tuple[Texture, int]] = {}
        self._warned: dict[int, Material] = {}

    def show(self, contents: SceneContents) -> None:
        """Make the bodies those of `contents`; what both have in common is kept.

        PyBullet never gives back all of a removed body's memory (about 0.8 kB a vertex are lost),
        so a body is made again only where model or scale are new.
        """
        if contents is self._contents:
            return
        spare: dict[_Key, list[list[int]]] = {}
        for key, bodies in zip(self._keys, self._bodies, strict=True):
            spare.setdefault(key, []).append(bodies)
        self._keys = [(id(drawn.model), drawn.scale) for drawn in contents.instances]
        self._bodies = []
        for key, drawn in zip(self._keys, contents.instances, strict=True):
            of_kind = spare.get(key)
            self._bodies.append(of_kind.pop() if of_kind else self._make(drawn.model, drawn.scale))
        for left_over in (body for lists in spare.values() for bodies in lists for body in bodies):
            self._client.removeBody(left_over)
        # The number of an object is unique only while the object lives.
        self._kept = [drawn.model for drawn in contents.instances]
        self._contents = contents

    def place(self, snapshot: WorldSnapshot, camera_from_world: NDArray[np.float64]) -> None:
        """Put every body where the camera at the origin sees it; `show` must have been called."""
        if not self._bodies:
            return
        eye_from_body = EYE_FROM_OPTICAL @ camera_from_world @ snapshot.world_from_body
        quats = Rotation.from_matrix(eye_from_body[:, :3, :3]).as_quat().tolist()
        places = eye_from_body[:, :3, 3].tolist()
        for bodies, place, quat in zip(self._bodies, places, quats, strict=True):
            for body in bodies:
                self._client.resetBasePositionAndOrientation(body, place, quat)

    def _make(self, model: Model, scale: tuple[float, float, float]) -> list[int]:
        """Make the bodies of one instance; panes of glass are left out, as in every renderer."""
        return [
            self._body(arrays, part.material)
            for part in model.parts
            if part.material.alpha != "blend"
            for arrays in _chunks(part, scale)
        ]

    def _body(self, arrays: dict[str, Any], material: Material) -> int:
        if material.alpha == "mask" and id(material) not in self._warned:
            self._warned[id(material)] = material
            _log.warning(
                "PyBullet draws material %r without its holes: it knows no alpha",
                material.name,
            )
        texture = material.base_colour_texture
        shape = self._client.createVisualShape(
            self._client.constants.GEOM_MESH, rgbaColor=_displayed(material), **arrays
        )
        body: int = self._client.createMultiBody(baseMass=0.0, baseVisualShapeIndex=shape)
        if texture is not None:
            self._client.changeVisualShape(body, -1, textureUniqueId=self._texture(texture))
        return body

    def _texture(self, texture: Texture) -> int:
        """Return PyBullet's number of a texture; it reads textures from files alone."""
        if id(texture) not in self._textures:
            with tempfile.TemporaryDirectory(prefix="sailenv_ros_") as folder:
                path = Path(folder) / "texture.png"
                cv2.imwrite(str(path), np.ascontiguousarray(texture[..., 2::-1]))
                self._textures[id(texture)] = (texture, self._client.loadTexture(str(path)))
        return self._textures[id(texture)][1]


def _chunks(part: ModelPart, scale: tuple[float, float, float]) -> Iterator[dict[str, Any]]:
    """Return the arrays of a part's meshes as PyBullet takes them, scaled."""
    mesh = part.mesh
    factors = np.asarray(scale)
    normals = mesh.normals / factors
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
    positions = mesh.positions * factors
    for first in range(0, len(mesh.triangles), CHUNK_TRIANGLES):
        some = mesh.triangles[first : first + CHUNK_TRIANGLES]
        used, corners = np.unique(some, return_inverse=True)
        corners = corners.reshape(-1, 3)
        vertices = [positions[used], normals[used], mesh.uvs[used]]
        if part.material.double_sided:
            # TinyRenderer never draws backs: they get triangles of their own.
            corners = np.concatenate([corners, corners[:, ::-1] + len(used)])
            backs = (vertices[0], -vertices[1], vertices[2])
            vertices = [np.concatenate(pair) for pair in zip(vertices, backs, strict=True)]
        yield {
            "vertices": vertices[0].tolist(),
            "normals": vertices[1].tolist(),
            "uvs": vertices[2].tolist(),
            "indices": corners.reshape(-1).tolist(),
        }


def _displayed(material: Material) -> list[float]:
    """Return a material's colour as sRGB: TinyRenderer shades in the display's values."""
    emits = max(material.emission) > 0.0
    colour = material.emission if emits else material.base_colour[:3]
    return [*srgb_from_linear(colour).tolist(), 1.0]
