"""Changes of light at single texels, as rays found them, and how long that holds.

Knows neither rays nor light maps.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.light.relight.shadow_maps import PointChanges

__all__ = ["TexelChanges"]


class TexelChanges(NamedTuple):
    """Changes of light at texels.

    Attributes
    ----------
    texels : (K,) intp
        Their numbers in the scene, in ascending order.
    rays : (K,) int32
        How many rays looked.
    outdated : (K,) bool
        Where something has moved since that rays may meet.
    found : PointChanges
    """

    texels: NDArray[np.intp]
    rays: NDArray[np.int32]
    outdated: NDArray[np.bool_]
    found: PointChanges

    @classmethod
    def of(cls, arrays: Mapping[str, NDArray[Any]]) -> TexelChanges:
        """Return those that are kept in arrays."""
        texels, rays, outdated = (arrays[name] for name in cls._fields[:3])
        return cls(texels, rays, outdated, PointChanges.of(arrays, "texel"))

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Return arrays to keep them in."""
        return {**dict(zip(self._fields[:3], self[:3], strict=True)), **self.found.arrays("texel")}

    @classmethod
    def fresh(cls, texels: NDArray[np.intp], rays: int, found: PointChanges) -> TexelChanges:
        """Return what so many rays have just found."""
        count = len(texels)
        return cls(texels, np.full(count, rays, np.int32), np.zeros(count, bool), found)

    def after(self, reached: NDArray[np.bool_]) -> TexelChanges:
        """Return the same after something has moved that reaches (K,) bool of them."""
        return self._replace(outdated=self.outdated | reached)

    def known(self, texels: NDArray[np.intp], rays: int) -> tuple[NDArray[np.bool_], PointChanges]:
        """Return what so many rays would find at texels.

        Returns
        -------
        known : (N,) bool
            Of which texels it is known.
        found : PointChanges
            Of these.
        """
        at = np.searchsorted(self.texels, texels)
        known = at < len(self.texels)
        at = at[known]
        same = (self.texels[at] == texels[known]) & (self.rays[at] == rays) & ~self.outdated[at]
        known[known] = same
        return known, self.found.at(at[same])

    def replaced(self, kept: NDArray[np.bool_], others: Sequence[TexelChanges]) -> TexelChanges:
        """Return those of the (K,) bool texels that are kept, and of others."""
        texels, rays, outdated = (
            np.concatenate([own[kept], *added])
            for own, *added in zip(self[:3], *(one[:3] for one in others), strict=True)
        )
        order = np.argsort(texels)
        found = self.found.replaced(kept, [one.found for one in others], order)
        return TexelChanges(texels[order], rays[order], outdated[order], found)
