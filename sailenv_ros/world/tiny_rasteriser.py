"""PyBullet's TinyRenderer as a source of surfaces: depth and instance id of every pixel.

A snapshot and a camera come in; the same two arrays that the OpenGL geometry pass leaves go out,
with a plain picture if one is wanted. Knows nothing of flow or of other views.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.colour import srgb_from_linear
from sailenv_ros.types.lights import Environment, Light
from sailenv_ros.types.snapshot import SceneContents, WorldSnapshot
from sailenv_ros.world.bullet import BulletClient
from sailenv_ros.world.tiny_bodies import EYE_FROM_OPTICAL, TinyBodies

__all__ = ["TinyRasteriser"]

NEAR_SHARE = 0.25
"""TinyRenderer cuts surfaces off at this share of near_m: between the two they still cover their
pixels, as everywhere; what is nearer is not seen. Less would cost depth its precision."""

FAR_M = 1e5
"""Surfaces beyond the camera's far_m are dropped afterwards, from exact depths."""

SWITCH = 400.0
"""TinyRenderer hands out window depth in float32, whose error is near 1e-7 z/near of z. Where z
exceeds this many times near, it is measured again with a near plane moved out: 5e-5 at worst."""

SECOND_NEAR = 0.8
"""Place of the second near plane, as a share of the depth where the second measure begins."""


class TinyRasteriser:
    """Draws with PyBullet's TinyRenderer, in a private world."""

    def __init__(self) -> None:
        self._client = BulletClient()
        self._bodies = TinyBodies(self._client)

    def draw(
        self, snapshot: WorldSnapshot, camera: Camera, *, picture: bool
    ) -> tuple[NDArray[np.float32], NDArray[np.uint8] | None]:
        """Draw everything.

        Returns
        -------
        surface : (H, W, 2) float32
            Depth along the optical axis [m], ``inf`` where nothing was hit, and the instance id.
        rgb : (H, W, 3) uint8 or None
            A plain sRGB picture: one light, no shadows, the sky.

        Raises
        ------
        PhysicsError
            If PyBullet refuses.
        """
        contents = snapshot.contents
        self._bodies.show(contents)
        self._bodies.place(snapshot, camera.camera_from_world)
        intrinsics = camera.intrinsics
        near_m = NEAR_SHARE * intrinsics.near_m
        colours, depth, body = self._shoot(intrinsics, near_m, contents, camera)
        hit = body >= 0
        second_m = SWITCH * near_m
        again = hit & (depth > second_m)
        if again.any():
            near_m = SECOND_NEAR * second_m
            _, far_depth, far_body = self._shoot(intrinsics, near_m, contents, camera)
            again &= far_body == body
            depth[again] = far_depth[again]
        surface = np.empty((*body.shape, 2), np.float32)
        surface[..., 0] = np.where(hit, depth, np.inf)
        surface[..., 1] = np.where(hit, self._bodies.instance_of_body[np.where(hit, body, 0)], 0)
        if not picture:
            return surface, None
        seen = hit & (depth <= intrinsics.far_m)
        rgb = np.where(seen[..., None], colours[..., :3], _backdrop(camera, contents.environment))
        return surface, (rgb + 0.5).astype(np.uint8)

    def close(self) -> None:
        """Free the private world; a second call does nothing."""
        self._client.close()

    def _shoot(
        self, intrinsics: CameraIntrinsics, near_m: float, contents: SceneContents, camera: Camera
    ) -> tuple[NDArray[np.uint8], NDArray[np.float64], NDArray[np.int64]]:
        """Return colours (H, W, 4), depth [m] and PyBullet's body number, -1 for none."""
        constants = self._client.constants
        shape = (intrinsics.height, intrinsics.width)
        _, _, colours, window, body = self._client.getCameraImage(
            intrinsics.width,
            intrinsics.height,
            viewMatrix=np.eye(4).reshape(-1).tolist(),
            projectionMatrix=_projection(intrinsics, near_m).T.reshape(-1).tolist(),
            renderer=constants.ER_TINY_RENDERER,
            flags=constants.ER_SEGMENTATION_MASK_OBJECT_AND_LINKINDEX,
            shadow=0,
            lightColor=(1.0, 1.0, 1.0),
            lightSpecularCoeff=0.0,
            **_lighting(contents, camera),
        )
        depth01 = np.asarray(window, np.float32).reshape(shape).astype(np.float64)
        with np.errstate(divide="ignore"):
            depth = FAR_M * near_m / (FAR_M - depth01 * (FAR_M - near_m))
        return (
            np.asarray(colours, np.uint8).reshape(*shape, 4),
            depth,
            np.asarray(body, np.int64).reshape(shape),
        )


