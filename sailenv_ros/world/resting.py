"""Bringing a new scene to rest: what stands is asleep from the first step on.

Bodies in, the same bodies out, some of them asleep. The engine puts a body to sleep only after two
seconds at rest; until then a furnished room costs as much as one in motion, and its objects creep
by fractions of a millimetre.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.world import actuation
from sailenv_ros.world.bodies import Body
from sailenv_ros.world.bullet import LINK_OF_BASE, BulletClient
from sailenv_ros.world.jointed_bodies import JointedBody

__all__ = ["begin_at_rest"]

TRIAL_STEPS = 120
"""Half a second: what falls is then 1.2 m lower."""

STILL_M = 0.002
STILL_DEG = 0.5
"""Rotation while settling below which an object is at rest at its first pose [deg]."""

SETTLES_M = 0.02
SETTLES_DEG = 8.0
"""Rotation while settling below which an object, such as a cushion, is at rest where it settled
[deg]."""

STILL_M_S = 0.05
STILL_RAD_S = 1.0
"""Cutlery trembles on its edges; the engine takes no more for motion either."""


def begin_at_rest(client: BulletClient, bodies: Sequence[Body], *, settled: bool = True) -> None:
    """Try for a moment what moves; put back what has moved, and let the others sleep.

    Parameters
    ----------
    client : BulletClient
    bodies : sequence of Body
        All of the world.
    settled : bool
        True puts what has settled by a little where it has settled; False moves nothing.
    """
    loose = [body for body in bodies if not body.placement.static]
    if not loose:
        return
    start = client.saveState()
    before = [body.world_from_body() for body in loose]
    floating = [
        (body, [-body.mass_kg * g for g in client.gravity]) for body in loose if body.floats
    ]
    for _ in range(TRIAL_STEPS):
        for body, lift in floating:
            actuation.push(client, body.bullet_id, lift, link=body.link)
        client.stepSimulation()
    asleep: list[Body] = []
    sunk: dict[int, tuple[list[float], list[float]]] = {}
    for body, matrix in zip(loose, before, strict=True):
        if body.behaviours or body.thrown or not body.collides or not _is_slow(body):
            continue
        moved_m, turned_deg = _way(matrix, body.world_from_body())
        if moved_m <= STILL_M and turned_deg <= STILL_DEG:
            asleep.append(body)
        elif isinstance(body, JointedBody):
            continue  # a joint begins where it is said to
        elif settled and moved_m < SETTLES_M and turned_deg < SETTLES_DEG:
            asleep.append(body)
            id_ = body.bullet_id
            sunk[id_] = client.getBasePositionAndOrientation(id_)
    _restore(client, start, sunk)
    states = client.constants
    sleep = states.ACTIVATION_STATE_SLEEP | states.ACTIVATION_STATE_DISABLE_WAKEUP
    # All that hangs together on joints sleeps, or nothing of it does.
    still = set(asleep)
    awake = {body.bullet_id for body in loose if body not in still}
    asleep = [body for body in asleep if body.bullet_id not in awake]
    for body in asleep:
        client.changeDynamics(body.bullet_id, LINK_OF_BASE, activationState=sleep)
    # The engine looks at who sleeps in the course of a step, in which all move once more.
    client.stepSimulation()
    _restore(client, start, sunk)
    client.removeState(start)
    # What touches something awake has woken in that step, unless it hangs on joints.
    wakes = states.ACTIVATION_STATE_ENABLE_WAKEUP
    again = states.ACTIVATION_STATE_SLEEP
    for body in asleep:
        state = wakes if isinstance(body, JointedBody) else again
        client.changeDynamics(body.bullet_id, LINK_OF_BASE, activationState=state)


def _restore(
    client: BulletClient, state: int, sunk: dict[int, tuple[list[float], list[float]]]
) -> None:
    """Put all back to the very bytes of the start, but for what has settled."""
    client.restoreState(state)
    for body, (position, quat) in sunk.items():
        client.resetBasePositionAndOrientation(body, position, quat)


def _is_slow(body: Body) -> bool:
    linear, angular = body.velocity()
    return bool(np.linalg.norm(linear) < STILL_M_S and np.linalg.norm(angular) < STILL_RAD_S)


def _way(before: NDArray[np.float64], now: NDArray[np.float64]) -> tuple[float, float]:
    """Return how far a body has moved [m] and turned [deg]."""
    cosine = (np.trace(now[:3, :3] @ before[:3, :3].T) - 1.0) / 2.0
    turned_deg = float(np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0))))
    return float(np.linalg.norm(now[:3, 3] - before[:3, 3])), turned_deg
