"""Workloads for counting frames per second; each is one way from the simulator to its user.

A setting in, something that makes frames out. Runs in a process of its own (`worker`), so that
environment, caches and OpenGL contexts are its own.
"""

from __future__ import annotations

import os
import subprocess
import sys
import types
import typing
import warnings
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Protocol

from sailenv_ros.errors import ProtocolError
from sailenv_ros.extras import need
from sailenv_ros.simulation.simulation import Simulation
from sailenv_ros.system.frame_socket import DIRECT_FRAMES
from sailenv_ros.system.memory import keep_freed_memory
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.views import FIVE_VIEWS

__all__ = ["STEPS", "TRANSPORTS", "Setting", "Workload", "environment_of", "make_workload"]

STEPS = 8
"""Physics steps between two frames: 30 frames per simulated second."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Setting:
    """Settings of a worker.

    Attributes
    ----------
    kind : str
        A name of `TRANSPORTS` or of `baselines.BASELINES`.
    scene : str
    width, height : int
        [px]
    views : tuple of str
    agents : int
        How many cameras; a peer has one.
    """

    kind: str
    scene: str
    width: int
    height: int
    views: tuple[str, ...]
    agents: int = 1

    @property
    def lens(self) -> CameraIntrinsics:
        """The cameras' intrinsics."""
        return CameraIntrinsics(width=self.width, height=self.height)


class Workload(Protocol):
    """Makes frames in lockstep."""

    renderer: str
    pids: tuple[int, ...]

    @property
    def repeated(self) -> int:
        """Number of frames requested again because images were lost."""

    def step(self) -> None:
        """Advance physics by `STEPS`."""

    def frames(self) -> list[dict[str, float]]:
        """Make one frame of each camera; return the stages' times that are known [s]."""

    def close(self) -> None:
        """End everything that was started."""


class _NothingLost:
    """Base of the workloads that lose no frames."""

    repeated = 0


class _InProcess(_NothingLost):
    def __init__(self, setting: Setting) -> None:
        keep_freed_memory()
        self._simulation = Simulation(setting.scene, mode="lockstep")
        self._names = [f"camera_{number}" for number in range(setting.agents)]
        for name in self._names:
            spec = AgentSpec(name=name, intrinsics=setting.lens, views=setting.views, rate_hz=0.0)
            self._simulation.register_agent(spec)
        self.renderer = self._simulation.info.renderer
        self.pids: tuple[int, ...] = ()

    def step(self) -> None:
        self._simulation.step(STEPS)

    def frames(self) -> list[dict[str, float]]:
        return [dict(self._simulation.capture(agent=name).timings_s) for name in self._names]

    def close(self) -> None:
        self._simulation.close()


class _ByAgent:
    """An Agent, or several in one process, and the simulator node that it starts."""

    def __init__(self, setting: Setting) -> None:
        from sailenv_ros import Agent

        self._stack = ExitStack()
        lockstep = {
            "scene": setting.scene,
            "mode": "lockstep",
            "agent.name": "",
            "gateway.port": 0,
        }
        self._agents = [
            self._stack.enter_context(
                Agent(
                    "rgb" in setting.views,
                    "instance" in setting.views,
                    "category" in setting.views,
                    "flow" in setting.views,
                    "depth" in setting.views,
                    width=setting.width,
                    height=setting.height,
                    views=setting.views,
                    namespace=f"/bench_{os.getpid()}",
                    simulator=lockstep,
                )
            )
            for _ in range(setting.agents)
        ]
        self.renderer = ""
        pid = self._agents[0].simulator_pid
        self.pids: tuple[int, ...] = () if pid is None else (pid,)

    @property
    def repeated(self) -> int:
        return sum(agent.recaptured for agent in self._agents)

    def step(self) -> None:
        self._agents[0].step(STEPS)

    def frames(self) -> list[dict[str, float]]:
        return [{"render": agent.get_frame()["render_s"]} for agent in self._agents]

    def close(self) -> None:
        self._stack.close()


