"""A simulator that starts before ROS is installed becomes a node as soon as that is there."""

from __future__ import annotations

import asyncio
import subprocess
import sys
import threading
from pathlib import Path

import aiohttp
import pytest

from sailenv_msgs.srv import GetPose, Step
from sailenv_ros.types.views import FIVE_VIEWS
from tests.support.ports import free_port
from tests.support.ros_probe import Probe
from tests.support.viewer_socket import ViewerSocket
from tests.support.waiting import until

pytestmark = pytest.mark.ros

NAMESPACE = "/sailenv"
SMALL = ["-p", "agent.width:=64", "-p", "agent.height:=48"]


class EarlyStart:
    """The process, with what it says; a context manager that ends it."""

    def __init__(self, setup: Path, *parameters: str) -> None:
        module = "sailenv_ros.ros.nodes.early_start"
        command = [sys.executable, "-m", module, "--ros-setup", str(setup), "--", "--ros-args"]
        self.process = subprocess.Popen(
            [*command, "-p", "scene:=optical", "-p", "gateway.port:=0", *SMALL, *parameters],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
        )
        self.lines: list[str] = []
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def _read(self) -> None:
        assert self.process.stderr is not None
        self.lines.extend(line.rstrip() for line in self.process.stderr)

    def await_line(self, text: str) -> None:
        until(
            lambda: any(text in line for line in self.lines) or self.process.poll() is not None,
            f"{text!r} to be said",
            80.0,
        )
        assert any(text in line for line in self.lines), self.lines

    def end(self) -> int:
        self.process.terminate()
        status = self.process.wait(30.0)
        self._reader.join(5.0)
        return status

    def __enter__(self) -> EarlyStart:
        return self

    def __exit__(self, *exc: object) -> None:
        if self.process.poll() is None:
            self.end()
        self._reader.join(5.0)
        assert self.process.stderr is not None
        self.process.stderr.close()


def program(folder: Path, text: str) -> Path:
    """Write what takes the place of the installation of ROS."""
    file = folder / "setup"
    file.write_text(f"#!/bin/sh\n{text}\n")
    file.chmod(0o755)
    return file


async def frame_in_a_browser(port: int) -> set[str]:
    """Return the views of the first frame that a page receives."""
    url = f"http://127.0.0.1:{port}"
    async with (
        aiohttp.ClientSession() as session,
        session.ws_connect(f"{url}/socket", origin=url) as connection,
    ):
        page = ViewerSocket(connection)
        await page.ask("watch", agent="debug_agent", views=list(FIVE_VIEWS))
        head = await page.frame()
        return {view["name"] for view in head["views"]}


def test_frames_come_before_ros_and_services_after_it(tmp_path: Path) -> None:
    """One process and one simulation: what a page has changed before, ROS tells after."""
    go_on = tmp_path / "go on"
    setup = program(
        tmp_path,
        f'echo "fetching $1"; while [ ! -e "{go_on}" ]; do sleep 0.1; done; echo fetched',
    )
    port = free_port()
    mode = ("-p", "mode:=lockstep", "-p", f"viewer.port:={port}")
    with EarlyStart(setup, *mode) as early:
        early.await_line("ROS 2 is installed meanwhile")
        early.await_line("in the background: fetching --environment")
        assert asyncio.run(frame_in_a_browser(port)) == set(FIVE_VIEWS)
        go_on.touch()
        early.await_line("rqt_image_view")
        with Probe(NAMESPACE) as probe:
            assert probe.done(Step, "step", Step.Request(steps=24)).stamp.nanosec == 100_000_000
            assert probe.done(GetPose, "agent/get_pose").success
        assert asyncio.run(frame_in_a_browser(port)) == set(FIVE_VIEWS)
        assert early.end() == 0
    assert not any("Traceback" in line for line in early.lines), early.lines


def test_without_ros_it_goes_on(tmp_path: Path) -> None:
    """An installation that fails is reported, with what to type; the window stays."""
    setup = program(tmp_path, "echo no connection; exit 7")
    port = free_port()
    with EarlyStart(setup, "-p", f"viewer.port:={port}") as early:
        early.await_line("in the background: no connection")
        early.await_line(f"ended with status 7; to do it by hand: {setup} --environment")
        assert asyncio.run(frame_in_a_browser(port)) == set(FIVE_VIEWS)
        assert early.end() == 0


def test_an_installation_is_broken_off_with_the_simulator(tmp_path: Path) -> None:
    """Nothing of it is left running."""
    alive = tmp_path / "alive"
    setup = program(tmp_path, f'(echo $$ > "{alive}"; exec sleep 600) & wait')
    with EarlyStart(setup, "-p", "viewer.port:=0") as early:
        until(lambda: alive.exists() and alive.read_text().strip(), "the installation", 80.0)
        assert early.end() == 0
    assert not any("Traceback" in line for line in early.lines), early.lines
    group = int(alive.read_text())
    until(lambda: not still_there(group), "its processes to end")


def still_there(group: int) -> bool:
    """Return whether any process of a group lives."""
    listed = subprocess.run(
        ["ps", "-e", "-o", "pgid=,stat="], capture_output=True, text=True, check=True
    ).stdout
    rows = (line.split() for line in listed.splitlines())
    return any(int(row[0]) == group and not row[1].startswith("Z") for row in rows)


def test_a_wrong_parameter_ends_it_in_a_sentence(tmp_path: Path) -> None:
    """As the node would, with status 2."""
    with EarlyStart(program(tmp_path, "exit 0"), "-p", "real_time_factor:=50.0") as early:
        assert early.process.wait(60.0) == 2
        early.await_line("from 0.1 to 10")
