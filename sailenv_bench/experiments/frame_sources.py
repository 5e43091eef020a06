"""Frame sources of experiments: an `Agent`, or a `Simulation` in this process.

Both give the frame dict that users get. The Agent is imported only where it is used: without ROS
the other source works.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from typing import Any, Protocol

import numpy as np

from sailenv_ros.simulation.simulation import Simulation
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics

__all__ = ["FrameSource", "agent_source", "in_process_source"]

ANSWER_S = 120.0
"""Time that a simulator may take on a busy machine, where the first frames take long [s]."""


class FrameSource(Protocol):
    """A source of frames of one size of picture, in lockstep."""

    @property
    def renderer(self) -> str:
        """One line: back end, device, driver."""

    def step(self, count: int) -> None:
        """Advance physics by steps of 1/240 s."""

    def get_frame(self, flow: bool) -> dict[str, Any]:
        """Return ``main`` (H, W, 3) uint8 BGR, and ``flow`` [px/s] if it is wanted."""


class _AgentSource:
    def __init__(self, with_flow: Any, without_flow: Any, renderer: str) -> None:
        self._agents = {True: with_flow, False: without_flow}
        self.renderer = renderer

    def step(self, count: int) -> None:
        self._agents[True].step(count)

    def get_frame(self, flow: bool) -> dict[str, Any]:
        frame: dict[str, Any] = self._agents[flow].get_frame()
        return frame


@contextmanager
def agent_source(scene: str, width: int, height: int) -> Iterator[FrameSource]:
    """Start a simulator node with two Agents: one that wants flow and picture, one the picture.

    Raises
    ------
    ImportError
        Without ROS.
    """
    from sailenv_ros import Agent

    off = {f"{view}_frame_active": False for view in ("object", "category", "depth")}
    common: dict[str, Any] = {
        "width": width,
        "height": height,
        "namespace": f"/bench_{os.getpid()}",
        "timeout_s": ANSWER_S,
        "start_timeout_s": ANSWER_S,
        "simulator": {"scene": scene, "mode": "lockstep", "agent.name": "", "gateway.port": 0},
        **off,
    }
    with ExitStack() as stack:
        with_flow = stack.enter_context(Agent(**common))
        without = stack.enter_context(Agent(**common, flow_frame_active=False))
        yield _AgentSource(with_flow, without, "in the simulator node, through shared memory")


class _InProcessSource:
    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation
        self.renderer = simulation.info.renderer

    def step(self, count: int) -> None:
        self._simulation.step(count)

    def get_frame(self, flow: bool) -> dict[str, Any]:
        if not flow:
            frame = self._simulation.capture(agent="without_flow")
            return {"main": np.ascontiguousarray(frame["rgb"][..., ::-1])}
        frame = self._simulation.capture(agent="with_flow")
        main = np.ascontiguousarray(frame["rgb"][..., ::-1])
        return {"main": main, "flow": frame["flow"]}


@contextmanager
def in_process_source(scene: str, width: int, height: int) -> Iterator[FrameSource]:
    """Start a simulation in this process; needs no ROS and sends nothing."""
    lens = CameraIntrinsics(width=width, height=height)
    with Simulation(scene, mode="lockstep") as simulation:
        for name, views in (("with_flow", ("rgb", "flow")), ("without_flow", ("rgb",))):
            spec = AgentSpec(name=name, intrinsics=lens, views=views, rate_hz=0.0)
            simulation.register_agent(spec)
        yield _InProcessSource(simulation)
