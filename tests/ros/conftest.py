"""Participants beside the simulator of a module: its fixture `node`, or that of a keeper."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from sailenv_msgs.srv import Reset
from sailenv_ros import Agent
from tests.support.ros_probe import Probe
from tests.support.sim_node_process import NodeProcess

LOCKSTEP = {
    "scene": "optical",
    "mode": "lockstep",
    "agent.name": "",
    "gateway.port": 0,
    "viewer.port": 0,
}
SMALL = {"width": 160, "height": 120}


@pytest.fixture(scope="module")
def participant(node: NodeProcess) -> Iterator[Probe]:
    """A participant, whom the simulator has found."""
    with Probe(node.namespace) as probe:
        yield probe


@pytest.fixture
def probe(participant: Probe) -> Iterator[Probe]:
    """The participant with no topic subscribed to; the scene stands at its beginning."""
    participant.done(Reset, "reset", Reset.Request(keep_seed=True))
    yield participant
    participant.listen_no_more()


@pytest.fixture(scope="module")
def keeper(request: pytest.FixtureRequest) -> Iterator[Agent]:
    """One lockstep simulator for the tests of a module, held by an Agent of its own."""
    module = request.module
    size = getattr(module, "SMALL", SMALL)
    with Agent(**size, namespace=module.NAMESPACE, simulator=LOCKSTEP) as keeper:
        yield keeper


@pytest.fixture
def agent(request: pytest.FixtureRequest, keeper: Agent) -> Iterator[Agent]:
    """A small agent that stands in the scene as it begins."""
    keeper.reset()
    with Agent(**SMALL, namespace=request.module.NAMESPACE) as agent:
        yield agent
