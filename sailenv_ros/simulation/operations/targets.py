"""Protocols of the simulation that operations need.

Each operation names the narrowest of these that it can do with; `OperationTarget` is all of them.
None knows who has it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from sailenv_ros.authoring.viewpoints import ViewScene
    from sailenv_ros.frame.frame import Frame
    from sailenv_ros.frame.truth.amodal_masks import AmodalMasks
    from sailenv_ros.simulation.agent_record import AgentRecord
    from sailenv_ros.simulation.agent_table import AgentTable
    from sailenv_ros.simulation.clock import Clock
    from sailenv_ros.simulation.editing.editor import SceneEditor
    from sailenv_ros.simulation.editing.scene_writer import SceneWriter
    from sailenv_ros.simulation.scenes import SceneLibrary
    from sailenv_ros.simulation.script.orchestrator import Orchestrator
    from sailenv_ros.simulation.script.randomiser import RandomisationRequest, Randomiser
    from sailenv_ros.simulation.script.scenario import SceneOverlay
    from sailenv_ros.simulation.space_queries import SpaceQueries
    from sailenv_ros.space import FreeSpace
    from sailenv_ros.types.camera import Camera, CameraIntrinsics
    from sailenv_ros.types.snapshot import WorldSnapshot
    from sailenv_ros.world.world import World

__all__ = [
    "BeginsScenes",
    "DrawsFrames",
    "HasAgents",
    "HasClock",
    "HasEditor",
    "HasLessons",
    "HasLibrary",
    "HasSceneWriter",
    "HasSpace",
    "HasWorld",
    "OperationTarget",
    "RunsTime",
    "Senses",
    "ViewsScene",
]


class HasWorld(Protocol):
    """A world, whose changes are announced."""

    @property
    def world(self) -> World:
        """The present world."""

    def announce(self) -> None:
        """Announce the scene as it is now."""


class HasAgents(HasWorld, Protocol):
    """Agents in a world."""

    @property
    def agents(self) -> AgentTable:
        """The agents of all scenes."""


class HasLibrary(HasWorld, Protocol):
    """Scenes and assets."""

    @property
    def library(self) -> SceneLibrary:
        """Where scenes and assets come from."""


class HasEditor(HasLibrary, Protocol):
    """Changes by the keys of a scene file."""

    editor: SceneEditor


class HasClock(HasWorld, Protocol):
    """The pace of simulated time."""

    clock: Clock


class RunsTime(HasClock, Protocol):
    """Simulated time that can be advanced."""

    def advance_to(self, step: int, *, every_frame: bool) -> None:
        """Run physics up to a step and render what falls due on the way."""


class BeginsScenes(HasWorld, Protocol):
    """Scenes that can begin again."""

    epoch: int
    additions: SceneOverlay
    randomiser: Randomiser

    @property
    def seed(self) -> int:
        """Seed of the present world's random numbers."""

    def begin(
        self,
        scene: str,
        seed: int,
        *,
        as_registered: bool,
        more: SceneOverlay = ...,
        chance: RandomisationRequest | None = None,
    ) -> None:
        """Leave the present world for a new one at simulated time 0."""

    def begin_scenario(self, scenario: str | Mapping[str, Any]) -> tuple[int, ...]:
        """Begin a scene with more objects than its own; return their instance ids."""

    def randomise_now(
        self, seed: int | None, index: int | None, things: object, record: object
    ) -> dict[str, Any]:
        """Begin the scene again with drawn values; return the record of them."""


class HasLessons(Protocol):
    """Objects that come and go."""

    orchestrator: Orchestrator


class DrawsFrames(HasAgents, Protocol):
    """Frames of agents."""

    def render(self, record: AgentRecord, views: Iterable[str]) -> Frame:
        """Render one frame of an agent now."""

    def render_all(self, wanted: Sequence[tuple[AgentRecord, Iterable[str]]]) -> list[Frame]:
        """Render one frame of each of some agents now."""

    def draw_amodal(self, snapshot: WorldSnapshot, camera: Camera, only: int = 0) -> AmodalMasks:
        """Draw each object of a snapshot alone."""


class HasSpace(Protocol):
    """Free space and rays."""

    space: SpaceQueries
    on_free_space: Callable[[FreeSpace], None]

    @property
    def seed(self) -> int:
        """Seed of the present world's random numbers."""


class Senses(HasSpace, HasWorld, Protocol):
    """Sensors in a world that rays look into."""


class ViewsScene(HasAgents, Protocol):
    """The scene as rules of cameras see it."""

    @property
    def seed(self) -> int:
        """Seed of the present world's random numbers."""

    def view_scene(self, lens: CameraIntrinsics) -> ViewScene:
        """Return the scene as it stands now, for rules of cameras."""


class HasSceneWriter(HasWorld, Protocol):
    """Scene files of the present world."""

    scene_writer: SceneWriter


class OperationTarget(
    HasEditor,
    RunsTime,
    BeginsScenes,
    HasLessons,
    DrawsFrames,
    HasSpace,
    ViewsScene,
    HasSceneWriter,
    Protocol,
):
    """All that operations need."""
