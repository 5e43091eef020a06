"""Settings of the engine that every world has."""

from __future__ import annotations

from sailenv_ros.world.bullet import STEPS_PER_SECOND, BulletClient

__all__ = ["configure"]

SOLVER_RESIDUAL = 1e-5
"""Sum of the squared changes of velocities at which the engine's solver ends [m²/s²]; with ten
times as much, cutlery on a plate never comes to rest."""

WARM_STARTING = 0.85
"""Share of a contact's last impulse that the solver begins with, Bullet's own default; with
PyBullet's 0.1 a book that lies on a bed trembles forever."""


def configure(client: BulletClient) -> None:
    """Give the engine its step, its solver, and an order that depends on no address."""
    client.setTimeStep(1.0 / STEPS_PER_SECOND)
    client.setPhysicsEngineParameter(
        # Without it the order of contacts, and with it the result, may depend on addresses.
        deterministicOverlappingPairs=1,
        numSolverIterations=50,
        # Iterations end where they change nothing any more: most do after a few.
        solverResidualThreshold=SOLVER_RESIDUAL,
        warmStartingFactor=WARM_STARTING,
    )
