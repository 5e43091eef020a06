"""`config/category_names.yaml`: what COCO, ADE20K and NYU Depth V2 call our categories."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from types import MappingProxyType
from typing import Literal, TypeAlias, get_args

from sailenv_ros.errors import UnknownName
from sailenv_ros.system.resources import resource_path
from sailenv_ros.system.yaml_text import from_yaml

__all__ = ["NAMING_SCHEMES", "NamingScheme", "names_in"]

NamingScheme: TypeAlias = Literal["coco", "ade20k", "nyu40"]

NAMING_SCHEMES: tuple[NamingScheme, ...] = get_args(NamingScheme)
"""COCO's 80 classes; ADE20K's 150 of scene parsing; the 40 of NYU Depth V2."""


@lru_cache(maxsize=len(NAMING_SCHEMES))
def names_in(scheme: NamingScheme) -> Mapping[str, str]:
    """Return the class of another data set by the name of our category.

    Categories that it has no class for are not in the mapping, and neither are those that scenes
    define.

    Raises
    ------
    UnknownName
        If it is none of `NAMING_SCHEMES`.

    Examples
    --------
    >>> names_in("nyu40")["couch"]
    'sofa'
    """
    if scheme not in NAMING_SCHEMES:
        raise UnknownName("naming scheme", scheme, NAMING_SCHEMES)
    text = resource_path("config", "category_names.yaml").read_text(encoding="utf-8")
    names = from_yaml(text)["names"]
    return MappingProxyType({own: row[scheme] for own, row in names.items() if scheme in row})
