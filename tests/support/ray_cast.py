"""An independent judge of ground truth: rays against triangles, and motion by plain arithmetic.

Everything is in float64 and shares no code with the renderer: Möller and Trumbore's intersection
for what a pixel sees, and for optical flow the path of the point through body and world frames.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.types.camera import Camera
from sailenv_ros.types.snapshot import WorldSnapshot


@dataclass(frozen=True)
class Hits:
    """First hit of each pixel's ray.

    Attributes
    ----------
    depth : (H, W) float64
        Along the optical axis [m]; inf for nothing.
    row : (H, W) int
        Row of the snapshot's instances; -1 for nothing.
    triangle : (H, W) int
        A number for each plane triangle of the scene; -1 for nothing.
    normal : (H, W, 3) float64
        Of the triangle, optical frame.
    """

    depth: NDArray[np.float64]
    row: NDArray[np.int64]
    triangle: NDArray[np.int64]
    normal: NDArray[np.float64]

    def away_from_edges(self) -> NDArray[np.bool_]:
        """(H, W) True where the eight neighbours see the same instance from the same side."""
        same = np.ones(self.row.shape, bool)
        for dv in (-1, 0, 1):
            for du in (-1, 0, 1):
                shifted = np.roll(self.row, (dv, du), (0, 1)) == self.row
                turned = np.roll(self.normal, (dv, du), (0, 1))
                same &= shifted & (np.abs(turned - self.normal).max(axis=-1) < 1e-6)
        same[0], same[-1], same[:, 0], same[:, -1] = False, False, False, False
        return same


def rays_of(camera: Camera) -> NDArray[np.float64]:
    """(H, W, 3) rays of depth 1; of length 1 through a lens that is no pin-hole."""
    lens = camera.intrinsics
    return lens.rays() if lens.is_pinhole else lens.unit_rays()


def is_parallel(camera: Camera) -> bool:
    """Whether the rays are side by side."""
    return camera.intrinsics.distortion_model == "orthographic"


def pixels_of(camera: Camera) -> NDArray[np.float64]:
    """(H, W, 2) column and row of each pixel."""
    lens = camera.intrinsics
    u, v = np.meshgrid(np.arange(lens.width), np.arange(lens.height))
    return np.stack([u, v], axis=-1).astype(np.float64)


def origins_of(camera: Camera) -> NDArray[np.float64]:
    """(H, W, 3) where rays begin: at the eye, or side by side, fx and fy to a metre."""
    lens = camera.intrinsics
    origins = np.zeros((lens.height, lens.width, 3))
    if is_parallel(camera):
        centre = ((lens.width - 1) / 2 + lens.cx_offset_px, (lens.height - 1) / 2)
        origins[..., 0] = (pixels_of(camera)[..., 0] - centre[0]) / lens.fx_px
        origins[..., 1] = (pixels_of(camera)[..., 1] - centre[1] - lens.cy_offset_px) / lens.fy_px
    return origins


def points_met(camera: Camera, depth: NDArray[np.float64]) -> NDArray[np.float64]:
    """(H, W, 3) points of the optical frame where rays meet something, after depths (H, W)."""
    with np.errstate(invalid="ignore"):
        return origins_of(camera) + rays_of(camera) * depth[..., None]


def cast(snapshot: WorldSnapshot, camera: Camera) -> Hits:
    """Cast the ray of every pixel against every front-facing triangle.

    Through a lens that is no pin-hole the result's depth is the distance along the ray.
    """
    rays, origins = (array.reshape(-1, 3) for array in (rays_of(camera), origins_of(camera)))
    best = np.full(len(rays), np.inf)
    row = np.full(len(rays), -1)
    number = np.full(len(rays), -1)
    normals = np.zeros((len(rays), 3))
    count = 0
    for index, drawn in enumerate(snapshot.contents.instances):
        eye_from_body = camera.camera_from_world @ snapshot.world_from_body[index]
        for part in drawn.model.parts:
            points = part.mesh.positions.astype(np.float64) * np.asarray(drawn.scale)
            points = points @ eye_from_body[:3, :3].T + eye_from_body[:3, 3]
            for a, b, c in points[part.mesh.triangles]:
                depth = _meet(rays, origins, a, b, c)
                nearer = depth < best
                best[nearer], row[nearer], number[nearer] = depth[nearer], index, count
                normal = np.cross(b - a, c - a)
                normals[nearer] = normal / np.linalg.norm(normal)
                count += 1
    shape = (camera.intrinsics.height, camera.intrinsics.width)
    return Hits(
        best.reshape(shape), row.reshape(shape), number.reshape(shape), normals.reshape(*shape, 3)
    )


def _meet(
    rays: NDArray[np.float64], origins: NDArray[np.float64], a: Any, b: Any, c: Any
) -> NDArray[np.float64]:
    """Depth at which rays meet a triangle's front; inf where they do not."""
    ab, ac = b - a, c - a
    p = np.cross(rays, ac)
    determinant = p @ ab
    begin = origins - a
    with np.errstate(divide="ignore", invalid="ignore"):
        u = (p * begin).sum(axis=-1) / determinant
        q = np.cross(begin, ab)
        v = (rays * q).sum(axis=-1) / determinant
        t = (q @ ac) / determinant
        hit = (determinant > 0) & (u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0)
    return np.where(hit, t, np.inf)


def flow_by_arithmetic(
    hits: Hits,
    now: WorldSnapshot,
    camera: Camera,
    past: WorldSnapshot,
    past_camera: Camera,
) -> NDArray[np.float64]:
    """(H, W, 2) velocity [px/s] of the point that each pixel sees; nan where it had no place.

    The point goes from the picture to the world, into its body, with the body to where it was,
    and from there into the earlier picture. What hits nothing is a direction, which has no place
    where rays are parallel unless nothing has moved.
    """
    dt_s = (now.sim_time_ns - past.sim_time_ns) * 1e-9
    rays = rays_of(camera)
    here = pixels_of(camera)
    met = points_met(camera, hits.depth)
    result = np.full((*hits.row.shape, 2), np.nan)
    nothing = hits.row < 0
    directions = rays[nothing] @ camera.world_from_camera[:3, :3].T
    then = directions @ past_camera.camera_from_world[:3, :3].T
    result[nothing] = here[nothing] - past_camera.intrinsics.project(then)
    if is_parallel(past_camera):
        result[nothing] = 0.0 if past_camera == camera else np.nan
    for row in range(len(now.contents.instances)):
        chosen = hits.row == row
        eye = met[chosen]
        world = eye @ camera.world_from_camera[:3, :3].T + camera.world_from_camera[:3, 3]
        body = (world - now.world_from_body[row][:3, 3]) @ now.world_from_body[row][:3, :3]
        world = body @ past.world_from_body[row][:3, :3].T + past.world_from_body[row][:3, 3]
        eye = world @ past_camera.camera_from_world[:3, :3].T + past_camera.camera_from_world[:3, 3]
        result[chosen] = here[chosen] - past_camera.intrinsics.project(eye)
    return result / dt_s
