"""Makes a scene ready for its first move, on a thread beside the frames."""

from __future__ import annotations

import threading
from concurrent.futures import CancelledError, Executor

from sailenv_ros.light.relight.baked_scene import BakedScene
from sailenv_ros.light.relight.baked_scene_store import BakedSceneStore
from sailenv_ros.light.relight.object_lights import ObjectLights
from sailenv_ros.light.relight.shown_shadows import ShownShadows
from sailenv_ros.types.snapshot import SceneContents, WorldSnapshot

__all__ = ["Preparation"]


class Preparation:
    """A scene made ready, with light and shadows of what can move.

    Parameters
    ----------
    pool : Executor
        Does it.
    scenes : BakedSceneStore
    contents : SceneContents
        With the light that was baked.
    snapshot : WorldSnapshot
    objects : ObjectLights
        They are updated; used by nobody else until `done`.
    """

    def __init__(
        self,
        pool: Executor,
        scenes: BakedSceneStore,
        contents: SceneContents,
        snapshot: WorldSnapshot,
        objects: ObjectLights,
    ) -> None:
        self._abandoned = threading.Event()
        self._future = pool.submit(self._prepared, scenes, contents, snapshot, objects)

    def done(self) -> bool:
        """Return whether nobody would wait for the result."""
        return self._future.done()

    def result(self, timeout_s: float | None = None) -> tuple[BakedScene, ShownShadows]:
        """Wait for what was made.

        Parameters
        ----------
        timeout_s : float or None
            For how long [s]; None waits until it is there.

        Raises
        ------
        CancelledError
            If it was abandoned before.
        TimeoutError
            If it is not there in time.
        """
        return self._future.result(timeout_s)

    def abandon(self) -> None:
        """Let it end after its present step; what has been found is kept on disk."""
        self._abandoned.set()
        self._future.cancel()

    def _prepared(
        self,
        scenes: BakedSceneStore,
        contents: SceneContents,
        snapshot: WorldSnapshot,
        objects: ObjectLights,
    ) -> tuple[BakedScene, ShownShadows]:
        scene = scenes.scene_of(contents, 1)
        self._go_on()
        objects.update(snapshot, scene, (), threads=1)
        self._go_on()
        shadows = ShownShadows(scene, objects.points)
        rest = [thing for thing in objects.things if not thing.moves]
        shadows.on(scene.baked, rest, (), threads=1)
        return scene, shadows

    def _go_on(self) -> None:
        if self._abandoned.is_set():
            raise CancelledError
