"""What a user asks about where the camera is: position, rotation, pose, whether it follows.

Part of `Agent`. Positions are in metres, rotations in degrees about fixed axes.
"""

from __future__ import annotations

from typing import Any

from numpy.typing import ArrayLike
from std_srvs.srv import SetBool, Trigger

from sailenv_msgs.srv import GetPose, SetPose, SetPosition, SetRotation
from sailenv_msgs_py.transforms import point_to_msg, pose_from_msg, pose_to_msg
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.geometry import Pose, vector

__all__ = ["PoseRequests"]


class PoseRequests:
    """Requests about an agent's pose; see `Agent`."""

    def _call_own(self, srv_type: Any, service: str, request: Any) -> Any:
        """Ask a service of this agent; give its answer, which says success."""
        raise NotImplementedError

    def get_position(self) -> tuple[float, float, float]:
        """Give the camera's world coordinates [m]."""
        return self.get_pose().position_m

    def set_position(self, position: ArrayLike, *, teleport: bool = False) -> None:
        """Move the camera to world coordinates [m].

        A set pose is motion, which flow shows; `teleport` cuts the past off instead.
        """
        point = point_to_msg(vector("position", position))
        request = SetPosition.Request(position=point, teleport=teleport)
        self._call_own(SetPosition, "set_position", request)

    def get_rotation(self) -> tuple[float, float, float]:
        """Give the camera's roll, pitch, yaw about fixed axes [deg]."""
        return self.get_pose().rpy_deg

    def set_rotation(self, rotation: ArrayLike, *, teleport: bool = False) -> None:
        """Turn the camera to roll, pitch, yaw about fixed axes [deg]."""
        roll, pitch, yaw = vector("rotation (roll, pitch, yaw)", rotation)
        request = SetRotation.Request(
            roll_deg=roll, pitch_deg=pitch, yaw_deg=yaw, teleport=teleport
        )
        self._call_own(SetRotation, "set_rotation", request)

    def get_pose(self) -> Pose:
        """Give the pose of the camera's body (x forward, y left, z up) in the world."""
        return pose_from_msg(self._call_own(GetPose, "get_pose", GetPose.Request()).pose.pose)

    def set_pose(self, pose: Pose, *, teleport: bool = False) -> None:
        """Move and turn the camera."""
        if not isinstance(pose, Pose):
            raise InvalidRequest("pose", pose, "a sailenv_ros.geometry.Pose")
        request = SetPose.Request(pose=pose_to_msg(pose), teleport=teleport)
        self._call_own(SetPose, "set_pose", request)

    def toggle_follow(self) -> bool:
        """Begin or end to follow the scene's mover; give the new state."""
        self._call_own(Trigger, "toggle_follow", Trigger.Request())
        return bool(self._call_own(GetPose, "get_pose", GetPose.Request()).following)

    def set_follow(self, following: bool) -> None:
        """Follow the scene's mover or stop."""
        self._call_own(SetBool, "set_follow", SetBool.Request(data=following))
