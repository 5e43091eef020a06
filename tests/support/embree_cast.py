"""Reference view of a camera, by ray casting: embree instead of a rasteriser."""

from __future__ import annotations

import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene
from numpy.typing import NDArray

from sailenv_ros.types.camera import Camera
from sailenv_ros.types.snapshot import WorldSnapshot
from tests.support.ray_cast import is_parallel, origins_of, rays_of


class RayCast:
    """The triangles of a snapshot, ready to be looked at.

    Surfaces that cannot be decided by geometry alone, with holes by alpha, are hit and marked.
    """

    def __init__(self, snapshot: WorldSnapshot) -> None:
        corners, ids, one_sided, masked = [], [], [], []
        rows = zip(snapshot.contents.instances, snapshot.world_from_body, strict=True)
        for drawn, world_from_body in rows:
            for part in drawn.model.parts:
                if part.material.alpha == "blend":
                    continue
                points = part.mesh.positions.astype(np.float64) * drawn.scale
                world = points @ world_from_body[:3, :3].T + world_from_body[:3, 3]
                corners.append(world[part.mesh.triangles])
                count = len(part.mesh.triangles)
                ids.append(np.full(count, drawn.instance.id))
                one_sided.append(np.full(count, not part.material.double_sided))
                masked.append(np.full(count, part.material.alpha == "mask"))
        self._corners = np.concatenate(corners)
        self._ids = np.concatenate(ids)
        self._one_sided = np.concatenate(one_sided)
        self._masked = np.concatenate(masked)
        edges = self._corners[:, 1:] - self._corners[:, :1]
        self._normals = np.cross(edges[:, 0], edges[:, 1])

    def look(
        self, camera: Camera
    ) -> tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.bool_]]:
        """Look through the middle of every pixel.

        Returns
        -------
        ids : (H, W) int64
            Instance ids, 0 where nothing is.
        depth : (H, W) float64
            Along the optical axis [m], computed from the triangle met, in double precision; along
            the ray through a lens that is no pin-hole.
        masked : (H, W) bool
            Where a surface with holes was met, through which the ray may have had to go.
        """
        intrinsics = camera.intrinsics
        rays = rays_of(camera).reshape(-1, 3)
        # What sees nothing looks ahead.
        rays = np.where(np.isnan(rays), [0.0, 0.0, 1.0], rays)
        directions = rays @ camera.world_from_camera[:3, :3].T
        eye = camera.world_from_camera[:3, 3]
        # Which side of a triangle is seen is a matter of where the eye is, not of the ray.
        towards = self._corners[:, 0] - eye
        if is_parallel(camera):
            towards = np.broadcast_to(camera.world_from_camera[:3, 2], towards.shape)
        away = np.einsum("ni,ni->n", towards, self._normals) >= 0.0
        drawn = np.flatnonzero(~(away & self._one_sided))
        scene = EmbreeScene()
        mesh = TriangleMesh(scene, self._corners[drawn].astype(np.float32))
        origins = origins_of(camera).reshape(-1, 3) @ camera.world_from_camera[:3, :3].T + eye
        hit = np.asarray(scene.run(origins.astype(np.float32), directions.astype(np.float32)))
        del mesh
        met = hit >= 0
        triangle = drawn[hit[met]]
        ids = np.zeros(len(directions), np.int64)
        depth = np.full(len(directions), np.inf)
        masked = np.zeros(len(directions), bool)
        # Where the plane of the triangle is met does not depend on embree's precision.
        normal = self._normals[triangle]
        along = np.einsum("ni,ni->n", self._corners[triangle, 0] - origins[met], normal)
        depth[met] = along / np.einsum("ni,ni->n", directions[met], normal)
        ids[met], masked[met] = self._ids[triangle], self._masked[triangle]
        shape = intrinsics.height, intrinsics.width
        return ids.reshape(shape), depth.reshape(shape), masked.reshape(shape)
