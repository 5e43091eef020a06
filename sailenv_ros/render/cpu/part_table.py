"""Parts of a scene, as tables that the native kernels read.

Scene contents come in, tables of parts go out. Meshes, textures and the parts of models that are
there already are used again: a scene that changes costs what has changed.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.render_types import (
    INSTANCES,
    PART,
    PART_DOUBLE_SIDED,
    PART_FINISH_MAP,
    PART_MASKED,
    PART_NORMAL_MAP,
    RIGID,
    address,
    record,
)
from sailenv_ros.render.cpu.lamp_parts import let_glow
from sailenv_ros.render.cpu.mesh_store import MeshArrays, MeshStore
from sailenv_ros.render.cpu.texture_store import TextureStore
from sailenv_ros.render.scene.drawn_meshes import (
    DrawnMesh,
    chart_table,
    meshes_of,
    occludes_itself,
    owner_of,
    unwrappings,
)
from sailenv_ros.render.scene.material_factors import glow_alone, material_factors
from sailenv_ros.render.scene.shadow_casters import casts
from sailenv_ros.types.deformation import MovedMesh
from sailenv_ros.types.lights import Light
from sailenv_ros.types.model import Material, Model
from sailenv_ros.types.snapshot import SceneContents, WorldSnapshot

__all__ = ["PartTable"]


@dataclass(frozen=True, eq=False, slots=True)
class _ModelParts:
    """The parts of a model, before they are some instance's; the model is kept."""

    model: Model
    meshes: list[DrawnMesh]
    parts: NDArray[np.void]
    see_through: NDArray[np.bool_]


@dataclass(frozen=True, eq=False, slots=True)
class _MovingMesh:
    """A mesh whose vertices move, and where it is in the tables."""

    instance_id: int
    drawn: DrawnMesh
    mesh: MeshArrays
    rest: MovedMesh
    places: list[tuple[NDArray[np.void], int]]


