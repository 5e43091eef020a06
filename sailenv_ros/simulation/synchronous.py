"""A simulation in the caller's own thread: each operation is carried out as it is asked for."""

from __future__ import annotations

import inspect
from concurrent.futures import Future
from typing import Any

from sailenv_ros.simulation.core import SimulationCore
from sailenv_ros.simulation.operations import Operation, WorldOperations

__all__ = ["SynchronousSimulation"]


class SynchronousSimulation(SimulationCore, WorldOperations):
    """A `SimulationCore` with its operations; nothing runs beside the caller.

    It begins in lockstep, with seed 0; all parameters are those of `SimulationCore`.
    """

    def __init__(self, *args: Any, **settings: Any) -> None:
        usual: dict[str, Any] = {
            "mode": "lockstep",
            "real_time_factor": 1.0,
            "seed": 0,
            "paused": False,
        }
        super().__init__(*args, **usual | settings)
        self.frames.work_alone()

    def submit_operation(
        self, operation: Operation[..., Any], arguments: inspect.BoundArguments
    ) -> Future[Any]:
        """Carry an operation out now."""
        done: Future[Any] = Future()
        done.set_result(operation.carry_out(self, arguments))
        return done
