"""One entry of the recipe → a finished model: sized, stood up, simplified, with its materials.

A folder of catalogues and a `RecipeEntry` in, a `PreparedAsset` out. Writes nothing but what it
unpacks for a moment.
"""

from __future__ import annotations

import dataclasses
import tempfile
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sailenv_content.procedural import PROCEDURAL
from sailenv_content.procedural.devices import SCREEN_BLACK, desktop_picture
from sailenv_content.procedural.paintings import landscape_picture
from sailenv_content.standard.catalogues import CatalogueEntry, Catalogues
from sailenv_content.standard.dividing import LabelledMesh, divided
from sailenv_content.standard.finishing import finished
from sailenv_content.standard.patterns import PATTERNS
from sailenv_ros.assets.finishes import FINISHES, finish_of
from sailenv_ros.assets.hulls import convex_hull, convex_parts, hulls_of_pieces, merged
from sailenv_ros.assets.importing import bounds_of
from sailenv_ros.assets.meshes import (
    RawMesh,
    box_uvs,
    is_open,
    outward,
    simplified,
    smooth_mesh,
    thinned_out,
)
from sailenv_ros.assets.model_files import RawPart, read_parts
from sailenv_ros.assets.recipe import MaterialRule, RecipeEntry
from sailenv_ros.errors import AssetError
from sailenv_ros.types.colour import linear_from_srgb
from sailenv_ros.types.model import AssetPart, ConvexShape, Material, ModelPart

__all__ = ["PreparedAsset", "prepare"]

CONCAVITY = 0.05
"""CoACD's threshold for the pack; with the one of imports (0.08) hollows of seats are filled."""

BASE_SHARE = 0.2

FEWEST_TRIANGLES = 64
"""No part is simplified below this."""

TRIANGLES_AT_ONE_METRE = 3500
TRIANGLES_EXPONENT = 0.65
"""An object of diagonal d has about 3500 d^0.65 triangles: seen from where it fills a picture of
VGA size, an edge is some four pixels long. What is drawn per frame is counted in triangles."""


@dataclass(frozen=True, eq=False, kw_only=True)
class PreparedAsset:
    """A finished model, and where it comes from.

    Attributes
    ----------
    parts : tuple of ModelPart
        Body frame, origin at the centre of the base.
    hulls : tuple of ConvexShape
        Empty for entries that collide as a box, a cylinder or a ball.
    labelled : tuple of AssetPart
        What of it is labelled apart.
    title, author, licence, source : str
    """

    parts: tuple[ModelPart, ...]
    hulls: tuple[ConvexShape, ...]
    labelled: tuple[AssetPart, ...]
    title: str
    author: str
    licence: str
    source: str


def prepare(name: str, entry: RecipeEntry, catalogues: Catalogues) -> PreparedAsset:
    """Make one object of the pack.

    Parameters
    ----------
    name : str
        Of the asset; seeds what is random.

    Raises
    ------
    AssetError, UnknownName
        If its model is not there or cannot be used.
    """
    library, _, what = entry.source.partition("/")
    if library == "made":
        raw = PROCEDURAL[what]()
        origin = ("sailenv_ros", "Apache-2.0", f"sailenv_ros {what}", what.replace("_", " "))
    else:
        listed = catalogues.entry(entry.source)
        raw = _from_catalogue(listed, catalogues)
        source = f"sweethome3d-furniture {entry.source}"
        origin = (listed.author, listed.licence, source, listed.title)
    raw = _turned(raw, entry.turn)
    raw += [part for what in entry.adds for part in PROCEDURAL[what]()]
    raw = _finished(raw, entry)
    author, licence, source, title = origin
    pieces = divided(name, raw, entry.parts)
    meshes = [piece.mesh for piece in pieces]
    drawn = _drawn(name, meshes, entry.triangles or enough_triangles(raw))
    return PreparedAsset(
        parts=tuple(drawn.values()),
        hulls=_hulls(raw, entry),
        labelled=_labelled(pieces, list(drawn)),
        title=title,
        author=author,
        licence=licence,
        source=source,
    )


def _labelled(pieces: Sequence[LabelledMesh], drawn: Sequence[int]) -> tuple[AssetPart, ...]:
    """Return the parts, by the places of their meshes among those that are drawn."""
    meshes: dict[tuple[str, str], list[int]] = {}
    for place, number in enumerate(drawn):
        piece = pieces[number]
        if piece.name:
            meshes.setdefault((piece.name, piece.category), []).append(place)
    return tuple(
        AssetPart(name=name, category=category, meshes=tuple(places))
        for (name, category), places in meshes.items()
    )


def _from_catalogue(listed: CatalogueEntry, catalogues: Catalogues) -> list[RawPart]:
    with tempfile.TemporaryDirectory(prefix="sailenv-") as folder:
        parts = read_parts(catalogues.unpack(listed, Path(folder)))
    # The catalogue's turn is in the file's axes (x right, y up, z front).
    swap = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    turn = swap @ listed.turn @ swap.T
    parts = tuple(_mapped(part, turn, np.zeros(3)) for part in parts)
    low, high = bounds_of(parts)
    size = np.where(high - low > 1e-9, high - low, 1.0)
    scale = np.diag(np.asarray(listed.size_m) / size)
    base = np.array([*(low[:2] + high[:2]) / 2.0, low[2]])
    return [_mapped(part, scale, -scale @ base) for part in parts]


