"""The scene as rays from shiny surfaces meet it: all that is drawn and does not deform.

Snapshots and a `PartTable` come in, a TRACED_SCENE for the shading kernel goes out.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.ray_kernels import build_tree
from sailenv_ros.native.render_types import PART, address, record
from sailenv_ros.native.traced_types import TRACED_INSTANCE, TRACED_SCENE
from sailenv_ros.rays.solid_models import SolidModel, SolidModels, solid_model
from sailenv_ros.render.cpu.part_table import PartTable
from sailenv_ros.render.scene.drawn_meshes import meshes_of, unwrappings
from sailenv_ros.types.baked_light import LightChart, Unwrapping
from sailenv_ros.types.model import Model
from sailenv_ros.types.snapshot import SceneContents, WorldSnapshot

__all__ = ["TracedScene"]

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
        self._of: tuple[object, object] | None = None
        self._opaque: NDArray[np.void] | None = None
        self._places = np.zeros(0, np.intp)
        self._solids = SolidModels(())
        self._rows = np.zeros(0, TRACED_INSTANCE)
        self._poses = np.full((0, 4, 4), np.nan)
        self._kept: tuple[NDArray[Any], ...] = ()

    def update(
        self, snapshot: WorldSnapshot, table: PartTable, still: NDArray[np.bool_]
    ) -> NDArray[np.void]:
        """Bring everything up to date.

        Parameters
        ----------
        snapshot : WorldSnapshot
            In baked light.
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
        assert contents.baked is not None
        instances, charts = contents.instances, contents.baked.charts
        # Lights change more often than what they shine on.
        same = self._of is not None and self._of[0] is instances and self._of[1] is charts
        if not same:
            self._show(contents, charts)
            self._of = instances, charts
        rows, opaque = self._rows, table.opaque
        if not same or self._opaque is not opaque:
            first = np.searchsorted(opaque["instance"], self._places)
            rows["parts_at"] = address(opaque) + first * PART.itemsize
            self._opaque = opaque
        rows["at_baked_pose"] = still[self._places]
        poses = snapshot.world_from_body[self._places]
        if not same or not np.array_equal(poses, self._poses):
            self._poses = poses
            rows["placed"], boxes = self._solids.at(poses)
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

    def _show(self, contents: SceneContents, charts: Mapping[int, LightChart]) -> None:
        models: dict[tuple[int, int, _Scale], tuple[object, _TracedModel]] = {}
        places, found = [], []
        for place, (drawn, flat) in enumerate(
            zip(contents.instances, unwrappings(contents), strict=True)
        ):
            if drawn.deforms or not drawn.model.triangle_count:
                continue
            key = id(drawn.model), id(flat), drawn.scale
            made = models.get(key) or self._models.get(key)
            if made is None:
                chart = charts.get(drawn.instance.id)
                # The tree that relighting has.
                baked = None if chart is None else chart.unwrapping
                solid = solid_model(drawn.model, drawn.scale, baked)
                made = (drawn.model, flat), _traced_model(drawn.model, flat, solid)
            models[key] = made
            places.append(place)
            found.append(made[1])
        self._models = models
        self._places = np.array(places, np.intp)
        self._solids = SolidModels([one.solid for one in found])
        scales = np.array([contents.instances[place].scale for place in places]).reshape(-1, 3)
        rows = self._rows = np.zeros(len(found), TRACED_INSTANCE)
        rows["part_of_at"] = [address(one.part_of) for one in found]
        rows["vertices_at"] = [address(one.vertices) for one in found]
        rows["inverse_scale"] = 1.0 / scales


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
