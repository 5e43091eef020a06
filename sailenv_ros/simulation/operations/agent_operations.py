"""Operations on agents: which there are, where they stand, what they see, one frame of theirs.

Where `agent` is None, it is the agent of the one who asks: an `Agent`'s own, a `Simulation`'s
first.
"""

from __future__ import annotations

from typing import Any

from numpy.typing import ArrayLike
from typing_extensions import Unpack

from sailenv_ros.errors import InvalidRequest, InvalidState
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.truth.amodal_masks import AmodalMasks
from sailenv_ros.simulation.operations import argument_checks as check
from sailenv_ros.simulation.operations.operation import Caller, operation
from sailenv_ros.simulation.operations.targets import DrawsFrames, HasAgents
from sailenv_ros.types.agents import RATE, AgentPose, AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.listed_views import Views, listed_views
from sailenv_ros.types.picture_settings import PictureChanges, PictureSettings
from sailenv_ros.types.validation import Bounds, vector
from sailenv_ros.types.views import FIVE_VIEWS

__all__ = ["AgentOperations", "set_following"]


def _agent_spec(what: str, value: object) -> AgentSpec:
    if not isinstance(value, AgentSpec):
        raise InvalidRequest(what, value, "a sailenv_ros.types.agents.AgentSpec")
    return value


def _intrinsics(what: str, value: object) -> CameraIntrinsics:
    if not isinstance(value, CameraIntrinsics):
        raise InvalidRequest(what, value, "a sailenv_ros.types.camera.CameraIntrinsics")
    return value


def _put(core: HasAgents, pose: Pose, agent: str | None, *, teleport: bool) -> None:
    before = core.agents[agent].spec
    was_driven = before.following and core.world.mover(before.mover).controller == "waypoint"
    core.agents.put(before.name, pose, core.world, teleport=teleport)
    if was_driven:
        core.announce()


def _set_pose(core: HasAgents, pose: Pose, agent: str | None, *, teleport: bool) -> None:
    ended = core.agents.turn_freely(core.agents[agent].spec.name, core.world)
    _put(core, pose, agent, teleport=teleport)
    if ended:
        core.announce()


def set_following(core: HasAgents, following: bool, agent: str | None) -> bool:
    """Have an agent follow its mover, or not; return the new state."""
    result = core.agents.set_follow(agent, following, core.world)
    core.announce()
    return result


