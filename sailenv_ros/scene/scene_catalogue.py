"""Finds scene files by name: folders with YAML files in, names and paths out; reads no file."""

from __future__ import annotations

import time
from collections.abc import Iterable
from pathlib import Path

from sailenv_ros.errors import UnknownName
from sailenv_ros.system.resources import resource_path

__all__ = ["SceneCatalogue"]

SUFFIXES = (".yaml", ".yml")

SETTLED_NS = 2_000_000_000
"""Age of a folder's last change from which on its time tells of the next one [ns]."""

_Kept = tuple[int, dict[str, Path]]


class SceneCatalogue:
    """Scenes by name: a file's name without its suffix.

    Parameters
    ----------
    paths : iterable of Path
        More folders, searched before the package's own: a scene there hides one of its name here.
    own : Path or None
        The package's own folder, if not the installed one.
    """

    def __init__(self, paths: Iterable[Path] = (), *, own: Path | None = None) -> None:
        self._folders = (
            *(Path(path) for path in paths),
            resource_path("scenes") if own is None else own,
        )
        self._kept: dict[Path, _Kept] = {}

    @property
    def folders(self) -> tuple[Path, ...]:
        """The folders, in the order of the search."""
        return self._folders

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the scenes that there are now, sorted."""
        return tuple(sorted(self._found()))

    def path(self, scene: str | Path, *, also: str = "") -> Path:
        """Find a scene's file.

        Parameters
        ----------
        scene : str or Path
            A name, or the path of a YAML file.
        also : str
            Other names that the caller takes, for the error.

        Raises
        ------
        UnknownName
            If there is no such scene.
        """
        found = self._found()
        if str(scene) in found:
            return found[str(scene)]
        if Path(scene).suffix in SUFFIXES and _is_file(Path(scene)):
            return Path(scene)
        raise UnknownName("scene", str(scene), sorted(found), also=also)

    def _found(self) -> dict[str, Path]:
        found: dict[str, Path] = {}
        for folder in self._folders:
            for name, path in self._files_of(folder).items():
                found.setdefault(name, path)
        return found

    def _files_of(self, folder: Path) -> dict[str, Path]:
        """Return a folder's scenes: read when it changes, as every frame tells their names."""
        try:
            changed_ns = folder.stat().st_mtime_ns
        except OSError:
            return {}
        kept = self._kept.get(folder)
        if kept is not None and kept[0] == changed_ns:
            return kept[1]
        files = {
            path.stem: path
            for path in sorted(folder.glob("*.y*ml"), reverse=True)
            if path.suffix in SUFFIXES and path.is_file()
        }
        self._kept.pop(folder, None)
        if time.time_ns() - changed_ns > SETTLED_NS:
            self._kept[folder] = changed_ns, files
        return files


def _is_file(path: Path) -> bool:
    try:
        return path.is_file()
    except (OSError, ValueError):  # a name too long, or with a zero byte
        return False
