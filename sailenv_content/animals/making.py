"""One animal: bones, flesh, skin, coat → an `Asset` with a skeleton."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_content.animals.anatomy import Anatomy, anatomy_of
from sailenv_content.animals.charts import Layout, layout_of
from sailenv_content.animals.coats import MARKS, CoatPainter, marks_of
from sailenv_content.animals.features import Piece, ear, eye
from sailenv_content.animals.looks import AnimalLook
from sailenv_content.animals.shape import EYE, body_of, grid_of
from sailenv_content.animals.surface import surface_of
from sailenv_content.animals.weights import dense_weights
from sailenv_content.people.rigging import strongest
from sailenv_ros.system.array_cache import Arrays, cached_arrays, code_digest
from sailenv_ros.types.colour import linear_from_hex, srgb_from_linear
from sailenv_ros.types.model import Asset, CylinderShape, Material, Mesh, Model, ModelPart
from sailenv_ros.types.rig import Rig

__all__ = ["animal_arrays", "make_animal"]

Doubles = NDArray[np.float64]
Texture = NDArray[np.uint8]

BODY_PX, HEAD_PX, EAR_PX, EYE_PX = 768, 448, 64, 64

_PARTS = ("body", "head", "ear.L", "ear.R", "eye.L", "eye.R")
_CODE = ("../sailenv_content/animals", "native", "types")

_LOW = 0.30
"""Height over that of the withers below which what faces up or down is a paw."""


def make_animal(name: str, look: AnimalLook) -> Asset:
    """Make an animal.

    Parameters
    ----------
    name : str
        Of the asset.
    look : AnimalLook
    """
    anatomy = anatomy_of(look)
    arrays = cached_arrays(
        "animal",
        (look.model_dump_json(),),
        lambda: animal_arrays(anatomy),
        code=code_digest(*_CODE, libraries=("scipy",)),
    )
    names = tuple(anatomy.joints)
    place = {joint: number for number, joint in enumerate(names)}
    model = Model(name=name, parts=tuple(_part(part, arrays) for part in _PARTS))
    unit = anatomy.unit
    return Asset(
        name=name,
        display_name=look.title,
        category=look.kind,
        model=model,
        collision=(
            CylinderShape(radius_m=0.3 * unit, height_m=unit, centre_m=(0.0, 0.0, 0.5 * unit)),
        ),
        mass_kg=look.mass,
        centre_of_mass_m=(0.0, 0.0, 0.7 * unit),
        tags=("animal", look.kind),
        rig=Rig(
            names=names,
            parents=np.array([place.get(above, -1) for above, _ in anatomy.joints.values()]),
            heads=np.array([at for _, at in anatomy.joints.values()]) - _middle(anatomy),
            bones=tuple(arrays[f"{part} bones"] for part in _PARTS),
            weights=tuple(arrays[f"{part} weights"] for part in _PARTS),
            legs=4,
        ),
    )


def animal_arrays(anatomy: Anatomy) -> Arrays:
    """Return the meshes, weights and pictures of all parts of an animal."""
    body = body_of(anatomy)
    vertices, normals, triangles = surface_of(body, grid_of(anatomy, body), 0.004 * anatomy.unit)
    dense = dense_weights(anatomy, body, vertices, triangles)
    marks = marks_of(anatomy, dense)
    painter = CoatPainter(anatomy)
    known = np.concatenate([vertices, marks], axis=1)
    bones, weights = strongest(dense)
    in_socket = _in_sockets(anatomy, vertices)
    is_head = (marks[triangles][..., 0] > 0.5).all(axis=1)
    found: dict[str, NDArray[np.generic]] = {}
    middle = _middle(anatomy)
    for part, chosen, side in (("body", ~is_head, BODY_PX), ("head", is_head, HEAD_PX)):
        # What is below the eyes, their sockets too, lies below brows.
        eyes = float(anatomy["head"][2]) + EYE[anatomy.look.kind][0][2] * anatomy.head_m
        low = _LOW * anatomy.unit if part == "body" else eyes
        own = triangles[chosen]
        layout = layout_of(vertices, own, side, low, np.asarray(in_socket[own].any(axis=1)))
        at = layout.sources
        found |= _mesh_arrays(
            part, vertices[at] - middle, normals[at], layout.uvs, layout.triangles
        )
        found[f"{part} bones"], found[f"{part} weights"] = bones[at], weights[at]
        found[f"{part} picture"] = _coat_picture(painter, layout, known)
    for side_ in "LR":
        for part, piece, picture in (
            (f"ear.{side_}", ear(anatomy, side_), None),
            (f"eye.{side_}", eye(anatomy, side_), _eye_picture(anatomy.look)),
        ):
            places = piece.vertices - middle
            found |= _mesh_arrays(part, places, piece.normals, piece.uvs, piece.triangles)
            joint = list(anatomy.joints).index(piece.joint)
            count = len(piece.vertices)
            found[f"{part} bones"] = np.full((count, 4), joint, np.uint16)
            found[f"{part} weights"] = np.tile(np.array([1, 0, 0, 0], np.float32), (count, 1))
            found[f"{part} picture"] = (
                _ear_picture(anatomy, painter, piece) if picture is None else picture
            )
    return found


def _middle(anatomy: Anatomy) -> Doubles:
    """Return (3,): the middle between nose and tail, on the floor, where the body frame is [m].

    What turns about it needs least room.
    """
    ahead = 0.5 * float(anatomy["nose"][0] + anatomy["tail01"][0])
    return np.array([ahead, 0.0, 0.0])


def _in_sockets(anatomy: Anatomy, vertices: Doubles) -> NDArray[np.bool_]:
    """Return (V,): which vertices are in what is carved out for the eyes."""
    place, radius, _ = EYE[anatomy.look.kind]
    own = (vertices - anatomy["head"]) / anatomy.head_m
    away = np.linalg.norm(own * [1.0, 0.0, 1.0] + np.abs(own) * [0.0, 1.0, 0.0] - place, axis=1)
    return np.asarray(away < 1.12 * radius)


def _mesh_arrays(
    part: str, vertices: Doubles, normals: Doubles, uvs: Doubles, triangles: NDArray[np.int64]
) -> dict[str, NDArray[np.generic]]:
    return {
        f"{part} positions": vertices.astype(np.float32),
        f"{part} normals": normals.astype(np.float32),
        f"{part} uvs": uvs.astype(np.float32),
        f"{part} triangles": triangles.astype(np.uint32),
    }


def _part(part: str, arrays: Arrays) -> ModelPart:
    picture: Texture = arrays[f"{part} picture"]
    return ModelPart(
        mesh=Mesh(
            positions=arrays[f"{part} positions"],
            normals=arrays[f"{part} normals"],
            uvs=arrays[f"{part} uvs"],
            triangles=arrays[f"{part} triangles"],
        ),
        material=Material(
            name=part.partition(".")[0],
            roughness=0.12 if part.startswith("eye") else 0.9,
            base_colour=(1.0, 1.0, 1.0, 1.0),
            base_colour_texture=picture,
        ),
    )


def _coat_picture(painter: CoatPainter, layout: Layout, known: Doubles) -> Texture:
    values, there = layout.spread(known)
    colours = painter.at(values[:, :3], values[:, 3:])
    return _spread_colours(colours, there)


def _ear_picture(anatomy: Anatomy, painter: CoatPainter, piece: Piece) -> Texture:
    """Return the picture of an ear: fur outside, bare skin with a seam of fur inside."""
    side = EAR_PX
    layout = Layout(np.arange(len(piece.vertices)), piece.triangles, piece.uvs, side)
    values, there = layout.spread(piece.vertices)
    marks = np.zeros((len(values), MARKS))
    marks[:, 0] = 1.0
    # As above its base, however far it hangs down.
    values[:, 2] = np.maximum(values[:, 2], anatomy[piece.joint][2])
    colours = painter.at(values, marks)
    rows, columns = np.nonzero(there)
    u = (columns + 0.5) / side
    v = 1.0 - (rows + 0.5) / side
    bare = np.clip((0.17 - np.abs(u - 0.75)) / 0.05, 0.0, 1.0) * np.clip((0.93 - v) / 0.1, 0.0, 1.0)
    bare = (0.85 * bare)[:, None]
    skin = np.array(linear_from_hex(anatomy.look.inner_ear)) * (0.65 + 0.35 * v)[:, None]
    return _spread_colours((1.0 - bare) * colours + bare * skin, there)


def _eye_picture(look: AnimalLook) -> Texture:
    """Return the picture of an eye: a cat's pupil is a slit, a dog's is round."""
    rows, columns = (np.mgrid[:EYE_PX, :EYE_PX] + 0.5) / EYE_PX * 2.0 - 1.0
    away = np.hypot(rows, columns)
    angle = np.degrees(2.0 * np.arctan(away))
    iris = np.array(linear_from_hex(look.eyes))
    shade = (0.75 + 0.45 * np.clip(rows + 0.4, 0.0, 1.0))[..., None]
    picture = np.tile(iris, (EYE_PX, EYE_PX, 1)) * shade
    if look.kind == "cat":
        pupil = np.hypot(columns / 0.16, rows / 0.42) - 1.0
        pupil = np.clip(0.5 - pupil / 0.25, 0.0, 1.0)
    else:
        pupil = np.clip((24.0 - angle) / 5.0, 0.0, 1.0)
    rim = np.clip((angle - (56.0 if look.kind == "cat" else 46.0)) / 8.0, 0.0, 1.0)
    dark = np.maximum(pupil, rim)[..., None]
    return _encoded((1.0 - dark) * picture + dark * np.array([0.006, 0.005, 0.005]))


def _spread_colours(colours: Doubles, there: NDArray[np.bool_]) -> Texture:
    """Return the picture of colours of some texels; the others have their mean."""
    encoded = _encoded(colours[None])[0]
    picture = np.empty((*there.shape, 4), np.uint8)
    picture[:] = np.rint(encoded.mean(axis=0))
    picture[there] = encoded
    return picture


def _encoded(linear: Doubles) -> Texture:
    pixels = np.full((*linear.shape[:2], 4), 255, np.uint8)
    pixels[..., :3] = np.rint(255.0 * srgb_from_linear(np.clip(linear, 0.0, 1.0)))
    return pixels
