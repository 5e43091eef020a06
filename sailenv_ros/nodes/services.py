"""The services of the simulator itself, each a few lines around one request."""

from __future__ import annotations

from collections.abc import Callable

from rclpy.node import Node
from std_srvs.srv import Trigger

from sailenv_msgs.srv import ChangeScene, DeleteAgent, RegisterAgent, Reset, Step
from sailenv_msgs_py.agents import agent_spec_from_msg, agent_spec_to_msg
from sailenv_msgs_py.stamps import stamp_from_ns
from sailenv_msgs_py.transforms import pose_from_msg
from sailenv_ros.nodes.requests import Requests, ServiceTable, offer

__all__ = ["SimulatorServices"]


class SimulatorServices:
    """Serves the simulator.

    Parameters
    ----------
    node : Node
    requests : Requests
    agents_changed : callable
        Called in the executor's thread after agents came or went, before the answer: an agent's
        topics and services are there when its registration is answered.
    """

    def __init__(self, node: Node, requests: Requests, agents_changed: Callable[[], None]) -> None:
        self._ask = requests
        self._agents_changed = agents_changed
        offer(node, self._table())

    def _table(self) -> ServiceTable:
        return (
            ("register_agent", RegisterAgent, self._register_agent),
            ("delete_agent", DeleteAgent, self._delete_agent),
            ("change_scene", ChangeScene, self._change_scene),
            ("reset", Reset, self._reset),
            ("step", Step, self._step),
            ("pause", Trigger, self._pause),
            ("resume", Trigger, self._resume),
        )

    async def _register_agent(
        self, request: RegisterAgent.Request, response: RegisterAgent.Response
    ) -> None:
        pose = pose_from_msg(request.pose) if request.has_pose else None
        spec = agent_spec_from_msg(request.agent, pose=pose)
        accepted = await self._ask("register_agent", spec)
        self._agents_changed()
        response.accepted = agent_spec_to_msg(accepted)

    async def _delete_agent(
        self, request: DeleteAgent.Request, response: DeleteAgent.Response
    ) -> None:
        await self._ask("delete_agent", request.name)
        self._agents_changed()

    async def _change_scene(
        self, request: ChangeScene.Request, response: ChangeScene.Response
    ) -> None:
        await self._ask("change_scene", request.scene)
        self._agents_changed()

    async def _reset(self, request: Reset.Request, response: Reset.Response) -> None:
        response.epoch = await self._ask("reset", None if request.keep_seed else request.seed)

    async def _step(self, request: Step.Request, response: Step.Response) -> None:
        response.stamp = stamp_from_ns(await self._ask("step", request.steps))

    async def _pause(self, request: Trigger.Request, response: Trigger.Response) -> None:
        await self._ask("pause")

    async def _resume(self, request: Trigger.Request, response: Trigger.Response) -> None:
        await self._ask("resume")