class PartTable:
    """The parts of the contents that are shown.

    Parameters
    ----------
    meshes : MeshStore or None
    textures : TextureStore or None
        Shared with tables of scenes that are shown before and after, which must not be at the same
        time unless the stores keep everything; None for its own.

    Attributes
    ----------
    contents : SceneContents or None
    opaque, glass, casters : (N,) PART
        What covers what lies behind it; what does not; what casts shadows.
    unlit : (N,) PART
        The same as `opaque`, with no lamp on.
    """

    def __init__(
        self, meshes: MeshStore | None = None, textures: TextureStore | None = None
    ) -> None:
        self._meshes = MeshStore() if meshes is None else meshes
        self._textures = TextureStore() if textures is None else textures
        self._empty()

    def _empty(self) -> None:
        self._models: dict[tuple[int, int, int, bool], _ModelParts] = {}
        self._deforming: list[tuple[int, int, list[DrawnMesh]]] = []
        self._moving: list[_MovingMesh] | None = []
        self.contents: SceneContents | None = None
        self.opaque = self.glass = self.casters = np.zeros(0, PART)
        self.unlit = self._unlit_glass = self.opaque
        self._scales = np.zeros((0, 3))
        self._baked_poses = np.zeros((0, 4, 4))
        self._keys: list[tuple[object, ...]] = []
        self._casting: dict[tuple[int, tuple[float, ...]], bool] = {}

    def forget(self) -> None:
        """Free what was made of the contents that were shown, and what the stores keep of them."""
        self._empty()
        self._meshes.trim(())
        self._textures.trim(())

    def show(self, contents: SceneContents) -> None:
        """Bring the tables up to date."""
        if contents is self.contents:
            return
        # If it fails, the tables are of nothing, and are made anew.
        before, self.contents = self.contents, None
        self._show(contents, before)
        self._light_lamps(contents)
        self.contents = contents
        self._moving = None

    def deform(self, snapshot: WorldSnapshot) -> None:
        """Put the vertices of what deforms where they are at an instant of the contents shown."""
        if not self._deforming:
            return
        if self._moving is None:
            self._moving = list(self._find_moving())
        for moving in self._moving:
            found = snapshot.deformations.get(moving.instance_id)
            moving.mesh.move(moving.rest if found is None else found.meshes[moving.drawn.part])
            for table, place in moving.places:
                table["sphere"][place] = moving.mesh.sphere

    def _light_lamps(self, contents: SceneContents) -> None:
        """Let the lamps that are on glow."""
        lit = [
            (row, drawn.model, power)
            for row, drawn in enumerate(contents.instances)
            if any(power := drawn.lamp_power(contents.lights))
        ]
        self.opaque, self.glass = self.unlit, self._unlit_glass
        if not lit:
            return
        self.opaque, self.glass = self.opaque.copy(), self.glass.copy()
        for row, model, power in lit:
            look = partial(material_factors, lamp_power=power)
            let_glow(self.opaque, row, model, look)
            let_glow(self.glass, row, model, look, see_through=True)

    def glowing_by(self, light: Light | None, *, lit: bool) -> NDArray[np.void]:
        """Return `unlit`, of which but the lamps of a light emit, if it is lit; None: as it is."""
        if light is None:
            return self.unlit
        table = self.unlit.copy()
        table["emission"] = 0.0
        for row, drawn in enumerate(() if self.contents is None else self.contents.instances):
            if lit and light.name in drawn.lit_by:
                let_glow(table, row, drawn.model, partial(glow_alone, light=light))
        return table

    def _show(self, contents: SceneContents, before: SceneContents | None) -> None:
        same_bake = before is not None and before.baked is contents.baked
        if before is not None and same_bake and before.instances is contents.instances:
            return
        keys: list[tuple[object, ...]] = [
            (drawn.instance.id, id(drawn.model), drawn.scale, drawn.deforms)
            for drawn in contents.instances
        ]
        if same_bake and keys == self._keys:
            return
        self._keys = keys
        charts, self._baked_poses = chart_table(contents)
        self._scales = np.array([drawn.scale for drawn in contents.instances]).reshape(-1, 3)
        models: dict[tuple[int, int, int, bool], _ModelParts] = {}
        casting_of: dict[tuple[int, tuple[float, ...]], bool] = {}
        shown: list[tuple[_ModelParts, int, bool]] = []
        is_new = False
        deforming: list[tuple[int, int, list[DrawnMesh]]] = []
        self._take_up_textures(contents)
        for row, (drawn, flat) in enumerate(
            zip(contents.instances, unwrappings(contents), strict=True)
        ):
            if not drawn.model.parts:
                continue
            owner = owner_of(drawn)
            occluded = occludes_itself(drawn, contents)
            key = (id(drawn.model), id(flat), owner, occluded)
            made = models.get(key) or self._models.get(key)
            if made is None:
                meshes = meshes_of(drawn.model, flat, owner, occluded=occluded)
                made, is_new = self._make(drawn.model, meshes), True
            models[key] = made
            if owner:
                deforming.append((row, owner, made.meshes))
            shape = (id(drawn.model), drawn.scale)
            if shape not in casting_of:
                known = self._casting.get(shape)
                casting_of[shape] = casts(drawn) if known is None else known
            shown.append((made, row, casting_of[shape]))
        # Looking for what is not needed takes longer than all else when one object comes or goes.
        trim = is_new or 2 * len(models) < len(self._models)
        self._models, self._casting, self._deforming = models, casting_of, deforming
        counts = np.array([len(made.parts) for made, _, _ in shown], np.intp)
        rows = np.repeat(np.array([row for _, row, _ in shown], np.intp), counts)
        table, glass = np.zeros(len(rows), PART), np.zeros(len(rows), bool)
        # Joining structures compares their types each time: bytes are joined in a tenth of it.
        whole, size, last = table.view(np.uint8), PART.itemsize, 0
        for made, _, _ in shown:
            first, last = last, last + len(made.parts)
            whole[first * size : last * size] = made.parts.view(np.uint8)
            glass[first:last] = made.see_through
        table["instance"], table["id"] = rows, contents.instance_ids[rows]
        table["chart"] = charts[rows]
        table["has_chart"] = charts[rows].any(axis=1)
        casting = np.repeat(np.array([cast for _, _, cast in shown], bool), counts)
        self.unlit, self._unlit_glass = table[~glass], table[glass]
        self.casters = table[~glass & casting]
        if trim:
            self._meshes.trim(self.shown_meshes())
            self._textures.trim(self.shown_materials())

    def _take_up_textures(self, contents: SceneContents) -> None:
        """Make the textures that are missing; those of a room that was left go before."""
        models = {id(drawn.model): drawn.model for drawn in contents.instances}
        prepared = {id(made.model) for made in self._models.values()}
        missing = [model for number, model in models.items() if number not in prepared]
        if not missing:
            return
        # What is told of models that go tells where their textures are.
        self._models = {key: made for key, made in self._models.items() if id(made.model) in models}
        self._textures.trim(_materials_of(models.values()))
        self._textures.prepare(_materials_of(missing))

    def shown_meshes(self) -> Iterator[DrawnMesh]:
        """Yield the meshes of all models that are shown."""
        for made in self._models.values():
            yield from made.meshes

    def shown_materials(self) -> Iterator[Material]:
        """Return the materials of all models that are shown."""
        return _materials_of(made.model for made in self._models.values())

    def at_baked_pose(self, snapshot: WorldSnapshot) -> NDArray[np.bool_]:
        """Return which instances have baked light: those that stand where they stood for it."""
        same: NDArray[np.bool_] = (snapshot.world_from_body == self._baked_poses).all(axis=(1, 2))
        return same

    def instances(
        self,
        poses: NDArray[np.float64],
        at_baked_pose: NDArray[np.bool_] | None,
        drawn: NDArray[np.bool_] | None = None,
        clip: tuple[int, tuple[int, int, int, int]] | None = None,
    ) -> NDArray[np.void]:
        """Return (1,) INSTANCES; the arrays must live as long as it.

        Parameters
        ----------
        poses : (N, 4, 4) float64
            In C order.
        at_baked_pose : (N,) bool or None
            None where nothing is shaded.
        drawn : (N,) bool or None
            Which instances are drawn; None for all.
        clip : (int, (4,) tuple of int) or None
            Row of an instance that is drawn in a part of the picture alone, see `OpeningWindows`.
        """
        row, part = (-1, (0, 0, 0, 0)) if clip is None else clip
        return record(
            INSTANCES,
            world_from_body_at=address(poses),
            scales_at=address(self._scales),
            drawn_at=address(drawn),
            at_baked_pose_at=address(at_baked_pose),
            count=len(poses),
            clipped=row + 1,
            clip=part,
        )

    def _find_moving(self) -> Iterator[_MovingMesh]:
        """Yield the meshes that deform, with their places in the tables."""
        tables: list[NDArray[np.void]] = []
        for table in (self.opaque, self.unlit, self.glass, self._unlit_glass, self.casters):
            if not any(table is known for known in tables):
                tables.append(table)
        for row, owner, meshes in self._deforming:
            for drawn in meshes:
                mesh = self._meshes.get(drawn)
                at = address(mesh.vertices)
                places = [
                    (table, int(place))
                    for table in tables
                    for place in np.flatnonzero(
                        (table["instance"] == row) & (table["vertices_at"] == at)
                    )
                ]
                rest = MovedMesh(drawn.mesh.positions, drawn.mesh.normals)
                yield _MovingMesh(owner, drawn, mesh, rest, places)

    def _make(self, model: Model, meshes: list[DrawnMesh]) -> _ModelParts:
        parts = np.zeros(len(model.parts), PART)
        places = zip(parts, model.parts, meshes, model.first_vertices[:-1], strict=True)
        for row, part, drawn, first in places:
            mesh = self._meshes.get(drawn)
            for axis, name in enumerate(("corner_x_at", "corner_y_at", "corner_z_at")):
                row[name] = address(mesh.corners[axis])
            row["corner_indices_at"] = address(mesh.corner_indices)
            row["vertex_indices_at"] = address(mesh.vertex_indices)
            row["vertices_at"] = address(mesh.vertices)
            row["clusters_at"] = address(mesh.clusters)
            row["corner_count"] = mesh.corner_count
            row["cluster_count"] = len(mesh.clusters)
            row["sphere"] = mesh.sphere
            row["first_vertex"] = first if drawn.owner else RIGID
            row["first_of_model"] = first
            row["colour_map_at"] = self._textures.colour_map(part.material)
            row["detail_map_at"] = self._textures.detail_map(part.material)
            _describe(row, part.material)
        see_through = np.array([part.material.alpha == "blend" for part in model.parts], bool)
        return _ModelParts(model, meshes, parts, see_through)


def _materials_of(models: Iterable[Model]) -> Iterator[Material]:
    return (part.material for model in models for part in model.parts)


def _describe(row: np.void, material: Material) -> None:
    factors = material_factors(material)
    row["colour"], row["base"] = factors.colour, factors.base
    row["roughness"], row["metallic"] = factors.roughness, factors.metallic
    row["alpha_cutoff"], row["emission"] = factors.alpha_cutoff, factors.emission
    row["cutoff_fall"], row["least_cutoff"] = factors.cutoff_fall, factors.least_cutoff
    flags = {
        PART_DOUBLE_SIDED: material.double_sided,
        PART_MASKED: material.alpha == "mask",
        PART_FINISH_MAP: material.metallic_roughness_texture is not None,
        PART_NORMAL_MAP: material.normal_texture is not None,
    }
    row["flags"] = sum(flag for flag, is_set in flags.items() if is_set)
