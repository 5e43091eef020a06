"""Settings of the engine that every world has."""

from __future__ import annotations

from sailenv_ros.world.bullet import STEPS_PER_SECOND, BulletClient

__all__ = ["ROBOT_SUBSTEPS", "configure", "subdivide_steps"]

SOLVER_RESIDUAL = 1e-5
"""Sum of the squared changes of velocities at which the engine's solver ends [m²/s²]; with ten
times as much, cutlery on a plate never comes to rest."""

WARM_STARTING = 0.85
"""Share of a contact's last impulse that the solver begins with, Bullet's own default; with
PyBullet's 0.1 a book that lies on a bed trembles forever."""

ROBOT_SUBSTEPS = 2
"""Parts into which the engine divides each step of a world that has robots. It takes the speed of
a step's end for all of it, an error of half a step in time: by steps of 1/240 s the hand of a Kuka
that swings was off by 1.4 % of its path, by halves of them 0.8 %."""


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


def subdivide_steps(client: BulletClient, *, robots: bool) -> None:
    """Let the engine divide each step, if the world has robots; forces last for all its parts."""
    client.setPhysicsEngineParameter(numSubSteps=ROBOT_SUBSTEPS if robots else 0)
