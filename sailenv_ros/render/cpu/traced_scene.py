"""The scene as rays from shiny surfaces meet it: all that is drawn and does not deform.

Snapshots and a `PartTable` come in, a TRACED_SCENE for the shading kernel goes out.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.ray_kernels import build_tree
from sailenv_ros.native.ray_types import RAY_INSTANCE
from sailenv_ros.native.render_types import PART, address, record
from sailenv_ros.native.traced_types import TRACED_INSTANCE, TRACED_SCENE
from sailenv_ros.rays.solid_models import SolidModel, solid_model
from sailenv_ros.render.cpu.part_table import PartTable
from sailenv_ros.render.scene.drawn_meshes import meshes_of, unwrappings
from sailenv_ros.types.baked_light import Unwrapping
from sailenv_ros.types.geometry import invert
from sailenv_ros.types.model import Model
from sailenv_ros.types.snapshot import SceneContents, WorldSnapshot

__all__ = ["TracedScene"]

_MARGIN_M = 1e-4
"""Boxes around instances are larger by this: poses are in floats there."""

_Scale = tuple[float, float, float]


@dataclass(frozen=True, eq=False, slots=True)
class _TracedModel:
    """A model's solid surface, and where its triangles are among those that are drawn.

    Attributes
    ----------
    part_of : (S,) int32
        Place of each triangle's part among the parts that are not see-through; -1 for none.
    vertices : (S, 3) uint32
        Of its corners among that part's vertices.
    """

    solid: SolidModel
    part_of: NDArray[np.int32]
    vertices: NDArray[np.uint32]


class TracedScene:
    """The instances of the contents that are shown last, as rays meet them."""

    def __init__(self) -> None:
        self._models: dict[tuple[int, int, _Scale], tuple[object, _TracedModel]] = {}
        self._of: tuple[SceneContents, NDArray[np.void]] | None = None
        self._places = np.zeros(0, np.intp)
        self._rows = np.zeros(0, TRACED_INSTANCE)
        self._centres = np.zeros((0, 3))
        self._halves = np.zeros((0, 3))
        self._poses = np.full((0, 4, 4), np.nan)
        self._kept: tuple[NDArray[Any], ...] = ()

    def update(
        self, snapshot: WorldSnapshot, table: PartTable, still: NDArray[np.bool_]
    ) -> NDArray[np.void]:
        """Bring everything up to date.

        Parameters
        ----------
        snapshot : WorldSnapshot
        table : PartTable
            That shows it.
        still : (N,) bool
            Which instances stand where their light was baked.

        Returns
        -------
        scene : (1,) TRACED_SCENE
            Points into arrays of this object and of the table; good until the next call.
        """
        contents = snapshot.contents
        shown = self._of is not None and self._of[0] is contents and self._of[1] is table.opaque
        if not shown:
            self._show(contents, table)
            self._of = contents, table.opaque
        poses = snapshot.world_from_body[self._places]
        rows = self._rows
        rows["at_baked_pose"] = still[self._places]
        if not shown or not np.array_equal(poses, self._poses):
            self._poses = poses
            rows["placed"]["body_from_world"] = invert(poses)[:, :3].reshape(-1, 12)
            turns = poses[:, :3, :3]
            middles = np.einsum("nij,nj->ni", turns, self._centres) + poses[:, :3, 3]
            halves = np.einsum("nij,nj->ni", np.abs(turns), self._halves) + _MARGIN_M
            boxes = np.concatenate([middles - halves, middles + halves], axis=1)
            nodes, order = build_tree(boxes, 1)
            made = record(
                TRACED_SCENE,
                nodes_at=address(nodes),
                order_at=address(order),
                instances_at=address(rows),
                count=len(rows),
            )
            self._kept = made, nodes, order
        return self._kept[0]

    def _show(self, contents: SceneContents, table: PartTable) -> None:
        models: dict[tuple[int, int, _Scale], tuple[object, _TracedModel]] = {}
        charts = {} if contents.baked is None else contents.baked.charts
        found: list[tuple[int, _TracedModel, _Scale]] = []
        for place, (drawn, flat) in enumerate(
            zip(contents.instances, unwrappings(contents), strict=True)
        ):
            if drawn.deforms or not drawn.model.triangle_count:
                continue
            key = id(drawn.model), id(flat), drawn.scale
            if key not in models:
                chart = charts.get(drawn.instance.id)
                made = self._models.get(key)
                if made is None:
                    baked = None if chart is None else chart.unwrapping
                    solid = solid_model(drawn.model, drawn.scale, baked)
                    made = (drawn.model, flat), _traced_model(drawn.model, flat, solid)
                models[key] = made
            found.append((place, models[key][1], drawn.scale))
        self._models = models
        self._places = np.array([place for place, _, _ in found], np.intp)
        self._centres = np.array([one.solid.centre for _, one, _ in found]).reshape(-1, 3)
        trees = [one.solid.tree for _, one, _ in found]
        self._halves = np.array([(t.high - t.low) / 2.0 for t in trees]).reshape(-1, 3)
        rows = np.zeros(len(found), TRACED_INSTANCE)
        placed = np.zeros(len(found), RAY_INSTANCE)
        placed["shape_at"] = [address(tree.record) for tree in trees]
        rows["placed"] = placed
        rows["part_of_at"] = [address(one.part_of) for _, one, _ in found]
        rows["vertices_at"] = [address(one.vertices) for _, one, _ in found]
        first = np.searchsorted(table.opaque["instance"], self._places)
        rows["parts_at"] = address(table.opaque) + first * PART.itemsize
        scales = np.array([scale for _, _, scale in found]).reshape(-1, 3)
        rows["inverse_scale"] = 1.0 / scales
        self._rows = rows


def _traced_model(model: Model, flat: Unwrapping | None, solid: SolidModel) -> _TracedModel:
    triangles = [mesh.triangles for mesh in meshes_of(model, flat)]
    counts = [len(own) for own in triangles]
    opaque = np.array([part.material.alpha != "blend" for part in model.parts], bool)
    rank = np.where(opaque, np.cumsum(opaque) - 1, -1)
    part_of = np.repeat(rank, counts)[solid.triangles].astype(np.int32)
    vertices = np.concatenate(triangles)[solid.triangles].astype(np.uint32)
    if solid.turned:
        vertices = vertices[:, [0, 2, 1]]
    return _TracedModel(solid, part_of, np.ascontiguousarray(vertices))
