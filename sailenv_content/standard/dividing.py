"""Divides a catalogue's model into labelled parts: pillows, fruits, books on a shelf.

Finished `RawPart`s and a recipe's `parts` in; the same surface out, each mesh with the name of its
part. Some models have a material for each pillow; of others the connected pieces are taken, or a
row of books is cut between its spines.
"""

from __future__ import annotations

import dataclasses
import fnmatch
from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from sailenv_ros.assets.meshes import RawMesh, components
from sailenv_ros.assets.model_files import RawPart
from sailenv_ros.assets.recipe import RecipePart
from sailenv_ros.errors import AssetError

__all__ = ["LabelledMesh", "divided"]

TOUCHING_M = 0.002
"""Pieces whose boxes are no farther from each other are of one part [m]."""

THINNEST_BOOK_M = 0.006
"""Least thickness of a book; in a row of books, less is the gap between two [m]."""


@dataclasses.dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class LabelledMesh:
    """A mesh and the part that it belongs to: name and category, both empty for the body."""

    mesh: RawPart
    name: str = ""
    category: str = ""


def divided(
    asset: str, parts: Sequence[RawPart], wanted: Mapping[str, RecipePart]
) -> list[LabelledMesh]:
    """Say of each mesh what part it belongs to; cut meshes that hold several.

    Parameters
    ----------
    asset : str
        Its name, for errors.
    parts : sequence of RawPart
        The whole model.
    wanted : mapping of str to RecipePart
        By the part's name, to which a number is added where it names several.

    Raises
    ------
    AssetError
        If a part names no mesh.
    """
    left = list(parts)
    found: list[LabelledMesh] = []
    for name, rule in wanted.items():
        own = [part for part in left if _fits(part.material.name, rule.materials)]
        left = [part for part in left if not any(part is taken for taken in own)]
        if rule.above is not None:
            pieces = [piece for part in own for piece in _pieces(part)]
            own = [piece for piece in pieces if _box(piece.mesh)[0][2] > rule.above]
            left += [piece for piece in pieces if _box(piece.mesh)[0][2] <= rule.above]
        if not own:
            raise AssetError(asset, f"no mesh is one of its part {name!r}")
        groups = _groups(own, rule)
        for number, group in enumerate(groups, 1):
            label = f"{name} {number}" if rule.each != "material" else name
            found += [LabelledMesh(mesh=m, name=label, category=rule.category) for m in group]
    return [*(LabelledMesh(mesh=part) for part in left), *found]


def _fits(name: str, patterns: Sequence[str]) -> bool:
    return any(fnmatch.fnmatchcase(name, pattern) for pattern in patterns)


def _groups(parts: Sequence[RawPart], rule: RecipePart) -> list[list[RawPart]]:
    if rule.each == "material":
        return [list(parts)]
    if rule.each == "mesh":
        return [[part] for part in parts]
    if rule.each == "book":
        books = [[book] for part in parts for book in _books(part)]
        return sorted(books, key=lambda group: _order(group[0]))
    return _touching([piece for part in parts for piece in _pieces(part)])


def _order(part: RawPart) -> tuple[float, float]:
    """Sort from top to bottom, then from the left, as the front shows them."""
    low, high = _box(part.mesh)
    return -round(float(low[2]), 2), float(low[1] + high[1])


def _box(mesh: RawMesh) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    used = mesh.positions[np.unique(mesh.triangles)]
    return used.min(axis=0), used.max(axis=0)


def _pieces(part: RawPart) -> Iterator[RawPart]:
    """Yield the connected pieces of a mesh."""
    piece_of = components(part.mesh)
    for piece in np.unique(piece_of):
        yield _some(part, piece_of == piece)


def _touching(pieces: Sequence[RawPart]) -> list[list[RawPart]]:
    """Join pieces whose boxes touch: a cushion and its buttons are one."""
    boxes = [_box(piece.mesh) for piece in pieces]
    near = [
        (a, b)
        for a in range(len(pieces))
        for b in range(a)
        if (boxes[a][0] - TOUCHING_M <= boxes[b][1]).all()
        and (boxes[b][0] - TOUCHING_M <= boxes[a][1]).all()
    ]
    ends = np.array(near, np.int64).reshape(-1, 2)
    graph = coo_matrix((np.ones(len(ends)), (ends[:, 0], ends[:, 1])), (len(pieces),) * 2)
    count, group_of = connected_components(graph, directed=False)
    groups = [[p for p, at in zip(pieces, group_of, strict=True) if at == g] for g in range(count)]
    return sorted(groups, key=lambda group: min(_order(piece) for piece in group))


def _books(row: RawPart) -> Iterator[RawPart]:
    """Cut a row of books that stand side by side along y, drawn as one strip of spines."""
    corners = row.mesh.positions[row.mesh.triangles]
    low, high = corners[..., 1].min(axis=1), corners[..., 1].max(axis=1)
    spans = sorted({(a, b) for a, b in zip(low, high, strict=True) if b - a >= THINNEST_BOOK_M})
    books: list[list[float]] = []
    for first, last in spans:
        if books and first < books[-1][1] - 0.5 * THINNEST_BOOK_M:
            books[-1][1] = max(books[-1][1], last)
        else:
            books.append([first, last])
    edges = np.array(books)
    # A side between two books belongs to the one that it closes: a hair inside along its normal.
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.maximum(np.linalg.norm(normals, axis=1), 1e-12)
    inside = corners[..., 1].mean(axis=1) - 1e-4 * normals[:, 1] / lengths
    beside = np.maximum(edges[:, 0] - inside[:, None], inside[:, None] - edges[:, 1])
    book_of = np.argmin(np.maximum(beside, 0.0), axis=1)
    for book in np.unique(book_of):
        yield _some(row, book_of == book)


def _some(part: RawPart, chosen: NDArray[np.bool_]) -> RawPart:
    """Return a mesh of some of the triangles."""
    mesh = part.mesh
    used, triangles = np.unique(mesh.triangles[chosen], return_inverse=True)
    normals = None if mesh.normals is None else mesh.normals[used]
    cut = dataclasses.replace(
        mesh,
        positions=mesh.positions[used],
        uvs=mesh.uvs[used],
        triangles=triangles.reshape(-1, 3),
        normals=normals,
    )
    return dataclasses.replace(part, mesh=cut)
