"""The services of one agent: `/<namespace>/<agent>/…`, each a few lines around one request."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any

from rclpy.node import Node
from std_srvs.srv import SetBool, Trigger

from sailenv_msgs.srv import (
    Capture,
    GetPicture,
    GetPose,
    SetPicture,
    SetPose,
    SetPosition,
    SetRate,
    SetRotation,
)
from sailenv_msgs_py.frame_info import WORLD_FRAME_ID
from sailenv_msgs_py.pictures import picture_changes_from_msg, picture_to_msg
from sailenv_msgs_py.stamps import stamp_from_ns
from sailenv_msgs_py.transforms import pose_from_msg, pose_stamped_to_msg, xyz_from_msg
from sailenv_ros.agents import AgentPose, AgentSpec
from sailenv_ros.errors import SimulationClosed
from sailenv_ros.frame import Frame, checked_views
from sailenv_ros.nodes.publishers import AgentPublisher
from sailenv_ros.nodes.requests import Requests, ServiceTable, offer

__all__ = ["AgentServices"]

AWAIT_SUBSCRIBERS_S = 0.5
"""How long a capture waits for subscribers of its views that are just being matched [s]."""


class AgentServices:
    """Serves one agent.

    Parameters
    ----------
    node : Node
    requests : Requests
    publisher : AgentPublisher
        Where captured frames go.
    spec : AgentSpec
    """

    def __init__(
        self, node: Node, requests: Requests, publisher: AgentPublisher, spec: AgentSpec
    ) -> None:
        self._node = node
        self._ask = requests
        self._publisher = publisher
        self._spec = spec
        # Waits and publishes, so that the executor does neither; one thread keeps their order.
        self._worker = ThreadPoolExecutor(1, thread_name_prefix=f"{spec.name}-capture")
        self._services = offer(node, self._table(), prefix=f"{spec.name}/")

    def _table(self) -> ServiceTable:
        return (
            ("set_position", SetPosition, self._set_position),
            ("set_rotation", SetRotation, self._set_rotation),
            ("set_pose", SetPose, self._set_pose),
            ("get_pose", GetPose, self._get_pose),
            ("toggle_follow", Trigger, self._toggle_follow),
            ("set_follow", SetBool, self._set_follow),
            ("set_rate", SetRate, self._set_rate),
            ("get_picture", GetPicture, self._get_picture),
            ("set_picture", SetPicture, self._set_picture),
            ("capture", Capture, self._capture),
        )

    def close(self) -> None:
        """Remove the services; called in the executor's thread, or after it has ended."""
        for service in self._services:
            self._node.destroy_service(service)
        self._services.clear()
        self._worker.shutdown(wait=False, cancel_futures=True)

    async def _set_position(
        self, request: SetPosition.Request, response: SetPosition.Response
    ) -> None:
        position = xyz_from_msg(request.position)
        await self._ask("set_position", self._spec.name, position, teleport=request.teleport)

    async def _set_rotation(
        self, request: SetRotation.Request, response: SetRotation.Response
    ) -> None:
        rpy_deg = (request.roll_deg, request.pitch_deg, request.yaw_deg)
        await self._ask("set_rotation", self._spec.name, rpy_deg, teleport=request.teleport)

    async def _set_pose(self, request: SetPose.Request, response: SetPose.Response) -> None:
        pose = pose_from_msg(request.pose)
        await self._ask("set_pose", self._spec.name, pose, teleport=request.teleport)

    async def _get_pose(self, request: GetPose.Request, response: GetPose.Response) -> None:
        here: AgentPose = await self._ask("get_pose", self._spec.name)
        stamp = stamp_from_ns(here.sim_time_ns)
        response.pose = pose_stamped_to_msg(here.pose, stamp, WORLD_FRAME_ID)
        response.roll_deg, response.pitch_deg, response.yaw_deg = here.pose.rpy_deg
        response.following = here.following
        response.mover = here.mover

    async def _toggle_follow(self, request: Trigger.Request, response: Trigger.Response) -> None:
        following = await self._ask("toggle_follow", self._spec.name)
        response.message = _follow_state(following)

    async def _set_follow(self, request: SetBool.Request, response: SetBool.Response) -> None:
        following = await self._ask("set_follow", self._spec.name, request.data)
        response.message = _follow_state(following)

    async def _set_rate(self, request: SetRate.Request, response: SetRate.Response) -> None:
        await self._ask("set_rate", self._spec.name, request.rate_hz)

    async def _get_picture(
        self, request: GetPicture.Request, response: GetPicture.Response
    ) -> None:
        response.picture = picture_to_msg(await self._ask("get_picture", self._spec.name))

    async def _set_picture(
        self, request: SetPicture.Request, response: SetPicture.Response
    ) -> None:
        changes = picture_changes_from_msg(request.picture, request.fields)
        settings = await self._ask("set_picture", self._spec.name, **changes)
        response.picture = picture_to_msg(settings)

    async def _capture(self, request: Capture.Request, response: Capture.Response) -> None:
        views = checked_views(request.views) if request.views else self._spec.views
        if not self._publisher.subscribed(views):
            await self._ask.settled(
                self._submit(self._publisher.await_subscribed, views, AWAIT_SUBSCRIBERS_S)
            )
        # Queued at once: what was asked before is in the picture, what comes later is not.
        rendering = self._ask.begin("capture", self._spec.name, views)
        frame, published = await self._ask.settled(self._submit(self._publish, rendering))
        response.stamp = stamp_from_ns(frame.stamp_ns)
        response.sequence = frame.sequence
        response.views_published = list(published)

    def _publish(self, rendering: Future[Frame]) -> tuple[Frame, tuple[str, ...]]:
        frame = rendering.result()
        return frame, self._publisher.publish(frame)

    def _submit(self, work: Callable[..., Any], *args: Any) -> Future[Any]:
        try:
            return self._worker.submit(work, *args)
        except RuntimeError:
            raise SimulationClosed(f"agent {self._spec.name!r} was deleted") from None


def _follow_state(following: bool) -> str:
    return "following" if following else "not following"
