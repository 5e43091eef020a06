"""The facade: a camera in the simulator as one Python object, for people who know no ROS.

Has the method names of the original SAILenv client. Raises typed errors and never prints; every
wait has a deadline. World coordinates are those of ROS (x forward, y left, z up) [m], angles [deg].
"""

from __future__ import annotations

import atexit
import threading
import uuid
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from sailenv_msgs.srv import DeleteAgent, RegisterAgent
from sailenv_msgs_py.agents import agent_spec_from_msg, agent_spec_to_msg
from sailenv_ros.agent.client import SimulatorClient
from sailenv_ros.agent.frame_pictures import FramePictures
from sailenv_ros.agent.frame_requests import FrameRequests
from sailenv_ros.agent.picture_requests import PictureRequests
from sailenv_ros.agent.pose_requests import PoseRequests
from sailenv_ros.agent.recorded import RecordedAgent
from sailenv_ros.agent.topics import AgentTopics
from sailenv_ros.agents import AgentSpec
from sailenv_ros.camera import CameraIntrinsics
from sailenv_ros.errors import SailenvError, SimulationClosed
from sailenv_ros.frame import checked_views
from sailenv_ros.picture_settings import PictureSettings

__all__ = ["Agent"]

END_S = 2.0
"""How long the simulator may take to take note of an Agent's end [s]."""


