"""Who hosts a gateway: `sailenv run --no-ros`, which needs no ROS, and how it begins and ends."""

from __future__ import annotations

import re
import signal
import socket
import subprocess
import sys
import urllib.request
from collections.abc import Iterator

import pytest

from sailenv_ros.errors import AddressInUse, InvalidRequest, UnknownName
from sailenv_ros.gateway import GatewayServer, gateway_server
from sailenv_ros.simulation import Simulation
from tests.support.ports import free_port
from tests.support.sailenv_client import original_client

# A process in which any import of ROS fails.
WITHOUT_ROS = """
import sys
for name in ("rclpy", "sailenv_msgs", "sensor_msgs", "std_msgs"):
    sys.modules[name] = None
from sailenv_ros.cli.main import main
sys.exit(main(sys.argv[1:]))
"""


@pytest.fixture
def viewer_port() -> int:
    """A port for the web viewer that nobody uses."""
    return free_port()


@pytest.fixture
def process(viewer_port: int) -> Iterator[subprocess.Popen[str]]:
    words = ["run", "optical", "--no-ros", "--port", "0", "--viewer-port", str(viewer_port)]
    command = [sys.executable, "-c", WITHOUT_ROS, *words]
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as started:
        yield started
        if started.poll() is None:
            started.kill()


@pytest.mark.gl
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_without_ros_there_is_a_simulator_all_the_same(
    process: subprocess.Popen[str], viewer_port: int, number: int
) -> None:
    """It says where it listens, serves the SAILenv client and a page, and ends with status 0."""
    assert process.stdout is not None
    assert "scene 'optical'; renderer: " in process.stdout.readline()
    found = re.match(
        r"listening on 127\.0\.0\.1:(\d+) for SAILenv clients", process.stdout.readline()
    )
    assert found
    with original_client(int(found[1]), width=32, height=24) as agent:
        assert agent.get_frame()["main"].shape == (24, 32, 3)
    url = f"http://127.0.0.1:{viewer_port}/"
    assert url in process.stdout.readline()
    with urllib.request.urlopen(url, timeout=20.0) as page:
        assert b"main.js" in page.read()
    process.send_signal(number)
    _, errors = process.communicate(timeout=30.0)
    assert process.returncode == 0
    assert "Traceback" not in errors


def test_an_address_in_use_is_refused(blank_simulation: Simulation) -> None:
    """The sentence names the address; nothing is left behind."""
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        with pytest.raises(AddressInUse, match=f"127.0.0.1:{port}"):
            GatewayServer(blank_simulation, port=port)
    with GatewayServer(blank_simulation, port=port) as server:
        assert server.port == port


def test_wrong_settings_are_refused(blank_simulation: Simulation) -> None:
    """A revision or port that there is not."""
    with pytest.raises(UnknownName, match="protocol"):
        GatewayServer(blank_simulation, protocol="1.0")
    with pytest.raises(InvalidRequest, match="port of the gateway"):
        GatewayServer(blank_simulation, port=70_000)


def test_a_gateway_ends_though_clients_are_there(blank_simulation: Simulation) -> None:
    """They are disconnected and their agents removed; a second end does nothing."""
    server = GatewayServer(blank_simulation, port=0)
    with socket.create_connection(("127.0.0.1", server.port), 5.0) as idle:
        idle.sendall(b"\x10\0\0\0\x10\0\0\0\0")
        assert idle.recv(4)
        server.close()
        server.close()
        while idle.recv(4096):
            pass
    # Requests are done in their order: this one comes after the agent's removal.
    blank_simulation.spawnable_display_names()
    assert [a.name for a in blank_simulation.info.agents if a.name.startswith("client_")] == []


def test_numbers_of_clients_come_again(
    blank_simulation: Simulation, monkeypatch: pytest.MonkeyPatch
) -> None:
    """So do the names of their topics; a number that is in use is passed over."""
    monkeypatch.setattr(gateway_server, "NUMBERS", 3)
    found = []
    with (
        GatewayServer(blank_simulation, port=0) as server,
        original_client(server.port, width=32, height=24) as stays,
    ):
        for _ in range(4):
            with original_client(server.port, width=32, height=24) as client:
                found.append(client.id)
        assert stays.id == 1
    assert found == [2, 3, 2, 3]
