"""Reflection maps of a room, kept separately for each light.

Radiance is linear in the power of each light. So the room is looked at once for each light alone,
at power 1, and once for the sky and what glows; when a light is made brighter or gets another
colour, that costs a sum. Pictures in six directions from several points come in, reflection maps
go out. Every back end draws with it. Knows no graphics library.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Hashable, Sequence
from dataclasses import asdict, dataclass, replace
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.render.scene import reflection_map as reflections
from sailenv_ros.render.scene.lightmap_compositing import Term
from sailenv_ros.render.scene.mirrored_lamps import Seen, Surroundings, glint_of, radiance_of
from sailenv_ros.render.scene.reflection_points import LAMPLESS, ReflectionPoints
from sailenv_ros.render.scene.reflection_store import ReflectionStore, room_key
from sailenv_ros.system.array_cache import cached_arrays, code_digest
from sailenv_ros.types.camera import Camera
from sailenv_ros.types.digests import sky_digest
from sailenv_ros.types.lights import Environment, Light
from sailenv_ros.types.snapshot import WorldSnapshot

__all__ = ["Look", "RoomReflections", "Share", "Sum"]

Look: TypeAlias = Callable[[Light | None, list[tuple[Camera, bool]]], list[Seen]]
"""``look(light, views)`` returns what cameras see under one light alone, with its lamps glowing if
the view says so; None: under the sky, with what emits of itself."""

Sum: TypeAlias = Callable[
    [Sequence[Term], NDArray[np.float32], NDArray[np.uint8]], NDArray[np.float16]
]
"""Signature of `lightmap_compositing.sum_texels`."""


@dataclass(frozen=True, eq=False, slots=True)
class Share:
    """One light's part of what is mirrored, at power 1.

    Attributes
    ----------
    texels : (T, 1, 3) float16
        All layers of `reflection_map.prefilter`, of one point after the other.
    around : (K, 3, 4) float64
        What `reflection_map.light_from_around` says of each point and colour.
    """

    texels: NDArray[np.float16]
    around: NDArray[np.float64]


class _Wanted(NamedTuple):
    """A light alone, or None for the sky; whether it is mirrored itself; its power."""

    key: Hashable
    alone: Light | None
    is_mirrored: bool
    power: NDArray[np.float32]


class RoomReflections:
    """The reflection maps of the room that is shown.

    Parameters
    ----------
    blur : Blur
        See `reflection_map.prefilter`.
    add : Sum
    store : ReflectionStore or None
        Serves several rooms, one after another, some of which are shown again; None keeps nothing
        but the room that is shown.
    drawn_by : str
        Distinguishes what draws: shares of rooms in light as it was baked are kept on disk for it.
        Empty keeps none.
    has_faces : bool
        Whether faces of area lights are in the maps; not if what draws finds them for each picture.

    Attributes
    ----------
    points : ReflectionPoints
        From where the room is looked at.
    layers : (K, L, E, E, 4) float16
        Of each point; see `reflection_map.prefilter`.
    around : (K, 4) float64
        What `reflection_map.light_from_around` says of each point.
    """

    def __init__(
        self,
        blur: reflections.Blur,
        add: Sum,
        store: ReflectionStore[Share] | None = None,
        drawn_by: str = "",
        *,
        has_faces: bool = True,
    ) -> None:
        self._blur = blur
        self._sum = add
        self._store = store
        self._drawn_by = drawn_by
        self._has_faces = has_faces
        self._room: Hashable = None
        self._shares: dict[Hashable, Share] = {}
        self._of: tuple[object, bytes] | None = None
        self._alone_of: dict[Light, Light] = {}
        self._environment: Environment | None = None
        self._sky: Environment | None = None
        edge = reflections.EDGE + 2
        self.points = ReflectionPoints()
        self.layers = np.zeros((1, len(reflections.ROUGHNESSES), edge, edge, 4), np.float16)
        self.around = np.zeros((1, 4))

    def update(
        self,
        snapshot: WorldSnapshot,
        still: NDArray[np.bool_],
        main: Light | None,
        look: Look,
        live: Collection[Light] = (),
    ) -> None:
        """Bring the maps up to date, when lights have changed, or what is lit, but for a while.

        Parameters
        ----------
        still : (N,) bool
            Which instances have baked light where they are: only these are mirrored.
        main : Light or None
            The light that casts the shadow map.
        live : collection of Light
            Those whose highlights are drawn with each picture: they are not mirrored once more.
        """
        contents = snapshot.contents
        assert contents.baked is not None
        of = (contents.baked.of_still, contents.instance_ids[still].tobytes())
        waits = contents.baked.rough and self._of is not None
        changed = self._of is None or self._of[0] is not of[0] or self._of[1] != of[1]
        if changed and not waits:
            self._shares, self._of = {}, of
            self.points.choose(snapshot)
            if self._store is not None or self._drawn_by:
                self._room = room_key(snapshot, still, self.points.points)
        if self._environment is not contents.environment:
            self._environment = contents.environment
            self._sky = replace(contents.environment, exposure=0.0)
        wanted = [_Wanted(("sky", self._sky), None, False, np.ones(3, np.float32))]
        alone_of = {}
        for light in contents.lights:
            alone = self._alone_of.get(light)
            if alone is None:
                alone = replace(light, colour=(1.0, 1.0, 1.0), intensity=1.0)
            alone_of[light] = alone
            power = np.array(light.power, np.float32)
            if power.any():
                mirrored = light is not main and light not in live
                key = alone, light is main, mirrored
                wanted.append(_Wanted(key, alone, mirrored, power))
        self._alone_of = alone_of
        shares = {
            one.key: self._shares.get(one.key)
            or (self._seen(one, look) if waits else self._share(one, look, snapshot))
            for one in wanted
        }
        self._shares = shares
        terms = [(shares[one.key].texels, one.power) for one in wanted]
        shown = np.full(terms[0][0].shape[:2], 255, np.uint8)
        texels = self._sum(terms, np.zeros(3, np.float32), shown)
        self.layers = texels.reshape(-1, *self.layers.shape[1:])
        self.around = sum(
            (np.einsum("c,kci->ki", one.power, shares[one.key].around) for one in wanted),
            np.zeros((len(self.layers), 4)),
        )

    def _share(self, wanted: _Wanted, look: Look, snapshot: WorldSnapshot) -> Share:
        """Return the share that the store has, or a new one."""
        known = None if self._store is None else self._store.get((self._room, wanted.key))
        if known is not None:
            return known
        made = self._kept(wanted, look, snapshot)
        if self._store is not None:
            self._store.put((self._room, wanted.key), made, snapshot)
        return made

    def _kept(self, wanted: _Wanted, look: Look, snapshot: WorldSnapshot) -> Share:
        """Return the share that is on disk, if it can be."""
        contents = snapshot.contents
        assert contents.baked is not None
        if not self._drawn_by or not contents.baked.of_still.checksum:
            return self._seen(wanted, look)
        sky = contents.environment.sky
        told = replace(contents.environment, sky=None, exposure=0.0)
        lit = (
            (None if sky is None else sky_digest(sky), told) if wanted.alone is None else wanted.key
        )
        arrays = cached_arrays(
            "reflection",
            [self._drawn_by, self._room, lit],
            lambda: asdict(self._seen(wanted, look)),
            code=code_digest("render/cpu", "render/scene", "native", "types"),
        )
        return Share(**arrays)

    def _seen(self, wanted: _Wanted, look: Look) -> Share:
        every = [reflections.cube_cameras(point) for point in self.points.points]
        views = [(one, number != LAMPLESS) for number, six in enumerate(every) for one in six]
        pictures = iter(look(wanted.alone, views))
        maps = []
        for number, cameras in enumerate(every):
            around = Surroundings(cameras, [next(pictures) for _ in cameras])
            mirrored = wanted.is_mirrored and number != LAMPLESS
            maps.append(self._layers(around, wanted.alone if mirrored else None))
        texels = np.concatenate([layers.reshape(-1, 1, 3) for layers in maps])
        return Share(np.ascontiguousarray(texels), np.array([_around(layers) for layers in maps]))

    def _layers(self, around: Surroundings, lamp: Light | None) -> NDArray[np.float16]:
        """Return (L, N + 2, N + 2, 3): what is mirrored around a point, with a lamp or none."""
        seen = [picture.radiance for picture in around.pictures]
        flat = reflections.flattened(around.cameras, seen, reflections.EDGE)
        glint = None
        if lamp is not None:
            if self._has_faces:
                flat += radiance_of(lamp, around)
            glint = glint_of(lamp, around)
        glints = [] if glint is None else [glint]
        return reflections.prefilter(flat, blur=self._blur, glints=glints)[..., :3]


def _around(layers: NDArray[np.float16]) -> NDArray[np.float64]:
    """Return (3, 4): what `light_from_around` says of each colour."""
    first = layers[0, 1:-1, 1:-1].astype(np.float64)
    return np.array([reflections.light_from_around(first * colour) for colour in np.eye(3)])
