"""ROS's standard interfaces of simulators: services and an action of `simulation_interfaces`.

Those of Jazzy (1.5) and of Rolling (2.1), whose fields differ. Handlers call operations of the
simulation; see docs/simulation_interfaces.md.
"""

from __future__ import annotations

import logging
from collections.abc import Callable
from typing import TYPE_CHECKING

from rclpy.node import Node

from sailenv_ros.simulation import Simulation

if TYPE_CHECKING:
    from sailenv_ros.ros.nodes.simulation_interfaces.server import SimulationInterfaces

__all__ = ["standard_interfaces"]

_log = logging.getLogger(__name__)


def standard_interfaces(
    beside: Node, simulation: Simulation, quit_process: Callable[[], None]
) -> SimulationInterfaces | None:
    """Make the node that offers them; None, and a warning, where an older version is installed.

    Parameters
    ----------
    beside : Node
        The simulator's node, whose namespace and context are taken.
    simulation : Simulation
    quit_process : callable
        Asks the process to end.
    """
    try:
        from sailenv_ros.ros.nodes.simulation_interfaces.server import SimulationInterfaces
    except (ImportError, AttributeError) as problem:  # types or constants are missing
        _log.warning(
            "the standard interfaces of simulators are not offered: they need version 1.5.1 "
            "or later of the package simulation_interfaces (%s)",
            problem,
        )
        return None
    return SimulationInterfaces(beside, simulation, quit_process)
