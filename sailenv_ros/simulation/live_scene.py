"""The scene that is simulated now, as editors, lessons and chance change it.

Knows neither operations nor frames nor threads.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from sailenv_ros.simulation.agent_table import AgentTable
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.world.bullet import STEPS_PER_SECOND
from sailenv_ros.world.world import World

__all__ = ["LiveScene", "SceneAnnouncer"]


class SceneAnnouncer:
    """Announces changes of a scene; several of them at once where that is wanted.

    Parameters
    ----------
    tell : callable
        Announces the scene as it is now.
    """

    def __init__(self, tell: Callable[[], None]) -> None:
        self._tell = tell
        self._holds = False
        self._is_due = False

    def __call__(self) -> None:
        """Announce the scene as it is now."""
        if self._holds:
            self._is_due = True
        else:
            self._tell()

    @contextmanager
    def once(self) -> Iterator[None]:
        """Announce the scene once after several changes, if there were any."""
        if self._holds:
            yield
            return
        self._holds, self._is_due = True, False
        try:
            yield
        finally:
            self._holds = False
            if self._is_due:
                self._tell()

    @contextmanager
    def silent(self) -> Iterator[None]:
        """Announce nothing of what is changed meanwhile."""
        self._holds = True
        try:
            yield
        finally:
            self._holds = False


@dataclass(slots=True, kw_only=True)
class LiveScene:
    """World and agents of one simulation, with where they come from.

    Attributes
    ----------
    library : SceneLibrary
    agents : AgentTable
    announce : SceneAnnouncer
        Called after each change that clients shall know.
    world : World
        The present one; another one from each change of scene and each reset on.
    seed : int
        Of the present world's random numbers.
    """

    library: SceneLibrary
    agents: AgentTable
    announce: SceneAnnouncer
    world: World
    seed: int

    @property
    def now_s(self) -> float:
        """Simulated time [s]."""
        return self.world.step_count / STEPS_PER_SECOND

    @property
    def agent_specs(self) -> dict[str, AgentSpec]:
        """The agents by name, those too that the scene brings and that come right after.

        Without the cameras of rigs, which go where their agents go.
        """
        specs = (*self.library.agents_of(self.world.scene), *self.agents.specs)
        return {spec.name: spec for spec in specs if not spec.body}
