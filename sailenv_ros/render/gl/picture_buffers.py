"""The textures that passes draw into, by size, and reading them back into arrays.

Agents of several sizes share one renderer: the textures of the sizes used last are kept.
"""

from __future__ import annotations

from collections import OrderedDict
from typing import Any

import moderngl
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.render.gl.geometry_pass import GeometryPass, Targets
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.views import VIEWS

__all__ = ["PictureBuffers"]

KEPT_SIZES = 24
"""Sets of textures that are kept: 16 agents, some with and without a picture."""


class PictureBuffers:
    """Textures by size and use."""

    def __init__(self, context: moderngl.Context, geometry_pass: GeometryPass) -> None:
        self._context = context
        self._geometry_pass = geometry_pass
        self._targets: OrderedDict[tuple[int, int, bool, tuple[str, ...], bool], Targets] = (
            OrderedDict()
        )
        self._pictures: OrderedDict[tuple[int, int], moderngl.Framebuffer] = OrderedDict()

    def targets(
        self, intrinsics: CameraIntrinsics, *, shaded: bool, outputs: tuple[str, ...], baked: bool
    ) -> Targets:
        """Return the targets of the geometry pass."""
        width, height = intrinsics.width, intrinsics.height
        baked = baked and shaded
        key = (width, height, shaded, outputs, baked)
        if key not in self._targets:
            while len(self._targets) >= KEPT_SIZES:
                self._targets.popitem(last=False)[1].close()
            self._targets[key] = self._geometry_pass.make_targets(
                width, height, shaded=shaded, outputs=outputs, baked=baked
            )
        self._targets.move_to_end(key)
        return self._targets[key]

    def picture(self, intrinsics: CameraIntrinsics) -> moderngl.Framebuffer:
        """Return what the edge pass draws into."""
        size = intrinsics.width, intrinsics.height
        if size not in self._pictures:
            while len(self._pictures) >= KEPT_SIZES:
                _release(self._pictures.popitem(last=False)[1])
            colour = self._context.texture(size, 4, dtype="f2")
            self._pictures[size] = self._context.framebuffer([colour])
        self._pictures.move_to_end(size)
        return self._pictures[size]

    def read_picture(self, picture: moderngl.Framebuffer | None) -> NDArray[np.float16]:
        """Read a lit picture, radiance and share; a fresh (H, W, 4) array."""
        assert picture is not None
        four = np.empty((picture.height, picture.width, 4), np.float16)
        # Reading three components would make the driver convert them, ten times slower.
        picture.read_into(four, components=4, dtype="f2")
        return four

    def read_surface(self, targets: Targets) -> NDArray[np.float32]:
        """Read depth and instance id; a fresh (H, W, 2) array."""
        return _read_float(targets.surface, 2)

    def read_output(self, targets: Targets, view: str) -> NDArray[Any]:
        """Read a view that is written as it is, 0 where nothing was hit; a fresh array."""
        four = _read_float(targets.outputs[view], 4)
        # The clear colour's fourth component is 0, a surface's is 1.
        values = np.where(four[..., 3:] > 0.0, four[..., : VIEWS[view].channels], np.float32(0.0))
        return values.reshape(VIEWS[view].shape(*four.shape[:2]))

    def close(self) -> None:
        """Free all textures."""
        for targets in self._targets.values():
            targets.close()
        self._targets.clear()
        for picture in self._pictures.values():
            _release(picture)
        self._pictures.clear()


def _release(picture: moderngl.Framebuffer) -> None:
    texture = picture.color_attachments[0]
    picture.release()
    texture.release()


def _read_float(texture: moderngl.Texture, components: int) -> NDArray[np.float32]:
    array = np.empty((texture.height, texture.width, components), np.float32)
    texture.read_into(array)
    return array
