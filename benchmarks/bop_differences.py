"""Says of each pixel about which bop_toolkit's masks and ours differ by which rule it does.

bop_toolkit draws an object by OpenGL and calls a pixel of it visible if the scene is no more than a
tolerance in front of it. Two rules follow, and nothing else tells its shares from exact ones:

- *edge*: OpenGL snaps corners to a grid of 1/256 px (`GL_SUBPIXEL_BITS` = 8), so a pixel
  whose centre lies so near an edge of the projected mesh may fall on its other side;
- *tolerance*: what lies in front of an object by less than the tolerance does not hide it.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

__all__ = ["Differences", "edge_distances", "project"]

Floats = NDArray[np.float64]

NEAR_EDGE_PX = 1.0 / 32.0
"""Corners are snapped by half of 1/256 px along each axis; single precision adds to that where they
lie far beside the canvas. Most pixels lie within 0.008 px, the farthest of 30 pictures at 0.029."""

DEPTH_STEP_MM = 0.2
"""Of stored depth: it is rounded by half of that."""


@dataclass
class Differences:
    """Counts of pixels that differ, by the rule.

    Attributes
    ----------
    edge, tolerance, neither : int
        Of visible pixels, in the picture.
    outside : int
        Pixels of whole objects beside the picture, of which counts alone are stored.
    farthest : float
        Of those near an edge, how far the farthest is [px].
    others : list of (float, float)
        Of pixels of neither rule: how far from an edge [px], how far behind the scene [mm].
    worst : list of (float, int, int, int, int)
        Difference of each object's share, its pixels, and how many of each rule.
    """

    edge: int = 0
    tolerance: int = 0
    neither: int = 0
    outside: int = 0
    farthest: float = 0.0
    others: list[tuple[float, float]] = field(default_factory=list)
    worst: list[tuple[float, int, int, int, int]] = field(default_factory=list)

    def add(
        self,
        *,
        share: float,
        stored_visible: NDArray[np.bool_],
        visible: NDArray[np.bool_],
        stored_mask: NDArray[np.bool_],
        own: Floats,
        seen: Floats,
        tolerance_mm: float,
        edges: Floats,
        whole: tuple[int, int],
    ) -> None:
        """Take one object of one picture.

        Parameters
        ----------
        share : float
            By which the visible shares differ.
        stored_visible, stored_mask : (H, W) bool
            Ours.
        visible : (H, W) bool
            bop_toolkit's.
        own, seen : (H, W) float
            bop_toolkit's distance of the object alone, ours of the scene [mm].
        edges : (E, 2, 2) float
            Of the mesh in the picture [px].
        whole : (int, int)
            Pixels of the whole object, bop_toolkit's and ours.
        """
        drawn = own > 0
        rows, columns = np.nonzero((visible != stored_visible) | (drawn != stored_mask))
        centres = np.stack([columns, rows], axis=-1).astype(float)
        distances = edge_distances(centres, edges)
        near_edge = distances <= NEAR_EDGE_PX
        self.farthest = max(self.farthest, float(distances[near_edge].max(initial=0.0)))
        behind = own[rows, columns] - seen[rows, columns]
        inside = drawn[rows, columns] & stored_mask[rows, columns]
        by_tolerance = inside & (behind <= tolerance_mm + DEPTH_STEP_MM) & visible[rows, columns]
        counts = (
            int((near_edge & ~by_tolerance).sum()),
            int(by_tolerance.sum()),
            int((~near_edge & ~by_tolerance).sum()),
        )
        for place in np.flatnonzero(~near_edge & ~by_tolerance):
            self.others.append((float(distances[place]), float(behind[place])))
        self.edge += counts[0]
        self.tolerance += counts[1]
        self.neither += counts[2]
        self.outside += abs((whole[0] - int(drawn.sum())) - (whole[1] - int(stored_mask.sum())))
        self.worst.append((share, whole[1], *counts))

    def told(self, tolerance_mm: float) -> str:
        """Return a sentence, and the worst objects."""
        over = sorted((w for w in self.worst if w[0] > 0.005), reverse=True)
        lines = [
            f"pixels that differ with {tolerance_mm} mm: {self.edge} within "
            f"{self.farthest:.4f} px of an edge, {self.tolerance} with something less than the "
            f"tolerance in front, {self.neither} by neither; beside the pictures {self.outside}",
            *(
                f"  by neither: {px:.4f} px from an edge, {mm:.2f} mm behind the scene"
                for px, mm in self.others
            ),
            f"{len(over)} of {len(self.worst)} objects differ by more than 0.005",
        ]
        lines += [
            f"  share {share:.4f} of {pixels} px: {edge} edge, {tolerance} tolerance, {rest} other"
            for share, pixels, edge, tolerance, rest in over[:8]
        ]
        return "\n".join(lines)


def project(points: Floats, rotation: Floats, shift: Floats, k: Floats) -> Floats:
    """Return (N, 2) pixels of points [mm]; NaN behind the camera."""
    optical = points @ rotation.T + shift.reshape(1, 3)
    depth = np.where(optical[:, 2] > 0.0, optical[:, 2], np.nan)
    return np.asarray((optical @ k.T)[:, :2] / depth[:, None], np.float64)


def edge_distances(centres: Floats, edges: Floats) -> Floats:
    """Return (P,) how far each point (P, 2) is from the nearest of edges (E, 2, 2) [px]."""
    start, along = edges[:, 0], edges[:, 1] - edges[:, 0]
    length = np.maximum((along**2).sum(axis=1), 1e-18)
    found = np.empty(len(centres))
    for number, centre in enumerate(centres):
        offset = centre - start
        at = np.clip((offset * along).sum(axis=1) / length, 0.0, 1.0)
        found[number] = np.nanmin(np.linalg.norm(offset - at[:, None] * along, axis=1))
    return found
