"""A frame as users hold it: its data, and what can be computed of them on request."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

from sailenv_ros.errors import InvalidState
from sailenv_ros.frame.data import DrawAmodal, FrameData
from sailenv_ros.frame.truth.amodal_masks import AmodalMasks
from sailenv_ros.frame.truth.frame_objects import keypoints_of, objects_of
from sailenv_ros.frame.truth.object_table import Keypoints, ObjectTable
from sailenv_ros.frame.truth.person_points import person_points, skeleton_of
from sailenv_ros.frame.truth.point_cloud import PointCloud, points_of

__all__ = ["Frame"]


@dataclass(frozen=True, slots=True)
class _DrawnAmodal:
    """Gives amodal masks that were drawn already."""

    masks: AmodalMasks

    def __call__(self, only: int = 0) -> AmodalMasks:
        return self.masks


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Frame(FrameData):
    """All views of one camera at one instant, with their objects, points and pictures.

    A mapping of the views' names to arrays: ``frame["depth"]``, ``"rgb" in frame``,
    ``frame.items()``. The attributes are those of `FrameData`.
    """

    @cached_property
    def objects(self) -> ObjectTable:
        """Ground truth of every object of the scene at the frame's instant, visible or not.

        Raises
        ------
        InvalidState
            If the scene of that instant is not known.
        """
        return objects_of(self)

    @cached_property
    def amodal(self) -> AmodalMasks:
        """Amodal masks: the pixels of each object, drawn alone; drawn at the first request.

        Raises
        ------
        InvalidState
            If the frame's objects cannot be drawn alone: amodal masks were not recorded, or the
            simulator has rendered a later frame of that agent.
        SimulationClosed
            If the simulation has ended.
        """
        if self.draw_amodal is None:
            raise InvalidState(
                "the frame has no amodal masks: ask a frame of a Simulation or of an Agent for "
                "them, before it is sent to another process, or record them"
            )
        return self.draw_amodal()

    def amodal_of(self, instance_id: int) -> AmodalMasks:
        """Return what one object covers, perhaps among others; quicker than `amodal`.

        Raises
        ------
        InvalidRequest
            If there is no object of that id.
        InvalidState, SimulationClosed
            As `amodal`.
        """
        if self.draw_amodal is None or "amodal" in self.__dict__:
            return self.amodal
        return self.draw_amodal(instance_id)

    @property
    def objects_with_amodal(self) -> ObjectTable:
        """The table of `objects` with the columns of `amodal`; see both for errors."""
        return self.objects.with_amodal(self.amodal)

    def keypoints(self, instance_id: int) -> Keypoints:
        """Return the named points of an object; the corners of its box if its asset names none.

        Raises
        ------
        InvalidRequest, InvalidState
            If there is no object of that id, or the scene is not known.
        """
        return keypoints_of(self, self.objects, instance_id)

    def joints(self, instance_id: int) -> Keypoints:
        """Return all joints of a person or an animal, as `keypoints` returns keypoints.

        Raises
        ------
        InvalidRequest
            If there is nobody of that id.
        """
        own = skeleton_of(self, instance_id)
        return person_points(self, instance_id, own.joint_names, own.joints)

    def points(self, *, in_world: bool = True) -> PointCloud:
        """Return the points that the pixels see, with their colours and labels.

        Parameters
        ----------
        in_world : bool
            False gives points in the camera's optical frame.

        Raises
        ------
        UnknownName
            If the frame has no depth.
        """
        return points_of(self, in_world=in_world)

    def field_values(self) -> dict[str, Any]:
        """Return the arguments of the constructor that make an equal frame in any process."""
        drawn = {"draw_amodal": self.amodal_source} if "amodal" in self.__dict__ else {}
        return {**super().field_values(), **drawn}

    @property
    def amodal_source(self) -> DrawAmodal | None:
        """Source of amodal masks for a copy: those that are drawn, else what draws them here."""
        return _DrawnAmodal(self.amodal) if "amodal" in self.__dict__ else self.draw_amodal

    def to_dict(self, *, copy: bool = True) -> dict[str, Any]:
        """Return the frame as the dict of the SAILenv client, with more in it.

        Parameters
        ----------
        copy : bool
            False hands this frame's own arrays over: nobody else may hold them, and the frame must
            not be used afterwards.

        Returns
        -------
        frame : dict
            See `sailenv_ros.frame.pictures.frame_dict.frame_dict`; every array is the caller's own.
        """
        from sailenv_ros.frame.pictures.frame_dict import frame_dict  # needs OpenCV

        return frame_dict(self, copy=copy)

    def _repr_html_(self) -> str:
        """Return the views as pictures, for notebooks."""
        from sailenv_ros.frame.html import frame_html  # needs Pillow

        return frame_html(self)