class AgentOperations(Caller):
    """Cameras in the world. Positions are in metres, rotations in degrees about fixed axes."""

    @operation(spec=_agent_spec)
    @staticmethod
    def register_agent(core: HasAgents, spec: AgentSpec) -> AgentSpec:
        """Add an agent; return its description as accepted."""
        accepted = core.agents.add(spec, core.world)
        core.announce()
        return accepted

    @operation(name=check.text)
    @staticmethod
    def delete_agent(core: HasAgents, name: str) -> None:
        """Remove an agent and end its streams."""
        core.agents.remove(name)
        core.announce()

    # -- pose ------------------------------------------------------------------------------

    @operation()
    @staticmethod
    def get_agent_pose(core: HasAgents, *, agent: str | None = None) -> AgentPose:
        """Return where an agent is, when, and whether it follows a mover."""
        return core.agents.pose(agent, core.world)

    @operation(pose=check.pose)
    @staticmethod
    def set_pose(
        core: HasAgents, pose: Pose, *, teleport: bool = False, agent: str | None = None
    ) -> None:
        """Move and turn an agent, or the mover that it follows (which leaves its waypoints then).

        A set pose is motion, which flow shows; `teleport` makes the next frame one without flow.
        What agent and mover faced by `set_look_at` and `set_mover_look_at`, they face no more.
        """
        _set_pose(core, pose, agent, teleport=teleport)

    @operation(position=vector)
    @staticmethod
    def set_position(
        core: HasAgents,
        position: ArrayLike,
        *,
        teleport: bool = False,
        agent: str | None = None,
    ) -> None:
        """Move an agent to world coordinates [m] and leave its orientation; see `set_pose`.

        It keeps facing what it faces by `set_look_at`.
        """
        here = core.agents.carried_pose(core.agents[agent], core.world)
        moved = Pose(vector("position", position), here.orientation_xyzw)
        _put(core, moved, agent, teleport=teleport)

    @operation(rotation=vector)
    @staticmethod
    def set_rotation(
        core: HasAgents,
        rotation: ArrayLike,
        *,
        teleport: bool = False,
        agent: str | None = None,
    ) -> None:
        """Turn an agent to roll, pitch, yaw about fixed axes [deg] and leave its position."""
        here = core.agents.pose(agent, core.world).pose
        turned = Pose.from_rpy_deg(here.position_m, rotation)
        _set_pose(core, turned, agent, teleport=teleport)

    def get_pose(self, *, agent: str | None = None) -> Pose:
        """Return the pose of an agent's body (x forward, y left, z up) in the world."""
        return self.get_agent_pose(agent=agent).pose

    @operation()
    @staticmethod
    def set_follow(core: HasAgents, following: bool, *, agent: str | None = None) -> bool:
        """Follow the mover or stop following it; return the new state."""
        return set_following(core, following, agent)

    # -- camera ----------------------------------------------------------------------------

    @operation(rate_hz=RATE.number)
    @staticmethod
    def set_rate(core: HasAgents, rate_hz: float, *, agent: str | None = None) -> None:
        """Change how often an agent's frames are streamed [Hz of simulated time]; 0: never."""
        core.agents.set_rate(agent, rate_hz, core.world)
        core.announce()

    @operation(intrinsics=_intrinsics)
    @staticmethod
    def set_intrinsics(
        core: HasAgents, intrinsics: CameraIntrinsics, *, agent: str | None = None
    ) -> None:
        """Change the lens or the size of an agent's camera; its next frame has no flow."""
        core.agents.set_intrinsics(agent, intrinsics)
        core.announce()

    @operation()
    @staticmethod
    def get_picture(core: HasAgents, *, agent: str | None = None) -> PictureSettings:
        """Return how an agent's pictures are made."""
        return core.agents[agent].spec.picture

    @operation(settings=check.optional(PictureSettings.checked))
    @staticmethod
    def set_picture(
        core: HasAgents,
        settings: PictureSettings | None = None,
        /,
        *,
        agent: str | None = None,
        **changes: Unpack[PictureChanges],
    ) -> PictureSettings:
        """Change exposure, tone curve and effects of an agent's pictures from the next frame on.

        Ground truth does not depend on them. They are kept by a reset.

        Parameters
        ----------
        settings : PictureSettings or None
            All of them at once; None leaves what `changes` do not name.
        agent : str or None
        **changes
            Some of them by their names in `PictureSettings`.

        Returns
        -------
        settings : PictureSettings
            As they are then.

        >>> agent.set_picture(exposure=1.0, bloom=0.1)  # doctest: +SKIP
        """
        record = core.agents[agent]
        present = record.spec.picture
        given = present if settings is None else settings
        wanted = given.changed(changes)
        if settings is not None or changes:
            core.agents.set_picture(record.spec.name, wanted)
            core.announce()
        return wanted

    # -- frames ----------------------------------------------------------------------------

    @operation(views=check.optional(check.view_names))
    @staticmethod
    def capture(
        core: DrawsFrames, views: Views | None = None, *, agent: str | None = None
    ) -> Frame:
        """Render one frame of an agent now.

        It shows the world after every operation that was asked for before.

        Parameters
        ----------
        views : str, iterable of str or None
            Names in `sailenv_ros.types.views.VIEWS`; None means the agent's own.
        agent : str or None

        Returns
        -------
        frame : Frame
            Its arrays are read-only.
        """
        record = core.agents[agent]
        return core.render(record, record.spec.views if views is None else views)

    @operation(sequence=Bounds(least=0, most=2**63 - 1, whole=True).integer)
    @staticmethod
    def get_amodal_masks(
        core: DrawsFrames, sequence: int = 0, *, agent: str | None = None
    ) -> AmodalMasks:
        """Draw each object of an agent's last frame alone: what it covers, whatever hides it.

        `Frame.amodal` asks for it.

        Parameters
        ----------
        sequence : int
            Number of the frame; 0 for whichever was the last.
        agent : str or None

        Returns
        -------
        masks : AmodalMasks
            Those that an `Agent` receives have no depths.

        Raises
        ------
        InvalidState
            If that frame was not the agent's last, or it has none yet.
        NativeLibraryError
            If there is no native library, which draws them.
        """
        record = core.agents[agent]
        if record.latest is None:
            raise InvalidState(f"agent {record.spec.name!r} has no frame yet; capture one first")
        if sequence not in (0, record.sequence):
            raise InvalidState(
                f"frame {sequence} is no longer the last of agent {record.spec.name!r}, which is "
                f"{record.sequence}; ask for amodal masks before the next frame"
            )
        return core.draw_amodal(record.latest.snapshot, record.latest.camera)

    def get_frame(self, views: Views = (), *, agent: str | None = None) -> dict[str, Any]:
        """Render one frame now and return it as the dict of the SAILenv client.

        Parameters
        ----------
        views : str or iterable of str
            More views than the agent's own, for this frame alone.
        agent : str or None

        Returns
        -------
        frame : dict
            See `sailenv_ros.frame.frame.Frame.to_dict`; every array is the caller's own.
        """
        more = listed_views(views)
        wanted = (*self._own_views(agent), *more) if more else None
        return self.capture(wanted, agent=agent).to_dict()

    def _own_views(self, agent: str | None) -> tuple[str, ...]:
        """Return the views of an agent's frames, as announced."""
        name = agent or self.own_agent
        chosen = [spec for spec in self.info.agents if name in (None, spec.name)]
        return chosen[0].views if chosen else FIVE_VIEWS
