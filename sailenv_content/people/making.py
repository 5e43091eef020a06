"""One person: build, skin, hair and clothes → an `Asset` with a skeleton."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from sailenv_content.people.arm_room import arms_out
from sailenv_content.people.cloth import strands
from sailenv_content.people.dressing import PersonPart, Undressed, clothes
from sailenv_content.people.fetch_bodies import SOURCE
from sailenv_content.people.figures import figure
from sailenv_content.people.garments import GARMENTS, SOLE_M
from sailenv_content.people.hair import HAIRSTYLES, hair_pieces
from sailenv_content.people.landmarks import Landmarks
from sailenv_content.people.looks import PersonLook
from sailenv_content.people.makehuman import BODY_VERTICES, BodyData
from sailenv_content.people.painting import (
    HEAD_WINDOW,
    WHOLE,
    SkinLook,
    eye_picture,
    eye_uvs,
    skin_picture,
)
from sailenv_content.people.pieces import clipped, vertex_normals
from sailenv_content.people.rigging import (
    joint_names,
    joint_parents,
    joint_places,
    vertex_weights,
)
from sailenv_ros.assets.simplification import fewer_triangles
from sailenv_ros.system.array_cache import Arrays, cached_arrays, code_digest
from sailenv_ros.types.colour import linear_from_hex
from sailenv_ros.types.model import (
    Asset,
    AssetPart,
    CylinderShape,
    Material,
    Mesh,
    Model,
    ModelPart,
)
from sailenv_ros.types.rig import Rig, RigPoint

__all__ = ["make_person"]

Doubles = NDArray[np.float64]
Indices = NDArray[np.int64]

SKIN_TRIANGLES = 8000
"""Of a whole skin: what clothes hide of it is left out besides."""

SKIN_ERROR = 0.0016

HIDDEN_M = 0.035
"""How far inside the edge of a garment skin is left out [m]: from there nobody sees it."""

HEAD_PX, SKIN_PX = 1024, 512


def make_person(name: str, look: PersonLook, data: BodyData, *, labelled: bool = False) -> Asset:
    """Make a person.

    Parameters
    ----------
    name : str
        Of the asset.
    look : PersonLook
    data : BodyData
    labelled : bool
        True gives hair and clothes labels of their own, as parts of the person.

    Raises
    ------
    AssetError
        If the data cannot be read.
    """
    maker = _Maker(look, data)
    parts = maker.parts()
    model = Model(
        name=name,
        parts=tuple(ModelPart(mesh=_mesh(part), material=part.material) for part in parts),
    )
    rig = Rig(
        names=joint_names(data),
        parents=joint_parents(data),
        heads=joint_places(data, maker.vertices),
        bones=tuple(part.bones for part in parts),
        weights=tuple(part.weights for part in parts),
        points=maker.points(),
    )
    labels = list(dict.fromkeys(part.label for part in parts if part.label)) if labelled else []
    height = float(maker.vertices[:BODY_VERTICES, 2].max())
    return Asset(
        name=name,
        display_name=look.title if not labelled else f"{look.title} in parts",
        category="person",
        model=model,
        collision=(
            CylinderShape(
                radius_m=0.13 * height, height_m=height, centre_m=(0.0, 0.0, 0.5 * height)
            ),
        ),
        mass_kg=round((13.5 + 17.0 * look.build.weight) * height**2, 1),
        centre_of_mass_m=(0.0, 0.0, 0.55 * height),
        tags=("person",),
        parts=tuple(
            AssetPart(
                name=label,
                category=_CATEGORIES.get(label, label),
                meshes=tuple(k for k, part in enumerate(parts) if part.label == label),
            )
            for label in labels
        ),
        rig=replace(rig, arms_out=arms_out(rig, parts)),
    )


def _mesh(part: PersonPart) -> Mesh:
    return Mesh(
        positions=part.positions.astype(np.float32),
        normals=part.normals.astype(np.float32),
        uvs=part.uvs.astype(np.float32),
        triangles=part.triangles.astype(np.uint32),
    )


class _Maker:
    """The parts of one person."""

    def __init__(self, look: PersonLook, data: BodyData) -> None:
        self._look, self._data = look, data
        self._marks = _landmarks(data)
        self.vertices = figure(data, look.build)
        self.vertices[:, 2] += SOLE_M
        self._bones, self._weights = vertex_weights(data)
        self._skin_normals = vertex_normals(self.vertices, data.groups["body"].triangles)
        self._person = Undressed(data, self._marks, self.vertices)

    def parts(self) -> list[PersonPart]:
        """Return all that is drawn."""
        return [
            *self._skin(),
            *self._eyes(),
            self._lashes(),
            *self._hair(),
            *clothes(self._person, self._look.wears),
        ]

    def points(self) -> tuple[RigPoint, ...]:
        """Return COCO's keypoints."""
        data, names = self._data, joint_names(self._data)
        places = joint_places(data, self.vertices)
        found = [
            ("nose", "head", self._nose()),
            *((f"{side} eye", "head", self._eye(letter)) for side, letter in _SIDES),
            *((f"{side} ear", "head", self._ear(sign)) for side, sign in _SIGNS),
        ]
        for what, joint in _COCO_JOINTS:
            for side, letter in _SIDES:
                bone = f"{joint}.{letter.upper()}"
                found.append((f"{side} {what}", bone, places[names.index(bone)]))
        return tuple(
            RigPoint(name=name, joint=names.index(joint), position_m=(at[0], at[1], at[2]))
            for name, joint, place in found
            for at in (np.asarray(place, float).tolist(),)
        )

    # -- inside ----------------------------------------------------------------------------

    def _nose(self) -> Doubles:
        base = self._marks.base[:BODY_VERTICES]
        near = np.where(np.abs(base[:, 2] - 0.70) < 0.03, base[:, 0], -9.0)
        tip: Doubles = self.vertices[int(near.argmax())]
        return tip

    def _eye(self, letter: str) -> Doubles:
        corners = np.unique(self._data.groups[f"helper-{letter}-eye"].triangles)
        own = self.vertices[corners]
        front: Doubles = own[own[:, 0] >= np.quantile(own[:, 0], 0.9)].mean(axis=0)
        return front

    def _ear(self, sign: float) -> Doubles:
        base = self._marks.base[:BODY_VERTICES]
        near = np.where(np.abs(base[:, 2] - 0.715) < 0.02, sign * base[:, 1], -9.0)
        found: Doubles = self.vertices[int(near.argmax())]
        return found

    def _skin(self) -> list[PersonPart]:
        data, look = self._data, self._look
        triangles, uv_triangles, vertices, uvs = _skin_triangles(data)
        hidden = np.zeros(len(data.base), bool)
        for wear in look.wears:
            kind = GARMENTS[wear.garment]
            margin = (0.25 if kind.label == "shoes" else 1.0) * HIDDEN_M
            hidden |= kind.field(self._marks) < -margin
        seen = ~hidden[vertices[triangles]].all(axis=1)
        is_head = (uvs[triangles][..., 0] > HEAD_WINDOW[0]).all(axis=1)
        is_head &= (uvs[triangles][..., 1] > HEAD_WINDOW[1]).all(axis=1)
        is_head &= (uvs[triangles][..., 1] < HEAD_WINDOW[3]).all(axis=1)
        colours = SkinLook(
            skin=linear_from_hex(look.skin),
            lips=linear_from_hex(look.lips),
            hair=linear_from_hex(look.hair_colour),
            brows=look.brows,
            stubble=look.stubble,
            age_years=look.build.age_years,
            seed=look.seed,
        )
        del uv_triangles
        found = []
        for chosen, window, side in (
            (seen & is_head, HEAD_WINDOW, HEAD_PX),
            (seen & ~is_head, WHOLE, SKIN_PX),
        ):
            used, places = np.unique(triangles[chosen], return_inverse=True)
            left, low, right, high = window
            material = Material(
                name="skin",
                roughness=0.55,
                base_colour=(1.0, 1.0, 1.0, 1.0),
                base_colour_texture=skin_picture(data, colours, window, side),
            )
            at = vertices[used]
            found.append(
                PersonPart(
                    label="",
                    positions=self.vertices[at],
                    normals=self._skin_normals[at],
                    uvs=(uvs[used] - [left, low]) / [right - left, high - low],
                    triangles=places.reshape(-1, 3),
                    material=material,
                    bones=self._bones[at],
                    weights=self._weights[at],
                )
            )
        return found

    def _eyes(self) -> list[PersonPart]:
        data = self._data
        material = Material(
            name="eye",
            roughness=0.12,
            base_colour=(1.0, 1.0, 1.0, 1.0),
            base_colour_texture=eye_picture(linear_from_hex(self._look.eyes)),
        )
        found = []
        for letter in ("l", "r"):
            group = data.groups[f"helper-{letter}-eye"]
            cut = clipped(group.triangles, group.uv_triangles, np.full(len(data.base), -1.0))
            uvs = eye_uvs(cut.mixed(self.vertices))
            found.append(self._person.part_of("", cut, uvs, material))
        return found

    def _lashes(self) -> PersonPart:
        data = self._data
        names = [f"helper-{side}-eyelashes-{k}" for side in "lr" for k in (1, 2)]
        cut = clipped(
            np.concatenate([data.groups[name].triangles for name in names]),
            np.concatenate([data.groups[name].uv_triangles for name in names]),
            np.full(len(data.base), -1.0),
        )
        material = Material(
            name="lashes", roughness=0.7, base_colour=(0.02, 0.015, 0.012, 1.0), double_sided=True
        )
        return self._person.part_of("", cut, cut.mixed_uvs(data.uvs), material)

    def _hair(self) -> list[PersonPart]:
        look = self._look
        style = HAIRSTYLES.get(look.hair)
        if style is None:
            return []
        material = strands(look.hair_colour, look.curls)
        head = joint_names(self._data).index("head")
        found = []
        for piece in hair_pieces(self._data, self._marks, style, self.vertices, self._skin_normals):
            count = len(piece.positions)
            weights = np.zeros((count, 4), np.float32)
            weights[:, 0] = 1.0
            found.append(
                PersonPart(
                    label="hair",
                    positions=piece.positions,
                    normals=piece.normals,
                    uvs=piece.uvs,
                    triangles=piece.triangles,
                    material=material,
                    bones=np.full((count, 4), head, np.uint16),
                    weights=weights,
                )
            )
        return found


