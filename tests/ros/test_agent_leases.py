"""Agents of clients that were killed go, at once where the host knows it, and nobody else's do."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

from sailenv_ros import Agent, Simulation
from sailenv_ros.errors import NameTaken
from sailenv_ros.ros.nodes.agent_endpoints import AgentEndpoints
from sailenv_ros.ros.nodes.requests import OperationRunner
from sailenv_ros.ros.nodes.tf_tree import TfTree
from sailenv_ros.system import client_locks
from sailenv_ros.system.process_locks import private_folder
from sailenv_ros.types.agents import MAX_AGENTS, AgentSpec
from tests.support.sim_node_process import NodeProcess
from tests.support.waiting import until

NAMESPACE = "/leased"

CLIENT = """
import os, sys
from sailenv_ros import Agent
agents = [
    Agent(width=32, height=24, namespace="/leased", name=name) for name in sys.argv[1:]
]
print("up", flush=True)
sys.stdin.readline()
"""


class Client:
    """A program that holds agents until it is killed."""

    def __init__(self, *names: str, environment: dict[str, str] | None = None) -> None:
        self._running = subprocess.Popen(
            [sys.executable, "-c", CLIENT, *names],
            env={
                **os.environ,
                "PYTHONPATH": os.pathsep.join(filter(None, sys.path)),
                **(environment or {}),
            },
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        assert self._running.stdout is not None
        assert self._running.stdout.readline() == "up\n"

    def kill(self) -> None:
        """End it as nothing but the kernel can."""
        self._running.kill()
        self._running.wait(10.0)
        assert self._running.stdin is not None
        assert self._running.stdout is not None
        self._running.stdin.close()
        self._running.stdout.close()


@pytest.fixture(scope="module")
def watcher() -> Iterator[Agent]:
    """An agent of this process in a simulator of its own process."""
    with (
        NodeProcess(NAMESPACE, mode="lockstep", agent__name="first"),
        Agent(width=32, height=24, namespace=NAMESPACE, name="watcher") as watcher,
    ):
        yield watcher


def names(watcher: Agent) -> set[str]:
    """Return the agents that there are."""
    return {spec.name for spec in watcher.info.agents}


def test_killed_clients_leave_nothing_and_others_stay(watcher: Agent) -> None:
    """All agents of a killed process go; those of the node, of this one and of nobody stay."""
    watcher.register_agent(AgentSpec(name="of_nobody", rate_hz=0.0))
    try:
        client = Client("one", "two")
        until(lambda: {"one", "two"} <= names(watcher), "the client's agents to be announced")
        client.kill()
        until(lambda: not {"one", "two"} & names(watcher), "the killed one's agents to go", 10.0)
        assert names(watcher) == {"first", "watcher", "of_nobody"}
        assert watcher.get_frame()["main"] is not None
    finally:
        watcher.delete_agent("of_nobody")


def test_killed_clients_use_nothing_up_and_give_their_names_back(watcher: Agent) -> None:
    """Their places and their names are free the moment they are dead, as often as one likes."""
    many = [f"agent_{number}" for number in range(MAX_AGENTS - 2)]
    for _ in range(2):
        Client(*many).kill()
    with Agent(width=32, height=24, namespace=NAMESPACE, name=many[0]) as successor:
        assert [successor.get_frame()["sequence"] for _ in range(2)] == [1, 2]


def test_a_refused_name_does_not_take_its_owners_agent_along(watcher: Agent) -> None:
    """Who asked for a name that was taken, and ended, never held that agent."""
    with Agent(width=32, height=24, namespace=NAMESPACE, name="owned") as owner:
        for name in ("owned", "first"):
            with pytest.raises(NameTaken):
                Agent(width=32, height=24, namespace=NAMESPACE, name=name)
        Client("other").kill()
        until(lambda: "other" not in names(watcher), "a killed one's agent to go", 10.0)
        assert owner.get_frame()["sequence"] == 1
        assert "first" in names(watcher)


def test_a_client_of_elsewhere_goes_when_dds_hears_nothing_of_it(
    watcher: Agent, tmp_path: Path
) -> None:
    """One whose lock cannot be seen, as on another host, is gone after its lease of 6 s."""
    (tmp_path / "runtime").mkdir(mode=0o700)
    client = Client("far", environment={"XDG_RUNTIME_DIR": str(tmp_path / "runtime")})
    until(lambda: "far" in names(watcher), "the client's agent to be announced")
    client.kill()
    # 8 s on an idle machine; DDS looks at leases from time to time.
    until(lambda: "far" not in names(watcher), "the far one's agent to go", 40.0)


def test_an_end_in_order_is_told_at_once(watcher: Agent) -> None:
    """A closed Agent is gone when `close` returns."""
    with Agent(width=32, height=24, namespace=NAMESPACE, name="orderly"):
        until(lambda: "orderly" in names(watcher), "the agent to be announced")
    until(lambda: "orderly" not in names(watcher), "its end to be announced", 5.0)


def test_names_that_nobody_asked_for_come_again(
    watcher: Agent, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Fast DDS keeps every topic's name; one that another agent has got is not used."""
    suffix = f".{os.getpid()}_agent"
    monkeypatch.setattr(client_locks, "MOST_NAMES", 2)
    monkeypatch.setattr(client_locks, "_NAMES", suffix)
    small = {"width": 32, "height": 24, "namespace": NAMESPACE}
    try:
        found = []
        for _ in range(4):
            with Agent(**small) as agent:
                assert [agent.get_frame()["sequence"] for _ in range(2)] == [1, 2]
                found.append(agent.id)
        assert found[2:] == found[:2]
        assert len(set(found)) == 2
        watcher.register_agent(AgentSpec(name=found[0], rate_hz=0.0))
        with Agent(**small) as agent:
            assert agent.id not in found
            assert agent.get_frame()["sequence"] == 1
        watcher.delete_agent(found[0])
    finally:
        for number in range(2):
            (private_folder() / f"{number}{suffix}").unlink(missing_ok=True)


@pytest.fixture
def node() -> Iterator[Node]:
    """A node of this process, which nobody spins."""
    context = Context()
    context.init([])
    node = Node("endpoints", context=context, use_global_arguments=False)
    yield node
    node.destroy_node()
    context.try_shutdown()


def test_an_agent_that_goes_before_its_topics_come_leaves_none(node: Node) -> None:
    """A page's agent is often gone when the node learns of it: 37 topics stayed each time."""
    executor = SingleThreadedExecutor(context=node.context)
    with Simulation("optical", mode="lockstep") as simulation:
        runner = OperationRunner(simulation, executor)
        endpoints = AgentEndpoints(node, simulation, runner, TfTree(node))
        before = set(node.publishers)
        for name in ("brief", "stays"):
            simulation.register_agent(AgentSpec(name=name, rate_hz=30.0))
        there = simulation.info
        simulation.delete_agent("brief")
        endpoints.reconcile(there)
        made = set(node.publishers) - before
        assert {publisher.topic.split("/")[0] for publisher in made} == {"stays"}
        endpoints.close()
        assert set(node.publishers) == before
    executor.shutdown(0.0)
