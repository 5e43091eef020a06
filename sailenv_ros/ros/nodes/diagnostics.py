"""/diagnostics once a second: how fast the simulation and each agent are, and what was dropped.

Reads counters of the simulation and of the agents' publishers; the wall clock is looked at here
because rates per second of it are what is told.
"""

from __future__ import annotations

import threading
import time
from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.node import Node

from sailenv_ros.frame.frame import Frame
from sailenv_ros.ros.nodes.qos import diagnostics_qos, no_events
from sailenv_ros.simulation import Simulation

__all__ = ["AgentCounts", "Diagnostics", "FrameCounter"]

INTERVAL_S = 1.0

SLOW = 0.9
"""Share of the requested real-time factor below which a warning is given."""


@dataclass(frozen=True, slots=True, kw_only=True)
class AgentCounts:
    """Counts of an agent's publisher since the previous report.

    Attributes
    ----------
    agent : str
    frames : int
        Frames that were published.
    timings_s : mapping of str to float
        Wall time of each stage, summed over these frames [s].
    dropped : int
        Frames since the beginning that were rendered and not published, as newer ones were there.
    """

    agent: str
    frames: int
    timings_s: Mapping[str, float]
    dropped: int


class FrameCounter:
    """Counts frames and their times; may be used from several threads."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._frames = 0
        self._timings_s: dict[str, float] = defaultdict(float)

    def add(self, frame: Frame, publish_s: float) -> None:
        """Take note of a frame that was published in that time [s]."""
        with self._lock:
            self._frames += 1
            for stage, took_s in {**frame.timings_s, "publish": publish_s}.items():
                self._timings_s[stage] += took_s

    def take(self, agent: str, dropped: int) -> AgentCounts:
        """Return what was counted and count again from 0."""
        with self._lock:
            counts = AgentCounts(
                agent=agent, frames=self._frames, timings_s=self._timings_s, dropped=dropped
            )
            self._frames, self._timings_s = 0, defaultdict(float)
        return counts


class Diagnostics:
    """Publishes /diagnostics.

    Parameters
    ----------
    node : Node
        Its namespace is part of each status's name.
    simulation : Simulation
    counts : callable
        Gives the counts of all agents since it was called before.
    """

    def __init__(
        self, node: Node, simulation: Simulation, counts: Callable[[], Iterable[AgentCounts]]
    ) -> None:
        self._simulation = simulation
        self._counts = counts
        self._name = node.get_namespace().strip("/")
        self._topic = node.create_publisher(
            DiagnosticArray, "/diagnostics", diagnostics_qos(), event_callbacks=no_events()
        )
        self._wall_s = time.monotonic()
        self._sim_time_ns = simulation.sim_time_ns
        self._clock = Clock(clock_type=ClockType.SYSTEM_TIME)
        # Not the node's clock: that may be the simulated one, which stands still at times.
        self._timer = node.create_timer(
            INTERVAL_S, self._publish, clock=Clock(clock_type=ClockType.STEADY_TIME)
        )

    def _publish(self) -> None:
        wall_s, sim_time_ns = time.monotonic(), self._simulation.sim_time_ns
        elapsed_s = max(wall_s - self._wall_s, 1e-9)
        advanced_s = max(0, sim_time_ns - self._sim_time_ns) * 1e-9  # a reset goes back to 0
        self._wall_s, self._sim_time_ns = wall_s, sim_time_ns
        statuses = [self._simulation_status(advanced_s / elapsed_s)]
        statuses += [self._agent_status(counts, elapsed_s) for counts in self._counts()]
        message = DiagnosticArray(status=statuses)
        message.header.stamp = self._clock.now().to_msg()
        self._topic.publish(message)

    def _simulation_status(self, real_time_factor: float) -> DiagnosticStatus:
        info = self._simulation.info
        runs = info.mode == "realtime" and not info.paused
        slow = runs and real_time_factor < SLOW * info.real_time_factor
        message = "runs" if runs else f"stands still ({'paused' if info.paused else info.mode})"
        if slow:
            message = f"slower than asked: {real_time_factor:.2f} of {info.real_time_factor:g}"
        values = {
            "scene": info.scene,
            "real-time factor": f"{real_time_factor:.3f}",
            "real-time factor aimed at": f"{info.real_time_factor:g}",
            "objects": str(len(info.instances)),
            "agents": str(len(info.agents)),
            "frames skipped": str(self._simulation.skipped_frames),
            "renderer": info.renderer,
        }
        return self._status("simulation", message, values, warn=slow)

    def _agent_status(self, counts: AgentCounts, elapsed_s: float) -> DiagnosticStatus:
        values = {
            "frames per second": f"{counts.frames / elapsed_s:.2f}",
            "frames dropped": str(counts.dropped),
        }
        for stage, total_s in counts.timings_s.items():
            values[f"{stage} [ms]"] = f"{1e3 * total_s / max(1, counts.frames):.2f}"
        message = "frames are published" if counts.frames else "nobody asks for frames"
        return self._status(f"agent {counts.agent}", message, values, warn=False)

    def _status(
        self, what: str, message: str, values: Mapping[str, str], *, warn: bool
    ) -> DiagnosticStatus:
        return DiagnosticStatus(
            level=DiagnosticStatus.WARN if warn else DiagnosticStatus.OK,
            name=f"{self._name}: {what}",
            message=message,
            hardware_id=self._name,
            values=[KeyValue(key=key, value=value) for key, value in values.items()],
        )
