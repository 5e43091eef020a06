"""The example of the SAILenv client does what it says."""

from __future__ import annotations

import runpy
import socket
import subprocess
import sys
from pathlib import Path

import pytest
from PIL import Image

from sailenv_ros.gateway import GatewayServer
from sailenv_ros.simulation import Simulation
from tests.support.sailenv_client import OriginalAgent

EXAMPLE = Path(__file__).parents[2] / "examples" / "05_original_client.py"


@pytest.mark.gl
def test_the_example_runs(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    """It prints what it saw, writes a picture, and leaves neither agent nor cube behind."""
    assert OriginalAgent  # imported before the example does, on Pythons that need a hand with it
    picture = tmp_path / "seen.png"
    with Simulation("object_view") as simulation, GatewayServer(simulation, port=0) as gateway:
        monkeypatch.setattr(sys, "argv", [str(EXAMPLE), str(gateway.port), str(picture)])
        runpy.run_path(str(EXAMPLE), run_name="__main__")
        left = [instance.name for instance in simulation.info.instances]
        scene = simulation.info.scene
        simulation.change_scene(scene)
        assert [instance.name for instance in simulation.info.instances] == left
        assert scene == "optical"
    out = capsys.readouterr().out
    assert "Error" not in out
    assert "floor" in out
    with Image.open(picture) as image:
        assert image.size == (320, 240)


def test_the_example_starts_a_simulator_where_there_is_none(tmp_path: Path) -> None:
    """In a process of its own; the simulator ends with it."""
    with socket.create_server(("127.0.0.1", 0)) as probe:
        port: int = probe.getsockname()[1]
    picture = tmp_path / "seen.png"
    # The client is imported first, as above.
    program = (
        "import runpy, sys; from tests.support.sailenv_client import OriginalAgent; "
        f"sys.argv = ['example', '{port}', '{picture}']; "
        f"runpy.run_path({str(EXAMPLE)!r}, run_name='__main__')"
    )
    done = subprocess.run(
        [sys.executable, "-c", program],
        cwd=EXAMPLE.parents[1],
        capture_output=True,
        text=True,
        timeout=110.0,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert f"no simulator listens on port {port}" in done.stdout
    with Image.open(picture) as image:
        assert image.size == (320, 240)
    with socket.socket() as later:
        assert later.connect_ex(("127.0.0.1", port)) != 0