def _mapped(part: RawPart, linear_map: NDArray[np.float64], shift: NDArray[np.float64]) -> RawPart:
    mesh = part.mesh
    normals = mesh.normals
    if normals is not None:
        normals = normals @ np.linalg.inv(linear_map)
    moved = dataclasses.replace(
        mesh, positions=mesh.positions @ linear_map.T + shift, normals=normals
    )
    return dataclasses.replace(part, mesh=moved)


def enough_triangles(parts: Sequence[RawPart]) -> int:
    """Return how many triangles an object of that size needs."""
    low, high = bounds_of(parts)
    return int(TRIANGLES_AT_ONE_METRE * float(np.linalg.norm(high - low)) ** TRIANGLES_EXPONENT)


def _turned(parts: list[RawPart], degrees: float) -> list[RawPart]:
    if not degrees:
        return parts
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    return [_mapped(part, turn, np.zeros(3)) for part in parts]


def _finished(parts: list[RawPart], entry: RecipeEntry) -> list[RawPart]:
    done = []
    for part in parts:
        rule = entry.rule(part.material.name)
        if not rule.drop:
            done.append(_with_finish(part, rule))
    if not done:
        raise AssetError(entry.source, "the recipe drops all its parts")
    return done


def _with_finish(part: RawPart, rule: MaterialRule) -> RawPart:
    kind = rule.finish or finish_of(part.material.name)
    colour = None
    if rule.colour is not None:
        red, green, blue = linear_from_srgb(
            np.frombuffer(bytes.fromhex(rule.colour[1:]), np.uint8) / 255.0
        )
        colour = (float(red), float(green), float(blue))
    material = finished(
        part.material,
        kind,
        colour=colour,
        roughness=rule.roughness,
        metallic=rule.metallic,
        pattern=rule.pattern,
    )
    material = dataclasses.replace(
        material, emission=rule.emission or material.emission, glow=rule.glow or material.glow
    )
    mesh = outward(part.mesh)
    if rule.shows is not None:
        mesh, material = _showing(mesh, material, rule.shows)
    pattern = _pattern_of(part.material, material, rule.pattern, kind)
    if pattern:
        mesh = box_uvs(mesh, PATTERNS[pattern].tile_m)
    if is_open(mesh):
        material = dataclasses.replace(material, double_sided=True)
    return dataclasses.replace(part, mesh=mesh, material=material)


def _showing(mesh: RawMesh, material: Material, what: str) -> tuple[RawMesh, Material]:
    """Return a screen with a picture across it, upright for who looks at its front."""
    low, high = mesh.positions.min(axis=0), mesh.positions.max(axis=0)
    size = np.maximum(high - low, 1e-9)
    # Who looks against x has y to the right.
    places = ((mesh.positions - low) / size)[:, 1:]
    ratio = float(size[1] / np.hypot(size[0], size[2]))
    if what == "desktop":
        picture = desktop_picture(0, ratio)
    else:
        picture = landscape_picture(5, ratio, grain=0.0)
    shown = dataclasses.replace(
        material, base_colour=(*SCREEN_BLACK, 1.0), base_colour_texture=picture
    )
    return dataclasses.replace(mesh, uvs=places), shown


def _pattern_of(before: Material, after: Material, given: str | None, kind: str | None) -> str:
    """Return the pattern that was put on, for which coordinates must be found."""
    if after.base_colour_texture is None or after.base_colour_texture is before.base_colour_texture:
        return ""
    return given if given is not None else FINISHES[kind].pattern if kind else ""


def _drawn(name: str, parts: Sequence[RawPart], limit: int) -> dict[int, ModelPart]:
    """Simplify to the limit: solid parts by their share, foliage to what those leave.

    Returns what is left by the numbers of the parts.
    """
    share = min(1.0, limit / sum(len(part.mesh.triangles) for part in parts))
    meshes: dict[int, RawMesh] = {}
    for number, part in enumerate(parts):
        if not _is_foliage(part):
            count = max(FEWEST_TRIANGLES, int(share * len(part.mesh.triangles)))
            meshes[number] = simplified(part.mesh, count)
    left = max(0, limit - sum(len(mesh.triangles) for mesh in meshes.values()))
    leaves = sum(len(part.mesh.triangles) for part in parts if _is_foliage(part))
    for number, part in enumerate(parts):
        if _is_foliage(part):
            count = max(FEWEST_TRIANGLES, int(left / leaves * len(part.mesh.triangles)))
            seed = zlib.crc32(f"{name}/{part.name}".encode())
            meshes[number] = thinned_out(part.mesh, count, seed=seed)
    return {
        number: ModelPart(mesh=smooth_mesh(meshes[number]), material=part.material)
        for number, part in enumerate(parts)
        if len(meshes[number].triangles)
    }


def _is_foliage(part: RawPart) -> bool:
    return finish_of(part.material.name) == "leaf"


def _hulls(parts: Sequence[RawPart], entry: RecipeEntry) -> tuple[ConvexShape, ...]:
    mesh = merged([part.mesh for part in parts])
    if entry.collision == "pieces":
        return hulls_of_pieces(mesh)
    if entry.collision == "convex":
        return convex_parts(mesh, threshold=CONCAVITY)
    points = mesh.positions[np.unique(mesh.triangles)]
    if entry.collision == "hull":
        return (convex_hull(points),)
    if entry.collision == "base":
        return (convex_hull(points[points[:, 2] < BASE_SHARE * points[:, 2].max()]),)
    return ()
