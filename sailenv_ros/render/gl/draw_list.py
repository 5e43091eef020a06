"""Draw list: the parts of all instances, sorted into batches, with their matrices per frame.

Scene contents come in once, poses and camera each frame; out comes a block of uniforms for each
part, and for each batch the parts that an eye may see. All matrices are composed in double
precision and rounded once.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native import cluster_kernels
from sailenv_ros.render.gl.geometry_buffers import GeometryBuffers
from sailenv_ros.render.gl.materials import BatchKind, MaterialBuffers
from sailenv_ros.render.scene.drawn_meshes import chart_table, drawn_meshes
from sailenv_ros.render.scene.material_factors import EMISSION_SCALE, glow_alone
from sailenv_ros.render.scene.shadow_casters import casts
from sailenv_ros.types.deformation import MovedMesh
from sailenv_ros.types.lights import Light
from sailenv_ros.types.snapshot import SceneContents, WorldSnapshot

__all__ = ["ROWS", "Batch", "DrawList"]

ROWS = 12
"""Vectors of four in a part's block of uniforms; `draw.glsl` says what each holds.

What a software rasteriser reads by a constant place it reads once for eight pixels or vertices; by
a place that each of them brings along it reads for one after the other. So every part is drawn by a
call of its own, with uniforms.
"""

_MATERIAL, _GLOW, _NORMAL, _CHART = 4, 6, 8, 11
"""Offsets in the block [floats]; before them stand the columns of the matrix to clip space."""


_CASTER = BatchKind()
"""Shadows are the same whatever a caster is made of."""


class Batch:
    """Parts of one kind: those that an eye may see, the nearest first.

    Parameters
    ----------
    kind : BatchKind
    parts : (N,) int
        Their numbers among all.

    Attributes
    ----------
    chosen : list of int
        What is to be drawn, in this order.
    """

    def __init__(self, kind: BatchKind, parts: NDArray[np.intp]) -> None:
        self.kind = kind
        self.chosen: list[int] = parts.tolist()
        self._parts = parts

    def choose(self, visible: NDArray[np.bool_], distance: NDArray[np.float64]) -> None:
        """Keep the visible parts, in the order of their distance."""
        kept = self._parts[visible[self._parts]]
        self.chosen = kept[np.argsort(distance[kept], kind="stable")].tolist()

    def least(self, distance: NDArray[np.float64]) -> float:
        """Return the least of its parts' distances."""
        return float(distance[self._parts].min())


