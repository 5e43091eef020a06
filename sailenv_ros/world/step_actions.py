"""Actions on bodies before a physics step: behaviours, walls that hold bodies up, floating.

Bodies and a time in, calls of the engine out. Behaviours that can be asked for many bodies at once
are; each body's share is the same bytes as if it were alone.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.behaviours import (
    MAX_SPEED_M_S,
    Actions,
    BehaviourKind,
    BodyStates,
    RunningBehaviour,
)
from sailenv_ros.world import actuation
from sailenv_ros.world.bodies import Body, FrustumPlanes
from sailenv_ros.world.bullet import LINK_OF_BASE, BulletClient
from sailenv_ros.world.crowd import Crowd
from sailenv_ros.world.person_body import PersonBody

__all__ = ["StepActions"]

Floats = NDArray[np.float64]
Asked = list[tuple[Body, RunningBehaviour]]

CAREFUL_SPEED_M_S = 0.5
"""Slower bodies are kept out of walls by the engine alone."""

MAX_DEPTH_M = 0.002
OUT_OF_WALLS_PER_S = 24.0


class StepActions:
    """The bodies of a world that something is done to, for some steps.

    Parameters
    ----------
    client : BulletClient
    bodies : iterable of Body
        Those that act, in the order in which they do; neither they nor their behaviours change
        while this is used.
    frustum_planes : callable
        As of `World`.
    crowd : Crowd
        What people among them know of the world.
    """

    def __init__(
        self,
        client: BulletClient,
        bodies: Iterable[Body],
        frustum_planes: FrustumPlanes,
        crowd: Crowd,
    ) -> None:
        self._client = client
        self._frustum_planes = frustum_planes
        acting = [body for body in bodies if body.acts]
        driven = ((body, body.forces()) for body in acting)
        self._driven = [(body, forces) for body, forces in driven if forces]
        self._people = [body for body in acting if isinstance(body, PersonBody)]
        for person in self._people:
            person.walker.crowd = crowd
        self._floating = [body for body in acting if body.floats]
        self._lifts = [tuple(-body.mass_kg * g for g in client.gravity) for body in self._floating]
        self._is_wall: dict[tuple[int, int], bool] = {}

    def act(self, time_s: float) -> None:
        """Do all for the step that begins at a simulated time [s]."""
        if self._driven:
            careful = self._behave(time_s)
            self._limit_penetration(careful)
        for person in self._people:
            person.advance(time_s)
        for body, lift in zip(self._floating, self._lifts, strict=True):
            actuation.push(self._client, body.bullet_id, lift, link=body.link)

    def _behave(self, time_s: float) -> list[Body]:
        """Ask the behaviours; return the bodies that may be pressed into walls."""
        careful = []
        places: list[dict[BehaviourKind | None, Asked]] = []
        for body, forces in self._driven:
            acted = False
            for place, running in enumerate(forces):
                if running.is_idle(time_s):
                    continue
                acted = True
                while len(places) <= place:
                    places.append({})
                together = running.kind.batch is not None and body.link == LINK_OF_BASE
                kind = running.kind if together else None
                places[place].setdefault(kind, []).append((body, running))
            # What rests is not asked for its speed: that would cost more than all else.
            if isinstance(body, PersonBody):
                continue
            if body.link == LINK_OF_BASE and (acted or body.is_fast):
                careful.append(body)
        planes = _once(self._frustum_planes)
        for kinds in places:
            for kind, asked in kinds.items():
                if kind is None or kind.batch is None:
                    for body, running in asked:
                        body.behave(running, time_s, planes)
                else:
                    self._behave_together(kind.batch, asked, time_s, planes)
        return careful

    def _behave_together(
        self,
        batch: Callable[[Sequence[RunningBehaviour], Floats, BodyStates], Actions],
        asked: Asked,
        time_s: float,
        planes: FrustumPlanes,
    ) -> None:
        running = [one for _, one in asked]
        times_s = np.array([one.own_time_s(time_s) for one in running])
        states = self._states(asked, planes)
        actions = batch(running, times_s, states)
        if actions.idle_until_s is not None:
            for one, until_s in zip(running, actions.idle_until_s.tolist(), strict=True):
                one.idle_until_s = until_s
        linear = _rows(actions.linear_velocities)
        angular = _rows(actions.angular_velocities)
        forces, torques = _rows(actions.forces_n), _rows(actions.torques_nm)
        client, frame = self._client, self._client.constants.WORLD_FRAME
        for row in np.flatnonzero(actions.acts).tolist():
            body = asked[row][0].bullet_id
            actuation.wake(client, body)
            if linear or angular:
                client.resetBaseVelocity(
                    body,
                    linear[row] if linear else states.linear_velocities[row].tolist(),
                    angular[row] if angular else states.angular_velocities[row].tolist(),
                )
            if forces:
                actuation.push(client, body, forces[row])
            if torques:
                client.applyExternalTorque(body, LINK_OF_BASE, torques[row], frame)

    def _states(self, asked: Asked, planes: FrustumPlanes) -> BodyStates:
        """Read the bodies from the engine."""
        get_place, get_velocity = (
            self._client.getBasePositionAndOrientation,
            self._client.getBaseVelocity,
        )
        places = [get_place(body.bullet_id) for body, _ in asked]
        positions, quats = np.array([p for p, _ in places]), np.array([q for _, q in places])
        velocities = np.array([get_velocity(body.bullet_id) for body, _ in asked])
        if not (np.isfinite(positions).all() and np.isfinite(quats).all()):
            for body, _ in asked:
                body.pose()  # names the one that is not finite
        for row, (body, _) in enumerate(asked):
            if body.off_centre:
                positions[row] = body.pose().position_m
        return BodyStates(
            positions_m=positions,
            orientations=quats,
            linear_velocities=velocities[:, 0],
            angular_velocities=velocities[:, 1],
            masses_kg=np.array([body.mass_kg for body, _ in asked]),
            inertias_kg_m2=np.array([body.inertia_kg_m2 for body, _ in asked]),
            frustum_planes=tuple(
                planes(one.parameters.viewer, one.parameters.view_distance_m) for _, one in asked
            ),
        )

    def _limit_penetration(self, bodies: Sequence[Body]) -> None:
        """Keep bodies out of walls, into which driven ones are pressed at each step."""
        get_velocity = self._client.getBaseVelocity
        for body in bodies:
            (x, y, z), angular = get_velocity(body.bullet_id)
            speed = math.sqrt(x * x + y * y + z * z)
            body.is_fast = speed >= CAREFUL_SPEED_M_S
            if not body.is_fast:
                continue
            share = min(1.0, MAX_SPEED_M_S / speed)
            limited = self._held_up(body.bullet_id, (x * share, y * share, z * share))
            if limited != (x, y, z):
                self._client.resetBaseVelocity(body.bullet_id, limited, angular)

    def _held_up(
        self, body: int, velocity: tuple[float, float, float]
    ) -> tuple[float, float, float]:
        """Return a velocity [m/s] without what presses a body deeper into a wall."""
        x, y, z = velocity
        for point in self._client.getContactPoints(bodyA=body):
            depth_m = -point[8]
            if depth_m <= 0.0 or not self._wall(point[2], point[4]):
                continue
            nx, ny, nz = point[7]
            # As fast into the wall as the engine bears, or out of it where it is in too deep.
            least = max(0.0, depth_m - MAX_DEPTH_M) * OUT_OF_WALLS_PER_S
            more = least - (x * nx + y * ny + z * nz)
            if more > 0.0:
                x, y, z = x + more * nx, y + more * ny, z + more * nz
        return x, y, z

    def _wall(self, body: int, link: int) -> bool:
        """Return whether a body is static."""
        if (body, link) not in self._is_wall:
            self._is_wall[body, link] = not self._client.getDynamicsInfo(body, link)[0]
        return self._is_wall[body, link]


def _rows(values: Floats | None) -> list[list[float]]:
    return [] if values is None else values.tolist()


def _once(planes: FrustumPlanes) -> FrustumPlanes:
    """Return planes that are computed once for each agent and distance; nobody moves meanwhile."""
    known: dict[tuple[str, float], Floats] = {}

    def cached(viewer: str, distance_m: float) -> Floats:
        key = viewer, distance_m
        if key not in known:
            known[key] = planes(viewer, distance_m) if viewer else np.zeros((0, 4))
        return known[key]

    return cached
