"""Operations of a simulator, each declared once.

A declaration is a name, a typed signature, a docstring, a deadline, the checks of its arguments,
and what it does to a simulation, of which it knows the parts in `targets` alone. `Simulation` runs
them in its loop thread, `Agent` sends them over ROS, and both offer each of them as a blocking
method with a future beside it.
"""

from sailenv_ros.simulation.operations.operation import BoundOperation, Caller, Operation, operation
from sailenv_ros.simulation.operations.operations import ALL_OPERATIONS, Operations, WorldOperations

__all__ = [
    "ALL_OPERATIONS",
    "BoundOperation",
    "Caller",
    "Operation",
    "Operations",
    "WorldOperations",
    "operation",
]
