"""Participants beside the simulator of a module, which its fixture `node` starts."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from sailenv_msgs.srv import Reset
from tests.support.ros_probe import Probe
from tests.support.sim_node_process import NodeProcess


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
