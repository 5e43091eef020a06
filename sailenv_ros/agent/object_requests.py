"""What a user asks about objects, models and scenarios, by the original client's names.

Part of `SimulatorClient`. Positions are in metres, rotations in degrees about fixed axes; ids are
the values of pixels.
"""

from __future__ import annotations

import array
import json
import operator
from collections.abc import Mapping, Sequence
from numbers import Real
from pathlib import Path
from typing import Any, BinaryIO

from numpy.typing import ArrayLike

from sailenv_msgs.srv import (
    AddBehaviour,
    DespawnObject,
    GetObject,
    LoadScenario,
    MoveObject,
    RemoveBehaviours,
    SpawnObject,
    UploadModel,
)
from sailenv_msgs_py.objects import behaviour_to_msg, object_state_from_response
from sailenv_msgs_py.transforms import pose_to_msg, vector_to_msg
from sailenv_ros.agent.asking import Asking, text_of
from sailenv_ros.errors import InvalidRequest, UnknownName
from sailenv_ros.geometry import Pose, vector
from sailenv_ros.labels import MAX_INSTANCE_ID
from sailenv_ros.objects import ObjectState
from sailenv_ros.scene.entries import plain_value

__all__ = ["ObjectRequests"]

UPLOAD_S = 120.0
"""How long an upload may take unless told otherwise [s]."""


class ObjectRequests(Asking):
    """Requests about objects; see `SimulatorClient`."""

    @property
    def spawnable_objects_names(self) -> list[str]:
        """Names of the catalogue that may be spawned."""
        return list(self._info.spawnables)

    def spawn_object(
        self,
        name: str,
        position: ArrayLike = (0.0, 0.0, 0.0),
        rotation: ArrayLike = (0.0, 0.0, 0.0),
        remove_dynamics: bool | None = None,
        scale: ArrayLike = (1.0, 1.0, 1.0),
        use_parent: bool = True,
        *,
        object_name: str = "",
        category: str = "",
        behaviours: Sequence[Mapping[str, Any]] = (),
        mass_kg: float = 0.0,
    ) -> int:
        """Put one more object into the scene.

        Parameters
        ----------
        name : str
            One of `spawnable_objects_names`, a display name, or what `send_obj_zip` gave.
        position : (3,) array-like
            Of its origin [m].
        rotation : (3,) array-like
            Roll, pitch, yaw about fixed axes [deg].
        remove_dynamics : bool or None
            True if physics shall never move it; None means True unless it has behaviours or a
            mass.
        scale : float or (3,) array-like
            Along the asset's axes, 0.001 to 1000.
        use_parent : bool
            Without a meaning here, where objects have no parents; the original's scripts pass it.
        object_name : str
            Unique in the scene; empty makes one of the asset's.
        category : str
            Instead of the asset's.
        behaviours : sequence of mapping
            What moves it of itself, as in a scene file: ``type`` and the parameters.
        mass_kg : float
            0 takes the asset's, scaled [kg].

        Returns
        -------
        id : int
            The value of its pixels in the instance view, and what the other requests take.
        """
        static = not (behaviours or mass_kg) if remove_dynamics is None else remove_dynamics
        request = SpawnObject.Request(
            asset=text_of("name", name),
            name=text_of("object_name", object_name),
            pose=pose_to_msg(Pose.from_rpy_deg(position, rotation)),
            scale=vector_to_msg(_scale(scale)),
            is_static=bool(static),
            mass_kg=_number("mass_kg", mass_kg),
            category=text_of("category", category),
            behaviours=[behaviour_to_msg(behaviour) for behaviour in behaviours],
        )
        epoch = self._info.epoch
        id_ = int(self._call(SpawnObject, "spawn_object", request).id)
        self._await_info(
            lambda info: info.epoch > epoch or any(i.id == id_ for i in info.instances),
            f"the spawned {name!r}",
        )
        return id_

    def despawn_object(self, obj: int | str) -> None:
        """Take an object, named by id or name, out of the scene; its id is not used again."""
        id_, epoch = self._object_id(obj), self._info.epoch
        self._call(DespawnObject, "despawn_object", DespawnObject.Request(id=id_))
        self._await_info(
            lambda info: info.epoch > epoch or all(i.id != id_ for i in info.instances),
            f"the end of object {obj!r}",
        )

    def move_object(
        self,
        obj: int | str,
        position: ArrayLike,
        rotation: ArrayLike | None = None,
        *,
        teleport: bool = False,
    ) -> None:
        """Move an object and stop it.

        Parameters
        ----------
        obj : int or str
            Its id or name.
        position : (3,) array-like
            Of its origin [m].
        rotation : (3,) array-like or None
            Roll, pitch, yaw about fixed axes [deg]; None leaves it turned as it is.
        teleport : bool
            False is motion, which flow shows; True cuts its past off.
        """
        id_ = self._object_id(obj)
        if rotation is None:
            pose = Pose(vector("position", position), self.get_object(id_).pose.orientation_xyzw)
        else:
            pose = Pose.from_rpy_deg(position, rotation)
        request = MoveObject.Request(id=id_, pose=pose_to_msg(pose), teleport=bool(teleport))
        self._call(MoveObject, "move_object", request)

    def get_object(self, obj: int | str) -> ObjectState:
        """Say what and where an object, named by id or name, is now."""
        request = GetObject.Request(id=self._object_id(obj))
        return object_state_from_response(self._call(GetObject, "get_object", request))

    def add_behaviour(self, obj: int | str, behaviour: Mapping[str, Any]) -> None:
        """Let an object move of itself, beside the behaviours that it has.

        Parameters
        ----------
        obj : int or str
            Its id or name; not a static one.
        behaviour : mapping
            As in a scene file: ``type`` and the parameters.
        """
        request = AddBehaviour.Request(
            id=self._object_id(obj), behaviour=behaviour_to_msg(behaviour)
        )
        self._call(AddBehaviour, "add_behaviour", request)

    def remove_behaviours(self, obj: int | str) -> None:
        """End everything that makes an object move of itself."""
        request = RemoveBehaviours.Request(id=self._object_id(obj))
        self._call(RemoveBehaviours, "remove_behaviours", request)

    def send_obj_zip(
        self,
        file: str | Path | BinaryIO,
        filename: str | None = None,
        *,
        name: str = "",
        category: str = "",
        height_m: float = 0.0,
        timeout_s: float = UPLOAD_S,
    ) -> str:
        """Upload a model, so that it can be spawned.

        Parameters
        ----------
        file : str, Path or binary file
            A zip archive of one obj with its mtl and textures, or a glb; at most 64 MB.
        filename : str or None
            Its name, of which the ending counts; needed where an open file is given.
        name : str
            Name in the catalogue; empty makes one of the file's name.
        category : str
            Name of its category; empty leaves it unlabelled.
        height_m : float
            Height that it is scaled to [m]; 0 takes its unit for the metre.
        timeout_s : float
            Deadline [s]; finding its collision pieces takes time.

        Returns
        -------
        name : str
            What `spawn_object` takes.
        """
        data, filename = _content(file, filename)
        request = UploadModel.Request(
            filename=filename,
            name=text_of("name", name),
            category=text_of("category", category),
            height_m=_number("height_m", height_m),
        )
        request.data = array.array("B", data)
        asset = str(self._call(UploadModel, "upload_model", request, timeout_s).asset)
        self._await_info(lambda info: asset in info.spawnables, f"the model {asset!r}")
        return asset

    def load_scenario(self, scenario: Mapping[str, Any] | str | Path) -> list[int]:
        """Begin a scene with more objects than its own, for all agents.

        Parameters
        ----------
        scenario : mapping, str or Path
            `scene` (its name; left out: the present one) and `objects` (as in a scene file): as a
            mapping, as YAML or JSON text, or as the path of a file with it.

        Returns
        -------
        ids : list of int
            Of the objects, in their order.
        """
        epoch = self._info.epoch
        request = LoadScenario.Request(document=_document(scenario))
        answer = self._call(LoadScenario, "load_scenario", request)
        self._await_info(lambda info: info.epoch > epoch, "the scenario")
        return [int(id_) for id_ in answer.ids]

    # -- inside ----------------------------------------------------------------------------

    def _object_id(self, obj: Any) -> int:
        """Give the id of an object, which the original's scripts hold as a decimal text."""
        ids = {instance.name: instance.id for instance in self._info.instances}
        if isinstance(obj, str) and obj in ids:
            return ids[obj]
        if isinstance(obj, str) and not obj.isdecimal():
            raise UnknownName("object", obj, ids)
        if isinstance(obj, bool):
            raise InvalidRequest("object", obj, "an instance id, or the name of an object")
        try:
            id_ = operator.index(int(obj) if isinstance(obj, str) else obj)
        except TypeError:
            accepted = "an instance id, or the name of an object"
            raise InvalidRequest("object", obj, accepted) from None
        if not 0 < id_ <= MAX_INSTANCE_ID:
            raise InvalidRequest("object", obj, f"an id from 1 to {MAX_INSTANCE_ID}")
        return id_