class _Gateway(_NothingLost):
    """The SAILenv client, and the simulator behind the gateway in another process."""

    def __init__(self, setting: Setting, *, use_gzip: bool) -> None:
        client = _original_client()
        self._host = subprocess.Popen(
            [sys.executable, "-m", "sailenv_bench.experiments.gateway_host", setting.scene],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        self.pids: tuple[int, ...] = (self._host.pid,)
        self._clients: list[Any] = []
        try:
            port, _, self.renderer = self._answer().partition(" ")
            for _ in range(setting.agents):
                agent = client(
                    main_frame_active="rgb" in setting.views,
                    depth_frame_active="depth" in setting.views,
                    object_frame_active="instance" in setting.views,
                    category_frame_active="category" in setting.views,
                    flow_frame_active="flow" in setting.views,
                    host="127.0.0.1",
                    port=int(port),
                    width=setting.width,
                    height=setting.height,
                    use_gzip=use_gzip,
                )
                agent.register()
                self._clients.append(agent)
        except BaseException:
            self.close()
            raise

    def step(self) -> None:
        assert self._host.stdin is not None
        self._host.stdin.write(f"{STEPS}\n")
        self._host.stdin.flush()
        self._answer()

    def frames(self) -> list[dict[str, float]]:
        for agent in self._clients:
            agent.get_frame()
        return []

    def close(self) -> None:
        for agent in self._clients:
            agent.delete()
        self._host.communicate(timeout=30.0)

    def _answer(self) -> str:
        # Whoever started this process has a deadline for it.
        assert self._host.stdout is not None
        line = self._host.stdout.readline()
        if not line:
            raise ProtocolError("the gateway's process has ended")
        return line.strip()


def _original_client() -> Any:
    if sys.version_info >= (3, 13):
        # What it imports of this module is gone from typing.
        module: Any = types.ModuleType("typing.io")
        module.BinaryIO = typing.BinaryIO
        sys.modules["typing.io"] = module
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)
        return need("sailenv.agent", "the gateway's measurement").Agent


TRANSPORTS: Mapping[str, Callable[[Setting], Workload]] = MappingProxyType(
    {
        "in process": _InProcess,
        "shared memory": _ByAgent,
        "DDS, our profile": _ByAgent,
        "DDS, default": _ByAgent,
        "gateway, raw": lambda setting: _Gateway(setting, use_gzip=False),
        "gateway, gzip": lambda setting: _Gateway(setting, use_gzip=True),
    }
)
"""Transports from the simulator to its user, by name."""


def environment_of(kind: str) -> dict[str, str]:
    """Return what a worker's environment has besides this process's own."""
    return dict(_ENVIRONMENTS.get(kind, {}))


_ENVIRONMENTS: Mapping[str, Mapping[str, str]] = {
    "shared memory": {DIRECT_FRAMES: "1"},
    "DDS, our profile": {DIRECT_FRAMES: "0"},
    # Fast DDS as it comes: whoever sets this variable is left alone by our own choice of profile.
    "DDS, default": {DIRECT_FRAMES: "0", "FASTDDS_BUILTIN_TRANSPORTS": "DEFAULT"},
}


class _Peer(_NothingLost):
    def __init__(self, setting: Setting) -> None:
        from sailenv_bench.experiments.baselines import BASELINES, BaselineScene

        self._scene = BaselineScene(setting.scene, setting.width, setting.height)
        self._picture = BASELINES[setting.kind][1]()
        self.renderer = ""
        self.pids: tuple[int, ...] = ()

    def step(self) -> None:
        self._picture.prepare(*self._scene.advance(STEPS))

    def frames(self) -> list[dict[str, float]]:
        self._picture.draw()
        return []

    def close(self) -> None:
        self._picture.close()
        self._scene.close()


def make_workload(setting: Setting) -> Workload:
    """Start what a setting names; views of `frame.VIEWS`, the five unless others are named."""
    made = TRANSPORTS.get(setting.kind, _Peer)
    views = setting.views or FIVE_VIEWS
    if setting.kind.startswith("gateway"):
        views = tuple(view for view in views if view in FIVE_VIEWS)
    return made(
        Setting(
            kind=setting.kind,
            scene=setting.scene,
            width=setting.width,
            height=setting.height,
            views=views,
            agents=setting.agents,
        )
    )
