"""ROS's standard interfaces of simulators: services and an action of `simulation_interfaces`.

Those of Jazzy (1.5) and of Rolling (2.1), whose fields differ; what an installation's version lacks
is not offered. Handlers call operations of the simulation; see docs/simulation_interfaces.md.
"""

from sailenv_ros.ros.nodes.simulation_interfaces.server import SimulationInterfaces

__all__ = ["SimulationInterfaces"]
