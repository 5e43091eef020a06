"""The facade: a camera in the simulator as one Python object, for people who know no ROS.

Has the method names of the SAILenv client, and the operations of `Simulation`. Raises typed errors
and never prints; every wait has a deadline. World coordinates are those of ROS (x forward, y left,
z up) [m], angles [deg].
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.ros.client.recorded import RecordedAgent
from sailenv_ros.ros.client.registered_agent import RegisteredAgent
from sailenv_ros.system.client_locks import unique_agent_name
from sailenv_ros.types.agents import WAITED_RATE, AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.listed_views import Views, listed_views
from sailenv_ros.types.picture_settings import PictureSettings
from sailenv_ros.types.rigs import RigCamera
from sailenv_ros.types.views import checked_views

__all__ = ["Agent"]


class Agent(RegisteredAgent):
    """A camera of its own in the simulator; a context manager.

    Parameters
    ----------
    main_frame_active, object_frame_active, category_frame_active, flow_frame_active, \
depth_frame_active : bool
        Which views `get_frame` gives.
    width, height : int
        Size of the frames [px], 8 to 4096.
    views : str or iterable of str
        More views, by their names in `sailenv_ros.types.views.VIEWS`.
    vertical_fov_deg : float
        Full vertical angle of view [deg].
    near_m, far_m : float
        Nearest and farthest depth that is seen [m].
    cx_offset_px, cy_offset_px : float
        From the picture's centre to the optical axis, to the right and down [px].
    intrinsics : CameraIntrinsics or None
        Size and lens instead of the numbers above, such as `load_calibration` reads.
    depth_range_m : float
        Depth that the 8-bit depth picture shows as black [m].
    following : bool
        True if the camera starts on the scene's mover.
    picture : PictureSettings or None
        What is done to its picture; None means the defaults.
    cameras : mapping of str to RigCamera, or None
        Cameras on its body besides, which `capture_rig` and `get_frames` capture at one instant.
    name : str
        Name of the agent; empty makes a unique one.
    namespace : str
        The simulator's ROS namespace.
    domain_id : int or None
        ROS domain; None means that of the environment.
    simulator : mapping or None
        Parameters of the simulator node if one has to be started, e.g. ``{"scene": "optical"}``.
    timeout_s : float
        Deadline of each operation [s], but of those that take long by nature (another scene, steps,
        uploads): they keep their own. Starting a simulator may take up to `start_timeout_s`.

    Raises
    ------
    InvalidRequest
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
        views: Views = (),
        vertical_fov_deg: float = 60.0,
        near_m: float = 0.05,
        far_m: float = 100.0,
        cx_offset_px: float = 0.0,
        cy_offset_px: float = 0.0,
        intrinsics: CameraIntrinsics | None = None,
        depth_range_m: float = 10.0,
        following: bool = True,
        picture: PictureSettings | None = None,
        cameras: Mapping[str, RigCamera] | None = None,
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
        lens = CameraIntrinsics(
            width=width,
            height=height,
            vertical_fov_deg=vertical_fov_deg,
            near_m=near_m,
            far_m=far_m,
            cx_offset_px=cx_offset_px,
            cy_offset_px=cy_offset_px,
        )
        if intrinsics is not None and lens != CameraIntrinsics():
            accepted = "left out where sizes, angles and distances of the camera are given"
            raise InvalidRequest("intrinsics", intrinsics.distortion_model, accepted)
        spec = AgentSpec(
            name=name or unique_agent_name(),
            intrinsics=lens if intrinsics is None else intrinsics,
            depth_range_m=depth_range_m,
            rate_hz=0.0,
            views=checked_views([*wanted, *listed_views(views)]),
            following=following,
            picture=PictureSettings() if picture is None else picture,
            cameras=cameras,
        )
        super().__init__(
            spec,
            any_name=not name,
            timeout_s=timeout_s,
            namespace=namespace,
            domain_id=domain_id,
            simulator=simulator,
            start_timeout_s=start_timeout_s,
        )

    # -- frames ----------------------------------------------------------------------------

    def get_frame(
        self,
        views: Views = (),
        *,
        agent: str | None = None,
        timeout_s: float | None = None,
    ) -> dict[str, Any]:
        """Render one frame now and return it as the dict of the SAILenv client.

        It shows the world after everything that this agent asked for before.

        Parameters
        ----------
        views : str or iterable of str
            More views than the agent's own, by their names in `sailenv_ros.types.views.VIEWS`;
            rendered for this frame alone.
        agent : str or None
            This one.
        timeout_s : float or None
            Deadline [s]; None means the agent's own.

        Returns
        -------
        frame : dict
            See `sailenv_ros.frame.frame.Frame.to_dict`; every array is the caller's own.

        Raises
        ------
        SimulatorLost
            If the simulator has ended.
        DeadlineExceeded
            If no complete frame arrived in time; `recaptured` counts the attempts that were
            repeated because images did not arrive.
        """
        more = listed_views(views)
        wanted = (*self._spec.views, *more) if more else None
        capture = self.capture if timeout_s is None else self.capture.within(timeout_s)
        # What was received is nobody else's: it is handed over as it is.
        return capture(wanted, agent=agent).to_dict(copy=False)

    def frames(
        self, rate_hz: float = 30.0, *, agent: str | None = None, timeout_s: float | None = None
    ) -> Iterator[dict[str, Any]]:
        """Yield frame after frame at a rate of simulated time, the newest each time.

        A loop slower than the rate misses frames, which shows in their `sequence`. The rate
        ends with the iteration; a view asked of `get_frame` before is in these frames too.

        Parameters
        ----------
        rate_hz : float
            Frames per simulated second, above 0 and up to 240.
        agent : str or None
            This one.
        timeout_s : float or None
            Deadline of each frame [s]; None means the agent's own.

        Yields
        ------
        frame : dict
            As of `get_frame`.

        Raises
        ------
        SimulatorLost, DeadlineExceeded
            If no frame came in time.
        """
        WAITED_RATE.number("rate_hz", rate_hz)
        if agent not in (None, self.id):
            raise InvalidRequest("agent", agent, f"{self.id!r}: an Agent receives its own frames")
        limit_s = self._timeout_s if timeout_s is None else timeout_s
        self.set_rate(rate_hz)
        try:
            sequence = 0
            while True:
                frame = self._own_frames.newer(sequence, limit_s)
                sequence = frame.sequence
                yield frame.to_dict(copy=False)
        finally:
            if self._frames is not None and self._remote.connection.simulator_lives():
                self.set_rate(0.0)

    @staticmethod
    def from_recording(path: str | Path, agent: str = "") -> RecordedAgent:
        """Open a recording as an agent whose `get_frame` returns what was seen then.

        Parameters
        ----------
        path : str or Path
            A bag folder, or one MCAP file.
        agent : str
            Name of the agent; empty if there is only one.

        Raises
        ------
        RecordingError
            If it cannot be read, or has no frames of an agent.
        UnknownName
            If there is no such agent, or several and none was named.
        """
        return RecordedAgent(path, agent)
