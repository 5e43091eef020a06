"""What a room looks like from its middle, blurred step by step: what shiny surfaces mirror.

Pictures of linear radiance in six directions come in, a texture goes out: the directions of the
world laid flat on an octahedron, for several roughnesses one behind the other.
"""

from __future__ import annotations

import cv2
import moderngl
import numba
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.camera import Camera, CameraIntrinsics
from sailenv_ros.geometry import Pose
from sailenv_ros.render.programs import set_uniform

__all__ = [
    "EDGE",
    "ReflectionMap",
    "cube_cameras",
    "flattened",
    "light_from_around",
    "octahedral_directions",
    "prefilter",
]

EDGE = 96
"""Texels along an edge of the octahedron's square, without its border."""

ROUGHNESSES = (0.0, 0.15, 0.3, 0.45, 0.6)
"""Of the layers; what is rougher mirrors the light around it, which the light map knows better."""

SAMPLES = 96

LUMA = np.array([0.299, 0.587, 0.114])

UNIT = 6

_FACE_PX = 96
_FACE_FOV_DEG = 92.0

_HEADINGS = ((0.0, 0.0), (90.0, 0.0), (180.0, 0.0), (270.0, 0.0), (0.0, 90.0), (0.0, -90.0))
"""Turn about z and about y [deg]."""


def cube_cameras(position_m: NDArray[np.float64]) -> list[Camera]:
    """Give six cameras that together see everything around a point."""
    intrinsics = CameraIntrinsics(
        width=_FACE_PX, height=_FACE_PX, vertical_fov_deg=_FACE_FOV_DEG, near_m=0.02
    )
    x, y, z = (float(number) for number in position_m)
    return [
        Camera(intrinsics=intrinsics, pose=Pose.from_rpy_deg((x, y, z), (0.0, pitch, yaw)))
        for yaw, pitch in _HEADINGS
    ]


def octahedral_directions(edge: int) -> NDArray[np.float32]:
    """Give (edge, edge, 3): the unit direction of each texel's centre."""
    at = (np.arange(edge, dtype=np.float32) + 0.5) / edge * 2.0 - 1.0
    x, y = np.meshgrid(at, at)
    z = 1.0 - np.abs(x) - np.abs(y)
    fold = np.maximum(-z, 0.0)
    directions = np.stack([x - np.copysign(fold, x), y - np.copysign(fold, y), z], axis=-1)
    unit: NDArray[np.float32] = directions / np.linalg.norm(directions, axis=-1, keepdims=True)
    return unit.astype(np.float32)