def _scale(scale: Any) -> tuple[float, float, float]:
    one = isinstance(scale, int | float) and not isinstance(scale, bool)
    factors = vector("scale", (scale, scale, scale) if one else scale)
    if not any(factors):
        # On the wire it would mean 1.
        raise InvalidRequest("scale", factors, "one number, or three, from 0.001 to 1000")
    return factors


def _number(what: str, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, Real):
        raise InvalidRequest(what, value, "a number")
    return float(value)


def _content(file: Any, filename: str | None) -> tuple[bytes, str]:
    """Read an uploaded file; give its bytes and its name."""
    if isinstance(file, str | Path):
        try:
            return Path(file).read_bytes(), filename or Path(file).name
        except OSError as problem:
            raise InvalidRequest("file", str(file), f"one that can be read ({problem})") from None
    if filename is None or not hasattr(file, "read"):
        raise InvalidRequest("file", file, "a path, or an open binary file with its filename")
    data = file.read()
    if not isinstance(data, bytes):
        raise InvalidRequest("file", file, "open for bytes, not for text")
    return data, text_of("filename", filename)


def _document(scenario: object) -> str:
    if isinstance(scenario, Path):
        try:
            return scenario.read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as problem:
            raise InvalidRequest("scenario", str(scenario), f"a file ({problem})") from None
    if isinstance(scenario, str):
        return scenario
    try:
        return json.dumps(plain_value(scenario))
    except (TypeError, ValueError):
        raise InvalidRequest("scenario", scenario, "of texts, numbers, lists, mappings") from None
