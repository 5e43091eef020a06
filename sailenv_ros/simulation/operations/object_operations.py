"""Operations on objects: what stands in a scene, and what moves it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from numpy.typing import ArrayLike
from typing_extensions import Unpack

from sailenv_ros.behaviours import STEP_S
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.scene.requested_changes import ObjectChanges
from sailenv_ros.simulation.operations import argument_checks as check
from sailenv_ros.simulation.operations.operation import Caller, operation
from sailenv_ros.simulation.operations.targets import BeginsScenes, HasEditor, HasLibrary, HasWorld
from sailenv_ros.types.contacts import Contact
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.objects import ObjectState
from sailenv_ros.types.validation import Bounds, vector

__all__ = ["ObjectOperations"]


def _behaviours(what: str, value: Any) -> tuple[Mapping[str, Any], ...]:
    if isinstance(value, str | Mapping) or not hasattr(value, "__iter__"):
        raise InvalidRequest(what, value, "a list of behaviours, as in a scene file")
    return tuple(check.behaviour("behaviour", item) for item in value)


def _scenario(what: str, value: Any) -> str | Mapping[str, Any]:
    if isinstance(value, Path):
        try:
            return value.read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as problem:
            raise InvalidRequest(what, str(value), f"a file ({problem})") from None
    if not isinstance(value, str | Mapping):
        raise InvalidRequest(what, value, "a mapping with scene, objects, timings, or its text")
    return value


class ObjectOperations(Caller):
    """Objects. They are named by instance id, the value of their pixels, or by name.

    Positions are in metres, rotations are roll, pitch, yaw about fixed axes in degrees.
    """

    @operation(
        name=check.text,
        position=check.optional(vector),
        rotation=check.optional(vector),
        scale=check.scale,
        pose=check.optional(check.pose),
        object_name=check.text,
        category=check.text,
        behaviours=_behaviours,
        mass_kg=check.number,
    )
    @staticmethod
    def spawn_object(
        core: HasEditor,
        name: str,
        position: ArrayLike | None = None,
        rotation: ArrayLike | None = None,
        remove_dynamics: bool | None = None,
        scale: ArrayLike = (1.0, 1.0, 1.0),
        use_parent: bool = True,
        *,
        pose: Pose | None = None,
        object_name: str = "",
        category: str = "",
        behaviours: Sequence[Mapping[str, Any]] = (),
        mass_kg: float = 0.0,
    ) -> int:
        """Add an object to the scene; return its instance id.

        Parameters
        ----------
        name : str
            One of `info.spawnables`, a display name, or what `send_obj_zip` returned.
        position : (3,) array-like or None
            Of the asset's origin, world frame [m]; None is the world's origin.
        rotation : (3,) array-like or None
            Roll, pitch, yaw about fixed axes [deg]; None turns nothing.
        remove_dynamics : bool or None
            True if physics shall never move it; None means True unless it has behaviours or a
            mass.
        scale : float or (3,) array-like
            Along the asset's axes, 0.001 to 1000.
        use_parent : bool
            No effect: objects have no parents here. Scripts of the SAILenv client pass it.
        pose : Pose or None
            Instead of position and rotation, not beside them.
        object_name : str
            Unique in the scene; empty makes one of the asset's.
        category : str
            Empty takes the asset's.
        behaviours : sequence of mapping
            What moves it, as in a scene file: ``type`` and the parameters. They start now.
        mass_kg : float
            0 takes the asset's, scaled [kg].

        Raises
        ------
        UnknownName, NameTaken, InvalidEntry, AssetError
            If it cannot be placed; the scene is as it was then.
        """
        is_static = not (behaviours or mass_kg) if remove_dynamics is None else remove_dynamics
        entry = {
            "name": object_name or core.editor.free_name(name),
            "asset": name,
            "scale": scale,
            "static": bool(is_static),
            "behaviours": behaviours,
        }
        if category:
            entry["category"] = category
        if mass_kg:
            entry["mass"] = mass_kg
        return core.editor.spawn(entry, check.pose_of(position, rotation, pose))

    @operation(obj=check.object_reference)
    @staticmethod
    def despawn_object(core: HasEditor, obj: int | str) -> None:
        """Remove an object from the scene; its id is not used again."""
        number = core.world.find(obj)
        core.editor.require_untaught(number)
        core.world.despawn(number)
        core.announce()

    @operation(
        obj=check.object_reference,
        position=check.optional(vector),
        rotation=check.optional(vector),
        pose=check.optional(check.pose),
    )
    @staticmethod
    def move_object(
        core: HasWorld,
        obj: int | str,
        position: ArrayLike | None = None,
        rotation: ArrayLike | None = None,
        *,
        pose: Pose | None = None,
        teleport: bool = False,
    ) -> None:
        """Move an object and stop it.

        Parameters
        ----------
        obj : int or str
        position : (3,) array-like or None
            Of its origin [m]; None leaves it where it is.
        rotation : (3,) array-like or None
            Roll, pitch, yaw about fixed axes [deg]; None leaves it turned as it is.
        pose : Pose or None
            Instead of position and rotation, not beside them.
        teleport : bool
            False is motion, which flow shows; True gives the object no flow in the next frame.
        """
        number = core.world.find(obj)
        if pose is None:
            here = core.world.body(number).pose()
            at = here.position_m if position is None else position
            to = (
                Pose(vector("position", at), here.orientation_xyzw)
                if rotation is None
                else Pose.from_rpy_deg(at, rotation)
            )
        else:
            to = check.pose_of(position, rotation, pose)
        core.world.put_body(number, to, teleport=teleport)

    @operation(obj=check.object_reference)
    @staticmethod
    def change_object(core: HasEditor, obj: int | str, /, **changes: Unpack[ObjectChanges]) -> None:
        """Change what an object is; its id, its place and its motion stay.

        Parameters
        ----------
        obj : int or str
            Not a part of a room.
        **changes
            ``name``, ``category``, ``scale``, ``static``, ``mass``, ``gravity``, ``friction``,
            ``restitution``, ``colour``, ``metallic``, ``roughness``, ``materials``, as in a scene
            file; None takes the asset's own. Where the scale changes, the next frame has no flow.

        Raises
        ------
        UnknownName, NameTaken, InvalidEntry, InvalidRequest
            If it cannot be such an object; it is as it was then.

        >>> agent.change_object("chair 1", scale=1.2, colour="#aa3311")  # doctest: +SKIP
        """
        core.editor.change_object(core.world.find(obj), changes)

    @operation(obj=check.object_reference)
    @staticmethod
    def get_object(core: HasWorld, obj: int | str) -> ObjectState:
        """Return what and where an object is now."""
        return core.world.object_state(core.world.find(obj))

    @operation(obj=check.object_reference, behaviour=check.behaviour)
    @staticmethod
    def add_behaviour(core: HasEditor, obj: int | str, behaviour: Mapping[str, Any]) -> None:
        """Add a behaviour to those that an object has.

        Parameters
        ----------
        obj : int or str
            Not a static one.
        behaviour : mapping
            As in a scene file: ``type`` and the parameters. It starts now.
        """
        core.editor.add_behaviour(core.world.find(obj), behaviour)

    @operation(obj=check.object_reference)
    @staticmethod
    def remove_behaviours(core: HasWorld, obj: int | str) -> None:
        """End all behaviours of an object; its speed remains."""
        body = core.world.body(core.world.find(obj))
        if body.behaviours:
            body.detach()
            core.announce()

    @operation(
        obj=check.object_reference,
        force_n=check.force,
        torque_nm=check.force,
        point_m=check.optional(vector),
        duration_s=Bounds(least=0.0, most=1e6, unit="s").number,
    )
    @staticmethod
    def apply_wrench(
        core: HasEditor,
        obj: int | str,
        force_n: ArrayLike = (0.0, 0.0, 0.0),
        torque_nm: ArrayLike = (0.0, 0.0, 0.0),
        point_m: ArrayLike | None = None,
        duration_s: float = 0.0,
    ) -> None:
        """Push and twist an object, or a mover that is a body, for some simulated time.

        Parameters
        ----------
        obj : int or str
            Not a static one; or the name of a mover, where no object has it.
        force_n : (3,) array-like
            World frame, each within 1e6 [N].
        torque_nm : (3,) array-like
            World frame, each within 1e6 [N m].
        point_m : (3,) array-like or None
            Where the force acts, in the object's own frame, its scale applied [m]; it moves with
            the object. None is the centre of mass. A mover's own frame is that of its body, which
            what it faces does not turn.
        duration_s : float
            0 to 1e6 [s]; 0 is one physics step.

        Notes
        -----
        The next step wakes it if it sleeps; the force begins with the one after. As with
        behaviours, nothing is driven faster than 10 m/s.
        """
        parameters = {
            "force": force_n,
            "torque": torque_nm,
            "duration": duration_s or STEP_S,
        }
        if point_m is not None:
            parameters["point"] = point_m
        core.editor.apply_wrench(obj, parameters)

    @operation(seconds=Bounds(least=0.0, most=1.0, unit="s").number)
    @staticmethod
    def contacts(core: HasWorld, seconds: float = 0.0) -> tuple[Contact, ...]:
        """Return what touched what in the last physics step, or in some time before now.

        Parameters
        ----------
        seconds : float
            0 to 1 [s]; 0 is the last step.

        Returns
        -------
        contacts : tuple of Contact
            One for each pair, in the order of their ids; a mover that is driven, or is a body, has
            the id 0.

        Notes
        -----
        Steps are kept from the first call on, for 10 simulated seconds after each; the first call
        knows only the last step.
        """
        return core.world.contacts(seconds)

    @operation(deadline_s=120.0, scenario=_scenario)
    @staticmethod
    def load_scenario(
        core: BeginsScenes, scenario: Mapping[str, Any] | str | Path
    ) -> tuple[int, ...]:
        """Begin a scene with more objects than its own; return their instance ids, in order.

        Parameters
        ----------
        scenario : mapping, str or Path
            `scene` (its name; left out: the present one), `objects` (as in a scene file) and
            `timings`, or `lessons` as in a scene file: as a mapping, as YAML or JSON text, or as
            the path of a file with it. A text that is only a name is that of the scene.
        """
        return core.begin_scenario(_scenario("scenario", scenario))

    @operation()
    @staticmethod
    def spawnable_display_names(core: HasLibrary) -> tuple[str, ...]:
        """Return the names of what can be spawned as people write them, e.g. ``Chair 01``."""
        return core.library.spawnable_display_names
