"""Whatever handlers share: the simulation, its state as the standard counts it, and names."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import ParamSpec, TypeVar

from simulation_interfaces.msg import Result, SimulationState

from sailenv_ros.ros.nodes.requests import OperationRunner
from sailenv_ros.ros.nodes.simulation_interfaces.results import Refusal
from sailenv_ros.simulation import Simulation
from sailenv_ros.simulation.operations import Operation
from sailenv_ros.types.entities import AssetOutline, Entity, NamedPose
from sailenv_ros.types.robots import first_links, link_of_asset
from sailenv_ros.types.scene_info import SceneInfo

__all__ = ["Desk", "Told"]

P = ParamSpec("P")
R = TypeVar("R")


@dataclass(frozen=True, slots=True)
class Told:
    """Information about an entity that a client has set: category, description, tags."""

    category: int
    description: str
    tags: tuple[str, ...]


@dataclass(slots=True)
class _OfEpoch:
    """Notes that end with a life of the scene."""

    epoch: int = 0
    names: dict[int, str] = field(default_factory=dict)
    told: dict[int, Told] = field(default_factory=dict)
    named_poses: tuple[NamedPose, ...] | None = None
    stopped: bool = False
    unloaded: bool = False


class Desk:
    """The simulation as handlers see it; used in one executor's thread.

    Parameters
    ----------
    simulation : Simulation
    runner : OperationRunner
        Of the executor that the handlers are in.
    quit_soon : callable
        Ends the process once the present answer was sent.

    Attributes
    ----------
    loading : int
        Number of worlds that are being loaded.
    outlines : dict of str to AssetOutline
        Those of the catalogue that were looked at.
    """

    def __init__(
        self, simulation: Simulation, runner: OperationRunner, quit_soon: Callable[[], object]
    ) -> None:
        self._simulation = simulation
        self._runner = runner
        self.quit_soon = quit_soon
        self.loading = 0
        self.outlines: dict[str, AssetOutline] = {}
        self._notes = _OfEpoch()

    @property
    def info(self) -> SceneInfo:
        """The scene as it was announced last."""
        return self._simulation.info

    @property
    def notes(self) -> _OfEpoch:
        """Notes about the present life of the scene."""
        epoch = self.info.epoch
        if epoch != self._notes.epoch:
            self._notes = _OfEpoch(epoch)
        return self._notes

    async def do(self, operation: Operation[P, R], /, *args: P.args, **kwargs: P.kwargs) -> R:
        """Carry out an operation."""
        return await self._runner.settled(self._runner.submit(operation, *args, **kwargs))

    # -- state -----------------------------------------------------------------------------

    @property
    def lockstep(self) -> bool:
        """True if time moves by steps alone."""
        return self.info.mode == "lockstep"

    @property
    def state(self) -> int:
        """The state as `SimulationState` counts it."""
        if self.loading:
            return int(SimulationState.STATE_LOADING_WORLD)
        if self.notes.unloaded:
            return int(SimulationState.STATE_NO_WORLD)
        if not self.lockstep and not self.info.paused:
            return int(SimulationState.STATE_PLAYING)
        if self.notes.stopped and self._simulation.sim_time_ns == 0:
            return int(SimulationState.STATE_STOPPED)
        return int(SimulationState.STATE_PAUSED)

    def require_world(self) -> None:
        """Refuse what needs a world while there is none.

        Raises
        ------
        Refusal
        """
        if self.state == SimulationState.STATE_LOADING_WORLD:
            raise Refusal(Result.RESULT_INCORRECT_STATE, "a world is being loaded; wait for it")
        if self.state == SimulationState.STATE_NO_WORLD:
            raise Refusal(Result.RESULT_INCORRECT_STATE, "no world is loaded; call load_world")

    # -- names -----------------------------------------------------------------------------

    def name_of(self, entity: Entity) -> str:
        """Return the name of an entity with its namespace."""
        return self.notes.names.get(entity.id, entity.name)

    @property
    def ids(self) -> Mapping[str, int]:
        """Ids of all entities by their names with namespaces; see `Entity.id`."""
        names, instances = self.notes.names, self.info.instances
        objects = {one.id: one.name for one in instances if not one.is_part}
        robots = {-number: name for name, number in first_links(instances).items()}
        return {names.get(number, name): number for number, name in (objects | robots).items()}

    def rename(self, number: int, plain: str, name: str) -> None:
        """Take note of the name with its namespace of what the scene calls otherwise."""
        names = self.notes.names
        names[number] = name
        if number < 0:
            for one in self.info.instances:
                link = link_of_asset(one.asset)
                if link and one.name == f"{plain} {link}":
                    names[one.id] = f"{name} {link}"

    @property
    def plain_names(self) -> frozenset[str]:
        """Names that the scene has for objects and robots."""
        instances = self.info.instances
        return frozenset((*(one.name for one in instances), *first_links(instances)))

    def find(self, name: str) -> int:
        """Return the id of an entity.

        Raises
        ------
        Refusal
            If there is none of that name.
        """
        number = self.ids.get(name)
        if number is None:
            raise Refusal(Result.RESULT_NOT_FOUND, f"there is no entity {name!r}; see get_entities")
        return number
