"""Parameters that take effect while the node runs: a change of one becomes a request.

ROS has checked type and range already; what depends on the simulation's state is checked here.
"""

from __future__ import annotations

from collections.abc import Sequence

from rcl_interfaces.msg import SetParametersResult
from rclpy.node import Node
from rclpy.parameter import Parameter

from sailenv_ros.errors import SailenvError
from sailenv_ros.ros.nodes.parameter_table import USE_SIM_TIME, without_a_clock
from sailenv_ros.simulation import Simulation

__all__ = ["LiveParameters"]


class LiveParameters:
    """Follows changes of a node's parameters.

    Parameters
    ----------
    node : Node
        With the parameters declared.
    simulation : Simulation
    agent : str
        Name of the agent that the parameters beginning ``agent.`` are of.
    """

    def __init__(self, node: Node, simulation: Simulation, agent: str) -> None:
        self._simulation = simulation
        self._agent = agent
        node.add_on_set_parameters_callback(self._check)
        node.add_post_set_parameters_callback(self._apply)

    def _check(self, parameters: Sequence[Parameter]) -> SetParametersResult:
        """Refuse a rate where its agent is gone, and a clock to follow."""
        if any(p.name == USE_SIM_TIME and p.value for p in parameters):
            return SetParametersResult(successful=False, reason=str(without_a_clock(True)))
        agents = [spec.name for spec in self._simulation.info.agents]
        if any(p.name == "agent.rate_hz" for p in parameters) and self._agent not in agents:
            why = f"agent {self._agent!r} is gone; use the service set_rate of another agent"
            return SetParametersResult(successful=False, reason=why)
        return SetParametersResult(successful=True)

    def _apply(self, parameters: Sequence[Parameter]) -> None:
        for parameter in parameters:
            try:
                self._request(parameter)
            except SailenvError:
                return  # the simulation has ended, which the node says

    def _request(self, parameter: Parameter) -> None:
        # Queued and not awaited: a request that takes long must not hold up the executor.
        if parameter.name == "real_time_factor":
            self._simulation.set_real_time_factor.submit(parameter.value)
        elif parameter.name == "agent.rate_hz":
            self._simulation.set_rate.submit(parameter.value, agent=self._agent)
