"""Shadows of what can move on what was baked, and the light that it gives back.

Rays from patches of the light map meet what can move, or do not: the difference is added to what
was baked. Where things are near or a lamp's shadow falls, each texel casts rays of its own. What
the main light gives straight is left as it is: its shadow map has what can move.
"""

from __future__ import annotations

import copy
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.light.bake.settings import INSIDE_SHARE
from sailenv_ros.light.relight.moved_surfaces import MovedSurfaces
from sailenv_ros.light.relight.object_light import ObjectLighting, PlacedObject
from sailenv_ros.light.relight.quality import FINE
from sailenv_ros.light.relight.ray_world import RayWorld
from sailenv_ros.light.relight.shadow_maps import INSIDE, PointChanges, ShadowMaps, with_neighbours
from sailenv_ros.light.relight.texel_changes import TexelChanges
from sailenv_ros.native.ray_types import RAY_LIGHT
from sailenv_ros.native.relight_kernels import direct_light_delta, gather_change, reached_points
from sailenv_ros.rays.ray_patterns import low_discrepancy_points, sequence_points
from sailenv_ros.types.baked_light import BakedLight
from sailenv_ros.types.light_shapes import light_record

__all__ = ["ObjectShadows"]

Floats = NDArray[np.float32]

CHANGED, WHOLE = 1, 2
"""States of points: their light is another one, or is to be found again."""

LEAST = 0.02
"""Objects that may take less of a patch's view than this share change nothing there."""

NEAR = 11.0
"""Where what hides light is farther than so many times its texels lie from the middle of a patch,
the patch is fine enough."""

TOUCHING = 4.0
"""Where it is nearer than so many times that, light changes so quickly that only many rays tell it
without noise."""

LEAST_DIRECT, LEAST_SOFT = 0.02, 0.1
"""Shares of what small lamps, and area lights, give a patch below which no edges of their shadows
are seen."""

MOST_APART = 128
"""Where more objects stand, kernels may look at those too that do not reach a point."""