def flattened(
    cameras: list[Camera], pictures: list[NDArray[np.float32]], edge: int
) -> NDArray[np.float32]:
    """Put six pictures together.

    Parameters
    ----------
    cameras : list of Camera
    pictures : list of (H, W, 3) float32

    Returns
    -------
    radiance : (edge, edge, 3) float32
    """
    directions = octahedral_directions(edge)
    result = np.zeros((edge, edge, 3), np.float32)
    nearest = np.full((edge, edge), -2.0, np.float32)
    for camera, picture in zip(cameras, pictures, strict=True):
        x, y, z = np.moveaxis(
            directions @ camera.world_from_camera[:3, :3].astype(np.float32), -1, 0
        )
        ahead = np.maximum(z, 1e-3)
        intrinsics = camera.intrinsics
        u = (x / ahead * intrinsics.fx + intrinsics.cx).astype(np.float32)
        v = (y / ahead * intrinsics.fy + intrinsics.cy).astype(np.float32)
        seen = cv2.remap(picture, u, v, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        mine = z > nearest
        result[mine], nearest[mine] = seen[mine], z[mine]
    return result


def prefilter(radiance: NDArray[np.float32]) -> NDArray[np.float16]:
    """Blur a map of all directions as rough surfaces would.

    Parameters
    ----------
    radiance : (N, N, 3) float32

    Returns
    -------
    layers : (L, N + 2, N + 2, 4) float16
        One layer for each of `ROUGHNESSES`, with a border that continues it across the edges.

    Notes
    -----
    Importance sampling of the GGX distribution with the viewer along the normal (Karis 2013, "Real
    shading in Unreal Engine 4").
    """
    edge = len(radiance)
    layers = np.zeros((len(ROUGHNESSES), edge + 2, edge + 2, 4), np.float16)
    directions = octahedral_directions(edge)
    for layer, roughness in zip(layers, ROUGHNESSES, strict=True):
        blurred = radiance if roughness == 0.0 else np.empty_like(radiance)
        if roughness > 0.0:
            _blur(radiance, directions, _lobe(roughness), blurred)
        layer[1:-1, 1:-1, :3] = np.minimum(blurred, 6e4)
        # Beyond an edge of the square lies the same edge, mirrored about its middle.
        layer[0, 1:-1], layer[-1, 1:-1] = layer[1, -2:0:-1], layer[-2, -2:0:-1]
        layer[1:-1, 0], layer[1:-1, -1] = layer[-2:0:-1, 1], layer[-2:0:-1, -2]
        layer[0, 0], layer[0, -1] = layer[-2, -2], layer[-2, 1]
        layer[-1, 0], layer[-1, -1] = layer[1, -2], layer[1, 1]
    return layers


def light_from_around(radiance: NDArray[np.float64]) -> NDArray[np.float64]:
    """Give the light that arrives on surfaces amidst a map of all directions.

    Parameters
    ----------
    radiance : (N, N, 3) float64

    Returns
    -------
    light : (4,) float64
        c0, cx, cy, cz: irradiance / pi on a surface of normal n is about c0 + c · n; its luma.
    """
    directions = octahedral_directions(len(radiance)).astype(np.float64)
    # A texel's solid angle shrinks with the cube of its distance from the octahedron's middle.
    share = np.abs(directions).sum(axis=-1) ** 3
    weighted = radiance @ LUMA * share / share.sum()
    along = np.einsum("vu,vux->x", weighted, directions)
    return np.array([weighted.sum(), *(2.0 * along)])


class ReflectionMap:
    """The texture, in one context; black until `write`."""

    def __init__(self, context: moderngl.Context) -> None:
        size = (EDGE + 2, EDGE + 2, len(ROUGHNESSES))
        self._texture = context.texture3d(size, 4, dtype="f2")
        self._texture.filter = (moderngl.LINEAR, moderngl.LINEAR)
        self._texture.repeat_x = self._texture.repeat_y = self._texture.repeat_z = False
        self._box = np.zeros((3, 3))
        self._light = np.zeros(4)

    def write(
        self, layers: NDArray[np.float16], position_m: NDArray[np.float64], box: NDArray[np.float64]
    ) -> None:
        """Take the layers of `prefilter`.

        Parameters
        ----------
        position_m : (3,) float64
            From where it was seen.
        box : (2, 3) float64
            Walls of the room; what is mirrored is looked for on them.
        """
        self._texture.write(np.ascontiguousarray(layers))
        self._box = np.stack([position_m, *box])
        self._light = light_from_around(layers[0, 1:-1, 1:-1, :3].astype(np.float64))

    def bind(self, program: moderngl.Program) -> None:
        """Make it readable for a program."""
        self._texture.use(UNIT)
        set_uniform(program, "reflections", UNIT)
        for name, value in zip(
            ("reflection_from", "room_low", "room_high"), self._box, strict=True
        ):
            set_uniform(program, name, tuple(value))
        set_uniform(program, "room_light", tuple(self._light))
        scale = EDGE / (EDGE + 2)
        last = len(ROUGHNESSES) - 1
        set_uniform(program, "reflection_texel", (scale, last / ROUGHNESSES[-1], last + 1.0))

    def close(self) -> None:
        """Free the texture."""
        self._texture.release()


def _lobe(roughness: float) -> NDArray[np.float32]:
    """Give (S, 4): directions about the z axis, and how much each counts."""
    index = np.arange(SAMPLES)
    turn = 2.0 * np.pi * ((index * 0.6180339887498949) % 1.0)
    share = (index + 0.5) / SAMPLES
    alpha2 = roughness**4
    cosine = np.sqrt((1.0 - share) / (1.0 + (alpha2 - 1.0) * share))
    sine = np.sqrt(1.0 - cosine**2)
    half = np.stack([sine * np.cos(turn), sine * np.sin(turn), cosine], axis=-1)
    light = 2.0 * cosine[:, None] * half - np.array([0.0, 0.0, 1.0])
    weight = np.maximum(light[:, 2], 0.0)
    return np.concatenate([light, weight[:, None]], axis=1).astype(np.float32)


@numba.njit(cache=True, nogil=True)
def _blur(radiance, directions, lobe, result):  # type: ignore[no-untyped-def]  # compiled
    edge = radiance.shape[0]
    for row in range(edge):
        for column in range(edge):
            nx, ny, nz = directions[row, column]
            # A frame about the normal without trigonometry (Duff et al. 2017).
            sign = 1.0 if nz >= 0.0 else -1.0
            a = -1.0 / (sign + nz)
            b = nx * ny * a
            r = g = bl = total = 0.0
            for k in range(lobe.shape[0]):
                lx, ly, lz, weight = lobe[k]
                if weight <= 0.0:
                    continue
                x = lx * (1.0 + sign * nx * nx * a) + ly * b + lz * nx
                y = lx * sign * b + ly * (sign + ny * ny * a) + lz * ny
                z = -lx * sign * nx - ly * ny + lz * nz
                s = abs(x) + abs(y) + abs(z)
                px, py = x / s, y / s
                if z < 0.0:
                    qx = (1.0 - abs(py)) * (1.0 if px >= 0.0 else -1.0)
                    py = (1.0 - abs(px)) * (1.0 if py >= 0.0 else -1.0)
                    px = qx
                u = min(max(int((px * 0.5 + 0.5) * edge), 0), edge - 1)
                v = min(max(int((py * 0.5 + 0.5) * edge), 0), edge - 1)
                r += weight * radiance[v, u, 0]
                g += weight * radiance[v, u, 1]
                bl += weight * radiance[v, u, 2]
                total += weight
            result[row, column, 0] = r / total
            result[row, column, 1] = g / total
            result[row, column, 2] = bl / total
