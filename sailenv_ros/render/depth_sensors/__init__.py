"""Depth as real sensors measure it, after published models: noise, steps, holes, shadows."""

from sailenv_ros.render.depth_sensors.sensor_file import DepthSensor, depth_sensor
from sailenv_ros.render.depth_sensors.surfaces import Surfaces

__all__ = ["DepthSensor", "Surfaces", "depth_sensor"]
