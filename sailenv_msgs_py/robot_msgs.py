"""Robots and their sensors, to and from their messages."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, cast

import geometry_msgs.msg as geometry
import numpy as np
from nav_msgs.msg import Odometry
from sensor_msgs.msg import Imu, JointState
from sensor_msgs.msg import LaserScan as LaserScanMsg
from std_msgs.msg import Header

from sailenv_msgs_py.stamps import ns_from_stamp, stamp_from_ns
from sailenv_msgs_py.transforms import pose_from_msg, pose_to_msg, twist_from_msg, twist_to_msg
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.robot_sensors import InertialMeasurement, LaserScan
from sailenv_ros.types.robots import DriveMode, Mount, RobotJointState, RobotState

__all__ = [
    "imu_to_msg",
    "inertial_from_response",
    "inertial_to_response",
    "odometry_to_msg",
    "positions_from_response",
    "positions_to_response",
    "robot_from_response",
    "robot_joints_to_msg",
    "robot_to_response",
    "scan_from_response",
    "scan_to_msg",
    "scan_to_response",
]


def robot_to_response(response: Any, state: RobotState) -> None:
    """Fill the response of GetRobot."""
    response.name, response.file, response.mount = state.name, state.file, state.mount
    response.link_names, response.link_ids = list(state.links), list(state.links.values())
    joints = state.joints
    response.joint_names = [joint.name for joint in joints]
    response.joint_links = [joint.link for joint in joints]
    response.joint_types = [joint.type for joint in joints]
    response.positions = [joint.position for joint in joints]
    response.velocities = [joint.velocity for joint in joints]
    response.efforts = [joint.effort for joint in joints]
    response.modes = [joint.mode for joint in joints]
    response.targets = [joint.target for joint in joints]
    response.lows = [joint.low for joint in joints]
    response.highs = [joint.high for joint in joints]
    response.pose = pose_to_msg(state.pose)
    response.twist = twist_to_msg((state.linear_m_s, state.angular_rad_s))
    forward, left, turn = state.command
    response.command = twist_to_msg(((forward, left, 0.0), (0.0, 0.0, turn)))
    response.time = stamp_from_ns(state.sim_time_ns)


def robot_from_response(response: Any) -> RobotState:
    """Read the response of GetRobot."""
    names = [
        *("joint_names", "joint_links", "joint_types", "positions", "velocities"),
        *("efforts", "modes", "targets", "lows", "highs"),
    ]
    columns = [getattr(response, name) for name in names]
    linear, angular = twist_from_msg(response.twist)
    told, turning = twist_from_msg(response.command)
    return RobotState(
        name=response.name,
        file=response.file,
        mount=cast(Mount, response.mount),
        links=dict(zip(response.link_names, map(int, response.link_ids), strict=True)),
        joints=tuple(
            RobotJointState(
                name=name,
                link=link,
                type=kind,
                position=position,
                velocity=velocity,
                effort=effort,
                mode=cast(DriveMode, mode),
                target=target,
                low=low,
                high=high,
            )
            for name, link, kind, position, velocity, effort, mode, target, low, high in zip(
                *columns, strict=True
            )
        ),
        pose=pose_from_msg(response.pose),
        linear_m_s=linear,
        angular_rad_s=angular,
        command=(told[0], told[1], turning[2]),
        sim_time_ns=ns_from_stamp(response.time),
    )


def positions_to_response(response: Any, positions: Mapping[str, float]) -> None:
    """Fill names and positions of joints."""
    response.names, response.positions = list(positions), list(positions.values())


def positions_from_response(response: Any) -> dict[str, float]:
    """Read names and positions of joints."""
    return dict(zip(response.names, response.positions, strict=True))


def scan_to_response(response: Any, scan: LaserScan) -> None:
    """Fill the response of GetScan."""
    response.pose = pose_to_msg(scan.pose)
    response.angle_min, response.angle_increment = scan.angle_min_rad, scan.angle_increment_rad
    response.range_min, response.range_max = scan.range_min_m, scan.range_max_m
    response.ranges = scan.ranges_m.tolist()
    response.time = stamp_from_ns(scan.sim_time_ns)


def scan_from_response(response: Any) -> LaserScan:
    """Read the response of GetScan."""
    return LaserScan(
        pose=pose_from_msg(response.pose),
        angle_min_rad=response.angle_min,
        angle_increment_rad=response.angle_increment,
        range_min_m=response.range_min,
        range_max_m=response.range_max,
        ranges_m=np.array(response.ranges, np.float64),
        sim_time_ns=ns_from_stamp(response.time),
    )


def inertial_to_response(response: Any, measured: InertialMeasurement) -> None:
    """Fill the response of GetInertial."""
    msg = imu_to_msg(measured, "")
    response.orientation = msg.orientation
    response.angular_rad_s = msg.angular_velocity
    response.acceleration = msg.linear_acceleration
    response.time = stamp_from_ns(measured.sim_time_ns)


def inertial_from_response(response: Any) -> InertialMeasurement:
    """Read the response of GetInertial."""
    q, w, a = response.orientation, response.angular_rad_s, response.acceleration
    return InertialMeasurement(
        orientation_xyzw=(q.x, q.y, q.z, q.w),
        angular_rad_s=(w.x, w.y, w.z),
        acceleration_m_s2=(a.x, a.y, a.z),
        sim_time_ns=ns_from_stamp(response.time),
    )


# -- topics --------------------------------------------------------------------------------


def robot_joints_to_msg(state: RobotState) -> JointState:
    """Make the message of all joints of a robot that move."""
    return JointState(
        header=Header(stamp=stamp_from_ns(state.sim_time_ns)),
        name=[joint.name for joint in state.joints],
        position=[joint.position for joint in state.joints],
        velocity=[joint.velocity for joint in state.joints],
        effort=[joint.effort for joint in state.joints],
    )


def odometry_to_msg(state: RobotState, odom_from_base: Pose, frames: tuple[str, str]) -> Odometry:
    """Make the message of where a robot is and how it moves, in its own axes (REP 105)."""
    msg = Odometry(
        header=Header(stamp=stamp_from_ns(state.sim_time_ns), frame_id=frames[0]),
        child_frame_id=frames[1],
    )
    msg.pose.pose = pose_to_msg(odom_from_base)
    msg.twist.twist = twist_to_msg((state.linear_m_s, state.angular_rad_s))
    return msg


def scan_to_msg(scan: LaserScan, frame_id: str, period_s: float) -> LaserScanMsg:
    """Make the message of a laser scan; all rays are of one instant."""
    count = len(scan.ranges_m)
    return LaserScanMsg(
        header=Header(stamp=stamp_from_ns(scan.sim_time_ns), frame_id=frame_id),
        angle_min=scan.angle_min_rad,
        angle_max=scan.angle_min_rad + (count - 1) * scan.angle_increment_rad,
        angle_increment=scan.angle_increment_rad,
        scan_time=period_s,
        range_min=scan.range_min_m,
        range_max=scan.range_max_m,
        ranges=scan.ranges_m.astype(np.float32).tolist(),
    )


def imu_to_msg(measured: InertialMeasurement, frame_id: str) -> Imu:
    """Make the message of an inertial measurement (REP 145)."""
    x, y, z, w = measured.orientation_xyzw
    wx, wy, wz = measured.angular_rad_s
    ax, ay, az = measured.acceleration_m_s2
    return Imu(
        header=Header(stamp=stamp_from_ns(measured.sim_time_ns), frame_id=frame_id),
        orientation=geometry.Quaternion(x=x, y=y, z=z, w=w),
        angular_velocity=geometry.Vector3(x=wx, y=wy, z=wz),
        linear_acceleration=geometry.Vector3(x=ax, y=ay, z=az),
    )
