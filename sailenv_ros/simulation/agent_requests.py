"""The requests about agents: which there are, where they stand, how often they are rendered.

Part of `SimulationCore`; each method does all of it or raises and leaves everything as it was.
Knows no thread and no renderer.
"""

from __future__ import annotations

from typing import Any

from sailenv_ros.agents import AgentPose, AgentSpec
from sailenv_ros.camera import CameraIntrinsics
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.geometry import Pose
from sailenv_ros.picture_settings import PictureSettings
from sailenv_ros.simulation.agent_table import AgentTable
from sailenv_ros.world.world import World

__all__ = ["AgentRequests"]


class AgentRequests:
    """What clients may ask of the agents; `SimulationCore` has them."""

    _agents: AgentTable
    _world: World

    def register_agent(self, spec: AgentSpec) -> AgentSpec:
        """Add an agent; give its spec as accepted."""
        accepted = self._agents.add(spec, self._world)
        self._announce()
        return accepted

    def delete_agent(self, name: str) -> None:
        """Remove an agent and end its streams."""
        self._agents.remove(name)
        self._announce()

    def get_pose(self, agent: str) -> AgentPose:
        """Say where an agent is."""
        return self._agents.pose(agent, self._world)

    def set_pose(self, agent: str, pose: Pose, *, teleport: bool = False) -> None:
        """Move an agent, or the mover that it follows."""
        before = self._agents[agent].spec
        was_driven = before.following and self._world.mover(before.mover).controller == "waypoint"
        self._agents.put(agent, pose, self._world, teleport=teleport)
        if was_driven:
            self._announce()

    def set_position(self, agent: str, position_m: Any, *, teleport: bool = False) -> None:
        """Move an agent and leave its orientation."""
        here = self.get_pose(agent).pose
        moved = Pose(position_m, here.orientation_xyzw)
        self.set_pose(agent, moved, teleport=teleport)

    def set_rotation(self, agent: str, rpy_deg: Any, *, teleport: bool = False) -> None:
        """Turn an agent to roll, pitch, yaw [deg] and leave its position."""
        here = self.get_pose(agent).pose
        self.set_pose(agent, Pose.from_rpy_deg(here.position_m, rpy_deg), teleport=teleport)

    def set_follow(self, agent: str, following: bool) -> bool:
        """Follow the mover or stop; give the new state."""
        result = self._agents.set_follow(agent, bool(following), self._world)
        self._announce()
        return result

    def toggle_follow(self, agent: str) -> bool:
        """Change between following and not; give the new state."""
        return self.set_follow(agent, not self._agents[agent].spec.following)

    def set_rate(self, agent: str, rate_hz: float) -> None:
        """Change how often an agent's frames are streamed [Hz of simulated time]; 0: never."""
        self._agents.set_rate(agent, rate_hz, self._world)
        self._announce()

    def set_intrinsics(self, agent: str, intrinsics: CameraIntrinsics) -> None:
        """Give an agent another lens; its next frame has no flow, for it has no past."""
        self._agents.set_intrinsics(agent, intrinsics)
        self._announce()

    def get_picture(self, agent: str) -> PictureSettings:
        """Say what is done to an agent's pictures."""
        return self._agents[agent].spec.picture

    def set_picture(
        self, agent: str, settings: PictureSettings | None = None, /, **changes: Any
    ) -> PictureSettings:
        """Change what is done to an agent's pictures, and to nothing else.

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
        present = self.get_picture(agent)
        given: object = present if settings is None else settings
        if not isinstance(given, PictureSettings):
            raise InvalidRequest("settings", given, "an object of PictureSettings")
        wanted = given.changed(changes)
        if settings is not None or changes:
            self._agents.set_picture(agent, wanted)
            self._announce()
        return wanted

    # -- of the simulation -----------------------------------------------------------------

    def _announce(self) -> None:
        raise NotImplementedError
