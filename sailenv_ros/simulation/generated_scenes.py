"""Scenes that are made when they are asked for: ``generated:kitchen:17`` in, a scene file out.

The files lie in the user's cache, in a folder for each state of rules and furniture.
"""

from __future__ import annotations

from functools import cached_property
from hashlib import blake2b
from pathlib import Path
from typing import TYPE_CHECKING

from sailenv_content import families, generation
from sailenv_ros.assets.asset_library import AssetLibrary
from sailenv_ros.assets.folders import standard_pack_folder
from sailenv_ros.assets.pack import PACK_FILE
from sailenv_ros.authoring.room_rules import names
from sailenv_ros.system.files import make_folder, storage_errors, write_file
from sailenv_ros.system.resources import resource_path
from sailenv_ros.system.user_folders import cache_folder, remove_oldest

if TYPE_CHECKING:
    from sailenv_content.generation.generator import Generator

__all__ = ["GeneratedScenes", "generation_state"]

FOLDER = "generated"
MAX_FILES = 1000
"""Greatest number of files that are kept."""


class GeneratedScenes:
    """Makes scenes by their names, each once.

    Parameters
    ----------
    assets : AssetLibrary
        What they are furnished with.
    """

    def __init__(self, assets: AssetLibrary) -> None:
        self._assets = assets

    def path(self, name: str) -> Path:
        """Return the file of a scene; it is made if it has not been.

        Raises
        ------
        InvalidRequest, UnknownName
            If the name is not ``generated:KIND:SEED``.
        AssetError, InvalidState
            If it cannot be made.
        StorageError
            If it cannot be written.
        """
        kind, seed = names.parsed_name(name, self._generator.rules)
        folder = cache_folder() / FOLDER / generation_state()
        path = folder / f"{names.file_stem(kind, seed)}.yaml"
        if not path.is_file():
            made = self._generator.generate(kind, seed)
            with storage_errors("generated scenes", folder):
                make_folder(folder)
                write_file(path, made.text.encode(), overwrite=True)
                remove_oldest(folder.glob("*.yaml"), most_files=MAX_FILES)
        return path

    @cached_property
    def _generator(self) -> Generator:
        # Most scenes are files, and the generator needs much.
        from sailenv_content.generation.generator import Generator

        return Generator(assets=self._assets)


def generation_state() -> str:
    """Return what changes with the rules and with the furniture."""
    digest = blake2b(digest_size=8)
    rules = resource_path("config", "rooms")
    files = [*sorted(rules.rglob("*.yaml")), standard_pack_folder() / PACK_FILE]
    for package in (names.__file__, generation.__file__, families.__file__):
        assert package is not None
        files += sorted(Path(package).parent.rglob("*.py"))
    for file in files:
        if file.is_file():
            digest.update(file.read_bytes())
    return digest.hexdigest()
