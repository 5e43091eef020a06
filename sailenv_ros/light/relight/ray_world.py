"""Triangles that rays hit before and after changes, as kernels take them.

From `BakedScene` and changes to structures of `native.ray_types`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.light.relight.baked_scene import BakedScene
from sailenv_ros.light.relight.scene_changes import (
    Change,
    PlacedInstance,
    placed_instances,
    ray_instances,
)
from sailenv_ros.light.relight.sent_light import sent_by_probes
from sailenv_ros.native.ray_kernels import build_tree
from sailenv_ros.native.ray_types import RAY_SCENE
from sailenv_ros.native.render_types import Record, address, record

__all__ = ["RayWorld", "ray_world"]

Floats = NDArray[np.float32]


@dataclass(frozen=True, eq=False, slots=True)
class RayWorld:
    """A scene before and after.

    Attributes
    ----------
    record : (1,) RAY_SCENE
        Keeps everything alive that it points to.
    changed : list of PlacedInstance
        What stands there before or after alone.
    """

    record: Record
    changed: list[PlacedInstance]

    def with_more(self, things: Sequence[PlacedInstance]) -> RayWorld:
        """Return the same with a few things that stand there, too, and were not baked."""
        changed = [*self.changed, *things]
        rows, _ = ray_instances(changed)
        made = self.record.copy()
        made["changed_at"], made["changed_count"] = address(rows), len(rows)
        made.kept = (*self.record.kept, rows, things)
        return RayWorld(made, changed)


def ray_world(
    scene: BakedScene,
    changes: Sequence[Change],
    before: Floats,
    after: Floats,
    *,
    settled: bool = False,
) -> RayWorld:
    """Put a scene and its changes together.

    Parameters
    ----------
    before, after : (P, C) float32
        Radiance of the patches; read whenever rays are followed.
    settled : bool
        True has things stand before as they do after.
    """
    moved = {change.id for change in changes if change.came is None}
    charts = scene.baked.charts
    resting = [
        PlacedInstance(scene.shape(id_), charts[id_].world_from_body, charts[id_], None, True, True)
        for id_ in scene.drawn
        if id_ not in moved
    ]
    changed = [
        thing
        for change in changes
        for thing in placed_instances(scene, change, _sent_out(scene, change))
    ]
    if settled:
        resting += [replace(thing, before=True) for thing in changed if thing.after]
        changed = []
    rows, boxes = ray_instances(resting)
    nodes, order = build_tree(boxes, 1)
    changed_rows, _ = ray_instances(changed)
    panes, passes = scene.panes
    made = record(
        RAY_SCENE,
        (scene, resting, rows, nodes, order, changed, changed_rows, before, after),
        nodes_at=address(nodes),
        order_at=address(order),
        resting_at=address(rows),
        changed_at=address(changed_rows),
        glass_at=address(panes.record),
        passes_at=address(passes),
        sky_at=address(scene.sky),
        patches_at=address(scene.patches.of_map),
        before_at=address(before),
        after_at=address(after),
        emitters_at=address(scene.emitters),
        emitter_count=len(scene.emitters),
        changed_count=len(changed_rows),
        patch_count=len(before),
        resting_count=len(rows),
        sky_height=scene.sky.shape[0],
        sky_width=scene.sky.shape[1],
        height=scene.side,
        width=scene.side,
        channels=before.shape[1],
    )
    return RayWorld(made, changed)


def _sent_out(scene: BakedScene, change: Change) -> Floats | None:
    """Return (6, C) float32: what something sends out that came, and has no texels."""
    if change.came is None or change.after is None:
        return None
    return sent_by_probes(scene.light_in_air, scene.baked.probes, *change.came, change.after)
