"""The catalogue of assets: a name in, an `Asset` out, each loaded once.

Where assets come from is a matter of its sources: built-in solids, packs on disk.
"""

from __future__ import annotations

import threading
from collections.abc import Iterable, Mapping
from typing import Protocol, runtime_checkable

from sailenv_ros.assets.primitives import Primitives
from sailenv_ros.errors import NameTaken, UnknownName
from sailenv_ros.scene.knowledge import OpenNames
from sailenv_ros.types.labels import PART_MARK
from sailenv_ros.types.model import Asset, Model

__all__ = ["AssetLibrary", "AssetSource", "OpenSource"]


class AssetSource(Protocol):
    """Something that has assets and loads them on demand."""

    @property
    def display_names(self) -> Mapping[str, str]:
        """Display name of each catalogue name; cheap, loads nothing."""
        ...

    def load(self, name: str) -> Asset:
        """Load the asset of a catalogue name.

        Raises
        ------
        AssetError
            If it cannot be used.
        """
        ...


@runtime_checkable
class OpenSource(Protocol):
    """A source with more names than can be listed: it makes what a name describes."""

    @property
    def display_names(self) -> Mapping[str, str]:
        """Nothing: its names are not listed."""
        ...

    def speaks_of(self, name: str) -> bool:
        """Return whether a name has the form of those of this source."""
        ...

    def load(self, name: str) -> Asset:
        """Make the asset of a name; the same object while it is in use.

        Raises
        ------
        UnknownName, AssetError
            If there is none of that name, or it cannot be made.
        """
        ...

    def sibling(self, name: str, seed: int) -> str | None:
        """Return the name of another asset of the same kind; None if a seed makes none of it."""
        ...

    def problem(self, name: str) -> UnknownName | None:
        """Return why there is no asset of a name; None if there is one. Makes nothing."""
        ...


