"""The operation that chooses camera poses by a rule."""

from __future__ import annotations

from typing import Any

from sailenv_ros.authoring.viewpoints import CameraView, sample_cameras
from sailenv_ros.simulation.operations import argument_checks as check
from sailenv_ros.simulation.operations.operation import Caller, operation
from sailenv_ros.simulation.operations.targets import ViewsScene

__all__ = ["ViewpointOperations"]


class ViewpointOperations(Caller):
    """Places for cameras; see docs/space.md."""

    @operation(
        deadline_s=300.0,
        rule=check.text,
        name=check.text,
        seed=check.optional(check.seed),
        agent=check.optional(check.text),
    )
    @staticmethod
    def sample_cameras(
        core: ViewsScene,
        rule: str,
        /,
        count: int = 1,
        *,
        name: str = "",
        seed: int | None = None,
        agent: str | None = None,
        **settings: Any,
    ) -> tuple[CameraView, ...]:
        """Choose camera poses by a rule, for an agent's lens; nothing moves.

        Parameters
        ----------
        rule : str
            ``object_view``, ``free_view`` or ``coverage``; see docs/space.md.
        count : int
            How many, 1 to 10,000.
        name : str
            What they are for: the same rule, settings, name and seed give the same poses in the
            same scene.
        seed : int or None
            None takes that of the scene.
        agent : str or None
            Whose lens it is.
        **settings
            Of the rule, those that shall differ from its own.

        Returns
        -------
        views : tuple of CameraView
            Pose, and the id of the object that it looks at; fewer than `count` if no more were
            found.

        Raises
        ------
        UnknownName, InvalidEntry, InvalidRequest
            If there is no such rule, or a setting is wrong.
        """
        scene = core.view_scene(core.agents[agent].spec.intrinsics)
        used = core.seed if seed is None else seed
        views = sample_cameras(scene, rule, count, seed=used, name=name, settings=settings)
        return tuple(views)
