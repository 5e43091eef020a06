"""Category of an imported object, from the words of its name: `config/import_categories.yaml`."""

from __future__ import annotations

import re
from functools import lru_cache
from typing import Any

from sailenv_ros.system.resources import resource_path
from sailenv_ros.system.yaml_text import from_yaml

__all__ = ["OTHER", "category_of_name"]

OTHER = "unlabelled"


def category_of_name(name: str, default: str = OTHER) -> str:
    """Return the category whose words are in a name, else the default.

    Words count from the first entry of the file on; CamelCase and underscores part words.
    """
    parted = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name)
    text = f" {' '.join(re.findall('[a-z]+', parted.lower()))} "
    return next((kind for words, kind in _table() if any(f" {w} " in text for w in words)), default)


@lru_cache(maxsize=1)
def _table() -> tuple[tuple[tuple[str, ...], str], ...]:
    path = resource_path("config", "import_categories.yaml")
    data: Any = from_yaml(path.read_text(encoding="utf-8"))
    return tuple((tuple(entry["words"]), str(entry["category"])) for entry in data["words"])
