"""Starts the simulator: `ros2 launch sailenv_ros sim.launch.py scene:=room_02`."""

from __future__ import annotations

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue
from launch_ros.substitutions import FindPackageShare


def generate_launch_description() -> LaunchDescription:
    """Return one node; its arguments override the file of parameters."""
    own_parameters = PathJoinSubstitution(
        [FindPackageShare("sailenv_ros"), "config", "sim_node.yaml"]
    )
    return LaunchDescription(
        [
            DeclareLaunchArgument(
                "scene", default_value="", description="First scene; empty for room_01."
            ),
            DeclareLaunchArgument(
                "mode", default_value="realtime", choices=["realtime", "lockstep"]
            ),
            DeclareLaunchArgument("seed", default_value="0", description="Seed of the scene."),
            DeclareLaunchArgument("namespace", default_value="/sailenv"),
            DeclareLaunchArgument(
                "params_file", default_value=own_parameters, description="ROS parameters (YAML)."
            ),
            Node(
                package="sailenv_ros",
                executable="sim_node",
                name="sim_node",
                namespace=LaunchConfiguration("namespace"),
                parameters=[
                    LaunchConfiguration("params_file"),
                    {
                        "scene": ParameterValue(LaunchConfiguration("scene"), value_type=str),
                        "mode": ParameterValue(LaunchConfiguration("mode"), value_type=str),
                        "seed": ParameterValue(LaunchConfiguration("seed"), value_type=int),
                    },
                ],
                output="screen",
            ),
        ]
    )
