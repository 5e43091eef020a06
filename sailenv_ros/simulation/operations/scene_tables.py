"""The scene as it was announced last, in tables."""

from __future__ import annotations

from sailenv_ros.simulation.operations.operation import Caller
from sailenv_ros.types.scene_info import SceneObject

__all__ = ["SceneTables"]


class SceneTables(Caller):
    """Tables of the present contents of the scene; nothing here blocks."""

    @property
    def scene(self) -> str:
        """Name of the present scene."""
        return self.info.scene

    @property
    def scenes(self) -> list[str]:
        """Names that `change_scene` takes."""
        return list(self.info.scenes)

    @property
    def categories(self) -> dict[int, str]:
        """Names of the categories by their ids, the values of the category view."""
        return {category.id: category.name for category in self.info.categories.values()}

    @property
    def category_colours(self) -> dict[int, tuple[int, int, int]]:
        """Red, green, blue of the categories' pictures by their ids."""
        return {category.id: category.colour for category in self.info.categories.values()}

    @property
    def instances(self) -> dict[int, SceneObject]:
        """The objects of the scene by their ids, the values of the instance view."""
        return dict(self.info.objects)
