"""The source of pieces for the `AssetLibrary`: a name in, a piece out, kept while it is in use.

What was made is kept on disk too, and read in a hundredth of the time.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache, partial
from types import MappingProxyType

from sailenv_content.families.names import FORM, PieceName, has_form, parsed
from sailenv_content.families.registry import (
    family_named,
    family_names,
    family_styles,
    making_code,
)
from sailenv_content.standard.patterns import PatternTextures
from sailenv_ros.assets.kept_assets import KeptAssets
from sailenv_ros.assets.model_cache import cached_object
from sailenv_ros.errors import UnknownName
from sailenv_ros.types.model import Asset

__all__ = ["FamilySource"]

_made: KeptAssets[PieceName, Asset] = KeptAssets()
_TEXTURES = PatternTextures()


class FamilySource:
    """Pieces by their names, ``FAMILY~STYLE:SEED``, and what opens of them, ``…#PART``."""

    @property
    def display_names(self) -> Mapping[str, str]:
        """Nothing: there are more names than can be listed."""
        return MappingProxyType({})

    def speaks_of(self, name: str) -> bool:
        """Return whether a name is meant to be one of a piece."""
        return has_form(name)

    def problem(self, name: str) -> UnknownName | None:
        """Return why there is no piece of a name; None if there is one."""
        return _problem(name)

    def sibling(self, name: str, seed: int) -> str | None:
        """Return the name of another piece of the same style; None for what is no whole piece."""
        wanted = parsed(name)
        if wanted is None or wanted.part:
            return None
        return PieceName(wanted.family, wanted.style, seed).whole

    def load(self, name: str) -> Asset:
        """Make a piece, or a part of one that opens.

        Raises
        ------
        UnknownName
            If there is none of that name.
        AssetError
            If the family gives none for that seed.
        """
        problem = _problem(name)
        if problem is not None:
            raise problem
        wanted = parsed(name)
        assert wanted is not None
        whole = _piece(PieceName(wanted.family, wanted.style, wanted.seed))
        if not wanted.part:
            return whole
        return next(one.asset for one in whole.moving if one.name == wanted.part)


@lru_cache(maxsize=4096)
def _problem(name: str) -> UnknownName | None:
    wanted = parsed(name)
    if wanted is None:
        return UnknownName("asset", name, (), also=f"{FORM} with a seed from 0 to 2147483647")
    if wanted.family not in family_names():
        return UnknownName("family of pieces", wanted.family, family_names())
    styles = family_styles(wanted.family)
    if wanted.style not in styles:
        return UnknownName(f"style of {wanted.family!r}", wanted.style, styles)
    if wanted.part:
        whole = _piece(PieceName(wanted.family, wanted.style, wanted.seed))
        names = [part.name for part in whole.moving]
        if wanted.part not in names:
            return UnknownName(f"moving part of {wanted.whole!r}", wanted.part, names)
    return None


def _piece(name: PieceName) -> Asset:
    return _made.get(name, partial(_kept, name))


def _kept(name: PieceName) -> Asset:
    def make() -> Asset:
        # Not before a piece is made: families load scipy, which takes half a second.
        from sailenv_content.families.making import make_piece

        return make_piece(family_named(name.family), name).asset

    return cached_object("piece", [name.whole], make, code=making_code(), shared=_TEXTURES)
