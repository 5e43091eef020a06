"""Starts the simulator with the names that Nav2 and MoveIt expect of its robot.

    ros2 launch sailenv_ros robot.launch.py scene:=/path/to/scene.yaml robot:=cart

The scene has the robot. Its topics are /map, /scan, /odom, /cmd_vel, /joint_states and
/robot_description; the frames map, odom and base_link are in /tf.
"""

from __future__ import annotations

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue
from launch_ros.substitutions import FindPackageShare

TOPICS = ("map", "scan", "odom", "cmd_vel", "joint_states", "joint_commands", "robot_description")
FRAMES = ("odom", "base_link")


def generate_launch_description() -> LaunchDescription:
    """Return the simulator, and frames without the robot's name beside its own."""
    robot = LaunchConfiguration("robot")
    parameters = PathJoinSubstitution([FindPackageShare("sailenv_ros"), "config", "sim_node.yaml"])
    return LaunchDescription(
        [
            DeclareLaunchArgument("scene", description="A scene with the robot."),
            DeclareLaunchArgument("robot", description="The robot's name there."),
            DeclareLaunchArgument("namespace", default_value="/sailenv"),
            Node(
                package="sailenv_ros",
                executable="sim_node",
                name="sim_node",
                namespace=LaunchConfiguration("namespace"),
                parameters=[
                    parameters,
                    {"scene": ParameterValue(LaunchConfiguration("scene"), value_type=str)},
                ],
                remappings=[
                    ([LaunchConfiguration("namespace"), "/", robot, f"/{topic}"], f"/{topic}")
                    for topic in TOPICS
                ],
                output="screen",
            ),
            *(
                Node(
                    package="tf2_ros",
                    executable="static_transform_publisher",
                    arguments=["--frame-id", [robot, f"/{frame}"], "--child-frame-id", frame],
                )
                for frame in FRAMES
            ),
        ]
    )
