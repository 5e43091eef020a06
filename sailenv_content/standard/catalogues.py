"""The furniture catalogues that the standard pack is made from: Sweet Home 3D's library files.

A ``.sh3f`` file is a zip archive with models and a Java properties file that tells each model's
size, author and turn. Its sizes are authoritative: models are drawn in units of their own.
"""

from __future__ import annotations

import re
import zipfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import AssetError, UnknownName

__all__ = ["LICENCES", "CatalogueEntry", "Catalogues"]

PROPERTIES = "PluginFurnitureCatalog.properties"

LICENCES = {
    "BlendSwap-CC-0": "CC0-1.0",
    "BlendSwap-CC-BY": "CC-BY-3.0",
    "KatorLegaz": "CC-BY-3.0-US",
    "Scopia": "CC-BY-3.0",
}
"""Licence of all models of each library (SPDX names)."""


@dataclass(frozen=True, eq=False, kw_only=True)
class CatalogueEntry:
    """One model of a library.

    Attributes
    ----------
    library, model : str
        E.g. ``"Scopia"``, ``"ficus"``.
    title, author, licence : str
    size_m : (3,) tuple of float
        Along the body's x, y, z: depth, width, height [m].
    turn : (3, 3) float64
        Rotation of the model in its file's axes.
    file : str
        Of the model inside the archive.
    """

    library: str
    model: str
    title: str
    author: str
    licence: str
    size_m: tuple[float, float, float]
    turn: NDArray[np.float64]
    file: str


class Catalogues:
    """The libraries of a folder.

    Parameters
    ----------
    folder : Path
        With the ``.sh3f`` files.

    Raises
    ------
    AssetError
        If one of the libraries is not there or cannot be read.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._entries: dict[str, CatalogueEntry] = {}
        for library in LICENCES:
            for entry in self._read(library):
                self._entries.setdefault(f"{library}/{entry.model}", entry)

    def entry(self, source: str) -> CatalogueEntry:
        """Return the entry of ``library/model``.

        Raises
        ------
        UnknownName
            If there is none.
        """
        if source not in self._entries:
            raise UnknownName("furniture model", source, self._entries)
        return self._entries[source]

    def unpack(self, entry: CatalogueEntry, folder: Path) -> Path:
        """Unpack a model with its materials and pictures into a folder; return its path."""
        home = PurePosixPath(entry.file).parent
        with self._archive(entry.library) as archive:
            for member in archive.namelist():
                if PurePosixPath(member).parent == home and not member.endswith("/"):
                    (folder / PurePosixPath(member).name).write_bytes(archive.read(member))
        return folder / PurePosixPath(entry.file).name

    def credits(self) -> Iterator[tuple[str, str]]:
        """Yield each library's licence text, with its name."""
        for library in LICENCES:
            with self._archive(library) as archive:
                yield library, archive.read("LICENSE.TXT").decode("utf-8", "replace")

    def notices(self, entry: CatalogueEntry) -> Iterator[tuple[str, bytes]]:
        """Yield the licence and credits files that lie beside a model, by name."""
        home = PurePosixPath(entry.file).parent
        with self._archive(entry.library) as archive:
            for member in archive.namelist():
                path = PurePosixPath(member)
                if path.parent == home and path.suffix.lower() in (".txt", ".html", ".htm"):
                    yield path.name, archive.read(member)

    def _archive(self, library: str) -> zipfile.ZipFile:
        path = self._folder / f"{library}.sh3f"
        try:
            return zipfile.ZipFile(path)
        except (OSError, zipfile.BadZipFile) as problem:
            raise AssetError(path.name, f"the library cannot be read ({problem})") from None

    def _read(self, library: str) -> Iterator[CatalogueEntry]:
        with self._archive(library) as archive:
            values = _properties(archive.read(PROPERTIES).decode("latin-1"))
        for key in values:
            if key.startswith("name#"):
                yield _entry(library, values, key.partition("#")[2])


def _properties(text: str) -> dict[str, str]:
    """Parse Java properties, as far as these files use the format."""
    joined = re.sub(r"\\\r?\n\s*", "", text)
    pairs = (re.match(r"\s*([^#!=:\s][^=:]*?)\s*[=:]\s*(.*)", line) for line in joined.splitlines())
    return {pair[1]: pair[2].strip() for pair in pairs if pair}


def _entry(library: str, values: dict[str, str], number: str) -> CatalogueEntry:
    def value(key: str) -> str:
        return values.get(f"{key}#{number}", "")

    file = value("model").lstrip("/")
    depth, width, height = (float(value(k)) / 100.0 for k in ("depth", "width", "height"))
    turn = np.array([float(v) for v in value("modelRotation").split()] or np.eye(3)).reshape(3, 3)
    return CatalogueEntry(
        library=library,
        model=PurePosixPath(file).parent.name,
        title=value("name").encode("latin-1").decode("unicode_escape"),
        author=value("creator").encode("latin-1").decode("unicode_escape"),
        licence=LICENCES[library],
        size_m=(depth, width, height),
        turn=turn,
        file=file,
    )
