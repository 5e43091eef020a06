"""A request that discovery loses is sent again where that does no harm, and else told."""

from __future__ import annotations

import os
import threading
from collections.abc import Iterator
from typing import Any

import pytest
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.task import Future

from sailenv_msgs.srv import Capture
from sailenv_ros.errors import DeadlineExceeded
from sailenv_ros.ros.client.connection import Connection
from tests.support.ros_probe import Probe
from tests.support.waiting import until

NAMESPACE = "/forgetful"


class Forgetful:
    """A service that never answers its first requests."""

    def __init__(self, probe: Probe) -> None:
        self.unanswered = 0
        self.received = 0
        self._never: list[Future] = []
        self._lock = threading.Lock()
        # Others are answered while one waits for ever.
        self._service = probe.node.create_service(
            Capture, "agent/capture", self._answer, callback_group=ReentrantCallbackGroup()
        )

    async def _answer(self, request: Capture.Request, response: Capture.Response) -> Any:
        with self._lock:
            self.received += 1
            response.sequence = self.received
        if response.sequence <= self.unanswered:
            self._never.append(Future())
            await self._never[-1]
        return response


@pytest.fixture(scope="module")
def probe() -> Iterator[Probe]:
    with Probe(NAMESPACE) as probe:
        yield probe


@pytest.fixture(scope="module")
def forgetful(probe: Probe) -> Forgetful:
    return Forgetful(probe)


@pytest.fixture
def connection() -> Iterator[Connection]:
    connection = Connection(int(os.environ["ROS_DOMAIN_ID"]), NAMESPACE)
    try:
        yield connection
    finally:
        connection.close()


def test_a_lost_request_is_sent_again(forgetful: Forgetful, connection: Connection) -> None:
    """The third is answered when two were lost, and its answer is the one that is taken."""
    forgetful.received, forgetful.unanswered = 0, 2
    response = connection.call(Capture, "agent/capture", Capture.Request(), 60.0, 0.1)
    assert response.sequence == 3


def test_requests_are_sent_once_unless_more_do_no_harm(
    forgetful: Forgetful, connection: Connection
) -> None:
    """Who does not ask for it gets the deadline's sentence, and the server one request."""
    known = connection._client(Capture, "agent/capture").service_is_ready
    until(known, "the service to be known")  # which is not what the deadline below is of
    forgetful.received, forgetful.unanswered = 0, 1
    with pytest.raises(DeadlineExceeded, match="an answer of the service /forgetful/agent/capture"):
        connection.call(Capture, "agent/capture", Capture.Request(), 2.0)
    assert forgetful.received == 1