class Agent(SimulatorClient, FrameRequests, PoseRequests, PictureRequests, FramePictures):
    """A camera of its own in the simulator; a context manager.

    Parameters
    ----------
    main_frame_active, object_frame_active, category_frame_active, flow_frame_active, \
depth_frame_active : bool
        Which views `get_frame` gives.
    width, height : int
        Size of the frames [px], 8 to 4096.
    views : sequence of str
        More views, by their names in `sailenv_ros.frame.VIEWS`.
    vertical_fov_deg : float
        Full vertical angle of view [deg].
    near_m, far_m : float
        Nearest and farthest depth that is seen [m].
    depth_range_m : float
        Depth that the 8-bit depth picture shows as black [m].
    following : bool
        True if the camera starts on the scene's mover.
    picture : PictureSettings or None
        What is done to its picture; None means the defaults.
    name : str
        Name of the agent; empty makes a unique one.
    namespace : str
        The simulator's ROS namespace.
    domain_id : int or None
        ROS domain; None means that of the environment.
    simulator : mapping or None
        Parameters of the simulator node if one has to be started, e.g. ``{"scene": "optical"}``.
    timeout_s : float
        Deadline of each request [s]; starting a simulator may take up to `start_timeout_s`.

    Raises
    ------
    InvalidRequest, RequestRefused
        If an argument cannot be accepted.
    SimulationClosed, DeadlineExceeded
        If there is no simulator and none could be started.
    """

    def __init__(
        self,
        main_frame_active: bool = True,
        object_frame_active: bool = True,
        category_frame_active: bool = True,
        flow_frame_active: bool = True,
        depth_frame_active: bool = True,
        width: int = 640,
        height: int = 480,
        *,
        views: Sequence[str] = (),
        vertical_fov_deg: float = 60.0,
        near_m: float = 0.05,
        far_m: float = 100.0,
        depth_range_m: float = 10.0,
        following: bool = True,
        picture: PictureSettings | None = None,
        name: str = "",
        namespace: str = "/sailenv",
        domain_id: int | None = None,
        simulator: Mapping[str, object] | None = None,
        timeout_s: float = 10.0,
        start_timeout_s: float = 60.0,
    ) -> None:
        active = {
            "rgb": main_frame_active,
            "depth": depth_frame_active,
            "category": category_frame_active,
            "instance": object_frame_active,
            "flow": flow_frame_active,
        }
        wanted = [view for view, is_active in active.items() if is_active]
        self._spec = AgentSpec(
            name=name or f"agent_{uuid.uuid4().hex[:10]}",
            intrinsics=CameraIntrinsics(
                width=width,
                height=height,
                vertical_fov_deg=vertical_fov_deg,
                near_m=near_m,
                far_m=far_m,
            ),
            depth_range_m=depth_range_m,
            rate_hz=0.0,
            views=checked_views([*wanted, *views]),
            following=following,
            picture=PictureSettings() if picture is None else picture,
        )
        self._lock = threading.RLock()
        self._topics: AgentTopics | None = None
        self._closed = False
        self.recaptured = 0
        super().__init__(
            namespace=namespace,
            domain_id=domain_id,
            simulator=simulator,
            timeout_s=timeout_s,
            start_timeout_s=start_timeout_s,
        )
        atexit.register(self.close)
        try:
            self.register()
        except BaseException:
            self.close()
            raise

    @staticmethod
    def from_recording(path: str | Path, agent: str = "") -> RecordedAgent:
        """Open a recording as an agent whose `get_frame` gives what was seen then.

        Parameters
        ----------
        path : str or Path
            A bag folder, or one MCAP file.
        agent : str
            Name of the agent; empty if there is only one.

        Raises
        ------
        RecordingError, UnknownName
            If it cannot be read, or has no such agent.
        """
        return RecordedAgent(path, agent)

    # -- life ------------------------------------------------------------------------------

    @property
    def id(self) -> str:
        """Name of this agent in the simulator, and of its topics."""
        return self._spec.name

    def register(self) -> None:
        """Make the agent known to the simulator; done on construction, needed after `delete`."""
        with self._lock:
            if self._topics is not None:
                return
            request = RegisterAgent.Request(agent=agent_spec_to_msg(self._spec))
            # Readers first: the agent's publishers then know them from their first message on.
            topics = AgentTopics(self._connection, self.id, self._spec.views)
            try:
                answer = self._call(RegisterAgent, "register_agent", request)
                self._topics = topics
                self._spec = agent_spec_from_msg(answer.accepted)
                topics.await_publishers(self._timeout_s)
            except BaseException:
                topics.close()
                self._topics = None
                raise

    def delete(self) -> None:
        """Remove the agent from the simulator; a second call does nothing."""
        with self._lock:
            if self._topics is not None:
                self._topics.close()
                self._topics = None
                self._connection.forget_services(self.id)
                self._call(DeleteAgent, "delete_agent", DeleteAgent.Request(name=self.id))

    def rejoin(self) -> None:
        """Connect anew after `SimulatorLost`, to a simulator that runs again or is started now.

        The agent is registered as it was at first, so its pose and its frames' numbers begin anew.
        """
        self._connection.check_process()
        with self._lock:
            if self._closed:
                raise SimulationClosed("the Agent was closed")
            # Where the old simulator lives after all, it shall not keep the name.
            with suppress(SailenvError):
                self.delete()
            self._reconnect()
            self.register()

    def close(self) -> None:
        """Remove the agent and disconnect; a second call does nothing.

        A simulator that was started for this agent ends with the last one that uses it.
        """
        if self._connection.is_inherited:
            return  # it is the parent's, who goes on with it
        with self._lock:
            if self._closed:
                return
            self._closed = True
            atexit.unregister(self.close)
            self._timeout_s = min(self._timeout_s, END_S)
            try:
                self.delete()
            except SailenvError:
                pass  # the simulator is gone, and with it the agent
            finally:
                self._release()

    def __enter__(self) -> Agent:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()

    # -- inside ----------------------------------------------------------------------------

    @property
    def _own_topics(self) -> AgentTopics:
        if self._topics is None:
            raise SimulationClosed(f"agent {self.id!r} was deleted; register it first")
        return self._topics

    def _call_own(self, srv_type: Any, service: str, request: Any) -> Any:
        if self._topics is None:
            raise SimulationClosed(f"agent {self.id!r} was deleted; register it first")
        return self._call(srv_type, f"{self.id}/{service}", request)
