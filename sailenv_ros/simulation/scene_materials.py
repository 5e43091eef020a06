"""Where the materials of scenes come from: the assets, and pictures beside the scenes' files."""

from __future__ import annotations

from pathlib import Path

from sailenv_ros.assets.asset_library import AssetLibrary
from sailenv_ros.assets.material_library import MaterialLibrary
from sailenv_ros.assets.pictures import Pictures

__all__ = ["SceneMaterials"]


class SceneMaterials:
    """Materials by scene.

    Parameters
    ----------
    assets : AssetLibrary
    own_folder : Path
        Of saved scenes.

    Attributes
    ----------
    pictures : Pictures
        Those that were sent.
    """

    def __init__(self, assets: AssetLibrary, own_folder: Path) -> None:
        self.pictures = Pictures()
        self._assets = assets
        self._own_folder = own_folder
        self._folders: dict[str, Path] = {}

    def note(self, scene: str, file: Path) -> None:
        """Take note of the file that a scene was built from."""
        self._folders[scene] = file.absolute().parent

    def of(self, scene: str) -> MaterialLibrary:
        """Return where the materials of a scene that was built come from."""
        return MaterialLibrary(self._assets, self.pictures, self._picture_folders(scene))

    def beside(self, file: Path) -> MaterialLibrary:
        """Return where the materials of a scene's file come from."""
        folders = (file.absolute().parent, self._own_folder)
        return MaterialLibrary(self._assets, self.pictures, folders)

    def picture_content(self, picture: str, scene: str) -> bytes:
        """Return the bytes of a picture that a scene shows.

        Raises
        ------
        AssetError
            If it is there no more.
        """
        return self.pictures.content(picture, self._picture_folders(scene))

    def _picture_folders(self, scene: str) -> tuple[Path, ...]:
        """Return where pictures of a scene that was built lie: beside it, or beside saved ones."""
        beside = self._folders.get(scene)
        return tuple(dict.fromkeys((beside or self._own_folder, self._own_folder)))
