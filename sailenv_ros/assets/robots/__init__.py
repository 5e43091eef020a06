"""Robots' files, URDF and MJCF, → `RobotModel`s; their links are assets of the catalogue."""

from sailenv_ros.assets.robots.robot_store import RobotStore, is_of_package, robot_path
from sailenv_ros.assets.robots.sent_files import keep_description

__all__ = ["RobotStore", "is_of_package", "keep_description", "robot_path"]
