"""Texels and patches of a bake where their objects stand now. From `BakedScene` and changes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.light.relight.baked_scene import BakedScene
from sailenv_ros.light.relight.scene_changes import Change
from sailenv_ros.native.relight_types import MappedTexels, PatchMap
from sailenv_ros.types.geometry import invert

__all__ = ["MovedSurfaces", "moved_surfaces"]

Floats = NDArray[np.float32]


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class MovedSurfaces:
    """Places of texels and patches, of which a few have moved.

    Attributes
    ----------
    scene : BakedScene
    positions, normals : (N, 3) float32
        Of the texels, world frame [m].
    patch_positions, patch_normals : (P, 3) float32
    wanted : (P,) uint8
        0 of what is gone, 2 of what has moved, else 1.
    """

    scene: BakedScene
    positions: Floats
    normals: Floats
    patch_positions: Floats
    patch_normals: Floats
    wanted: NDArray[np.uint8]

    def texels(self, of: NDArray[np.bool_] | slice = slice(None)) -> MappedTexels:
        """Return the texels, or some of them, as kernels take them."""
        scene = self.scene
        return MappedTexels(
            scene.places[of], self.positions[of], self.normals[of], scene.owners[of]
        )

    def patches(self) -> PatchMap:
        """Return the patches as kernels take them."""
        patches = self.scene.patches
        return PatchMap(
            patches.of_map, patches.places, self.patch_positions, self.patch_normals, patches.owners
        )


def moved_surfaces(scene: BakedScene, changes: Sequence[Change]) -> MovedSurfaces:
    """Put the texels and patches of what moved to where they are now."""
    patches = scene.patches
    wanted = np.ones(len(patches.size), np.uint8)
    points = [scene.positions, patches.positions]
    directions = [scene.normals, patches.normals]
    moved = [change for change in changes if change.came is None]
    if moved:
        points, directions = ([array.copy() for array in arrays] for arrays in (points, directions))
    for change in moved:
        chosen = [scene.owners == change.id, patches.owners == change.id]
        wanted[chosen[1]] = 0 if change.after is None else 2
        if change.after is None:
            continue
        motion = change.after @ invert(scene.baked.charts[change.id].world_from_body)
        for place, direction, own in zip(points, directions, chosen, strict=True):
            place[own] = place[own] @ motion[:3, :3].T + motion[:3, 3]
            direction[own] = direction[own] @ motion[:3, :3].T
    return MovedSurfaces(
        scene=scene,
        positions=points[0],
        normals=directions[0],
        patch_positions=points[1],
        patch_normals=directions[1],
        wanted=wanted,
    )
