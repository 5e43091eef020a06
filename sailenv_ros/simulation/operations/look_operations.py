"""Operations by which agents and movers keep looking at something."""

from __future__ import annotations

from typing import TYPE_CHECKING

from numpy.typing import ArrayLike

from sailenv_ros.errors import UnknownName
from sailenv_ros.simulation.operations import argument_checks as check
from sailenv_ros.simulation.operations.operation import Caller, operation
from sailenv_ros.simulation.operations.targets import HasAgents, HasWorld
from sailenv_ros.types.geometry import POSITION_LIMIT_M
from sailenv_ros.types.look_at import LookAt
from sailenv_ros.types.validation import vector

if TYPE_CHECKING:
    from sailenv_ros.world.look_at_solver import LookAtSolver

__all__ = ["LookOperations"]


def _point(what: str, value: ArrayLike) -> tuple[float, float, float]:
    return vector(what, value, limit=POSITION_LIMIT_M)


def _gaze(core: HasWorld, obj: int | str | None, point_m: ArrayLike | None) -> LookAtSolver | None:
    if obj is None and point_m is None:
        return None
    point = (0.0, 0.0, 0.0) if point_m is None else _point("point_m", point_m)
    # Parts of objects have no frame of their own.
    name = "" if obj is None else core.world.body(core.world.find(obj)).placement.name
    return core.world.gaze(LookAt(obj=name, point_m=point))


class LookOperations(Caller):
    """Look-at constraints: what is faced from now on, whatever moves."""

    @operation(
        obj=check.optional(check.object_reference),
        point_m=check.optional(_point),
    )
    @staticmethod
    def set_look_at(
        core: HasAgents,
        obj: int | str | None = None,
        point_m: ArrayLike | None = None,
        *,
        agent: str | None = None,
    ) -> None:
        """Have an agent face an object or a point from now on; without either, nothing any more.

        Parameters
        ----------
        obj : int or str or None
            The object; None: the point is one of the world.
        point_m : (3,) array-like or None
            World frame, or the object's own frame with its scale applied [m]. None: the object's
            origin.
        agent : str or None

        Raises
        ------
        UnknownName, InvalidRequest, InvalidState
            If there is no such agent or object now, or the point is not finite or beyond 10 km;
            nothing is changed then.

        Notes
        -----
        It does not roll. Straight above or below the point, the heading is the one that the agent
        has by itself. An object that is despawned or leaves is looked for where it was last.
        `set_pose` and `set_rotation` end it, `set_position` does not.

        >>> agent.set_look_at("football")  # doctest: +SKIP
        """
        core.agents.look_at(agent, _gaze(core, obj, point_m), core.world)
        core.announce()

    def get_look_at(self, *, agent: str | None = None) -> LookAt | None:
        """Return what an agent faces, as announced; None if nothing.

        An object that is gone is told as the point where it was last.

        Raises
        ------
        UnknownName
            If there is no such agent.
        """
        specs = {spec.name: spec for spec in self.info.agents}
        name = agent or self.own_agent or next(iter(specs), "")
        if name not in specs:
            raise UnknownName("agent", name, specs)
        return specs[name].look_at

    @operation(
        obj=check.optional(check.object_reference),
        point_m=check.optional(_point),
        mover=check.text,
    )
    @staticmethod
    def set_mover_look_at(
        core: HasWorld,
        obj: int | str | None = None,
        point_m: ArrayLike | None = None,
        mover: str = "",
    ) -> None:
        """Have a mover face an object or a point from now on; without either, nothing any more.

        What follows the mover is turned with it. It continues along its waypoints, or as commands
        say: forward is then towards what it faces.

        Parameters
        ----------
        obj, point_m
            As for `set_look_at`.
        mover : str

        Notes
        -----
        As for `set_look_at`. `turn_mover`, `drive_mover` with an angular velocity, and `set_pose`
        or `set_rotation` of an agent that follows it end it.
        """
        found = core.world.mover(mover)
        found.face(_gaze(core, obj, point_m), core.world.sim_time_ns)
        core.announce()

    def get_mover_look_at(self, mover: str = "") -> LookAt | None:
        """Return what a mover faces, as announced; None if nothing.

        Raises
        ------
        UnknownName
            If there is no such mover.
        """
        infos = {info.name: info for info in self.info.movers}
        name = mover or next(iter(infos))
        if name not in infos:
            raise UnknownName("mover", name, infos)
        return infos[name].look_at