def _projection(intrinsics: CameraIntrinsics, near_m: float) -> NDArray[np.float64]:
    """Return the projection of eye coordinates.

    TinyRenderer looks through the lower left corners of its window's pixels; half a pixel more in
    both directions makes that the centres.
    """
    result = np.zeros((4, 4))
    result[0, 0] = 2.0 * intrinsics.fx / intrinsics.width
    result[0, 2] = 1.0 / intrinsics.width
    result[1, 1] = 2.0 * intrinsics.fy / intrinsics.height
    result[1, 2] = 1.0 / intrinsics.height
    result[2, 2] = -(FAR_M + near_m) / (FAR_M - near_m)
    result[2, 3] = -2.0 * FAR_M * near_m / (FAR_M - near_m)
    result[3, 2] = -1.0
    return result


def _lighting(contents: SceneContents, camera: Camera) -> dict[str, Any]:
    """Boil lights and sky down to what TinyRenderer has: one direction, two strengths."""
    suns = [light for light in contents.lights if light.type == "directional"]
    sun: Light | None = max(suns, key=_strength, default=None)
    environment = contents.environment
    sky = np.mean([environment.sky_zenith, environment.sky_horizon, environment.sky_ground], axis=0)
    around = float(np.mean(environment.sky_share * sky + np.asarray(environment.ambient)))
    exposure = 2.0**environment.exposure
    ambient = float(_toned(np.array(around * exposure)))
    lit = around + (_strength(sun) / np.pi if sun is not None else 0.0)
    direction = (0.0, 0.0, 1.0)
    if sun is not None:
        eye_from_world = EYE_FROM_OPTICAL[:3, :3] @ camera.camera_from_world[:3, :3]
        x, y, z = (float(c) for c in -eye_from_world @ np.asarray(sun.direction))
        direction = (x, y, z)
    return {
        "lightDirection": direction,
        "lightAmbientCoeff": ambient,
        "lightDiffuseCoeff": float(_toned(np.array(lit * exposure))) - ambient,
    }


def _backdrop(camera: Camera, environment: Environment) -> NDArray[np.float64]:
    """Return (H, W, 3) 0 to 255: the analytic sky, or the plain background."""
    intrinsics = camera.intrinsics
    exposure = 2.0**environment.exposure
    if environment.background == "colour":
        plain = _toned(np.asarray(environment.background_colour) * exposure)
        return np.broadcast_to(255.0 * plain, (intrinsics.height, intrinsics.width, 3))
    rays = intrinsics.rays()
    up = (rays @ camera.world_from_camera[2, :3]) / np.linalg.norm(rays, axis=-1)
    high = np.sqrt(np.clip(up, 0.0, 1.0))[..., None]
    low = np.clip(-up / 0.12, 0.0, 1.0)[..., None]
    low = low * low * (3.0 - 2.0 * low)
    horizon = np.asarray(environment.sky_horizon)
    upper = horizon + high * (np.asarray(environment.sky_zenith) - horizon)
    return 255.0 * _toned((upper + low * (np.asarray(environment.sky_ground) - upper)) * exposure)


def _toned(radiance: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return sRGB values 0 to 1 on the filmic curve of the other back end (Narkowicz 2015)."""
    c = radiance * (2.51 * radiance + 0.03) / (radiance * (2.43 * radiance + 0.59) + 0.14)
    return srgb_from_linear(c)


def _strength(light: Light) -> float:
    return light.intensity * max(light.colour)
