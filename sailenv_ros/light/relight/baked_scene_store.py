"""The last scene that was made ready for relighting, for who shows it again.

A data set's shards, environments of one room and resets show the same room with the same light
many times; to lay out its texels takes most of a second. Knows no change.
"""

from __future__ import annotations

import copy
import threading
from typing import TypeAlias

import numpy as np

from sailenv_ros.light.bake.sky_picture import sky_picture
from sailenv_ros.light.relight.baked_scene import BakedScene
from sailenv_ros.light.relight.found_light import FoundLight
from sailenv_ros.types.model import Model
from sailenv_ros.types.snapshot import SceneContents

__all__ = ["BakedSceneStore"]

_Drawn: TypeAlias = tuple[int, Model, tuple[float, ...], tuple[str, ...]]


class BakedSceneStore:
    """Keeps one scene; any thread may ask."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._kept: tuple[tuple[_Drawn, ...], BakedScene] | None = None

    def scene_of(self, contents: SceneContents, threads: int) -> BakedScene:
        """Return a scene whose light is baked; made, or the last one if that is the same.

        Parameters
        ----------
        contents : SceneContents
            With baked light.
        threads : int
            The scene does not depend on it.
        """
        baked = contents.baked
        assert baked is not None
        kept = self._known(contents)
        if kept is not None:
            # The same but for what is seen where nothing is hit.
            scene = copy.copy(kept)
            scene.baked = baked
            scene.sky = np.ascontiguousarray(sky_picture(contents.environment), np.float32)
            if not np.array_equal(scene.sky, kept.sky):
                scene.found = FoundLight()
            return scene
        scene = BakedScene(baked, contents, threads)
        with self._lock:
            self._kept = _drawn(contents), scene
        return scene

    def forget_others(self, contents: SceneContents) -> None:
        """Free the scene that is kept, with all its models, if another one is shown now."""
        if self._known(contents) is None:
            with self._lock:
                self._kept = None

    def _known(self, contents: SceneContents) -> BakedScene | None:
        """Return the scene that is kept, if it is that of these contents."""
        with self._lock:
            kept, baked = self._kept, contents.baked
        if kept is None or baked is None:
            return None
        before = kept[1].baked
        same = before.layers is baked.layers and before.charts is baked.charts
        return kept[1] if same and kept[0] == _drawn(contents) else None


def _drawn(contents: SceneContents) -> tuple[_Drawn, ...]:
    """Return what has baked light, in which models are compared by identity."""
    charts = {} if contents.baked is None else contents.baked.charts
    return tuple(
        (one.instance.id, one.model, one.scale, one.lit_by)
        for one in contents.instances
        if one.instance.id in charts
    )
