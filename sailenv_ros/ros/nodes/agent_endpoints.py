"""Keeps topics and services of agents in step with the agents that the simulation has."""

from __future__ import annotations

from dataclasses import dataclass

from rclpy.node import Node

from sailenv_ros.errors import SailenvError
from sailenv_ros.ros.nodes.agent_services import AgentServices
from sailenv_ros.ros.nodes.diagnostics import AgentCounts
from sailenv_ros.ros.nodes.disparity_topics import DisparityTopics
from sailenv_ros.ros.nodes.publishers import AgentPublisher
from sailenv_ros.ros.nodes.requests import OperationRunner
from sailenv_ros.ros.nodes.tf_tree import TfTree
from sailenv_ros.simulation import Simulation
from sailenv_ros.system.memory import give_back_freed_memory
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.scene_info import SceneInfo

__all__ = ["AgentEndpoints"]


@dataclass(slots=True, kw_only=True)
class _Endpoint:
    spec: AgentSpec
    publisher: AgentPublisher
    services: AgentServices

    def close(self) -> None:
        # Services first: nobody captures into topics that are about to go.
        self.services.close()
        self.publisher.close()


class AgentEndpoints:
    """Topics and services of all agents; used by the executor's thread alone."""

    def __init__(
        self, node: Node, simulation: Simulation, runner: OperationRunner, tf: TfTree
    ) -> None:
        self._tf = tf
        self._disparity = DisparityTopics(node)
        self._node = node
        self._simulation = simulation
        self._runner = runner
        self._endpoints: dict[str, _Endpoint] = {}

    def reconcile(self, info: SceneInfo) -> None:
        """Make what is missing and remove what belongs to nobody any more."""
        specs = {spec.name: spec for spec in info.agents}
        left = self._endpoints.keys() - specs.keys()
        for name, endpoint in list(self._endpoints.items()):
            spec = specs.get(name)
            if spec is None or endpoint.publisher.ended or not _same_topics(spec, endpoint.spec):
                self._endpoints.pop(name).close()
        if left:
            # Their frames and endpoints leave holes in memory among what stays.
            give_back_freed_memory()
        self._tf.set_agents(info.agents)
        self._disparity.set_agents(info.agents)
        for name, spec in specs.items():
            if name not in self._endpoints:
                self._add(spec)
            elif self._endpoints[name].spec.rate_hz != spec.rate_hz:
                self._set_rate(self._endpoints[name], spec)

    def publisher_of(self, agent: str) -> AgentPublisher | None:
        """Return the publisher of an agent; None if it has none (yet). From any thread."""
        endpoint = self._endpoints.get(agent)
        return None if endpoint is None else endpoint.publisher

    def counts(self) -> list[AgentCounts]:
        """Return what each agent's publisher did since this was asked before."""
        return [endpoint.publisher.counts() for endpoint in self._endpoints.values()]

    def close(self) -> None:
        """Remove all of them."""
        while self._endpoints:
            self._endpoints.popitem()[1].close()
        self._disparity.set_agents(())

    def _set_rate(self, endpoint: _Endpoint, spec: AgentSpec) -> None:
        try:
            endpoint.publisher.set_rate(spec.rate_hz)
        except SailenvError:
            return  # deleted meanwhile; the next scene_info says so
        endpoint.spec = spec

    def _add(self, spec: AgentSpec) -> None:
        try:
            publisher = AgentPublisher(
                self._node, self._simulation, spec, self._tf, self._disparity
            )
        except SailenvError:
            return  # deleted meanwhile; the next scene_info says so
        services = AgentServices(
            self._node, self._runner, publisher, spec, publisher_of=self.publisher_of
        )
        self._endpoints[spec.name] = _Endpoint(spec=spec, publisher=publisher, services=services)


def _same_topics(one: AgentSpec, other: AgentSpec) -> bool:
    """Return whether two specs differ at most in what topics and services need not be made for.

    Another lens is none of it: frames bring their camera along, and a service that changes it must
    live to answer.
    """
    return (one.depth_range_m, one.views) == (other.depth_range_m, other.views)
