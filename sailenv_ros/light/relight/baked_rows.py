"""Instances that the light of a scene depends on, and where they stood for it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.light.relight.scene_changes import Change
from sailenv_ros.types.snapshot import DrawnInstance, SceneContents

__all__ = ["BakedRows", "baked_rows", "has_shape_of"]

SMALLEST_M = 0.15
"""Objects that came and are smaller in two directions change no light but their own."""


@dataclass(frozen=True, eq=False, slots=True)
class BakedRows:
    """Part of the shown contents that light depends on.

    Attributes
    ----------
    contents : SceneContents
    rows : (N,) int64
        Of its instances.
    ids : list of int
    poses : (N, 4, 4) float64
        Where they were baked; NaN where they were not.
    gone : list of Change
        What was baked and is there no more.
    """

    contents: SceneContents
    rows: NDArray[np.int64]
    ids: list[int]
    poses: NDArray[np.float64]
    gone: list[Change]


def baked_rows(original: SceneContents, contents: SceneContents) -> BakedRows:
    """Return what light depends on of contents, of which the original ones were baked."""
    assert original.baked is not None
    assert contents.baked is not None
    charts = original.baked.charts
    known = {drawn.instance.id: drawn for drawn in original.instances}
    rows, ids, poses = [], [], []
    for row, drawn in enumerate(contents.instances):
        id_ = drawn.instance.id
        before = known.get(id_)
        same = before is not None and has_shape_of(drawn, before)
        pose = None
        if same and id_ in contents.baked.charts and drawn.model.triangle_count:
            pose = charts[id_].world_from_body
        elif drawn.is_baked and drawn.model.triangle_count and not same:
            size = np.ptp(drawn.model.bounds(), axis=0) * np.abs(drawn.scale)
            if np.sort(size)[1] >= SMALLEST_M:
                pose = np.full((4, 4), np.nan)
        if pose is not None:
            rows.append(row)
            ids.append(id_)
            poses.append(pose)
    present = set(ids)
    gone = [
        Change(id=id_, before=charts[id_].world_from_body, after=None)
        for id_, drawn in known.items()
        if id_ in charts and id_ not in present and drawn.model.triangle_count
    ]
    return BakedRows(
        contents,
        np.array(rows, np.int64),
        ids,
        np.array(poses, np.float64).reshape(-1, 4, 4),
        gone,
    )


def has_shape_of(drawn: DrawnInstance, before: DrawnInstance) -> bool:
    """Return whether something has the very triangles that another has, of whatever material."""
    if drawn.scale != before.scale or len(drawn.model.parts) != len(before.model.parts):
        return False
    return drawn.model is before.model or all(
        now.mesh is then.mesh
        or (
            len(now.mesh.triangles) == len(then.mesh.triangles)
            and np.array_equal(
                now.mesh.positions[now.mesh.triangles], then.mesh.positions[then.mesh.triangles]
            )
        )
        for now, then in zip(drawn.model.parts, before.model.parts, strict=True)
    )
