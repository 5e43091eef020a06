"""What is built beside a running simulation is shown by it, as if it had been there before."""

from __future__ import annotations

import logging
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sailenv_ros.light.bake.light_files import light_folder
from sailenv_ros.simulation import Simulation
from sailenv_ros.simulation.background_build import BackgroundBuild, BuildStep, furnishing
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.geometry import Pose
from tests.support.waiting import until

ROOM = """
version: 1
lights:
  - {name: lamp, type: point, position: [0, 0, 1.5]}
room: {size: [2, 2, 2]}
objects:
  - {name: ball, asset: sphere, position: [0.5, 0, 0.5], scale: 0.4, static: true}
"""
EYE = AgentSpec(
    name="eye",
    intrinsics=CameraIntrinsics(width=64, height=48),
    rate_hz=0.0,
    following=False,
    pose=Pose((-0.8, 0.0, 1.0)),
)


@pytest.mark.slow
def test_light_that_is_baked_meanwhile_is_shown(cell: Path) -> None:
    """The same picture as that of a simulation that begins with the light."""
    with Simulation(cell, mode="lockstep", agent=EYE) as simulation:
        before, revision = simulation.capture(["rgb"]), simulation.info.revision
        with BackgroundBuild(simulation, [furnishing(str(cell), everything=False)]) as build:
            until(lambda: simulation.background_task, "a report of progress", timeout_s=100.0)
            assert simulation.background_task.startswith("light of "), simulation.background_task
            until(lambda: not build.running, "the light to be baked", timeout_s=100.0)
        assert simulation.background_task == ""
        until(lambda: simulation.info.revision > revision, "the light to be taken up")
        after = simulation.capture(["rgb"])
    with Simulation(cell, mode="lockstep", agent=EYE) as fresh:
        np.testing.assert_array_equal(after["rgb"], fresh.capture(["rgb"])["rgb"])
    assert np.abs(after["rgb"].astype(int) - before["rgb"].astype(int)).max() > 10


def test_a_simulation_that_ends_breaks_it_off(cell: Path) -> None:
    """No process goes on, and nothing that is half done is left."""
    with Simulation(cell, mode="lockstep") as simulation:
        build = BackgroundBuild(simulation, [furnishing(str(cell), everything=False)])
        build.close()
    assert not build.running
    assert not list(light_folder().glob("*.light"))


def shell(text: str, **keys: Any) -> BuildStep:
    """Return a step that a shell carries out."""
    return BuildStep(command=("sh", "-c", text), by_hand="make it", **keys)


def test_steps_follow_each_other_and_say_what_they_do(
    cell: Path, caplog: pytest.LogCaptureFixture
) -> None:
    """One that fails is reported with what to type, and the next one begins."""
    caplog.set_level(logging.INFO)
    done: list[str] = []
    steps = [
        shell("echo first", done=lambda: done.append("first")),
        shell("echo second; exit 3", done=lambda: done.append("second")),
        shell("echo $WHO", environment={"WHO": "third"}, done=lambda: done.append("third")),
    ]
    with Simulation(cell, mode="lockstep") as simulation:
        with BackgroundBuild(simulation, steps) as build:
            until(lambda: not build.running, "the steps to end", timeout_s=60.0)
        assert simulation.background_task == ""
    said = [record.getMessage() for record in caplog.records]
    shown = [text for text in said if text.startswith("in the background: ")]
    assert [text.rpartition(" ")[2] for text in shown] == ["first", "second", "third"]
    assert "building in the background ended with status 3; to do it by hand: make it" in said
    assert done == ["first", "third"]
