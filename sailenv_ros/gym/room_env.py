"""The base of all environments: rooms, an eye, episodes. What an episode is about, tasks say.

A task is one file: it places things at the start, carries actions out, and judges by ground truth.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, TypeAlias, cast

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from sailenv_ros.errors import InvalidRequest, InvalidState, UnknownName
from sailenv_ros.gym.eye import Eye, Look
from sailenv_ros.gym.room import OwnObject, Room, RoomOrder
from sailenv_ros.gym.room_settings import FAST_PICTURE, STEP_NS, THREADS
from sailenv_ros.gym.room_store import shared_rooms
from sailenv_ros.gym.room_table import KINDS, room_names
from sailenv_ros.space.free_space import BodySize
from sailenv_ros.system.threads import thread_count
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.listed_views import Views
from sailenv_ros.types.picture_settings import PictureSettings
from sailenv_ros.types.snapshot import Observation
from sailenv_ros.types.validation import checked_flag

__all__ = ["Arrays", "Info", "RoomEnv"]

Arrays: TypeAlias = dict[str, NDArray[Any]]
"""An observation by the names of the spaces."""

Info: TypeAlias = dict[str, Any]


class RoomEnv(gymnasium.Env[Arrays, Any]):
    """An agent with one eye in a room.

    Parameters
    ----------
    views : str or iterable of str
        What it observes: names in `sailenv_ros.types.views.VIEWS`.
    width, height : int
        Of each view [px].
    vertical_fov_deg : float
    intrinsics : CameraIntrinsics or None
        Size and lens instead of the three.
    picture : PictureSettings
        Of the view ``rgb``.
    most_depth_m : float
        What is farther, or nothing at all, is observed as that [m].
    retina : (2,) tuple of int or None
        Rings and wedges by which views are seen, see `Retina`; None sees pixels.
    split : {'train', 'val', 'test'}
    rooms : int or sequence of str
        How many rooms of the split, or names of scenes; each episode is in one, drawn at random.
    kinds : sequence of str
        Kinds of the rooms.
    baked : bool
        True bakes the light of each room when it is first entered, which takes up to a minute;
        False takes plain light.
    discrete : bool
        Numbered actions, or continuous ones.
    threads : int
        That draw; pictures do not depend on it.
    render_mode : {None, 'rgb_array'}

    Raises
    ------
    UnknownName, InvalidRequest
        If a view, a split or a size cannot be.
    """

    metadata: ClassVar[dict[str, Any]] = {  # type: ignore[misc]
        "render_modes": ["rgb_array"],
        "render_fps": 30,
    }
    body: ClassVar[BodySize] = BodySize(height_m=1.3, radius_m=0.2)
    """Size of the agent that walks in the rooms."""
    opens: ClassVar[bool] = False
    """Whether doors are opened."""
    needs: frozenset[str] = frozenset()
    """Views that the task judges by, whether they are observed or not."""

    def __init__(
        self,
        *,
        views: Views = ("rgb",),
        width: int = 84,
        height: int = 84,
        vertical_fov_deg: float = 75.0,
        intrinsics: CameraIntrinsics | None = None,
        picture: PictureSettings = FAST_PICTURE,
        most_depth_m: float = 10.0,
        retina: tuple[int, int] | None = None,
        split: str = "train",
        rooms: int | Sequence[str] = 8,
        kinds: Sequence[str] = KINDS,
        baked: bool = False,
        discrete: bool = True,
        threads: int = 1,
        render_mode: str | None = None,
    ) -> None:
        if render_mode is not None and render_mode not in self.metadata["render_modes"]:
            raise UnknownName("render_mode", str(render_mode), self.metadata["render_modes"])
        lens = intrinsics or CameraIntrinsics(
            width=width, height=height, vertical_fov_deg=vertical_fov_deg
        )
        self.eye = Eye(views, lens, picture, most_depth_m, retina)
        self.discrete = checked_flag("discrete", discrete)
        self.render_mode = render_mode
        self.room_names = room_names(rooms, split=split, kinds=kinds)
        self._spaces: dict[str, spaces.Space[Any]] = {**self.eye.spaces, **self._other_spaces()}
        # Declared as the space of a mapping, which Dict is not in the types of Gymnasium.
        self.observation_space = cast("spaces.Space[Arrays]", spaces.Dict(self._spaces))
        self.action_space = self._actions()
        self._baked = checked_flag("baked", baked)
        self._threads = THREADS.integer("threads", threads)
        self._store = shared_rooms()
        self._room: Room | None = None
        self._past: Observation | None = None
        self._steps = 0
        self._over = True
        self._closed = False
        self._store.join()

    # -- episodes --------------------------------------------------------------------------

    @property
    def eye_pose(self) -> Pose:
        """Where the eye is now."""
        return self._eye_pose()

    @property
    def moved(self) -> dict[str, Pose]:
        """Poses of what the episode moves, by names of objects; empty where nothing moves."""
        return self.room.named(self._places())

    @property
    def room(self) -> Room:
        """The room of the episode.

        Raises
        ------
        InvalidState
            Before the first `reset`.
        """
        if self._room is None:
            raise InvalidState("no episode has begun; call reset first")
        return self._room

    @property
    def time_ns(self) -> int:
        """Simulated time since the episode began [ns]."""
        return self._steps * STEP_NS

    def reset(
        self,
        *,
        seed: int | None = None,
        options: Mapping[str, Any] | None = None,
        out: Mapping[str, NDArray[Any]] | None = None,
    ) -> tuple[Arrays, Info]:
        """Begin an episode.

        Parameters
        ----------
        seed : int or None
            The same seed begins the same episode; None continues the random numbers of before.
        options : mapping or None
            ``room``: the name of one of `room_names`, instead of one at random.
        out : mapping of str to array or None
            Takes the observation; None makes new arrays.

        Raises
        ------
        InvalidRequest, InvalidState
            If there is no such room, or none for this task.
        """
        self.begin(seed=seed, options=options)
        observation, _, _, _, info = self.observe(out)
        return observation, info

    def begin(self, *, seed: int | None = None, options: Mapping[str, Any] | None = None) -> None:
        """Begin an episode without a look; see `reset`, which is `begin` and `observe`."""
        if self._closed:
            raise InvalidState("the environment was closed; make another one")
        super().reset(seed=seed)
        chosen = dict(options or {})
        wanted = chosen.pop("room", None)
        if chosen:
            raise UnknownName("option", next(iter(chosen)), ("room",))
        if wanted is not None and wanted not in self.room_names:
            raise UnknownName("room", str(wanted), self.room_names)
        first = int(self.np_random.integers(len(self.room_names)))
        self._past, self._steps = None, 0
        order = self.room_names[first:] + self.room_names[:first]
        for name in order if wanted is None else (wanted,):
            self._enter(name)
            if self._begin():
                break
        else:
            raise InvalidRequest("rooms", ", ".join(order[:4]), self._lacking())
        self._over = False

    def step(
        self, action: Any, *, out: Mapping[str, NDArray[Any]] | None = None
    ) -> tuple[Arrays, float, bool, bool, Info]:
        """Carry out an action; then a thirtieth of a second has passed.

        Raises
        ------
        InvalidRequest
            If the action is not in `action_space`.
        InvalidState
            If no episode is running.
        """
        self.act(action)
        return self.observe(out)

    def act(self, action: Any) -> None:
        """Carry out an action without a look; see `step`, which is `act` and `observe`."""
        self.require_action(action)
        if self._over:
            raise InvalidState("the episode is over, or none has begun; call reset first")
        self._steps += 1
        self._act(action)

    def require_action(self, action: Any) -> None:
        """Refuse an action that is not in `action_space`.

        Raises
        ------
        InvalidRequest
        """
        if not self.action_space.contains(action):
            raise InvalidRequest("action", action, f"one of {self.action_space}")

    def observe(
        self, out: Mapping[str, NDArray[Any]] | None = None
    ) -> tuple[Arrays, float, bool, bool, Info]:
        """Look, and judge what is there; once after each `begin` and each `act`."""
        look = self._look()
        reward, self._over = self._judge(look)
        return self._observation(look, out), reward, self._over, False, self._info()

    def render(self) -> NDArray[np.uint8] | None:
        """Return the picture (H, W, 3) of now; None without a `render_mode`."""
        if self.render_mode is None:
            return None
        picture = Eye("rgb", self.eye.intrinsics, self.eye.picture)
        scene = self.room.scene_at(self.time_ns, self._places())
        return np.array(picture.look(self.room, scene, self.eye_pose, None).views["rgb"])

    def close(self) -> None:
        """Leave the room; a second call does nothing. With the last one everything is freed."""
        if not self._closed:
            self._closed = True
            self._leave()
            self._store.part()
        super().close()

    # -- what a task says --------------------------------------------------------------------

    @abstractmethod
    def _actions(self) -> spaces.Space[Any]:
        """Return the space of actions."""

    @abstractmethod
    def _begin(self) -> bool:
        """Place things at the start of an episode; False if the room has no such task."""

    @abstractmethod
    def _act(self, action: Any) -> None:
        """Carry an action out."""

    @abstractmethod
    def _judge(self, look: Look) -> tuple[float, bool]:
        """Return the reward for what is there after an action, and whether the task is over.

        Called once after the start, too.
        """

    @abstractmethod
    def _info(self) -> Info:
        """Return the figures of a paper's table."""

    @abstractmethod
    def _eye_pose(self) -> Pose:
        """Return where the eye is."""

    def _places(self) -> Mapping[int, NDArray[np.float64]]:
        """Return the poses (4, 4) of what was moved, by rows of the room's snapshot."""
        return {}

    def _own_objects(self, name: str) -> tuple[OwnObject, ...]:
        """Return own objects in a room."""
        return ()

    def _other_spaces(self) -> dict[str, spaces.Space[Any]]:
        """Return what is observed besides views."""
        return {}

    def _other_observations(self, look: Look) -> dict[str, Any]:
        """Return values of these spaces."""
        return {}

    def _lacking(self) -> str:
        """Return in words which rooms have this task."""
        return "rooms with free space"

    # -- inside ----------------------------------------------------------------------------

    def _enter(self, name: str) -> None:
        if self._room is not None and self._room.name == name:
            return
        own, threads = self._own_objects(name), min(self._threads, thread_count())
        order = RoomOrder(name, self.body, own, self._baked, threads, self.opens)
        entered = self._store.enter(order)
        self._leave()
        self._room = entered

    def _leave(self) -> None:
        if self._room is not None:
            self._store.leave(self._room)
            self._room = None

    def _look(self) -> Look:
        room = self.room
        scene = room.scene_at(self.time_ns, self._places())
        look = self.eye.look(room, scene, self._eye_pose(), self._past, self.needs)
        self._past = look.past
        room.was_drawn()
        return look

    def _observation(self, look: Look, out: Mapping[str, NDArray[Any]] | None) -> Arrays:
        made: Arrays = {}
        for name, space in self._spaces.items():
            made[name] = np.empty(space.shape or (), space.dtype) if out is None else out[name]
        self.eye.write(look.views, made)
        for name, value in self._other_observations(look).items():
            made[name][...] = value
            if not made[name].shape:
                made[name] = made[name][()]  # a number, as the spaces have it
        return made
