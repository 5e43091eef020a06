"""The movers of a world, and what of them is in the engine: collision proxies and rigid bodies.

Names and commands in, poses of movers out, step by step.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from types import MappingProxyType

from sailenv_ros.errors import UnknownName
from sailenv_ros.types.rigid_body import RigidBody
from sailenv_ros.world.bullet import LINK_OF_BASE, BulletClient
from sailenv_ros.world.collision_proxy import CollisionProxy
from sailenv_ros.world.mover import Mover
from sailenv_ros.world.mover_body import AT_REST, Motion, MoverBody
from sailenv_ros.world.mover_motion import MoverCommand

__all__ = ["MoverTable"]

Piece = tuple[int, int]
"""The engine's number of a body, and that of its link."""

ROOM_M = 0.3
"""Radius of what a mover takes upon the floor [m]."""


class MoverTable:
    """The movers of one world.

    Parameters
    ----------
    client : BulletClient
    movers : sequence of Mover
        At least one.
    """

    def __init__(self, client: BulletClient, movers: Sequence[Mover]) -> None:
        self._client = client
        self._movers = {mover.name: mover for mover in movers}
        self._proxies: dict[str, CollisionProxy] = {}
        self._gains: dict[frozenset[Piece], float] = {}

    def enter(self) -> None:
        """Put those into the engine that begin as rigid bodies."""
        for mover in self._movers.values():
            if mover.begins_as is not None:
                mover.set_body(self._ball(mover, *mover.begins_as, 0), 0)

    def __getitem__(self, name: str) -> Mover:
        """Find a mover; the empty name means the first.

        Raises
        ------
        UnknownName
        """
        if not name:
            return next(iter(self._movers.values()))
        if not isinstance(name, str) or name not in self._movers:
            raise UnknownName("mover", str(name), self._movers)
        return self._movers[name]

    @property
    def by_name(self) -> Mapping[str, Mover]:
        """The movers by name, in the scene's order; read-only."""
        return MappingProxyType(self._movers)

    @property
    def bodies(self) -> tuple[MoverBody, ...]:
        """The bodies of those that are rigid bodies, in the same order."""
        return tuple(m.body for m in self._movers.values() if m.body is not None)

    @property
    def pieces(self) -> Mapping[Piece, str]:
        """Names of movers by the engine's numbers of what they are there."""
        proxies = {(proxy.bullet_id, LINK_OF_BASE): name for name, proxy in self._proxies.items()}
        bodies = {(body.bullet_id, LINK_OF_BASE): body.placement.name for body in self.bodies}
        return {**proxies, **bodies}

    def places(self, time_ns: int) -> Iterator[tuple[float, float, float]]:
        """Yield what those take upon the floor that others bump into: x, y, radius [m]."""
        for name in sorted(set(self.pieces.values())):
            x, y, _ = self[name].pose_at(time_ns).position_m
            yield x, y, ROOM_M

    # -- steps -----------------------------------------------------------------------------

    def before_step(self, time_ns: int) -> None:
        """Do what the step needs that begins at a simulated time [ns]."""
        for proxy in self._proxies.values():
            proxy.before_step(time_ns)
        for body in self.bodies:
            body.before_step()

    def after_step(self, time_ns: int) -> None:
        """Take note of what the step has done that began at a simulated time [ns]."""
        for proxy in self._proxies.values():
            proxy.after_step(time_ns)
        self._gains = {}
        # Of two that strike each other the first bounces them both.
        shares = {(body.bullet_id, LINK_OF_BASE): body.rigid.restitution for body in self.bodies}
        done: set[Piece] = set()
        for mover in self._movers.values():
            body = mover.body
            if body is None:
                continue
            piece = body.bullet_id, LINK_OF_BASE
            for other, gain in body.after_step(shares, done).items():
                self._gains[frozenset((piece, other))] = gain
            done.add(piece)
            mover.moved(body.turned_from(mover.own_pose_at(time_ns)))

    def gain(self, first: Piece, second: Piece) -> float:
        """Return by what the last step's impulse between two bodies was multiplied by a bounce."""
        return self._gains.get(frozenset((first, second)), 1.0)

    # -- what is changed -------------------------------------------------------------------

    def drive(self, name: str, command: MoverCommand, time_ns: int) -> None:
        """Have a mover walk; see `World.drive`."""
        driven = self[name]
        driven.command(command, time_ns)
        if driven.name not in self._proxies:
            self._proxies[driven.name] = CollisionProxy(self._client, driven)

    def set_mover_body(self, name: str, rigid: RigidBody | None, time_ns: int) -> bool:
        """Make a mover a rigid body, or none any more; see `World.set_mover_body`."""
        mover = self[name]
        old = mover.body
        if rigid is None:
            if old is None:
                return False
            mover.set_body(None, time_ns)
            old.remove()
            return True
        if old is not None and old.rigid == rigid:
            return False
        mover.require_untracked()
        new = self._ball(mover, rigid, AT_REST if old is None else old.motion, time_ns)
        if old is not None:
            new.take_wrenches(old)
            old.remove()
        mover.set_body(new, time_ns)
        return True

    def _ball(self, mover: Mover, rigid: RigidBody, motion: Motion, time_ns: int) -> MoverBody:
        """Put a ball into the engine where a mover is at a simulated time [ns]."""
        return MoverBody(self._client, mover.name, rigid, mover.own_pose_at(time_ns), motion)
