"""Operations on the scene and its time: another scene, a new start, pause, steps."""

from __future__ import annotations

from sailenv_ros.errors import InvalidState
from sailenv_ros.simulation.operations import argument_checks as check
from sailenv_ros.simulation.operations.operation import Caller, operation
from sailenv_ros.simulation.operations.targets import BeginsScenes, HasClock, RunsTime
from sailenv_ros.types.validation import checked_integer

__all__ = ["MAX_STEPS", "ClockOperations"]

MAX_STEPS = 1_000_000
"""Most steps that one call of `step` may ask for (over an hour of simulated time)."""


def _steps(what: str, value: object) -> int:
    return checked_integer("steps", value, 1, MAX_STEPS)


class ClockOperations(Caller):
    """Scene and time, for all agents."""

    @operation(deadline_s=120.0, scene=check.text)
    @staticmethod
    def change_scene(core: BeginsScenes, scene: str) -> None:
        """Leave the present world for another scene of `scenes`, at simulated time 0."""
        core.begin(scene, core.seed, as_registered=False)

    @operation(deadline_s=120.0, seed=check.optional(check.seed))
    @staticmethod
    def reset(core: BeginsScenes, seed: int | None = None) -> int:
        """Begin the present scene again, as it was at its start; return the new epoch.

        Parameters
        ----------
        seed : int or None
            0 to 2^63 - 1; None keeps the present one, and every byte comes back, also of what
            was drawn at random. With a seed that is drawn again.
        """
        chosen = core.seed if seed is None else seed
        core.begin(
            core.world.scene,
            chosen,
            as_registered=True,
            more=core.additions,
            chance=core.randomiser.chance_of_reset(seeded=seed is not None),
        )
        return core.epoch

    @operation()
    @staticmethod
    def pause(core: HasClock) -> None:
        """Stop simulated time; a second call does nothing."""
        if core.clock.set_paused(True):
            core.announce()

    @operation()
    @staticmethod
    def resume(core: HasClock) -> None:
        """Let simulated time run again; a second call does nothing."""
        if core.clock.set_paused(False):
            core.announce()

    @operation()
    @staticmethod
    def set_real_time_factor(core: HasClock, factor: float) -> None:
        """Change how many simulated seconds per wall second are aimed at, 0.1 to 10."""
        core.clock.set_real_time_factor(factor)
        core.announce()

    @operation(deadline_s=600.0, count=_steps)
    @staticmethod
    def step(core: RunsTime, count: int = 1) -> int:
        """Advance a paused or lockstep simulation, with every streamed frame that falls due.

        Parameters
        ----------
        count : int
            Physics steps of 1/240 s, 1 to 1,000,000.

        Returns
        -------
        sim_time_ns : int
            Simulated time afterwards [ns].
        """
        if core.clock.runs_by_itself:
            raise InvalidState(
                "the simulation's clock is running: pause it before stepping, or make the "
                'simulation with mode="lockstep", where time moves by step alone'
            )
        core.advance_to(core.world.step_count + count, every_frame=True)
        return core.world.sim_time_ns
