"""What shiny surfaces mirror of a room, kept for each light apart.

Radiance is linear in the power of each light. So the room is looked at once for each light alone,
at power 1, and once for the sky and what glows; when a light is made brighter or gets another
colour, that costs a sum. Pictures in six directions come in, reflection maps go out.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import dataclass, replace
from functools import partial
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.camera import Camera
from sailenv_ros.lights import Environment, Light
from sailenv_ros.native.light_maps import blur_directions, sum_texels
from sailenv_ros.render import reflection_map as reflections
from sailenv_ros.snapshot import SceneContents

__all__ = ["Look", "RoomReflections"]

Look: TypeAlias = Callable[[Light | None, list[Camera]], list[NDArray[np.float32]]]
"""``look(light, cameras)`` returns (H, W, 3) for each camera: linear radiance under one light
alone; None: under the sky, with what glows."""


@dataclass(frozen=True, eq=False, slots=True)
class _Share:
    """One light's part of what is mirrored, at power 1.

    Attributes
    ----------
    texels : (T, 1, 3) float16
        All layers of `reflection_map.prefilter`.
    around : (3, 4) float64
        What `reflection_map.light_from_around` says of each colour.
    """

    texels: NDArray[np.float16]
    around: NDArray[np.float64]


class RoomReflections:
    """The reflection map of the room that is shown.

    Parameters
    ----------
    threads : int
        How many threads work. The map does not depend on it.

    Attributes
    ----------
    layers : (L, E, E, 4) float16
        See `reflection_map.prefilter`.
    room : dict of str to array
        Fields of LIGHT: ``reflection_from``, ``room_low``, ``room_high``, ``room_light``.
    """

    def __init__(self, threads: int) -> None:
        self._blur = partial(blur_directions, threads=threads)
        self._sum = partial(sum_texels, threads=threads)
        self._shares: dict[Hashable, _Share] = {}
        self._of: tuple[object, bytes] | None = None
        self._alone_of: dict[Light, Light] = {}
        self._environment: Environment | None = None
        self._sky: Environment | None = None
        edge = reflections.EDGE + 2
        self.layers = np.zeros((len(reflections.ROUGHNESSES), edge, edge, 4), np.float16)
        self.room: dict[str, NDArray[np.float64]] = {}

    def update(
        self,
        contents: SceneContents,
        still: NDArray[np.bool_],
        main: Light | None,
        look: Look,
    ) -> None:
        """Bring the map up to date, when lights have changed.

        Parameters
        ----------
        still : (N,) bool
            Which instances have baked light where they are: only these are mirrored.
        main : Light or None
            The light that casts the shadow map.
        """
        assert contents.baked is not None
        of = (contents.baked, contents.instance_ids[still].tobytes())
        if self._of is None or self._of[0] is not of[0] or self._of[1] != of[1]:
            self._shares, self._of = {}, of
        middle, (low, high) = reflections.view_point(contents.baked.probes)
        if self._environment is not contents.environment:
            self._environment = contents.environment
            self._sky = replace(contents.environment, exposure=0.0)
        wanted: list[tuple[Hashable, Light | None, NDArray[np.float32]]] = [
            (("sky", self._sky), None, np.ones(3, np.float32))
        ]
        alone_of = {}
        for light in contents.lights:
            alone = self._alone_of.get(light)
            if alone is None:
                alone = replace(light, colour=(1.0, 1.0, 1.0), intensity=1.0)
            alone_of[light] = alone
            power = np.asarray(light.colour, np.float32) * np.float32(light.intensity)
            if power.any():
                wanted.append(((alone, light is main), alone, power))
        self._alone_of = alone_of
        shares = {
            key: self._shares.get(key) or self._share(middle, alone, look)
            for key, alone, _ in wanted
        }
        self._shares = shares
        terms = [(shares[key].texels, power) for key, _, power in wanted]
        shown = np.full(terms[0][0].shape[:2], 255, np.uint8)
        texels = self._sum(terms, np.zeros(3, np.float32), shown)
        self.layers = texels.reshape(self.layers.shape)
        around = sum(power @ shares[key].around for key, _, power in wanted)
        self.room = {
            "reflection_from": middle,
            "room_low": low,
            "room_high": high,
            "room_light": np.asarray(around, np.float64),
        }

    def _share(self, middle: NDArray[np.float64], alone: Light | None, look: Look) -> _Share:
        cameras = reflections.cube_cameras(middle)
        flat = reflections.flattened(cameras, look(alone, cameras), reflections.EDGE)
        layers = reflections.prefilter(flat, blur=self._blur)[..., :3]
        seen = layers[0, 1:-1, 1:-1].astype(np.float64)
        each = [reflections.light_from_around(seen * colour) for colour in np.eye(3)]
        return _Share(np.ascontiguousarray(layers).reshape(-1, 1, 3), np.stack(each))