class AssetLibrary:
    """All assets of all sources; may be used from several threads.

    Parameters
    ----------
    sources : iterable of AssetSource
        By default the built-in solids alone.

    Raises
    ------
    NameTaken
        If two assets have the same catalogue or display name.
    """

    def __init__(self, sources: Iterable[AssetSource] | None = None) -> None:
        self._source_of: dict[str, AssetSource] = {}
        self._name_of: dict[str, str] = {}
        self._loaded: dict[str, Asset] = {}
        self._lock = threading.Lock()
        self._open: list[OpenSource] = []
        for source in (Primitives(),) if sources is None else sources:
            if isinstance(source, OpenSource):
                self._open.append(source)
            for name, display_name in source.display_names.items():
                self._add(name, display_name, source)

    @property
    def names(self) -> tuple[str, ...]:
        """Catalogue names, in the order of the sources."""
        return tuple(self._source_of)

    @property
    def all_names(self) -> OpenNames:
        """Catalogue names and display names; all that `get` takes is in it."""
        return OpenNames(self._name_of, self._fault_of)

    @property
    def display_names(self) -> Mapping[str, str]:
        """Display name of each catalogue name, in the order of the sources."""
        # The display name is the last alias that an asset is given.
        return {name: alias for alias, name in self._name_of.items()}

    def canonical(self, name: str) -> str:
        """Return the catalogue name of a catalogue name or display name.

        Raises
        ------
        UnknownName
            If no asset has that name.
        """
        if isinstance(name, str) and name in self._name_of:
            return self._name_of[name]
        source = self._open_source(name)
        if source is None:
            raise UnknownName("asset", name, self._name_of)
        problem = source.problem(name)
        if problem is not None:
            raise problem
        return name

    def get(self, name: str) -> Asset:
        """Return an asset; the same object each time.

        Parameters
        ----------
        name : str
            Catalogue name (``"chair_01"``) or display name (``"Chair 01"``).

        Raises
        ------
        UnknownName
            If no asset has that name.
        AssetError
            If it cannot be loaded.
        """
        name = self.canonical(name)
        if name not in self._source_of:
            return self.source(name).load(name)  # which keeps what is in use
        with self._lock:
            if name not in self._loaded:
                self._loaded[name] = self._source_of[name].load(name)
            return self._loaded[name]

    def peek(self, name: str) -> Asset:
        """Return an asset as `get` does, but keep none that was not in use.

        Raises
        ------
        UnknownName, AssetError
            As `get`.
        """
        name = self.canonical(name)
        with self._lock:
            loaded = self._loaded.get(name)
        return loaded or self.source(name).load(name)

    def category_of(self, name: str) -> str:
        """Return the category of an asset; empty if there is none of that name."""
        return self.peek(name).category if self.has(name) else ""

    def drawn_model(self, name: str) -> Model:
        """Return what is drawn of an instance by its ``asset``; keeps none that was not in use.

        Parameters
        ----------
        name : str
            Of an asset, whose parts are left out then, or of a part: ``bed_02/left pillow``.

        Raises
        ------
        UnknownName, AssetError
            As `get`, also if the asset has no such part.
        """
        whole, mark, wanted = name.partition(PART_MARK)
        asset = self.peek(whole)
        if not mark:
            return asset.body_model
        for part in asset.parts:
            if part.name == wanted:
                return asset.part_model(part)
        raise UnknownName(f"part of {whole!r}", wanted, [part.name for part in asset.parts])

    def source(self, name: str) -> AssetSource:
        """Return what an asset comes from, by its catalogue or display name.

        Raises
        ------
        UnknownName
            If no asset has that name.
        """
        name = self.canonical(name)
        found = self._source_of.get(name) or self._open_source(name)
        assert found is not None  # as it has a name
        return found

    def sibling(self, name: str, seed: int) -> str | None:
        """Return the name of another asset of the same kind; None if a seed makes none of it."""
        source = self._open_source(name)
        return None if source is None else source.sibling(name, seed)

    def has(self, name: str) -> bool:
        """Return whether `get` takes a name."""
        return name in self._name_of or self._fault_of(name) == ""

    def add(self, asset: Asset) -> None:
        """Add an asset that is there already, e.g. one that a user uploaded.

        Raises
        ------
        NameTaken
            If its catalogue or display name is in use.
        """
        with self._lock:
            self._add(asset.name, asset.display_name, _Ready(asset))

    def renew(self, sources: Iterable[AssetSource]) -> None:
        """Take assets that are not loaded yet from these sources, and add those that are new.

        What was added by `add`, or is in use, stays as it is; a name that is taken is left out.
        """
        with self._lock:
            renewed = tuple(sources)
            self._open = [source for source in renewed if isinstance(source, OpenSource)]
            for source in renewed:
                for name, display_name in source.display_names.items():
                    if name not in self._source_of:
                        if display_name not in self._name_of:
                            self._add(name, display_name, source)
                    elif not isinstance(self._source_of[name], _Ready):
                        self._source_of[name] = source

    def _fault_of(self, name: str) -> str | None:
        source = self._open_source(name)
        if source is None:
            return None
        problem = source.problem(name)
        return "" if problem is None else str(problem)

    def _open_source(self, name: object) -> OpenSource | None:
        if not isinstance(name, str):
            return None
        return next((source for source in self._open if source.speaks_of(name)), None)

    def _add(self, name: str, display_name: str, source: AssetSource) -> None:
        aliases = dict.fromkeys((name, display_name))
        for alias in aliases:
            if alias in self._name_of:
                raise NameTaken("asset", alias)
        self._name_of.update(dict.fromkeys(aliases, name))
        self._source_of[name] = source


class _Ready:
    """A source of one asset that needs no loading."""

    def __init__(self, asset: Asset) -> None:
        self._asset = asset

    @property
    def display_names(self) -> Mapping[str, str]:
        return {self._asset.name: self._asset.display_name}

    def load(self, name: str) -> Asset:
        return self._asset
