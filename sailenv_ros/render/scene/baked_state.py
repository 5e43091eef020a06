"""Baked light as it is at one instant: the light map, and the light around each instance.

A snapshot comes in, arrays that shading reads go out. They are made again when lights change (light
map) and when something moves (light around instances). Knows no graphics library.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.render.scene.drawn_meshes import unwrappings
from sailenv_ros.render.scene.lightmap_compositing import (
    CompositedLight,
    composite_lightmap,
    instance_light,
)
from sailenv_ros.types.baked_light import LIGHT_TERMS, ObjectLight
from sailenv_ros.types.colour import LUMINANCE
from sailenv_ros.types.lights import Environment, Light
from sailenv_ros.types.snapshot import SceneContents, WorldSnapshot

__all__ = ["FIRST_FACTOR", "INSTANCE_ROW", "ROW_IDS", "BakedState"]

Floats: TypeAlias = NDArray[np.float32]

ROW_IDS = 256
"""The table of instances has a multiple of this number of rows."""

INSTANCE_ROW = 3 * LIGHT_TERMS + 12
"""Numbers of an instance in the table: terms of red, green and blue, see `ObjectLight`; then the
body's axes, four numbers each, of which the last is 0; that of the first axis is 1 more than the
number of the instance's first vertex among `BakedState.vertex_factors`, or 0."""

FIRST_FACTOR = 3 * LIGHT_TERMS + 3
"""Where that number is."""

LEAST_FACTOR, MOST_FACTOR = 1e-3, 4.0
"""Light at a vertex is so many times what terms say: where these are next to nothing, the quotient
says nothing; 0 would say that there is none."""


class BakedState:
    """The baked light of the scene that is shown.

    Attributes
    ----------
    composited : CompositedLight or None
        Replaced by another object when lights have changed.
    instances : (R, INSTANCE_ROW) float32
        The light around each instance id. Where that is not known, by the probes at the instance's
        middle. Replaced by another array when something has moved.
    vertex_factors : (K,) float32
        What that light is multiplied by at vertices, of one instance after another, see
        `ObjectLight.found`. Replaced with `instances`.
    """

    def __init__(self) -> None:
        self._of: tuple[object, tuple[Light, ...], Environment] | None = None
        self._contents: SceneContents | None = None
        self._placed: tuple[CompositedLight, SceneContents, object] | None = None
        self._poses: NDArray[np.float64] | None = None
        self._shown: tuple[object, object] = (None, None)
        self._middles = np.zeros((0, 4))
        self._vertex_counts: dict[int, int] = {}
        self._sums: dict[int, tuple[ObjectLight, Floats, Floats]] = {}
        self.composited: CompositedLight | None = None
        self.instances: Floats = np.zeros((ROW_IDS, INSTANCE_ROW), np.float32)
        self.vertex_factors: Floats = np.zeros(0, np.float32)

    def update(self, snapshot: WorldSnapshot) -> CompositedLight | None:
        """Bring everything up to date; None where the scene has no baked light."""
        contents = snapshot.contents
        if contents.baked is None:
            self.composited = self._of = self._contents = None
            return None
        if self._contents is not contents or self.composited is None:
            # Exposure comes after the light: a picture made brighter needs no new mixture.
            of = (contents.baked, contents.lights, replace(contents.environment, exposure=0.0))
            if self.composited is None or self._of != of:
                self.composited = composite_lightmap(*of)
                self._of = of
            self._contents = contents
        self._place(snapshot, self.composited)
        return self.composited

    def _place(self, snapshot: WorldSnapshot, composited: CompositedLight) -> None:
        """Look the light around each instance up, where anything has moved or changed."""
        contents, poses = snapshot.contents, snapshot.world_from_body
        placed = (composited, contents, snapshot.object_light)
        if self._placed == placed and np.array_equal(self._poses, poses):  # type: ignore[arg-type]
            return
        assert contents.baked is not None
        instances, charts = self._shown
        self._shown = contents.instances, contents.baked.charts
        if instances is not contents.instances:
            self._middles = _middles(contents)
        if instances is not contents.instances or charts is not contents.baked.charts:
            self._vertex_counts = _vertex_counts(contents)
        if self._placed is None or self._placed[0] is not composited:
            self._sums = {}
        self._placed, self._poses = placed, poses
        self.instances = self.around(snapshot, composited.probes)
        known, self._sums = self._sums, {}
        factors, count = [np.zeros(0, np.float32)], 0
        for id_, light in snapshot.object_light.items():
            total = known.get(id_)
            if total is None or total[0] is not light:
                total = light, _sum_of(light, composited), _factors_of(light, composited)
            self._sums[id_] = total
            self.instances[id_] = total[1]
            # Light may be that of a moment ago, when another model stood there.
            if len(total[2]) and len(total[2]) == self._vertex_counts.get(id_):
                self.instances[id_, FIRST_FACTOR] = 1 + count
                factors.append(total[2])
                count += len(total[2])
        self.vertex_factors = np.concatenate(factors)

    def around(self, snapshot: WorldSnapshot, probes: NDArray[np.float32]) -> NDArray[np.float32]:
        """Look the light around each instance of the snapshot of `update` up; as `instances`."""
        contents = snapshot.contents
        assert contents.baked is not None
        points = np.einsum("nij,nj->ni", snapshot.world_from_body, self._middles)[:, :3]
        light = instance_light(probes, contents.baked.probes, points)
        ids = contents.instance_ids.astype(np.intp)
        rows = int(ids.max(initial=0)) // ROW_IDS + 1
        table = np.zeros((rows * ROW_IDS, INSTANCE_ROW), np.float32)
        for colour in range(3):
            first = colour * LIGHT_TERMS
            table[ids, first : first + 4] = light[..., colour]
        return table


