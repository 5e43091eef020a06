"""Robots' files, URDF and MJCF, → `RobotModel`s; their links are assets of the catalogue."""

from sailenv_ros.assets.robots.robot_store import RobotStore, is_of_package, robot_path

__all__ = ["RobotStore", "is_of_package", "robot_path"]
