"""Every request of a simulation as a blocking method with a deadline.

The methods are those of `SimulationCore` by name; `Requests` queues them through `request` and
waits. Knows no thread and no queue.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures import Future
from concurrent.futures import TimeoutError as FutureTimeout
from typing import Any, Literal, TypeVar

from numpy.typing import ArrayLike

from sailenv_ros.agents import AgentPose, AgentSpec
from sailenv_ros.camera import CameraIntrinsics
from sailenv_ros.errors import DeadlineExceeded
from sailenv_ros.frame import Frame
from sailenv_ros.geometry import Pose
from sailenv_ros.lights import Light
from sailenv_ros.objects import ObjectState
from sailenv_ros.picture_settings import PictureSettings
from sailenv_ros.simulation.edit_requests import EditRequests

__all__ = ["REQUESTS", "Requests", "wait_for"]

T = TypeVar("T")

REQUESTS = frozenset(
    {
        "add_light",
        "attach_behaviour",
        "capture",
        "change_object",
        "change_scene",
        "delete_agent",
        "despawn_object",
        "detach_behaviours",
        "drive_mover",
        "get_object",
        "get_picture",
        "get_pose",
        "lights",
        "load_scenario",
        "move_object",
        "mover_pose",
        "pause",
        "register_agent",
        "remove_light",
        "reset",
        "resume",
        "save_scene",
        "scene_text",
        "set_ambient_light",
        "set_background",
        "set_environment",
        "set_follow",
        "set_intrinsics",
        "set_light",
        "set_mover_controller",
        "set_picture",
        "set_pose",
        "set_position",
        "set_rate",
        "set_real_time_factor",
        "set_rotation",
        "set_waypoints",
        "spawn_object",
        "spawnable_display_names",
        "step",
        "thumbnail",
        "toggle_follow",
        "turn_mover",
        "upload_model",
    }
)
"""Names that `Simulation.request` takes: public requests of `SimulationCore`, and what needs no
world: models and thumbnails."""


class Requests(EditRequests):
    """The blocking methods; `Simulation` adds the queue that `request` puts them into."""

    def request(self, name: str, /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Queue a request by its name; the future gives its result or raises its error."""
        raise NotImplementedError

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

    def change_scene(self, name: str, *, timeout_s: float = 120.0) -> None:
        """Leave the present world for another scene, at simulated time 0."""
        self._ask("change_scene", timeout_s, name)

    def reset(self, seed: int | None = None, *, timeout_s: float = 120.0) -> int:
        """Begin the present scene anew, with another seed if one is given; give the epoch."""
        result: int = self._ask("reset", timeout_s, seed)
        return result

    def pause(self, *, timeout_s: float = 30.0) -> None:
        """Hold simulated time."""
        self._ask("pause", timeout_s)

    def resume(self, *, timeout_s: float = 30.0) -> None:
        """Let simulated time run on."""
        self._ask("resume", timeout_s)

    def set_real_time_factor(self, factor: float, *, timeout_s: float = 30.0) -> None:
        """Change how many simulated seconds per wall second are aimed at, 0.1 to 10."""
        self._ask("set_real_time_factor", timeout_s, factor)

    def step(self, count: int = 1, *, timeout_s: float = 600.0) -> int:
        """Advance by physics steps of 1/240 s; give the simulated time afterwards [ns]."""
        result: int = self._ask("step", timeout_s, count)
        return result

    def capture(
        self, agent: str, views: Iterable[str] | None = None, *, timeout_s: float = 30.0
    ) -> Frame:
        """Render exactly one frame of an agent, after everything asked before."""
        wanted = None if views is None else tuple(views)
        result: Frame = self._ask("capture", timeout_s, agent, wanted)
        return result

    # -- objects, lights, surroundings -----------------------------------------------------

    def spawn_object(
        self,
        asset: str,
        *,
        name: str | None = None,
        pose: Pose,
        scale: ArrayLike = (1.0, 1.0, 1.0),
        static: bool = False,
        category: str | None = None,
        behaviours: Sequence[Mapping[str, Any]] = (),
        mass_kg: float | None = None,
        timeout_s: float = 30.0,
    ) -> int:
        """Put one more object into the scene; give its instance id, the value of its pixels.

        Parameters
        ----------
        asset : str
            Catalogue or display name.
        name : str or None
            Unique in the scene; None makes one of the asset's.
        pose : Pose
            Of the asset's origin, world frame.
        scale : float or (3,) array-like
            Along the asset's axes, 0.001 to 1000.
        static : bool
            True if physics shall never move it.
        category : str or None
            Instead of the asset's.
        behaviours : sequence of mapping
            What moves it of itself, as in a scene file: ``type`` and the parameters. They start
            now.
        mass_kg : float or None
            None takes the asset's, scaled [kg].

        Raises
        ------
        UnknownName, NameTaken, InvalidEntry, AssetError
            If it cannot be placed; the scene is as it was then.
        """
        result: int = self._ask(
            "spawn_object",
            timeout_s,
            asset,
            name=name,
            pose=pose,
            scale=scale,
            static=static,
            category=category,
            behaviours=behaviours,
            mass_kg=mass_kg,
        )
        return result

    def despawn_object(self, obj: int | str, *, timeout_s: float = 30.0) -> None:
        """Take an object, named by id or name, out of the scene; its id is not used again."""
        self._ask("despawn_object", timeout_s, obj)

    def move_object(
        self, obj: int | str, pose: Pose, *, teleport: bool = False, timeout_s: float = 30.0
    ) -> None:
        """Move an object and stop it; that is motion, which flow shows, unless it teleports."""
        self._ask("move_object", timeout_s, obj, pose, teleport=teleport)

    def get_object(self, obj: int | str, *, timeout_s: float = 30.0) -> ObjectState:
        """Say what and where an object is."""
        result: ObjectState = self._ask("get_object", timeout_s, obj)
        return result

    def spawnable_display_names(self, *, timeout_s: float = 30.0) -> tuple[str, ...]:
        """Give the names of what can be spawned as people write them, e.g. ``Chair 01``."""
        result: tuple[str, ...] = self._ask("spawnable_display_names", timeout_s)
        return result

    def lights(self, *, timeout_s: float = 30.0) -> tuple[Light, ...]:
        """Give the lights as they are now."""
        result: tuple[Light, ...] = self._ask("lights", timeout_s)
        return result

    def set_light(self, name: str, *, timeout_s: float = 30.0, **changes: Any) -> Light:
        """Change attributes of a light, by their names in `Light`; give the light as it is then."""
        result: Light = self._ask("set_light", timeout_s, name, **changes)
        return result

    def set_ambient_light(self, colour: ArrayLike, *, timeout_s: float = 30.0) -> None:
        """Set the light that arrives from everywhere (linear radiance)."""
        self._ask("set_ambient_light", timeout_s, colour)

    def set_background(
        self,
        kind: Literal["sky", "colour"],
        colour: ArrayLike | None = None,
        *,
        timeout_s: float = 30.0,
    ) -> None:
        """Show the sky or a linear colour where nothing is hit; no colour keeps the last one."""
        self._ask("set_background", timeout_s, kind, colour)

    def upload_model(
        self,
        data: bytes,
        *,
        name: str,
        filename: str,
        category: str | None = None,
        height_m: float | None = None,
        timeout_s: float = 120.0,
    ) -> str:
        """Add a model to the catalogue; give the name that it is spawned by.

        The simulation goes on meanwhile. See `sailenv_ros.simulation.uploads` for the arguments;
        an empty name is made from the file's, with a number where it is in use.

        Raises
        ------
        NameTaken, UnknownName, InvalidRequest, AssetError
            If it cannot be used; the catalogue is as it was then.
        """
        result: str = self._ask(
            "upload_model",
            timeout_s,
            data,
            name=name,
            filename=filename,
            category=category,
            height_m=height_m,
        )
        return result

    def load_scenario(
        self, scenario: str | Mapping[str, Any], *, timeout_s: float = 120.0
    ) -> tuple[int, ...]:
        """Begin a scene with more objects than its own; give their instance ids, in order.

        Parameters
        ----------
        scenario : str or mapping
            A scene's name, or a mapping with `scene` (its name; the present one if left out) and
            `objects` (as in a scene file).
        """
        result: tuple[int, ...] = self._ask("load_scenario", timeout_s, scenario)
        return result

    def attach_behaviour(
        self,
        obj: int | str,
        type_: str,
        parameters: Mapping[str, Any] | None = None,
        *,
        timeout_s: float = 30.0,
    ) -> None:
        """Let an object, named by id or name, move of itself in one more way, from now on."""
        self._ask("attach_behaviour", timeout_s, obj, type_, parameters)

    def detach_behaviours(self, obj: int | str, *, timeout_s: float = 30.0) -> None:
        """End everything that makes an object move of itself; its speed remains."""
        self._ask("detach_behaviours", timeout_s, obj)

    def set_mover_controller(
        self, mover: str, controller: Literal["waypoint", "rigidbody"], *, timeout_s: float = 30.0
    ) -> None:
        """Choose what drives a mover; the empty name means the scene's first."""
        self._ask("set_mover_controller", timeout_s, mover, controller)

    def drive_mover(
        self,
        mover: str = "",
        *,
        linear_m_s: ArrayLike = (0.0, 0.0, 0.0),
        angular_rad_s: ArrayLike = (0.0, 0.0, 0.0),
        timeout_s: float = 30.0,
    ) -> None:
        """Have a mover walk for half a simulated second, unless another command comes.

        Forward and left along the ground, up along the world's z [m/s]; pitch (down is positive)
        and yaw (left is positive) [rad/s]. What it meets stops it.
        """
        self._ask(
            "drive_mover", timeout_s, mover, linear_m_s=linear_m_s, angular_rad_s=angular_rad_s
        )

    def turn_mover(
        self,
        mover: str = "",
        *,
        pitch_rad: float = 0.0,
        yaw_rad: float = 0.0,
        timeout_s: float = 30.0,
    ) -> None:
        """Turn a mover at once: pitch (down is positive), yaw (left is positive) [rad]."""
        self._ask("turn_mover", timeout_s, mover, pitch_rad=pitch_rad, yaw_rad=yaw_rad)

    def _ask(self, name: str, timeout_s: float, /, *args: Any, **kwargs: Any) -> Any:
        """Queue a request and wait; its result has the type of the core's method."""
        return wait_for(self.request(name, *args, **kwargs), f"the request {name!r}", timeout_s)


def wait_for(future: Future[T], what: str, timeout_s: float) -> T:
    """Wait for a future; the deadline's error names what it was waited for."""
    try:
        return future.result(timeout_s)
    except FutureTimeout:
        if future.done():
            raise
        future.cancel()
        raise DeadlineExceeded(what, timeout_s) from None