def _sum_of(light: ObjectLight, composited: CompositedLight) -> NDArray[np.float32]:
    """Return (INSTANCE_ROW,): the layers of an object's light as bright as they are now."""
    total = np.zeros((LIGHT_TERMS, 3), np.float32)
    total[0] = composited.more
    for number, bounced, direct in composited.powers:
        total += light.bounced[number] * bounced + light.direct[number][:, None] * direct
    axes = np.zeros((3, 4), np.float32)
    axes[:, :3] = light.axes
    return np.concatenate([total.T.reshape(-1), axes.reshape(-1)])


def _factors_of(light: ObjectLight, composited: CompositedLight) -> Floats:
    """Return (V,): what light by terms is multiplied by at vertices, as bright as layers are."""
    # What is added is the same everywhere.
    found, fitted = np.full((2, light.found.shape[1]), 1e-6 + composited.more @ LUMINANCE)
    for number, bounced, direct in composited.powers if len(found) else ():
        powers = np.array([bounced @ LUMINANCE, direct @ LUMINANCE])
        found += light.found[number].astype(np.float64) @ powers
        fitted += light.fitted[number].astype(np.float64) @ powers
    quotient = np.maximum(found, 0.0) / np.maximum(fitted, 1e-6)
    return np.asarray(np.clip(quotient, LEAST_FACTOR, MOST_FACTOR), np.float32)


def _vertex_counts(contents: SceneContents) -> dict[int, int]:
    """Return the number of vertices of each instance that has no place in the light map."""
    return {
        drawn.instance.id: drawn.model.first_vertices[-1]
        for drawn, flat in zip(contents.instances, unwrappings(contents), strict=True)
        if flat is None and not drawn.deforms
    }


def _middles(contents: SceneContents) -> NDArray[np.float64]:
    """Return (N, 4): the homogeneous middle of each instance in its body frame."""
    middles = np.ones((len(contents.instances), 4))
    if contents.instances:
        middles[:, :3] = [drawn.model.middle for drawn in contents.instances]
        middles[:, :3] *= [drawn.scale for drawn in contents.instances]
    return middles
