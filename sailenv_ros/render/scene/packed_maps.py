"""A material's normal map and its metallic-roughness map in one texture: one look-up for both.

Red and green: the normal's x and y, 128 = 0; z follows, as normals have length 1. Blue: roughness.
Alpha: metallic. On a software rasteriser each look-up costs a twentieth of a picture of a room.
"""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.types.model import Material, Texture

__all__ = ["pack_maps"]


def pack_maps(material: Material) -> Texture | None:
    """Join both maps in the greater of their sizes; None if the material has neither.

    Returns
    -------
    texture : (H, W, 4) uint8 or None
        What a map that is not there would hold is without meaning.
    """
    finish, normal = material.metallic_roughness_texture, material.normal_texture
    present = [texture for texture in (finish, normal) if texture is not None]
    if not present:
        return None
    height, width = (max(texture.shape[axis] for texture in present) for axis in (0, 1))
    result = np.full((height, width, 4), 128, np.uint8)
    if normal is not None:
        result[..., :2] = _brought_to(normal[..., :2], height, width)
    if finish is not None:
        result[..., 2:] = _brought_to(finish[..., 1:3], height, width)
    result.flags.writeable = False
    return result


def _brought_to(texture: NDArray[np.uint8], height: int, width: int) -> NDArray[np.uint8]:
    if texture.shape[:2] == (height, width):
        return texture
    same = np.ascontiguousarray(texture)
    return np.asarray(cv2.resize(same, (width, height), interpolation=cv2.INTER_LINEAR), np.uint8)
