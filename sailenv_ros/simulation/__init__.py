"""The composition root without ROS: scene, world and renderer behind one thread-safe face."""

from sailenv_ros.simulation.frame_stream import FrameStream
from sailenv_ros.simulation.simulation import Simulation

__all__ = ["FrameStream", "Simulation"]
