"""The gateway in sim_node: beside topics and services, on the port of its parameter."""

from __future__ import annotations

import socket

import pytest

from tests.support.ports import free_port
from tests.support.sailenv_client import original_client
from tests.support.sim_node_process import NodeProcess
from tests.support.waiting import until

pytestmark = pytest.mark.ros


def test_the_node_serves_the_original_client() -> None:
    """The log says where, a frame comes, and the node ends with a client still there."""
    port = free_port()
    with NodeProcess("/gate", gateway__port=port) as node:
        assert f"connect to 127.0.0.1, port {port}" in node.log
        with original_client(port, width=32, height=24) as agent:
            assert agent.get_frame()["flow"].shape == (24, 32, 2)
            node.close()
        assert node.status() == 0
        assert "Traceback" not in node.log


def test_ports_in_use_are_no_reason_not_to_start() -> None:
    """The node says that SAILenv clients cannot connect and that there is no window, and runs."""
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        with NodeProcess("/gate", gateway__port=port, viewer__port=port) as node:
            assert "cannot connect here" in node.log
            until(lambda: "no window in the browser here" in node.log, "the warning")
            assert node.alive
