"""Operations on rigs: the frames of all cameras of one body, at one instant."""

from __future__ import annotations

from typing import Any

from sailenv_ros.frame.frame import Frame
from sailenv_ros.simulation.operations import argument_checks as check
from sailenv_ros.simulation.operations.operation import Caller, operation
from sailenv_ros.simulation.operations.targets import DrawsFrames
from sailenv_ros.types.listed_views import Views
from sailenv_ros.types.rigs import camera_of

__all__ = ["RigOperations"]


class RigOperations(Caller):
    """Several cameras on one body. Each is also an agent, called ``<agent>/<camera>``."""

    @operation(views=check.optional(check.view_names))
    @staticmethod
    def capture_rig(
        core: DrawsFrames, views: Views | None = None, *, agent: str | None = None
    ) -> dict[str, Frame]:
        """Render one frame of each camera of a rig now, all of one instant.

        Parameters
        ----------
        views : str, iterable of str or None
            Views of each; None means each camera's own.
        agent : str or None
            The agent whose body carries the cameras.

        Returns
        -------
        frames : dict of str to Frame
            By the cameras' names in the rig, in the order they were given. Stamp and scene are the
            same; flow and occlusion refer to each camera's own last frame.

        Raises
        ------
        UnknownName, InvalidState
            If there is no such agent or view, or the agent has no cameras.
        """
        cameras = core.agents.rig(agent)
        frames = core.render_all(
            [(record, record.spec.views if views is None else views) for record in cameras]
        )
        return {
            camera_of(record.spec.name): frame
            for record, frame in zip(cameras, frames, strict=True)
        }

    def get_frames(
        self, views: Views | None = None, *, agent: str | None = None
    ) -> dict[str, dict[str, Any]]:
        """Render one frame of each camera of a rig now, as dicts of the SAILenv client.

        Parameters
        ----------
        views, agent
            As of `capture_rig`.

        Returns
        -------
        frames : dict of str to dict
            By the cameras' names in the rig; see `Frame.to_dict`.
        """
        frames = self.capture_rig(views, agent=agent)
        return {name: frame.to_dict() for name, frame in frames.items()}