class DrawList:
    """The draws of one scene's contents.

    Parameters
    ----------
    contents : SceneContents
    geometry : GeometryBuffers
    materials : MaterialBuffers
    see_through : bool
        True for the parts whose material is see-through (``blend``), each in a batch of its own;
        False for all others.

    Attributes
    ----------
    uniforms : (P, ROWS, 4) float32
        The block of each part.
    lies : list of (int, int)
        First index and number of indices of each part, in the index buffer of `geometry`.
    """

    def __init__(
        self,
        contents: SceneContents,
        geometry: GeometryBuffers,
        materials: MaterialBuffers,
        *,
        see_through: bool = False,
    ) -> None:
        parts = sorted(
            (
                (materials.kind(part.material), row, part, mesh)
                for row, (drawn, meshes) in enumerate(
                    zip(contents.instances, drawn_meshes(contents), strict=True)
                )
                for part, mesh in zip(drawn.model.parts, meshes, strict=True)
                if (part.material.alpha == "blend") == see_through
            ),
            key=lambda entry: (entry[0], entry[1]),
        )
        self.contents = contents
        self._instance_rows = np.array([row for _, row, *_ in parts], dtype=np.intp)
        self._looks = [(row, part.material) for _, row, part, _ in parts]
        self._scales = np.array([drawn.scale for drawn in contents.instances]).reshape(-1, 3)
        self.uniforms = np.zeros((len(parts), ROWS, 4), np.float32)
        for block, (_, row, part, _) in zip(self.uniforms, parts, strict=True):
            block[_MATERIAL:_NORMAL] = materials.vectors(part.material)
            block[_MATERIAL, 0] = contents.instance_ids[row]
        powers = [drawn.lamp_power(contents.lights) for drawn in contents.instances]
        self._lamps = [
            (number, lit[_GLOW - _MATERIAL :])
            for number, (_, row, part, _) in enumerate(parts)
            if any(powers[row]) and any(part.material.glow)
            for lit in (materials.lit_vectors(part.material, powers[row]),)
        ]
        self._unlit = self.uniforms[:, _GLOW:_NORMAL].copy()
        self.show_lamps()
        slices = [geometry.slice(mesh) for *_, mesh in parts]
        self.uniforms[:, _NORMAL, 3] = [
            contents.instances[row].model.first_vertices[mesh.part] - lies.first_vertex
            for (_, row, _, mesh), lies in zip(parts, slices, strict=True)
        ]
        self.lies = [(mesh.first_index, mesh.index_count) for mesh in slices]
        self._ranges = np.array(
            [(lies.first_cluster, lies.cluster_count, lies.index_count) for lies in slices],
            np.int64,
        ).reshape(-1, 3)
        self._geometry = geometry
        self._corners = np.array(
            [_corners(part.mesh.positions) for _, _, part, _ in parts]
        ).reshape(-1, 8, 4)
        self._deforming = [
            (number, contents.instances[row].instance.id, mesh)
            for number, (_, row, _, mesh) in enumerate(parts)
            if mesh.owner
        ]
        self._kinds = kinds = [kind for kind, *_ in parts]
        everything = np.arange(len(parts))
        self.batches = tuple(_batches(kinds, everything, apart=see_through))
        casting = np.array([casts(contents.instances[row]) for row in self._instance_rows], bool)
        self.casters = Batch(_CASTER, everything[casting])
        self._charts, self._baked_poses = chart_table(contents)
        self._charted = self._charts.any(axis=1)
        self._charts[~self._charted, 3] = 1.0
        self._one_sided = np.array([not kind.double_sided for kind in kinds], bool)
        self._clip = np.zeros((len(parts), 4, 4))
        self._eye_from_object = np.zeros((len(contents.instances), 4, 4))
        self._visible = np.ones(len(parts), bool)
        self._distance = np.zeros(len(parts))

    def place(
        self,
        snapshot: WorldSnapshot,
        clip_from_eye: NDArray[np.float64],
        eye_from_world: NDArray[np.float64],
        *,
        only: NDArray[np.bool_] | None = None,
    ) -> None:
        """Write the matrices of one eye (a camera or a light), and choose what it may see.

        Parameters
        ----------
        clip_from_eye, eye_from_world : (4, 4) float64
        only : (N,) bool or None
            Which instances are drawn; None for all.
        """
        count = len(self._instance_rows)
        self._deform(snapshot)
        if count:
            eye_from_body = eye_from_world @ snapshot.world_from_body
            eye_from_object = eye_from_body.copy()
            eye_from_object[:, :, :3] *= self._scales[:, None, :]
            clip = clip_from_eye @ eye_from_object
            # Normals go by the inverse transpose: the rotation with the reciprocal scale.
            normal = eye_from_body[:, :3, :3] / self._scales[:, None, :]
            # GLSL stores columns, NumPy rows: the transpose is what GLSL reads as the matrix.
            self.uniforms[:, :4] = clip.transpose(0, 2, 1)[self._instance_rows]
            self.uniforms[:, _NORMAL : _NORMAL + 3, :3] = normal[self._instance_rows]
            # What has no chart has the share that it hides of itself there.
            known = self.at_baked_pose(snapshot) | ~self._charted
            self.uniforms[:, _CHART] = np.where(known[:, None], self._charts, 0.0)[
                self._instance_rows
            ]
            self._clip = clip[self._instance_rows]
            self._eye_from_object = eye_from_object
            self._visible, self._distance = _seen(self._clip, self._corners)
            if only is not None:
                self._visible &= only[self._instance_rows]
            for batch in self.batches:
                batch.choose(self._visible, self._distance)

    def _deform(self, snapshot: WorldSnapshot) -> None:
        """Put the vertices of what deforms where they are."""
        for number, instance_id, drawn in self._deforming:
            found = snapshot.deformations.get(instance_id)
            moved = (
                MovedMesh(drawn.mesh.positions, drawn.mesh.normals)
                if found is None
                else found.meshes[drawn.part]
            )
            self._geometry.move(drawn, moved)
            self._corners[number] = _corners(moved.positions)

    def show_lamps(self) -> None:
        """Let the lamps that are on glow."""
        self.uniforms[:, _GLOW:_NORMAL] = self._unlit
        for part, on in self._lamps:
            self.uniforms[part, _GLOW:_NORMAL] = on

    def glow_by(self, light: Light | None, *, lit: bool) -> None:
        """Let the lamps of one light alone emit if it is lit; None: what does of itself."""
        self.uniforms[:, _GLOW:_NORMAL] = self._unlit
        if light is None:
            return
        self.uniforms[:, _NORMAL - 1, 3] = 0.0
        for number, (row, material) in enumerate(self._looks):
            names = self.contents.instances[row].lit_by
            if lit and any(material.glow) and light.name in names:
                factors = glow_alone(material, light)
                self.uniforms[number, _GLOW] = factors.colour
                self.uniforms[number, _NORMAL - 1, 3] = factors.emission / EMISSION_SCALE

    def seen_indices(
        self, by_corner: Callable[[BatchKind], bool]
    ) -> tuple[NDArray[np.uint32], list[tuple[int, int]]]:
        """Gather the triangles that the eye of `place`, which has perspective, may see.

        Parameters
        ----------
        by_corner : callable
            Says of which kinds nothing is read but positions.

        Returns
        -------
        indices : (N,) uint32
        lies : list of (int, int)
            First index and number of indices of each part among them.
        """
        chosen = [part for batch in self.batches for part in batch.chosen]
        if not chosen:
            return np.zeros(0, np.uint32), [(0, 0)] * len(self.lies)
        linear, offset = self._eye_from_object[:, :3, :3], self._eye_from_object[:, :3, 3:]
        eyes = np.linalg.solve(linear, -offset)[:, :, 0].astype(np.float64)
        rows = self._instance_rows
        seen, lies = cluster_kernels.seen_indices(
            np.array(chosen, np.intp),
            self._geometry.clusters,
            self._ranges,
            self._clip,
            eyes[rows],
            self._one_sided,
            self._geometry.indices,
            self._geometry.corner_indices,
            np.array([by_corner(kind) for kind in self._kinds], bool),
        )
        return seen, [(first, count) for first, count in lies.tolist()]

    def at_baked_pose(self, snapshot: WorldSnapshot) -> NDArray[np.bool_]:
        """Return which instances have baked light: those that stand where they stood for it."""
        same: NDArray[np.bool_] = (snapshot.world_from_body == self._baked_poses).all(axis=(1, 2))
        return same

    def farthest_first(self) -> list[Batch]:
        """Return the batches that the eye of `place` may see, the most distant first."""
        seen = [batch for batch in self.batches if batch.chosen]
        return sorted(seen, key=lambda batch: -batch.least(self._distance))

    def choose_casters(self, instances: NDArray[np.bool_]) -> None:
        """Keep those casters of some instances that the eye of `place` may see."""
        self.casters.choose(self._visible & instances[self._instance_rows], self._distance)


