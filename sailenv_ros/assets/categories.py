"""`config/categories.yaml` → `CategoryTable`: the fixed categories, their ids and colours."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from typing import Annotated

import yaml
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from sailenv_ros.errors import AssetError, NameTaken
from sailenv_ros.system.resources import resource_path
from sailenv_ros.system.yaml_text import from_yaml
from sailenv_ros.types.labels import Category, CategoryTable

__all__ = ["LAST_FIXED_ID", "load_categories"]

LAST_FIXED_ID = 199
"""Higher ids belong to scenes and packs."""


class _CategoryEntry(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)

    id: Annotated[int, Field(ge=1, le=LAST_FIXED_ID, strict=True)]
    name: Annotated[str, Field(pattern=r"^[a-z0-9][a-z0-9 -]{0,62}$")]
    colour: Annotated[str, Field(pattern=r"^#[0-9a-f]{6}$")]

    def to_category(self) -> Category:
        red, green, blue = bytes.fromhex(self.colour[1:])
        return Category(id=self.id, name=self.name, colour=(red, green, blue))


class _CategoriesFile(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)

    categories: tuple[_CategoryEntry, ...]


def load_categories(path: Path | None = None) -> CategoryTable:
    """Read a table of categories.

    Parameters
    ----------
    path : Path or None
        ``None`` reads the package's own, once.

    Raises
    ------
    AssetError
        If the file cannot be read or breaks the rules that it states at its top.
    """
    return _own_table() if path is None else _read(path)


@lru_cache(maxsize=1)
def _own_table() -> CategoryTable:
    return _read(resource_path("config", "categories.yaml"))


def _read(path: Path) -> CategoryTable:
    try:
        content = _CategoriesFile.model_validate(from_yaml(path.read_text(encoding="utf-8")))
        ids = [entry.id for entry in content.categories]
        if len(set(ids)) != len(ids):
            raise NameTaken("category id", str(next(i for i in ids if ids.count(i) > 1)))
        return CategoryTable(entry.to_category() for entry in content.categories)
    except (OSError, UnicodeDecodeError, yaml.YAMLError, ValidationError, NameTaken) as problem:
        raise AssetError(str(path), " ".join(str(problem).split())) from None
