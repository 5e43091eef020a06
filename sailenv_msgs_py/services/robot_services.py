"""Services of the operations on robots; a part of `table`."""

from __future__ import annotations

import sailenv_msgs.srv as srv
from sailenv_msgs_py.robot_msgs import (
    inertial_from_response,
    inertial_to_response,
    positions_from_response,
    positions_to_response,
    robot_from_response,
    robot_to_response,
    scan_from_response,
    scan_to_response,
)
from sailenv_msgs_py.services import robot_conversions as robots
from sailenv_msgs_py.services.service import Service
from sailenv_ros.simulation.operations import Operations

__all__ = ["ROBOT_SERVICES"]

ROBOT_SERVICES: tuple[Service, ...] = (
    Service(
        Operations.spawn_robot,
        srv.SpawnRobot,
        write=robots.write_spawned,
        read=robots.read_spawned,
        result=lambda response: response.spawned_name,
        fill=robots.fill_spawned,
    ),
    Service(Operations.despawn_robot, srv.DespawnRobot),
    Service(Operations.get_robots, srv.GetRobots, result=lambda response: tuple(response.names)),
    Service(
        Operations.get_robot,
        srv.GetRobot,
        fill=lambda response, state, info: robot_to_response(response, state),
        result=robot_from_response,
    ),
    Service(Operations.robot_description, srv.GetRobotDescription, name="get_robot_description"),
    Service(
        Operations.drive_joints,
        srv.DriveJoints,
        none={"gain": 0.0, "effort": 0.0, "speed": 0.0},
        write=robots.write_targets,
        read=robots.read_targets,
    ),
    Service(
        Operations.put_joints,
        srv.PutJoints,
        write=lambda given: robots.write_named(given, "positions"),
        read=lambda given: robots.read_named(given, "positions"),
    ),
    Service(
        Operations.drive_robot,
        srv.DriveRobot,
        write=robots.write_command,
        read=robots.read_command,
    ),
    Service(
        Operations.link_pose,
        srv.GetLinkPose,
        name="get_link_pose",
        write=robots.write_elsewhere,
        read=robots.read_elsewhere,
    ),
    Service(
        Operations.reach_pose,
        srv.ReachPose,
        fill=lambda response, found, info: positions_to_response(response, found),
        result=positions_from_response,
    ),
    Service(
        Operations.get_scan,
        srv.GetScan,
        fill=lambda response, scan, info: scan_to_response(response, scan),
        result=scan_from_response,
    ),
    Service(
        Operations.get_inertial,
        srv.GetInertial,
        fill=lambda response, measured, info: inertial_to_response(response, measured),
        result=inertial_from_response,
    ),
)
"""Services of the simulator that concern its robots."""
