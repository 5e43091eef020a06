"""A retina: fine in the middle, coarse around, as rings and wedges whose radii grow by a factor.

Log-polar sampling (Schwartz, "Spatial mapping in the primate sensory projection", Biological
Cybernetics 25, 1977): ring k is at the radius a·bᵏ. Pictures are averaged over each cell, so that
nothing aliases; of labels and depth a cell has that of the pixel at its middle.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.types.validation import Bounds

__all__ = ["Retina"]

RINGS = Bounds(least=2, most=1024, whole=True)
WEDGES = Bounds(least=4, most=1024, whole=True)

INNERMOST_PX = 0.75
"""Outer radius of the innermost ring [px]."""


class Retina:
    """Cells of a retina in a picture.

    Parameters
    ----------
    width, height : int
        Of the picture [px].
    rings, wedges : int
        At least 2 and 4. Ring 0 is innermost and reaches the nearest side of the picture at the
        last; wedge 0 begins on the right, and they follow clockwise.

    Raises
    ------
    InvalidRequest
        If there are too few or too many.
    """

    def __init__(self, width: int, height: int, rings: int, wedges: int) -> None:
        self.rings = RINGS.integer("rings", rings)
        self.wedges = WEDGES.integer("wedges", wedges)
        centre_x, centre_y = (width - 1) / 2.0, (height - 1) / 2.0
        outermost = min(width, height) / 2.0
        growth = max(outermost / INNERMOST_PX, 1.0 + 1e-9) ** (1.0 / (self.rings - 1))
        # The pixel at the middle of each cell.
        radius = INNERMOST_PX * growth ** (np.arange(self.rings) - 0.5)
        angle = 2.0 * np.pi * (np.arange(self.wedges) + 0.5) / self.wedges
        u = np.rint(centre_x + radius[:, None] * np.cos(angle)).astype(np.intp)
        v = np.rint(centre_y + radius[:, None] * np.sin(angle)).astype(np.intp)
        u, v = np.clip(u, 0, width - 1), np.clip(v, 0, height - 1)
        self._middles = (v * width + u).reshape(-1)
        # The cell of each pixel; those beyond the outermost ring are in none.
        x, y = np.arange(width) - centre_x, np.arange(height)[:, None] - centre_y
        far = np.hypot(x, y)
        with np.errstate(divide="ignore"):
            ring = np.ceil(np.log(far / INNERMOST_PX) / np.log(growth))
        ring = np.clip(np.nan_to_num(ring, neginf=0.0), 0, None).astype(np.intp)
        turn = np.mod(np.arctan2(y, x) / (2.0 * np.pi), 1.0)
        wedge = np.minimum((turn * self.wedges).astype(np.intp), self.wedges - 1)
        cell = (ring * self.wedges + wedge).reshape(-1)
        inside = np.flatnonzero(ring.reshape(-1) < self.rings)
        order = inside[np.argsort(cell[inside], kind="stable")]
        self._order = order
        self._cells, self._starts, self._counts = np.unique(
            cell[order], return_index=True, return_counts=True
        )

    def sample(self, view: NDArray[Any], *, mean: bool) -> NDArray[Any]:
        """Return (rings, wedges, …) of a view (H, W, …), of the same dtype.

        Parameters
        ----------
        view : (H, W) or (H, W, C) array
        mean : bool
            True averages each cell, rounded to nearest; False takes the pixel at its middle, as
            cells without a pixel of their own do in any case.
        """
        flat = view.reshape(view.shape[0] * view.shape[1], *view.shape[2:])
        cells = flat[self._middles]
        if mean:
            sums = np.add.reduceat(flat[self._order].astype(np.int64), self._starts)
            counts = self._counts.reshape(-1, *[1] * (flat.ndim - 1))
            cells[self._cells] = (2 * sums + counts) // (2 * counts)
        return np.asarray(cells.reshape(self.rings, self.wedges, *view.shape[2:]))
