"""Findings: what people should know of a data set and cannot see in its files, by scene.

Frames that are dark or clipped, and choices of objects that met none in a scene. They are counted
while shards are made, and the card tells them.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping

import cv2

from sailenv_ros.frame.frame import Frame

__all__ = ["CLIPPED", "DARK", "Findings", "brightness_fault", "finding_lines"]

DARK_MEDIAN = 64
"""A frame is dark if half of its pixels have less luma than this, of 255."""

BRIGHT_MEDIAN = 224
"""A frame is clipped if half of its pixels have more luma than this."""

CLIPPED_LUMA = 250
CLIPPED_SHARE = 0.05
"""It is clipped, too, if this share of its pixels has at least that luma."""

DARK = f"dark frames (half of the pixels have a luma below {DARK_MEDIAN} of 255)"
CLIPPED = (
    f"clipped frames (half of the pixels have a luma above {BRIGHT_MEDIAN}, or "
    f"{CLIPPED_SHARE:.0%} one of {CLIPPED_LUMA} or more)"
)

MOST_SCENES = 12
"""Scenes that are named for one finding; of others only the number is told."""


class Findings:
    """Counts of what was found.

    Attributes
    ----------
    counts : mapping of str to Counter of str
        Of each finding: how often in which scene.
    """

    def __init__(self) -> None:
        self.counts: dict[str, Counter[str]] = {}

    def add(self, finding: str, scene: object) -> None:
        """Count a finding in a scene."""
        self.counts.setdefault(finding, Counter())[str(scene)] += 1

    def look_at(self, frame: Frame, scene: object) -> None:
        """Count a frame that is dark or clipped; one without a picture is neither."""
        fault = brightness_fault(frame)
        if fault:
            self.add(fault, scene)

    def plain(self) -> dict[str, dict[str, int]]:
        """Return the counts as JSON holds them, sorted."""
        return {what: dict(sorted(self.counts[what].items())) for what in sorted(self.counts)}


def brightness_fault(frame: Frame) -> str:
    """Return `DARK`, `CLIPPED` or an empty text, by the histogram of the picture's luma."""
    if "rgb" not in frame.views:
        return ""
    luma = cv2.cvtColor(frame["rgb"], cv2.COLOR_RGB2GRAY)
    counts = cv2.calcHist([luma], [0], None, [256], [0, 256]).ravel()
    half = 0.5 * luma.size
    if counts[:DARK_MEDIAN].sum() > half:
        return DARK
    clipped = counts[CLIPPED_LUMA:].sum() >= CLIPPED_SHARE * luma.size
    return CLIPPED if clipped or counts[BRIGHT_MEDIAN + 1 :].sum() > half else ""


def finding_lines(findings: Iterable[Mapping[str, Mapping[str, int]]]) -> Iterator[str]:
    """Yield a line of Markdown for each finding of some shards, with its number and its scenes."""
    total: dict[str, Counter[str]] = {}
    for part in findings:
        for what, scenes in part.items():
            total.setdefault(what, Counter()).update(scenes)
    for what, counts in sorted(total.items()):
        named = sorted(counts.items(), key=lambda pair: (-pair[1], pair[0]))
        told = ", ".join(f"{scene} ({count})" for scene, count in named[:MOST_SCENES])
        more = len(named) - MOST_SCENES
        rest = f" and {more} more scenes" if more > 0 else ""
        yield f"- **{what}**: {sum(counts.values())}, in {told}{rest}"
