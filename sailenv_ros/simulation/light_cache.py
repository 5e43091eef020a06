"""Loads baked light into worlds, where it has been baked already. From `World` to `World`.

Never bakes: a simulator that runs must not be held up for minutes.
"""

from __future__ import annotations

import logging
from concurrent.futures import Future, ThreadPoolExecutor

from sailenv_ros.errors import InvalidState
from sailenv_ros.light.bake.fingerprint import fingerprint
from sailenv_ros.light.bake.light_files import load_baked, load_draft, remembered
from sailenv_ros.simulation.room_exposure import take_light
from sailenv_ros.types.baked_light import BakedLight
from sailenv_ros.world.world import World

__all__ = ["BAKE_COMMAND", "LightCache"]

BAKE_COMMAND = "sailenv scene bake"

_log = logging.getLogger(__name__)


class LightCache:
    """Finds the light that is baked already; keeps the last, so that a reset loads nothing.

    Parameters
    ----------
    wanted : bool
        False loads none.
    drafts : bool
        False loads no draft: what is rendered must not depend on how far a bake is.
    required : bool
        True refuses worlds whose light is not baked.
    """

    def __init__(self, *, wanted: bool = True, drafts: bool = True, required: bool = False) -> None:
        self._wanted = wanted
        self._drafts = drafts
        self._required = required
        self._last: BakedLight | None = None
        self._is_draft = False
        self._prefetched: tuple[str, str, Future[BakedLight | None]] | None = None
        self._misleading: set[str] = set()

    def is_final(self, world: World) -> bool:
        """Return whether a world has light that no bake will replace."""
        baked = world.contents.baked
        if baked is None:
            return False
        return not (self._is_draft and self._last is not None and baked.layers is self._last.layers)

    def prefetch(self, stamp: str) -> None:
        """Read beside its caller the light that a scene file had, while its world is built.

        Parameters
        ----------
        stamp : str
            As `light_files.remember` was told it.
        """
        self._prefetched = None
        if not self._wanted or stamp in self._misleading:
            return
        name = remembered(stamp)
        if name is None or (self._last is not None and self._last.fingerprint == name):
            return
        reading = ThreadPoolExecutor(1, "light")
        self._prefetched = stamp, name, reading.submit(load_baked, name)
        reading.shutdown(wait=False)

    def apply(self, world: World, scene: str) -> None:
        """Load a world's baked light, the draft if that is all there is, or say how to bake it.

        Parameters
        ----------
        world : World
            Just built.
        scene : str
            The name or file by which a user asks for it.

        Raises
        ------
        InvalidState
            If light is required, and not baked.
        """
        if not self._wanted:
            return
        name = fingerprint(world.snapshot())
        prefetched, self._prefetched = self._prefetched, None
        if prefetched is not None and prefetched[1] != name:
            # What is random in a scene may decide on its light: nothing is read in vain again.
            self._misleading.add(prefetched[0])
            prefetched = None
        if self._last is None or self._last.fingerprint != name or self._is_draft:
            before, self._is_draft = self._last, False
            self._last = load_baked(name) if prefetched is None else prefetched[2].result()
            draft = load_draft(name) if self._drafts and self._last is None else None
            if draft is not None:
                self._last, self._is_draft = draft, True
            elif self._last is None and before is not None and before.fingerprint == name:
                self._last, self._is_draft = before, True
        if self._last is not None:
            take_light(world, self._last)
            return
        if self._required:
            raise InvalidState(
                f"the light of scene {scene} is not baked; bake it with: {BAKE_COMMAND} {scene}"
            )
        _log.info(
            "the light of scene %s is not baked yet and is worked out from frame to frame; "
            "for bounced light and soft shadows: %s %s",
            scene,
            BAKE_COMMAND,
            scene,
        )
