"""The recent scene announcements of a simulator, by their revision; the newest among them.

`SceneInfo`s in, in the order in which they were announced. Used by one thread at a time.
"""

from __future__ import annotations

from sailenv_ros.types.scene_info import SceneInfo

__all__ = ["DEPTH", "SceneHistory"]

DEPTH = 64
"""Announcements that are kept; a frame that arrives is of the last or of one shortly before."""


class SceneHistory:
    """The last `DEPTH` announcements of one simulator."""

    def __init__(self) -> None:
        self._infos: dict[int, SceneInfo] = {}
        self.latest: SceneInfo | None = None

    def add(self, info: SceneInfo) -> None:
        """Take the next announcement."""
        if self.latest is not None and info.revision < self.latest.revision:
            self._infos.clear()  # another simulator has begun, which counts anew
        self._infos[info.revision] = self.latest = info
        while len(self._infos) > DEPTH:
            del self._infos[next(iter(self._infos))]

    def of_revision(self, revision: int) -> SceneInfo | None:
        """Return the announcement of exactly that revision, if it came and is still kept."""
        return self._infos.get(revision)
