"""The composition root without ROS: scene, world and renderer behind one thread-safe face."""

from sailenv_ros.simulation.simulation import Simulation
from sailenv_ros.simulation.stream import FrameStream

__all__ = ["FrameStream", "Simulation"]
