"""Baked light times the colours of what it falls on: one picture for formats that cannot multiply.

UsdPreviewSurface has no product of two textures. So each texel of this picture has the radiance of
its surface; places in it are those in the light map.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.scene_export.contents import ExportedScene
from sailenv_ros.scene_export.textures import halved
from sailenv_ros.types.colour import LINEAR_OF_SRGB8, srgb_from_linear
from sailenv_ros.types.model import Material, ModelPart, Texture

__all__ = ["lit_picture", "metalness", "takes_light"]

LONGEST_SIDE_PX, FINEST = 4096, 4
"""Of the picture; a texel of the light map becomes at most so many along each side."""

GUTTER_PX = 3.0
"""Surfaces reach beyond their edges by so much, for filters and the blocks of JPEG."""

CHUNK_PX, WIDTH_PX = 1 << 20, 1 << 10
"""Pixels that are looked at together, and how wide they are as a picture."""

Array = NDArray[np.float64]


def takes_light(material: Material) -> bool:
    """Return whether a surface in the light map is drawn by it: not glass, nor what emits."""
    return material.alpha != "blend" and not any(material.emission)


def metalness(material: Material) -> float:
    """Return the mean share of a surface that is metal, 0 to 1."""
    texture = material.metallic_roughness_texture
    return material.metallic * (1.0 if texture is None else float(texture[..., 2].mean()) / 255.0)


def lit_picture(scene: ExportedScene) -> Texture:
    """Return (H, W, 4) uint8, sRGB, opaque: radiance of surfaces, in shares of the light's white.

    Parameters
    ----------
    scene : ExportedScene
        With a light map.
    """
    light = scene.light_map
    assert light is not None
    height, width = light.texture.shape[:2]
    fold = min(max(LONGEST_SIDE_PX // max(height, width), 1), FINEST)
    arriving = LINEAR_OF_SRGB8[light.texture[..., :3]].astype(np.float32)
    picture = np.full((fold * height, fold * width, 4), 255, np.uint8)
    picture[..., :3] = 0
    size = np.array([fold * width, fold * height], np.float64)
    surfaces = [
        _Surface.of(part, places * size)
        for piece in (piece for body in scene.bodies for piece in body.pieces)
        if piece.light_places
        for part, places in zip(piece.parts, piece.light_places, strict=True)
        if takes_light(part.material)
    ]
    within = np.zeros(picture.shape[:2], bool)
    for gutter in (0.0, GUTTER_PX):  # edges reach where no triangle is
        for surface in surfaces:
            for at, uvs in surface.covered(size, gutter, within):
                light_there = _between(arriving, (at + 0.5) / fold - 0.5, repeats=False)
                told = srgb_from_linear(light_there * surface.colours(uvs))
                picture[at[:, 1], at[:, 0], :3] = np.rint(255.0 * told)
                if not gutter:
                    within[at[:, 1], at[:, 0]] = True
    picture.flags.writeable = False
    return picture


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class _Surface:
    """A part in the picture.

    Attributes
    ----------
    corners : (M, 3, 2) float64
        Of its triangles, in pixels.
    uvs : (M, 3, 2) float64
        Texture coordinates of these.
    colour : (3,) float32
        Multiplies the texture; without what a metal mirrors instead.
    texels : (H, W, 3) float32 or None
        Linear; as fine as the picture, at most.
    """

    corners: Array
    uvs: Array
    colour: NDArray[np.float32]
    texels: NDArray[np.float32] | None

    @classmethod
    def of(cls, part: ModelPart, places: Array) -> _Surface:
        """Return a part; `places` (V, 2) are its vertices in pixels of the picture."""
        material, mesh = part.material, part.mesh
        corners = np.asarray(places, np.float64)[mesh.triangles]
        uvs = mesh.uvs.astype(np.float64)[mesh.triangles]
        texels = None
        texture = material.base_colour_texture
        if texture is not None:
            around = np.array(texture.shape[1::-1], np.float64)
            shares = np.abs(_doubled_area(uvs * around)) / np.maximum(
                np.abs(_doubled_area(corners)), 1e-9
            )
            while np.median(shares) >= 4.0 and min(texture.shape[:2]) > 1:
                texture, shares = halved(texture), shares / 4.0
            texels = LINEAR_OF_SRGB8[texture[..., :3]].astype(np.float32)
        colour = np.array(material.base_colour[:3], np.float32) * (1.0 - metalness(material))
        return cls(corners=corners, uvs=uvs, colour=colour, texels=texels)

    def covered(
        self, size: Array, gutter: float, within: NDArray[np.bool_]
    ) -> Iterator[tuple[NDArray[np.intp], Array]]:
        """Yield pixels (N, 2) whose middles its triangles cover, and their (N, 2) coordinates.

        Parameters
        ----------
        size : (2,) float64
            Of the picture; nothing beyond it is yielded.
        gutter : float
            So far beyond a triangle's edges, too [px]; then nothing that is `within` any.
        within : (H, W) bool
        """
        area = _doubled_area(self.corners)
        low = np.ceil(self.corners.min(axis=1) - gutter - 0.5).clip(0)
        high = np.floor(self.corners.max(axis=1) + gutter - 0.5).clip(max=size - 1)
        sides = (high - low + 1).clip(0).astype(np.intp)
        counts = np.where(np.abs(area) > 1e-9, sides.prod(axis=1), 0)
        shares, least = self._laws(low + 0.5, np.where(counts, area, 1.0), gutter)
        coordinates = np.einsum("mkx,mku->mux", shares, self.uvs)
        corner = low.astype(np.intp)
        ends = np.cumsum(counts)
        begun = 0
        while begun < len(counts):
            done = ends[begun - 1] if begun else 0
            until = max(int(np.searchsorted(ends, done + CHUNK_PX, "right")), begun + 1)
            triangle = np.repeat(np.arange(begun, until), counts[begun:until])
            inside = np.arange(len(triangle)) - (ends - counts - done)[triangle]
            down, right = np.divmod(inside, sides[triangle, 0])
            begun = until
            columns, rows = right + corner[triangle, 0], down + corner[triangle, 1]
            if gutter:
                free = np.flatnonzero(~within[rows, columns])
                triangle, right, down = triangle[free], right[free], down[free]
                columns, rows = columns[free], rows[free]
            kept = np.ones(len(triangle), bool)
            for own in range(3):
                kept &= _linear(shares[:, own], triangle, right, down) >= least[triangle, own]
            triangle, right, down = triangle[kept], right[kept], down[kept]
            uvs = [_linear(coordinates[:, axis], triangle, right, down) for axis in range(2)]
            yield np.stack([columns[kept], rows[kept]], axis=1), np.stack(uvs, axis=1)

    def _laws(self, origin: Array, area: Array, gutter: float) -> tuple[Array, Array]:
        """Return (M, 3, 3) how a corner's share grows along both axes and what it is at the origin.

        And (M, 3) how small each share may be.
        """
        shares, least = np.empty((len(area), 3, 3)), np.empty((len(area), 3))
        for own in range(3):
            start, end = self.corners[:, (own + 1) % 3], self.corners[:, (own + 2) % 3]
            edge, away = end - start, origin - start
            shares[:, own, 0], shares[:, own, 1] = -edge[:, 1] / area, edge[:, 0] / area
            shares[:, own, 2] = (edge[:, 0] * away[:, 1] - edge[:, 1] * away[:, 0]) / area
            least[:, own] = -gutter * np.hypot(edge[:, 0], edge[:, 1]) / np.abs(area)
        return shares, least

    def colours(self, uvs: Array) -> NDArray[np.float32]:
        """Return (N, 3) linear colours at texture coordinates, whose v grows upwards."""
        if self.texels is None:
            return np.broadcast_to(self.colour, (len(uvs), 3))
        height, width = self.texels.shape[:2]
        at = uvs * (width, -height) + (-0.5, height - 0.5)
        return self.colour * _between(self.texels, at, repeats=True)


def _doubled_area(corners: Array) -> Array:
    """Return (M,) twice the signed area of triangles (M, 3, 2)."""
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area: Array = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
    return area


def _linear(
    laws: Array, which: NDArray[np.intp], right: NDArray[np.intp], down: NDArray[np.intp]
) -> Array:
    """Return (N,) values by laws (M, 3): growth along both axes, value at the origin."""
    along, across, first = laws.T
    values: Array = along[which] * right + across[which] * down + first[which]
    return values


def _between(texels: NDArray[np.float32], at: Array, *, repeats: bool) -> NDArray[np.float32]:
    """Return (N, 3) bilinear values at columns and rows (N, 2), counted from middles of texels."""
    if not len(at):
        return np.zeros((0, 3), np.float32)
    if repeats:
        at = at % texels.shape[1::-1]
    # As a picture, since rows and columns of what OpenCV samples are limited.
    rows = -(-len(at) // WIDTH_PX)
    places = np.zeros((2, rows * WIDTH_PX), np.float32)
    places[:, : len(at)] = at.T
    columns, lines = places.reshape(2, rows, WIDTH_PX)
    border = cv2.BORDER_WRAP if repeats else cv2.BORDER_REPLICATE
    found = cv2.remap(texels, columns, lines, cv2.INTER_LINEAR, borderMode=border)
    return np.asarray(found.reshape(-1, 3)[: len(at)], np.float32)
