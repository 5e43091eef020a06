"""Bad requests to every service: a sentence answers each, and what is refused changed nothing.

Some of them can be done after all: a field that another one says is not used may hold anything.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import pytest
from rcl_interfaces.srv import GetParameters, SetParametersAtomically
from rclpy.parameter import Parameter

from sailenv_msgs.msg import ErrorCode
from sailenv_msgs.srv import GetPose, GetSceneText
from sailenv_msgs_py.services import AGENT_SERVICES, SIMULATOR_SERVICES, Service
from tests.support.bad_requests import bad_requests
from tests.support.ros_probe import Probe
from tests.support.sim_node_process import NodeProcess

pytestmark = pytest.mark.ros

NAMESPACE = "/bad_requests"
NODE = f"{NAMESPACE}/sim_node"
LONGEST_SENTENCE = 2000
"""A refusal may list names that are accepted, and shows what was asked for cut short."""

TRIED = [
    service
    for service in (*SIMULATOR_SERVICES, *AGENT_SERVICES)
    if any(bad_requests(service.type, np.random.default_rng(0)))
]
"""The others have flags alone, or nothing."""


@pytest.fixture(scope="module")
def node(tmp_path_factory: pytest.TempPathFactory) -> Iterator[NodeProcess]:
    """A lockstep simulator with one small agent, which saves scenes in a folder of its own."""
    saved = {"SAILENV_SCENES": str(tmp_path_factory.mktemp("scenes"))}
    with NodeProcess(
        NAMESPACE,
        environment=saved,
        mode="lockstep",
        agent__width=64,
        agent__height=48,
        agent__following=False,
    ) as node:
        yield node


@pytest.fixture(scope="module")
def probe(node: NodeProcess) -> Iterator[Probe]:
    """A client of that node."""
    with Probe(NAMESPACE) as probe:
        probe.discover({name_of(service): service.type for service in TRIED})
        yield probe


def name_of(service: Service) -> str:
    """Return the name of a service below the simulator's namespace."""
    return f"agent/{service.name}" if service.of_agent else service.name


@pytest.mark.parametrize("service", TRIED, ids=lambda service: service.name)
def test_bad_requests(node: NodeProcess, probe: Probe, service: Service) -> None:
    """The whole scene and the agent's pose are the same after a refusal, and no error is ours."""
    name = name_of(service)
    random = np.random.default_rng(list(name.encode()))
    before = state(probe)
    refused = 0
    for what, request in bad_requests(service.type, random):
        answer = probe.call(service.type, name, request)
        assert node.alive, what
        if answer.success:
            before = state(probe)
            continue
        refused += 1
        assert answer.code not in (0, ErrorCode.INTERNAL_FAULT), (what, answer.message)
        assert 0 < len(answer.message) < LONGEST_SENTENCE, (what, answer.message[:500])
        assert "Traceback" not in answer.message, what
        assert state(probe) == before, what
    assert refused, f"{name} does whatever is asked for"


def test_parameters_are_set_all_or_none(node: NodeProcess, probe: Probe) -> None:
    """One bad value among good ones, wherever it stands, and none of them is changed."""
    good = Parameter("real_time_factor", value=2.0)
    bad = [
        Parameter("agent.rate_hz", value=math.nan),
        Parameter("real_time_factor", value=-1.0),
        Parameter("real_time_factor", value="fast"),
        Parameter("nobody", value=1),
    ]
    before = parameters(probe)
    for one in bad:
        for both in ([good, one], [one, good]):
            wanted = [each.to_parameter_msg() for each in both]
            request = SetParametersAtomically.Request(parameters=wanted)
            service = f"{NODE}/set_parameters_atomically"
            result = probe.call(SetParametersAtomically, service, request).result
            assert not result.successful, both
            assert result.reason, both
            assert parameters(probe) == before, both
    assert node.alive


def parameters(probe: Probe) -> list[float]:
    """The values of what was tried."""
    request = GetParameters.Request(names=["real_time_factor", "agent.rate_hz"])
    values = probe.call(GetParameters, f"{NODE}/get_parameters", request).values
    return [value.double_value for value in values]


def state(probe: Probe) -> tuple[str, str]:
    """All that a scene file could say of the scene, and where the agent stands."""
    text = probe.done(GetSceneText, "get_scene_text").text
    return text, str(probe.done(GetPose, "agent/get_pose").pose.pose)
