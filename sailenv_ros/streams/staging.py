"""One episode on its stage: what is there, what moves, how it is lit, where the camera stands."""

from __future__ import annotations

from collections.abc import Mapping

from sailenv_ros.authoring.room_rules.random_stream import RandomStream
from sailenv_ros.simulation.synchronous import SynchronousSimulation
from sailenv_ros.streams.course import Course
from sailenv_ros.streams.plan import Place
from sailenv_ros.streams.replacing import replace_pieces
from sailenv_ros.streams.state import Colour, StreamState, tinted
from sailenv_ros.types.geometry import Pose, look_at
from sailenv_ros.types.labels import LIVING, ROOM_PARTS, Instance
from sailenv_ros.types.lights import Light

__all__ = ["Stage"]

EYE_M = 1.5
"""Height of the eye where a room has neither mover nor agent [m]."""

OPENS_S = (3.0, 8.0)
PUSHED_S = (1.0, 5.0)
_WORN = (0.62, 0.5, 0.3)
"""Factors of a colour that has yellowed as far as it can."""

_DAYLIGHT = ("area", "directional")


class Stage:
    """The room of an episode that has just begun.

    Parameters
    ----------
    core : SynchronousSimulation
    dice : RandomStream
        Of the episode.
    course : Course
    place : Place
        Of the episode's first frame.
    seed : int
        Of the stream.
    """

    def __init__(
        self,
        core: SynchronousSimulation,
        dice: RandomStream,
        course: Course,
        place: Place,
        seed: int,
    ) -> None:
        self._core, self._dice, self._course = core, dice, course
        self._habit, self._room, self._seed = place.habit, place.room, seed
        self._lights: Mapping[str, Light] = {light.name: light for light in core.info.lights}
        surroundings = core.world.contents.environment
        self._ambient, self._outside = surroundings.ambient, surroundings.outside_factor
        self._standing = [
            agent.pose
            for agent in core.info.agents
            if agent.pose is not None and not agent.following
        ]
        self._state = StreamState()
        self._target = ""

    # -- once an episode ---------------------------------------------------------------------

    def furnish(self, state: StreamState) -> None:
        """Take out what is not there, paint and wear the rest, set things in motion."""
        with self._core.scene.announce.once():
            self._furnish(state)

    def _furnish(self, state: StreamState) -> None:
        core = self._core
        for one in self._objects():
            if one.category in state.absent:
                core.despawn_object(one.id)
        if state.furniture_lives:
            replace_pieces(core, self._objects(), state.furniture_lives, self._seed, self._room)
        if state.paint is not None:
            for one in core.info.instances:
                if one.category == "wall":
                    core.set_material(one.id, colour=state.paint)
        present = self._objects()
        if state.worn:
            tint = tinted(_WORN, state.worn)
            for one in present:
                if one.static:
                    core.set_material(one.id, tint=tint)
        joints = [joint.name for joint in core.get_joints() if joint.high > joint.low]
        for name in self._dice.mixed(sorted(joints))[: self._course.moves.open]:
            period = round(self._dice.between(OPENS_S), 1)
            core.add_behaviour(name, {"type": "open_and_close", "period": period})
        things = [one for one in present if one.category not in LIVING]
        loose = sorted(one.name for one in things if not one.static and one.name not in joints)
        for name in self._dice.mixed(loose)[: self._course.moves.pushed]:
            interval = round(self._dice.between(PUSHED_S), 1)
            core.add_behaviour(name, {"type": "poltergeist", "mean_interval": interval})
        names = sorted(one.name for one in things if self._is_below_eyes(one.name))
        self._target = self._dice.one(names) if names else ""

    # -- at each tick ------------------------------------------------------------------------

    def light(self, state: StreamState, agent: str) -> None:
        """Set lights, picture and lens."""
        with self._core.scene.announce.once():
            self._light(state, agent)

    def _light(self, state: StreamState, agent: str) -> None:
        core, eye = self._core, self._course.eye
        self._state = state
        for name, light in self._lights.items():
            day = light.type in _DAYLIGHT
            factor = state.daylight if day else state.lamplight
            tint = state.daylight_colour if day else state.lamp_colour
            core.set_light(
                name, intensity=light.intensity * factor, colour=_times(light.colour, tint)
            )
        core.set_environment(
            ambient=_times(self._ambient, _scaled(state.daylight_colour, state.daylight)),
            outside_factor=self._outside * state.daylight,
        )
        core.set_picture(eye.picture.to_settings().changed(state.picture), agent=agent)
        core.set_intrinsics(eye.lens(state.zoom), agent=agent)

    # -- for each frame ----------------------------------------------------------------------

    def eye(self) -> Pose:
        """Return where the camera is now, but for how it is mounted."""
        core = self._core
        if self._habit == "stand" and self._standing:
            return self._standing[0]
        if not core.world.movers:
            return self._standing[0] if self._standing else _in_the_middle()
        pose = core.get_mover_pose()
        if self._habit == "fixate" and self._target:
            state = core.get_object(self._target)
            return look_at(pose.position_m, state.pose.position_m)
        return pose

    def mounted(self, pose: Pose) -> Pose:
        """Return the pose of a camera on what carries it."""
        return pose.carried(Pose.from_rpy_deg(self._state.mount_m, self._state.mount_rpy_deg))

    # -- inside ------------------------------------------------------------------------------

    def _is_below_eyes(self, name: str) -> bool:
        return self._core.get_object(name).pose.position_m[2] < EYE_M

    def _objects(self) -> list[Instance]:
        """Return what has a place of its own in the room, parts left out."""
        return [
            one
            for one in self._core.info.instances
            if not one.parent and one.category not in ROOM_PARTS
        ]


def _in_the_middle() -> Pose:
    return Pose((0.0, 0.0, EYE_M))


def _times(colour: Colour, factors: Colour) -> Colour:
    red, green, blue = (a * b for a, b in zip(colour, factors, strict=True))
    return red, green, blue


def _scaled(colour: Colour, factor: float) -> Colour:
    return _times(colour, (factor,) * 3)
