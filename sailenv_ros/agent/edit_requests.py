"""What a user asks in order to edit a scene: objects, surroundings, movers, saving.

Part of `SimulatorClient`. Positions are in metres, rotations in degrees about fixed axes; keys and
values of objects and surroundings are those of a scene file.
"""

from __future__ import annotations

import io
from collections.abc import Collection, Sequence
from typing import Any

import numpy as np
from geometry_msgs.msg import Twist
from numpy.typing import ArrayLike, NDArray
from PIL import Image

from sailenv_msgs.srv import (
    ChangeObject,
    DriveMover,
    GetThumbnail,
    SaveScene,
    SetEnvironment,
    SetMoverController,
    SetWaypoints,
)
from sailenv_msgs_py.objects import keys_to_json
from sailenv_msgs_py.transforms import pose_to_msg, vector_to_msg
from sailenv_ros.agent.asking import Asking, text_of
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.geometry import Pose, vector
from sailenv_ros.scene_info import MoverInfo

__all__ = ["EditRequests"]

SLOW_S = 60.0
"""How long saving with models, or the first picture of the catalogue, may take [s]."""


class EditRequests(Asking):
    """Requests of an editor; see `SimulatorClient`."""

    # -- objects and surroundings ----------------------------------------------------------

    def change_object(self, obj: int | str, /, **changes: Any) -> None:
        """Change what an object is; its id, its place and its motion stay.

        Parameters
        ----------
        obj : int or str
            Its id or name; not a part of a room.
        **changes
            ``name``, ``category``, ``scale``, ``static``, ``mass``, ``gravity``, ``friction``,
            ``restitution``, ``colour``, ``metallic``, ``roughness``, as in a scene file; None
            takes the asset's own. Where the scale changes, the next frame has no flow.

        >>> agent.change_object("chair 1", scale=1.2, colour="#aa3311")  # doctest: +SKIP
        """
        text = keys_to_json("changes of an object", changes)
        request = ChangeObject.Request(id=self._object_id(obj), changes_json=text)
        self._announced(ChangeObject, "change_object", request, "the changed object")

    def set_environment(self, /, **changes: Any) -> None:
        """Change the surroundings, by the keys of `environment` in a scene file.

        >>> agent.set_environment(sky_map="forest", exposure=0.5)  # doctest: +SKIP
        """
        text = keys_to_json("changes of the environment", changes)
        request = SetEnvironment.Request(changes_json=text)
        self._announced(SetEnvironment, "set_environment", request, "the changed surroundings")

    # -- movers ----------------------------------------------------------------------------

    @property
    def movers(self) -> dict[str, MoverInfo]:
        """The movers by their names, with what drives them and their tracks; the first first."""
        return {mover.name: mover for mover in self._info.movers}

    def set_mover_controller(self, controller: str, mover: str = "") -> None:
        """Choose what drives a mover.

        Parameters
        ----------
        controller : {'waypoint', 'rigidbody'}
            Its waypoints, from where they were interrupted; or commands and set poses.
        mover : str
            Its name; empty means the scene's first.
        """
        request = SetMoverController.Request(
            mover=text_of("mover", mover), controller=text_of("controller", controller)
        )
        self._call(SetMoverController, "set_mover_controller", request)
        self._await_info(
            lambda info: any(
                m.controller == controller for m in info.movers if m.name == mover or not mover
            ),
            f"the controller {controller!r}",
        )

    def drive_mover(
        self,
        linear_m_s: ArrayLike = (0.0, 0.0, 0.0),
        angular_rad_s: ArrayLike = (0.0, 0.0, 0.0),
        mover: str = "",
    ) -> None:
        """Have a mover walk for half a simulated second, unless another command comes.

        Parameters
        ----------
        linear_m_s : (3,) array-like
            Forward and left along the ground, up along the world's z, each within 5 [m/s].
        angular_rad_s : (3,) array-like
            0, pitch (down is positive), yaw (left is positive), each within 5 [rad/s].
        mover : str
            Its name; empty means the scene's first. Its controller must be ``rigidbody``.
        """
        command = Twist(
            linear=vector_to_msg(vector("linear_m_s", linear_m_s)),
            angular=vector_to_msg(vector("angular_rad_s", angular_rad_s)),
        )
        request = DriveMover.Request(mover=text_of("mover", mover), command=command)
        self._call(DriveMover, "drive_mover", request)

    def set_waypoints(
        self,
        waypoints: Sequence[Pose | tuple[ArrayLike, ArrayLike]],
        mover: str = "",
        *,
        append: bool = False,
        total_time_s: float | None = None,
        loop: bool | None = None,
    ) -> None:
        """Give a mover another track; `movers` tells the one that it has.

        Parameters
        ----------
        waypoints : sequence of Pose, or of pairs of a position and a rotation
            [m] and roll, pitch, yaw [deg]; at most 1000. None of them leaves it where it is.
        mover : str
            Its name; empty means the scene's first.
        append : bool
            True adds them to those that it has.
        total_time_s : float or None
            Time to run through all of them once [s]; None leaves it as it is.
        loop : bool or None
            True if the last leads on to the first; None leaves it as it is.
        """
        if total_time_s is not None and not total_time_s > 0.0:
            raise InvalidRequest("total_time_s", total_time_s, "a number above 0 [s]")
        kinds = {None: "AS_IT_IS", True: "CLOSED", False: "OPEN"}
        request = SetWaypoints.Request(
            mover=text_of("mover", mover),
            waypoints=[pose_to_msg(_pose(waypoint)) for waypoint in waypoints],
            append=bool(append),
            total_time=0.0 if total_time_s is None else float(total_time_s),
            loop=getattr(SetWaypoints.Request, kinds[None if loop is None else bool(loop)]),
        )
        self._announced(SetWaypoints, "set_waypoints", request, "the new track")

    def add_waypoint(
        self, position: ArrayLike, rotation: ArrayLike = (0.0, 0.0, 0.0), mover: str = ""
    ) -> None:
        """Lengthen a mover's track by a position [m] and roll, pitch, yaw [deg]."""
        self.set_waypoints([(position, rotation)], mover, append=True)

    # -- the scene and the catalogue -------------------------------------------------------

    def save_scene(
        self,
        name: str,
        *,
        overwrite: bool = False,
        title: str = "",
        cameras: Collection[str] = (),
        keep_models: bool = False,
    ) -> str:
        """Write the present world as a scene file, which `change_scene` takes from then on.

        Parameters
        ----------
        name : str
            Of the scene: letters, digits, spaces, ``_`` or ``-``. Not that of a scene elsewhere.
        overwrite : bool
            True replaces a saved scene of that name.
        title : str
            One line for people; empty leaves that of the present scene.
        cameras : collection of str
            Agents to be saved beside those that the scene brought along.
        keep_models : bool
            True puts uploaded models that the scene holds into your own pack, without which it
            could not be loaded again.

        Returns
        -------
        path : str
            Of the file, on the simulator's machine.
        """
        request = SaveScene.Request(
            name=text_of("name", name),
            overwrite=bool(overwrite),
            title=text_of("title", title),
            cameras=[text_of("camera", camera) for camera in cameras],
            keep_models=bool(keep_models),
        )
        path = str(self._call(SaveScene, "save_scene", request, SLOW_S).path)
        self._await_info(lambda info: name in info.scenes, f"the scene {name!r}")
        return path

    def get_thumbnail(self, name: str) -> NDArray[np.uint8]:
        """Give a picture of an object of the catalogue, (120, 160, 3) uint8 BGR."""
        request = GetThumbnail.Request(asset=text_of("name", name))
        answer = self._call(GetThumbnail, "get_thumbnail", request, SLOW_S)
        with Image.open(io.BytesIO(bytes(answer.png))) as picture:
            return np.asarray(picture.convert("RGB"))[..., ::-1].copy()

    # -- inside ----------------------------------------------------------------------------

    def _announced(self, srv_type: Any, service: str, request: Any, what: str) -> None:
        """Ask for a change, and wait until it is announced."""
        before = self._info
        self._call(srv_type, service, request)
        self._await_info(lambda info: info is not before, what)

    def _object_id(self, obj: Any) -> int:
        """Give the id of an object."""
        raise NotImplementedError


def _pose(waypoint: Any) -> Pose:
    if isinstance(waypoint, Pose):
        return waypoint
    if not isinstance(waypoint, Sequence) or len(waypoint) != 2:
        raise InvalidRequest("waypoint", waypoint, "a Pose, or a pair of position and rotation")
    return Pose.from_rpy_deg(waypoint[0], waypoint[1])