def _corners(positions: NDArray[np.float32]) -> NDArray[np.float64]:
    """Return (8, 4): the homogeneous corners of the box around points."""
    low, high = positions.min(axis=0), positions.max(axis=0)
    corners = np.stack(np.meshgrid(*np.stack([low, high], axis=1)), axis=-1).reshape(8, 3)
    return np.concatenate([corners, np.ones((8, 1))], axis=1).astype(np.float64)


def _seen(
    clip_from_part: NDArray[np.float64], corners: NDArray[np.float64]
) -> tuple[NDArray[np.bool_], NDArray[np.float64]]:
    """Return which boxes reach into the picture, and how far their middles are.

    A box is out of it if all its corners lie beyond one of the four sides. The picture is taken a
    hundredth wider than it is, so that no rounding on the GPU can make a difference.
    """
    clip = corners @ clip_from_part.transpose(0, 2, 1)
    x, y, w = clip[..., 0], clip[..., 1], clip[..., 3]
    wide = 1.01 * w
    beyond = [(side < 0.0).all(axis=1) for side in (wide + x, wide - x, wide + y, wide - y)]
    return ~np.any(beyond, axis=0), clip[..., 2:].mean(axis=1)[:, 0]


def _batches(
    kinds: list[BatchKind], parts: NDArray[np.intp], *, apart: bool = False
) -> Iterator[Batch]:
    if apart:
        for kind, part in zip(kinds, parts, strict=True):
            yield Batch(kind, np.array([part]))
        return
    for kind in sorted(set(kinds)):
        chosen = np.array([k == kind for k in kinds], dtype=bool)
        yield Batch(kind, parts[chosen])
