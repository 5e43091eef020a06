"""A person's clothes: garments on a figure, one over another.

A figure and what is worn in, parts with weights out.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sailenv_content.people.cloth import TILE_M, cloth, leather
from sailenv_content.people.garments import GARMENTS, SOLE_M, GarmentKind
from sailenv_content.people.landmarks import Landmarks
from sailenv_content.people.looks import Wear
from sailenv_content.people.makehuman import BODY_VERTICES, BodyData
from sailenv_content.people.pieces import Cut, clipped, smoothed, vertex_normals
from sailenv_content.people.rigging import joint_names, strongest, vertex_weights
from sailenv_ros.types.model import Material

__all__ = ["PersonPart", "Undressed", "clothes"]

Doubles = NDArray[np.float64]
Indices = NDArray[np.int64]

UNDER_M = 0.06
"""How far inside the edge of another garment, worn over it, one is left out [m]."""

LAYER_M = 0.005
"""By how much more a garment that is worn over another one is off the body [m]."""


@dataclass(frozen=True, eq=False, slots=True)
class PersonPart:
    """Triangles of one material with their weights; `label` is empty for the body's own."""

    label: str
    positions: Doubles
    normals: Doubles
    uvs: Doubles
    triangles: Indices
    material: Material
    bones: NDArray[np.uint16]
    weights: NDArray[np.float32]


@dataclass(frozen=True, eq=False, slots=True)
class Undressed:
    """A figure that clothes are put on.

    Attributes
    ----------
    data : BodyData
    marks : Landmarks
    vertices : (V, 3) float64
        Of the figure and its helpers [m].
    """

    data: BodyData
    marks: Landmarks
    vertices: Doubles

    def part_of(
        self,
        label: str,
        cut: Cut,
        uvs: Doubles,
        material: Material,
        positions: Doubles | None = None,
        normals: Doubles | None = None,
    ) -> PersonPart:
        """Return a cut of the mesh as a part, with its weights; on the figure unless moved."""
        if positions is None:
            positions = cut.mixed(self.vertices)
        if normals is None:
            whole = vertex_normals(self.vertices, cut.first[cut.triangles])
            normals = whole[cut.first]
        bones, weights = self._mixed_weights(cut)
        return PersonPart(label, positions, normals, uvs, cut.triangles, material, bones, weights)

    def _mixed_weights(self, cut: Cut) -> tuple[NDArray[np.uint16], NDArray[np.float32]]:
        bones, weights = vertex_weights(self.data)
        dense = np.zeros((len(cut.first), len(joint_names(self.data))))
        rows = np.arange(len(dense))[:, None]
        for corner, share in ((cut.first, 1.0 - cut.share), (cut.second, cut.share)):
            np.add.at(dense, (rows, bones[corner]), share[:, None] * weights[corner])
        return strongest(dense)


def clothes(person: Undressed, wears: Sequence[Wear]) -> list[PersonPart]:
    """Return what is worn, from the skin outwards."""
    worn = [(GARMENTS[wear.garment], wear) for wear in wears]
    fields = [kind.field(person.marks) for kind, _ in worn]
    found = []
    for place, (kind, wear) in enumerate(worn):
        field = fields[place]
        over = fields[place + 1 :] if kind.label != "shoes" else []
        if over:
            field = np.maximum.reduce([field, *(-UNDER_M - other for other in over)])
        if (field[person.data.groups[kind.group].triangles] < 0.0).any():  # not all covered
            found.append(_garment(person, kind, wear, place, fields[place], field))
    return found


def _garment(
    person: Undressed, kind: GarmentKind, wear: Wear, place: int, whole: Doubles, field: Doubles
) -> PersonPart:
    data = person.data
    group = data.groups[kind.group]
    cut = clipped(group.triangles, group.uv_triangles, field)
    moved = _off_body(person, kind, group.triangles, place, whole)
    size = TILE_M * (0.5 if kind.label == "shoes" else 1.0)
    uvs = cut.mixed_uvs(data.uvs) * (16.0 / size)
    if kind.fabric == "leather":
        material = leather(wear.colour)
    else:
        material = cloth(wear.colour, wear.print, wear.second, kind.fabric)
    normals = cut.mixed(vertex_normals(moved, group.triangles))
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-9)
    return person.part_of(kind.label, cut, uvs, material, cut.mixed(moved), normals)


def _off_body(
    person: Undressed, kind: GarmentKind, triangles: Indices, place: int, field: Doubles
) -> Doubles:
    """Return the mesh's vertices where a garment has them."""
    own, marks = person.vertices, person.marks
    size = float(own[:BODY_VERTICES, 2].max()) / 1.68
    normals = vertex_normals(own, triangles)
    ease = np.full(len(own), kind.ease_m + LAYER_M * place)
    if kind.flare_m:
        height = marks.height_m
        edge = height[field < 0.0].min(initial=0.0)
        low = np.clip(1.0 - (height - edge) / 0.22, 0.0, 1.0)
        ease += kind.flare_m * np.where(marks.is_arm, 0.0, low)
    wrist = np.clip((marks.arm_m - 0.25) / 0.2, 0.0, 1.0)
    ease *= 1.0 - 0.5 * wrist
    if kind.bridging:
        raised = smoothed(own, triangles, kind.bridging) - own
        outward = np.einsum("vk,vk->v", raised, normals)
        # Not at the shoulders, which would look padded.
        y, z = marks.base[:, 1], marks.base[:, 2]
        beside = np.clip((np.abs(y) - 0.09) / 0.06, 0.0, 1.0) * (z > 0.36)
        share = np.where(marks.is_arm, 0.15, 1.0 - 0.85 * beside)
        ease = ease + share * np.clip(outward, 0.0, 0.05)
    moved = own + size * ease[:, None] * normals
    if kind.label == "shoes":
        low = np.clip((0.045 - (own[:, 2] - SOLE_M) / size) / 0.04, 0.0, 1.0)
        moved += size * 0.004 * low[:, None] * normals * [1.0, 1.0, 0.0]
        moved[:, 2] = np.maximum((1.0 - low) * moved[:, 2], 0.0)
    return moved
