"""The blocking methods about agents: where they stand and what they see; part of `Requests`."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from numpy.typing import ArrayLike

from sailenv_ros.agents import AgentPose, AgentSpec
from sailenv_ros.camera import CameraIntrinsics
from sailenv_ros.frame import Frame
from sailenv_ros.geometry import Pose
from sailenv_ros.picture_settings import PictureSettings
from sailenv_ros.simulation.calls import Calls

__all__ = ["AgentCalls"]


class AgentCalls(Calls):
    """The requests of `AgentRequests`, and the capture of a frame."""

    def register_agent(self, spec: AgentSpec, *, timeout_s: float = 30.0) -> AgentSpec:
        """Add an agent; give its spec as accepted."""
        result: AgentSpec = self._ask("register_agent", timeout_s, spec)
        return result

    def delete_agent(self, name: str, *, timeout_s: float = 30.0) -> None:
        """Remove an agent and end its streams."""
        self._ask("delete_agent", timeout_s, name)

    def get_pose(self, agent: str, *, timeout_s: float = 30.0) -> AgentPose:
        """Say where an agent is."""
        result: AgentPose = self._ask("get_pose", timeout_s, agent)
        return result

    def set_pose(
        self, agent: str, pose: Pose, *, teleport: bool = False, timeout_s: float = 30.0
    ) -> None:
        """Move an agent, or the mover that it follows (which waypoints then drive no longer).

        A set pose is motion, which flow shows; `teleport` cuts the past off instead.
        """
        self._ask("set_pose", timeout_s, agent, pose, teleport=teleport)

    def set_position(
        self, agent: str, position_m: ArrayLike, *, teleport: bool = False, timeout_s: float = 30.0
    ) -> None:
        """Move an agent to world coordinates [m] and leave its orientation."""
        self._ask("set_position", timeout_s, agent, position_m, teleport=teleport)

    def set_rotation(
        self, agent: str, rpy_deg: ArrayLike, *, teleport: bool = False, timeout_s: float = 30.0
    ) -> None:
        """Turn an agent to roll, pitch, yaw about fixed axes [deg] and leave its position."""
        self._ask("set_rotation", timeout_s, agent, rpy_deg, teleport=teleport)

    def set_follow(self, agent: str, following: bool, *, timeout_s: float = 30.0) -> bool:
        """Follow the mover or stop; give the new state."""
        result: bool = self._ask("set_follow", timeout_s, agent, following)
        return result

    def toggle_follow(self, agent: str, *, timeout_s: float = 30.0) -> bool:
        """Change between following and not; give the new state."""
        result: bool = self._ask("toggle_follow", timeout_s, agent)
        return result

    def set_rate(self, agent: str, rate_hz: float, *, timeout_s: float = 30.0) -> None:
        """Change how often an agent's frames are streamed [Hz of simulated time]; 0: never."""
        self._ask("set_rate", timeout_s, agent, rate_hz)

    def set_intrinsics(
        self, agent: str, intrinsics: CameraIntrinsics, *, timeout_s: float = 30.0
    ) -> None:
        """Give an agent another lens or size; its next frame has no flow."""
        self._ask("set_intrinsics", timeout_s, agent, intrinsics)

    def get_picture(self, agent: str, *, timeout_s: float = 30.0) -> PictureSettings:
        """Say what is done to an agent's pictures."""
        result: PictureSettings = self._ask("get_picture", timeout_s, agent)
        return result

    def set_picture(
        self,
        agent: str,
        settings: PictureSettings | None = None,
        /,
        *,
        timeout_s: float = 30.0,
        **changes: Any,
    ) -> PictureSettings:
        """Change exposure, tone curve and effects of an agent's pictures from the next frame on.

        Ground truth does not depend on them.

        Parameters
        ----------
        agent : str
        settings : PictureSettings or None
            All of them at once; None leaves what `changes` do not name.
        **changes
            Some of them by their names in `PictureSettings`.

        Returns
        -------
        settings : PictureSettings
            As they are then.
        """
        result: PictureSettings = self._ask("set_picture", timeout_s, agent, settings, **changes)
        return result

    def capture(
        self, agent: str, views: Iterable[str] | None = None, *, timeout_s: float = 30.0
    ) -> Frame:
        """Render exactly one frame of an agent, after everything asked before."""
        wanted = None if views is None else tuple(views)
        result: Frame = self._ask("capture", timeout_s, agent, wanted)
        return result
