"""One client's conversation: messages in, steps to carry out and bytes to send out; no socket.

An answer is a generator (see `steps`). Its driver decides how to wait; it needs no thread
and no simulation, which is how it is tested against anything that a peer may send.
"""

from __future__ import annotations

from collections.abc import Callable, Generator
from typing import Any

from sailenv_ros.errors import NameTaken, ProtocolError
from sailenv_ros.frame.frame import Frame
from sailenv_ros.gateway.codec import Message, pack_floats, pack_ints, pack_string, pack_strings
from sailenv_ros.gateway.light_answers import LightAnswers
from sailenv_ros.gateway.object_answers import ObjectAnswers
from sailenv_ros.gateway.payloads import packed_frame, views_of_flags
from sailenv_ros.gateway.scene_names import scene_of_wire, wire_scenes
from sailenv_ros.gateway.steps import Request, Response, Step, Work, errors_as_text
from sailenv_ros.gateway.unity import (
    pose_from_unity,
    unity_angles_deg,
    unity_from_vector,
    vector_from_unity,
)
from sailenv_ros.simulation.operations import Operations
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.scene_info import SceneInfo

__all__ = ["AGENT_PREFIX", "Session"]

AGENT_PREFIX = "client_"
"""Begins the names of the agents that clients of the gateway are."""

Vector3 = tuple[float, float, float]


class Session:
    """One connection, which is one agent.

    Parameters
    ----------
    info : callable
        Gives the scene as it was announced last.
    next_id : callable
        Gives a number to try: it is another's where there is an agent of its name.
    """

    def __init__(self, info: Callable[[], SceneInfo], next_id: Callable[[], int]) -> None:
        self._info = info
        self._answers = (self, ObjectAnswers(info, lambda: self.agent), LightAnswers(info))
        self._next_id = next_id
        self._agent: AgentSpec | None = None
        self._use_gzip = False
        self._ended = False

    @property
    def agent(self) -> str:
        """Name of the agent; empty before the registration was asked for and after the end."""
        return "" if self._agent is None else self._agent.name

    @property
    def ended(self) -> bool:
        """True once the client has said that it goes."""
        return self._ended

    def answer(self, message: Message) -> Response:
        """Begin the answer to a message; the errors that a client cannot be told are raised."""
        group = next(group for group in self._answers if hasattr(group, message.name))
        answer: Callable[..., Response] = getattr(group, message.name)
        return answer(**message.fields)

    # -- life ------------------------------------------------------------------------------

    def register(self, width: int, height: int, use_gzip: bool) -> Response:
        """Become an agent; tell its number and the scenes."""
        intrinsics = CameraIntrinsics(width=width, height=height)
        number = yield from self._registered(intrinsics)
        self._use_gzip = use_gzip
        return [pack_ints(number), pack_strings(wire_scenes(self._info()))]

    def _registered(self, intrinsics: CameraIntrinsics) -> Generator[Step, Any, int]:
        while True:
            number = self._next_id()
            # Known before it is there, so that whoever breaks this off can remove it.
            self._agent = AgentSpec(
                name=f"{AGENT_PREFIX}{number}", intrinsics=intrinsics, rate_hz=0.0
            )
            try:
                self._agent = yield Request(Operations.register_agent, self._agent)
            except NameTaken:
                self._agent = None  # it is somebody else's
            else:
                return number

    def delete(self) -> Response:
        """Remove the agent; nothing is answered."""
        self._ended = True
        yield Request(Operations.delete_agent, self.agent)
        self._agent = None
        return []

    # -- frames ----------------------------------------------------------------------------

    def frame(self, flags: int) -> Response:
        """Render the views asked for, now, and tell the time since the frame before."""
        if self._agent is None:
            raise ProtocolError("a frame was asked for before the registration")
        views = views_of_flags(flags)
        # Someone may want nothing but the time.
        frame: Frame = yield Request(Operations.capture, views or ("instance",), agent=self.agent)
        depth_range_m, use_gzip = self._agent.depth_range_m, self._use_gzip

        def pack() -> list[bytes]:
            return packed_frame(frame, views, depth_range_m=depth_range_m, use_gzip=use_gzip)

        pieces: list[bytes] = yield Work(pack)
        return pieces

    # -- scene -----------------------------------------------------------------------------

    def change_scene(self, name: str) -> Response:
        """Change the scene, for everybody."""
        return errors_as_text(
            lambda: Request(Operations.change_scene, scene_of_wire(name, self._info()))
        )

    def get_categories(self) -> Response:
        """Return the number and name of each category."""
        yield from ()
        table = self._info().categories
        entries = [pack_ints(number) + pack_string(table[number].name) for number in table]
        return [pack_ints(len(entries)), *entries]

    # -- pose ------------------------------------------------------------------------------

    def get_position(self) -> Response:
        """Return where the agent is."""
        here = yield Request(Operations.get_agent_pose, agent=self.agent)
        return [pack_floats(*unity_from_vector(here.pose.position_m))]

    def set_position(self, position: Vector3) -> Response:
        """Move the agent, or the mover that it follows."""
        return errors_as_text(
            lambda: Request(
                Operations.set_position, vector_from_unity("position", position), agent=self.agent
            )
        )

    def get_rotation(self) -> Response:
        """Return how the agent is turned."""
        here = yield Request(Operations.get_agent_pose, agent=self.agent)
        return [pack_floats(*unity_angles_deg(here.pose))]

    def set_rotation(self, rotation: Vector3) -> Response:
        """Turn the agent, or the mover that it follows."""
        return errors_as_text(
            lambda: Request(
                Operations.set_rotation,
                pose_from_unity((0.0, 0.0, 0.0), rotation).rpy_deg,
                agent=self.agent,
            )
        )

    def toggle_follow(self) -> Response:
        """Follow the mover, or stop."""
        return errors_as_text(lambda: Request(Operations.toggle_follow, agent=self.agent))