_CATEGORIES = {"shoes": "shoe"}

_SIDES = (("left", "l"), ("right", "r"))
_SIGNS = (("left", 1.0), ("right", -1.0))
_COCO_JOINTS = (
    ("shoulder", "upperarm01"),
    ("elbow", "lowerarm01"),
    ("wrist", "wrist"),
    ("hip", "upperleg01"),
    ("knee", "lowerleg01"),
    ("ankle", "foot"),
)


@lru_cache(maxsize=2)
def _landmarks(data: BodyData) -> Landmarks:
    return Landmarks(data)


@lru_cache(maxsize=2)
def _skin_triangles(data: BodyData) -> tuple[Indices, Indices, Indices, Doubles]:
    """Return the triangles of skin, fewer than the data has, of vertices with one uv each.

    Also the vertex of the mesh and the texture coordinates of each.
    """
    group = data.groups["body"]
    pairs = np.stack([group.triangles.reshape(-1), group.uv_triangles.reshape(-1)], axis=1)
    unique, place = np.unique(pairs, axis=0, return_inverse=True)
    triangles = place.reshape(-1, 3).astype(np.int64)
    positions = data.base[unique[:, 0]].copy()

    def made() -> Arrays:
        fewer = fewer_triangles(positions, triangles, SKIN_TRIANGLES, max_error=SKIN_ERROR)
        return {"triangles": fewer}

    key = SOURCE, SKIN_TRIANGLES, SKIN_ERROR
    fewer = cached_arrays("skin", key, made, code=code_digest("assets"))["triangles"]
    return fewer, fewer, unique[:, 0], data.uvs[unique[:, 1]]
