"""Framed pictures: landscapes, blocks of colour, washes, flowers, each drawn by code."""

from __future__ import annotations

from collections.abc import Callable

import cv2
import numpy as np
from numpy.typing import NDArray

from sailenv_content.procedural.shapes import Vector3, box, part
from sailenv_ros.assets.meshes import RawMesh
from sailenv_ros.assets.model_files import RawPart
from sailenv_ros.types.model import Texture

__all__ = ["landscape_picture", "painting"]

Field = NDArray[np.float64]


def painting(number: int, width: float, height: float, frame: Vector3) -> list[RawPart]:
    """Return a framed picture that hangs on the wall behind it and looks along x."""
    edge, depth = 0.035, 0.03
    canvas = RawMesh(
        positions=np.array(
            [
                [0.018, y * (width / 2 - edge), z]
                for y, z in ((1, edge), (-1, edge), (-1, height - edge), (1, height - edge))
            ]
        ),
        uvs=np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]),
        triangles=np.array([[0, 1, 2], [0, 2, 3]]),
    )
    bars = [
        box((depth, width, edge), (depth / 2, 0.0, edge / 2)),
        box((depth, width, edge), (depth / 2, 0.0, height - edge / 2)),
        box((depth, edge, height - 2 * edge), (depth / 2, (width - edge) / 2, height / 2)),
        box((depth, edge, height - 2 * edge), (depth / 2, -(width - edge) / 2, height / 2)),
        box((0.01, width - edge, height - edge), (0.005, 0.0, height / 2)),
    ]
    frames = [part("frame wood", bar, base_colour=(*frame, 1.0), roughness=0.4) for bar in bars]
    art = ARTS[number % len(ARTS)](number, width / height)
    return [
        part("canvas", canvas, base_colour=(1, 1, 1, 1), base_colour_texture=art, roughness=0.8),
        *frames,
    ]


def _texture(picture: NDArray[np.float64]) -> Texture:
    pixels = np.full((*picture.shape[:2], 4), 255, np.uint8)
    pixels[..., :3] = np.rint(255.0 * np.clip(picture, 0.0, 1.0))
    pixels.flags.writeable = False
    return pixels


def _canvas_noise(
    generator: np.random.Generator, shape: tuple[int, int], scale: float
) -> NDArray[np.float64]:
    coarse = generator.standard_normal(
        (max(2, int(shape[0] / scale)), max(2, int(shape[1] / scale)))
    )
    return np.asarray(cv2.resize(coarse, shape[::-1], interpolation=cv2.INTER_CUBIC))


def landscape_picture(number: int, aspect: float, grain: float = 0.025) -> Texture:
    """Hills behind hills under an evening sky; `grain` is the canvas's, 0 for a screen."""
    generator = np.random.default_rng(number)
    rows, columns = 384, int(384 * aspect)
    v = np.linspace(0.0, 1.0, rows)[:, None, None]
    top, horizon = np.array([0.32, 0.50, 0.68]), np.array([0.95, 0.78, 0.56])
    picture = np.broadcast_to(top + (horizon - top) * v / 0.6, (rows, columns, 3)).copy()
    x = np.linspace(0.0, 1.0, columns)
    sun = np.hypot((x[None] - 0.68) * aspect, np.linspace(0, 1, rows)[:, None] - 0.36)
    picture[sun < 0.07] = (1.0, 0.93, 0.72)
    far, near = np.array([0.50, 0.56, 0.62]), np.array([0.13, 0.24, 0.16])
    for layer in range(6):
        share = layer / 5.0
        ridge = np.full(columns, 0.45 + 0.5 * share)
        for octave in range(4):
            phase, cycles = generator.uniform(0, 6.28), generator.uniform(0.7, 1.6) * 2**octave
            ridge = ridge + 0.06 / 1.9**octave * np.sin(6.28 * cycles * x + phase)
        below = np.linspace(0.0, 1.0, rows)[:, None] > ridge[None]
        picture[below] = far + (near - far) * share
    picture += grain * _canvas_noise(generator, picture.shape[:2], 3.0)[..., None]
    return _texture(picture)


def _blocks(number: int, aspect: float) -> Texture:
    """Rectangles of few colours between dark lines."""
    generator = np.random.default_rng(number)
    rows, columns = 384, int(384 * aspect)
    picture = np.full((rows, columns, 3), 0.93)
    palette = np.array([[0.80, 0.17, 0.13], [0.11, 0.23, 0.52], [0.93, 0.74, 0.14], [0.93] * 3])
    cuts = [sorted({0, n, *(generator.integers(n // 8, n - n // 8, 4))}) for n in (rows, columns)]
    for r0, r1 in zip(cuts[0], cuts[0][1:], strict=False):
        for c0, c1 in zip(cuts[1], cuts[1][1:], strict=False):
            picture[r0:r1, c0:c1] = palette[generator.choice(4, p=[0.2, 0.15, 0.15, 0.5])]
    for cut in cuts[0][1:-1]:
        picture[max(0, cut - 4) : cut + 4] = 0.06
    for cut in cuts[1][1:-1]:
        picture[:, max(0, cut - 4) : cut + 4] = 0.06
    picture += 0.012 * _canvas_noise(generator, picture.shape[:2], 2.0)[..., None]
    return _texture(picture)


def _washes(number: int, aspect: float) -> Texture:
    """Broad washes of colour that run into one another."""
    generator = np.random.default_rng(number)
    shape = (384, int(384 * aspect))
    palette = np.array(
        [[0.93, 0.90, 0.84], [0.16, 0.33, 0.40], [0.85, 0.55, 0.36], [0.62, 0.72, 0.68]]
    )
    fields = np.stack([_canvas_noise(generator, shape, 110.0) for _ in palette])
    weights = np.exp(4.0 * fields + np.array([0.8, 0.0, -0.4, 0.0])[:, None, None])
    weights /= weights.sum(axis=0)
    picture = np.einsum("khw,kc->hwc", weights, palette)
    picture += 0.03 * _canvas_noise(generator, shape, 4.0)[..., None]
    return _texture(picture)


def _flowers(number: int, aspect: float) -> Texture:
    """Poppies in a meadow, dabbed."""
    generator = np.random.default_rng(number)
    rows, columns = 384, int(384 * aspect)
    picture = np.zeros((rows, columns, 3), np.float32)
    picture[:] = np.linspace([0.72, 0.80, 0.86], [0.36, 0.47, 0.20], rows)[:, None]
    for _ in range(2600):
        y = int(rows * generator.uniform(0.3, 1.0) ** 0.7)
        x, size = int(generator.integers(0, columns)), 2 + int(9 * y / rows)
        shade = np.array([0.30, 0.45, 0.16]) * generator.uniform(0.6, 1.5)
        cv2.line(
            picture, (x, y), (x + int(generator.normal(0, 3)), y - 2 * size), shade.tolist(), 2
        )
    for y in np.sort(rows * generator.uniform(0.35, 1.0, 170)):
        x, size = int(generator.integers(0, columns)), 2 + int(10 * y / rows)
        shade = np.array([0.85, 0.16, 0.10]) * generator.uniform(0.75, 1.15)
        cv2.ellipse(picture, (x, int(y)), (size, int(0.7 * size)), 0, 0, 360, shade.tolist(), -1)
        cv2.circle(picture, (x, int(y)), max(1, size // 4), (0.12, 0.08, 0.08), -1)
    return _texture(picture.astype(np.float64))


ARTS: tuple[Callable[[int, float], Texture], ...] = (landscape_picture, _blocks, _washes, _flowers)