class ObjectShadows:
    """Shadows in a scene whose furniture stands where it stands.

    Parameters
    ----------
    lighting : ObjectLighting
    surfaces : MovedSurfaces
        Of the same scene and changes.
    """

    def __init__(self, lighting: ObjectLighting, surfaces: MovedSurfaces) -> None:
        self._lighting, self._surfaces, self._threads = lighting, surfaces, 1
        scene = surfaces.scene
        lights = [layer.light for layer in scene.baked.layers]
        lamps = [(n, one) for n, one in enumerate(lights) if one and one.type != "directional"]
        # As kernels return them: area lights first.
        lamps.sort(key=lambda lamp: lamp[1].type != "area")
        self._records = {n: light_record(light) for n, light in lamps}
        self._areas = [n for n, light in lamps if light.type == "area"]
        self._lamps = [n for n, light in lamps if light.type != "area"]
        columns = 3 * len(lights) + len(self._records)
        patches = len(scene.patches.size)
        self._patches = PointChanges.none(patches, columns)
        # As it was found: there are patches of which only their texels tell.
        self._state = np.zeros(patches, np.uint8)
        self._again = np.zeros(patches, bool)
        away = scene.positions - scene.patches.positions[scene.patches.of_texel]
        far = np.linalg.norm(away, axis=1)
        self._size, self._margin = scene.patches.means(far), np.zeros(patches, np.float32)
        np.maximum.at(self._margin, scene.patches.of_texel, far)
        self._texels = TexelChanges.fresh(np.zeros(0, np.intp), 0, PointChanges.none(0, columns))
        self._things: dict[int, tuple[object, PlacedObject]] = {}
        self._maps = ShadowMaps(surfaces, len(self._lamps))

    @property
    def casters(self) -> frozenset[int]:
        """Ids of the objects whose shadows are known."""
        return frozenset(self._things)

    def update(self, things: Mapping[int, tuple[object, PlacedObject]], threads: int) -> bool:
        """Find the shadows of objects where they are now; return whether any has changed.

        Parameters
        ----------
        things : mapping of int to tuple
            By id; what tells an object's places apart, and the object.
        threads : int
            No result depends on it.
        """
        before = self._things
        left = [before[id_][1] for id_, (key, _) in before.items() if _key(things, id_) != key]
        taken = [thing for id_, (key, thing) in things.items() if _key(before, id_) != key]
        if not left and not taken:
            return False
        self._things, self._threads = dict(things), threads
        self._find(self._may_change([*left, *taken]), [*left, *taken])
        return True

    def copy(self) -> ObjectShadows:
        """Return the same shadows, which change apart from these."""
        same = copy.copy(self)
        same._patches, same._maps = self._patches.copy(), self._maps.copy()
        same._state = self._state.copy()
        return same

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Return what was found, and where that was last, for `take`."""
        found = np.flatnonzero(self._patches.state).astype(np.int32)
        return {
            "again": np.flatnonzero(self._again).astype(np.int32),
            "patches": found,
            "state": self._state[found],
            **self._patches.at(found).arrays("patch"),
            **self._texels.arrays(),
        }

    def take(
        self,
        things: Mapping[int, tuple[object, PlacedObject]],
        arrays: Mapping[str, NDArray[Any]],
        threads: int,
    ) -> None:
        """Take what was found before of objects, from where these shadows are."""
        self._things, self._threads = dict(things), threads
        self._again = np.zeros(len(self._state), bool)
        self._again[arrays["again"]] = True
        self._maps.forget(self._again)
        known, found = np.flatnonzero(self._patches.state), arrays["patches"]
        self._patches.put(known, PointChanges.none(len(known), self._patches.change.shape[1]))
        self._patches.put(found, PointChanges.of(arrays, "patch"))
        self._state[known], self._state[found] = 0, arrays["state"]
        self._texels = TexelChanges.of(arrays)

    def with_changes(
        self, lighting: ObjectLighting, surfaces: MovedSurfaces, near: Collection[int]
    ) -> ObjectShadows:
        """Return the shadows of the same objects where some furniture stands elsewhere.

        Parameters
        ----------
        lighting : ObjectLighting
        surfaces : MovedSurfaces
            Of the scene with these changes.
        near : collection of int
            Ids of the objects near furniture that has changed: the shadows of others are the same.
        """
        changed = ObjectShadows(lighting, surfaces)
        changed._things, changed._threads = self._things, self._threads
        changed._texels = self._texels
        changed._patches, changed._state = self._patches.copy(), self._state.copy()
        every = [thing for _, thing in self._things.values()]
        asked = changed._may_change(every) & (surfaces.wanted == WHOLE)
        asked |= changed._may_change([self._things[id_][1] for id_ in near])
        changed._find(asked)
        return changed

    def on(self, light: BakedLight) -> BakedLight:
        """Return light of the same scene with the shadows in it."""
        if not self._things:
            return light
        after = self._maps.on(
            self._maps_of(light), self._patches,
            self._texels.texels, self._texels.found, self._threads,
        )  # fmt: skip
        bounced, direct = after[: len(light.layers)], after[len(light.layers) :]
        of_layer = dict(zip(self._records, direct, strict=True))
        layers = [
            replace(layer, bounced=own, direct=of_layer.get(number, layer.direct))
            for number, (layer, own) in enumerate(zip(light.layers, bounced, strict=True))
        ]
        return replace(
            light, layers=tuple(layers), casters=self.casters, unshadowed=light, checksum=""
        )

    # -- inside --------------------------------------------------------------------------------

    def _world_of(self, things: Sequence[PlacedObject]) -> RayWorld:
        lighting = self._lighting
        placed = [replace(lighting.placed(thing), before=False) for thing in things]
        return lighting.world.with_more(placed)

    def _may_change(self, things: Sequence[PlacedObject]) -> NDArray[np.bool_]:
        """Return (P,) bool: the patches whose light objects may change."""
        surfaces = self._surfaces
        places = surfaces.patch_positions, surfaces.patch_normals
        return self._reached(things, *places, self._margin) & (surfaces.wanted > 0)

    def _reached(
        self, things: Sequence[PlacedObject], positions: Floats, normals: Floats, margins: Floats
    ) -> NDArray[np.bool_]:
        """Return (K,) bool: the points that objects reach, or the way of light to them."""
        found = reached_points(
            self._world_of(things).record, positions, normals, margins,
            _joined(self._records.values()), least=LEAST, threads=self._threads,
        )  # fmt: skip
        reached: NDArray[np.bool_] = found > 0
        return reached

    def _find(self, reached: NDArray[np.bool_], moved: Sequence[PlacedObject] = ()) -> None:
        """Find what changes at patches, and at the texels of those where that is not enough.

        Parameters
        ----------
        reached : (P,) bool
            Patches whose light may be another one.
        moved : sequence of PlacedObject
            All that has changed, where it was and where it is: what nothing of it reaches is as it
            was found. Without any, everything is found again.
        """
        surfaces, patches = self._surfaces, self._patches
        every = [thing for _, (_, thing) in sorted(self._things.items())]
        anew = not moved or len(every) + len(moved) > MOST_APART
        # Whether a patch is enough depends on those beside it, too.
        self._again = again = with_neighbours(surfaces.scene, reached)
        self._maps.forget(again)
        asked = np.flatnonzero(again & self._may_change(every))
        fresh = np.ones(len(asked), bool) if anew else reached[asked]
        found = patches.at(asked)._replace(state=self._state[asked])
        nothing = PointChanges.none(int(again.sum()), patches.change.shape[1])
        patches.put(np.flatnonzero(again), nothing)
        self._state[again] = 0
        world = self._world_of(every)
        places = surfaces.patch_positions, surfaces.patch_normals
        gathered = self._gathered(world, *places, asked[fresh], FINE.rays, 0)
        found.put(np.flatnonzero(fresh), gathered)
        patches.put(asked, found)
        self._state[asked] = found.state
        close, edges = self._uneven(asked, found)
        # They say nothing of others.
        patches.state[asked[close | edges]] = INSIDE
        touching = (close | edges) & (found.nearness < TOUCHING * self._size[asked])
        chosen = (
            (touching, FINE.texel_rays),
            (close & ~touching, FINE.rays),
            (edges & ~(close | touching), FINE.edge_rays),
        )
        texels = self._texels.texels
        moves = np.ones(len(texels), bool)
        if not anew:
            at = surfaces.positions[texels], surfaces.normals[texels]
            moves = self._reached(moved, *at, np.zeros(len(texels), np.float32))
        known = self._texels.after(moves)
        fresh_texels = [
            self._found_at(known, world, self._texels_of(asked[own]), rays) for own, rays in chosen
        ]
        self._texels = known.replaced(~again[surfaces.scene.patches.of_texel[texels]], fresh_texels)

    def _found_at(
        self, known: TexelChanges, world: RayWorld, texels: NDArray[np.intp], rays: int
    ) -> TexelChanges:
        """Find what changes at texels, as far as it is not known."""
        surfaces = self._surfaces
        there, found_before = known.known(texels, rays)
        found = PointChanges.none(len(texels), self._patches.change.shape[1])
        found.put(np.flatnonzero(there), found_before)
        places = surfaces.positions, surfaces.normals
        fresh = self._gathered(world, *places, texels[~there], rays, len(self._state))
        found.put(np.flatnonzero(~there), fresh)
        return TexelChanges.fresh(texels, rays, found)

    def _uneven(
        self, asked: NDArray[np.intp], found: PointChanges
    ) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
        """Return which patches are not enough: by what is close, and where shadows end."""
        scene, change = self._surfaces.scene, self._patches.change
        areas, lamps = np.split(
            change[:, change.shape[1] - len(self._records) :], [len(self._areas)], 1
        )
        # Between patches that an edge crosses, rays of one may miss it.
        edges: NDArray[np.bool_] = with_neighbours(
            scene, _share(lamps, scene.direct[:, self._lamps]) > LEAST_DIRECT
        )[asked]
        soft = with_neighbours(scene, _share(areas, scene.direct[:, self._areas]) > LEAST_SOFT)
        edges |= soft[asked] & (found.state > 0)
        close: NDArray[np.bool_] = found.nearness < NEAR * self._size[asked]
        close |= found.state == INSIDE
        return close & (found.state > 0), edges

    def _texels_of(self, patches: NDArray[np.intp]) -> NDArray[np.intp]:
        """Return the texels of patches, in their order in the scene."""
        chosen = np.zeros(len(self._patches.state), bool)
        chosen[patches] = True
        return np.flatnonzero(chosen[self._surfaces.scene.patches.of_texel])

    def _gathered(
        self,
        world: RayWorld,
        positions: Floats,
        normals: Floats,
        chosen: NDArray[np.integer],
        rays: int,
        first_number: int,
    ) -> PointChanges:
        """Gather what changes at chosen points."""
        here, facing = positions[chosen], normals[chosen]
        numbers = (chosen + first_number).astype(np.uint32)
        count, threads = len(chosen), self._threads
        state, bounced, areas, nearness = gather_change(
            world.record, here, facing, np.full(count, CHANGED, np.uint8),
            low_discrepancy_points(rays), _joined(self._records[n] for n in self._areas),
            sequence_points(FINE.area_rays), LEAST, inside_share=INSIDE_SHARE,
            most_changed=1.0, numbers=numbers, threads=threads,
        )  # fmt: skip
        columns = [bounced, areas]
        nothing = np.zeros(len(self._patches.state), np.uint8)
        for number in self._lamps:
            touched, change, _ = direct_light_delta(
                world.record, self._records[number], here, facing, np.zeros(count, np.int32),
                nothing, sequence_points(FINE.light_rays), numbers=numbers, threads=threads,
            )  # fmt: skip
            columns.append(np.where(touched > 0, change, np.float32(0.0))[:, None])
            state = np.where((state == 0) & (touched > 0), np.uint8(CHANGED), state)
        return PointChanges(state, np.concatenate(columns, axis=1), nearness)

    def _maps_of(self, light: BakedLight) -> list[NDArray[np.float16]]:
        """Return the maps that shadows are in: bounced light, and direct light of some layers."""
        layers = light.layers
        return [layer.bounced for layer in layers] + [layers[n].direct for n in self._records]


def _share(change: Floats, light: Floats) -> Floats:
    """Return (P,) float32: how much changes of (P, N) lights of each patch."""
    share: Floats = np.abs(change).sum(axis=1) / np.maximum(light.sum(axis=1), 1e-6)
    return share


def _key(things: Mapping[int, tuple[object, PlacedObject]], id_: int) -> object:
    known = things.get(id_)
    return None if known is None else known[0]


def _joined(records: Iterable[NDArray[np.void]]) -> NDArray[np.void]:
    return np.concatenate([np.zeros(0, RAY_LIGHT), *records])
