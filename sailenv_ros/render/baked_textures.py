"""Baked light on the GPU: the light map of the moment, and the light around each instance.

Scene contents come in, textures that the lighting pass reads go out. They are written again when
lights change (light map) and when something moves (light around instances).
"""

from __future__ import annotations

from dataclasses import replace

import moderngl
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.lights import Environment, Light
from sailenv_ros.render.light_mixing import MixedLight, instance_light, mix
from sailenv_ros.render.programs import set_uniform
from sailenv_ros.snapshot import SceneContents, WorldSnapshot

__all__ = ["BakedTextures"]

LIGHT_MAP_UNIT, INSTANCE_UNIT = 4, 5

ROW_IDS = 256
"""Instance ids per row of the texture with the light around instances: three texels each."""


class BakedTextures:
    """The baked light of the scene that is shown, in one context."""

    def __init__(self, context: moderngl.Context) -> None:
        self._context = context
        self._light_map: moderngl.Texture | None = None
        self._instances: moderngl.Texture | None = None
        self._of: tuple[object, tuple[Light, ...], Environment] | None = None
        self._placed: tuple[MixedLight, SceneContents] | None = None
        self._poses: NDArray[np.float64] | None = None
        self._middles = np.zeros((0, 4))
        self.mixed: MixedLight | None = None

    def show(self, snapshot: WorldSnapshot) -> MixedLight | None:
        """Bring the textures up to date; None where the scene has no baked light."""
        contents = snapshot.contents
        if contents.baked is None:
            self.mixed = self._of = None
            return None
        # Exposure comes after the light: a picture that is made brighter needs no new mixture.
        of = (contents.baked, contents.lights, replace(contents.environment, exposure=0.0))
        if self.mixed is None or self._of != of:
            self.mixed, self._of = mix(*of), of
            self._upload(self.mixed)
        self._place(snapshot, self.mixed)
        return self.mixed

    def bind(self, program: moderngl.Program) -> None:
        """Make the textures readable for a program."""
        assert self._light_map is not None
        assert self._instances is not None
        self._light_map.use(LIGHT_MAP_UNIT)
        set_uniform(program, "light_map", LIGHT_MAP_UNIT)
        self._instances.use(INSTANCE_UNIT)
        set_uniform(program, "instance_light", INSTANCE_UNIT)

    def close(self) -> None:
        """Free the textures."""
        for texture in (self._light_map, self._instances):
            if texture is not None:
                texture.release()

    def _upload(self, mixed: MixedLight) -> None:
        height, width, _ = mixed.texels.shape
        if self._light_map is None or self._light_map.size != (width, height):
            if self._light_map is not None:
                self._light_map.release()
            self._light_map = self._context.texture((width, height), 4, dtype="f2")
            self._light_map.filter = (moderngl.LINEAR, moderngl.LINEAR)
            self._light_map.repeat_x = self._light_map.repeat_y = False
        self._light_map.write(np.ascontiguousarray(mixed.texels))

    def _place(self, snapshot: WorldSnapshot, mixed: MixedLight) -> None:
        """Look the light around each instance up, where anything has moved or changed."""
        contents, poses = snapshot.contents, snapshot.world_from_body
        placed = (mixed, contents)
        if self._placed == placed and np.array_equal(self._poses, poses):  # type: ignore[arg-type]
            return
        if self._placed is None or self._placed[1] is not contents:
            self._middles = _middles(contents)
        assert contents.baked is not None
        self._placed, self._poses = placed, poses
        points = np.einsum("nij,nj->ni", poses, self._middles)[:, :3]
        light = instance_light(mixed.probes, contents.baked.probes, points)
        ids = contents.instance_ids.astype(np.intp)
        rows = int(ids.max(initial=0)) // ROW_IDS + 1
        # Red, green and blue of an instance side by side, each with its four numbers.
        table = np.zeros((rows * ROW_IDS, 3, 4), np.float32)
        table[ids] = light.transpose(0, 2, 1)
        if self._instances is None or self._instances.height != rows:
            if self._instances is not None:
                self._instances.release()
            self._instances = self._context.texture((3 * ROW_IDS, rows), 4, dtype="f4")
            self._instances.filter = (moderngl.NEAREST, moderngl.NEAREST)
        self._instances.write(table)


def _middles(contents: SceneContents) -> NDArray[np.float64]:
    """Give (N, 4): the homogeneous middle of each instance in its body frame."""
    middles = np.ones((len(contents.instances), 4))
    for row, drawn in enumerate(contents.instances):
        middles[row, :3] = drawn.model.bounds().mean(axis=0) * np.asarray(drawn.scale)
    return middles
