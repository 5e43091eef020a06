"""What motion costs: physics with many moving bodies, and many agents that look at them.

Prints milliseconds per simulated second and the real-time factor for bodies in a closed box, and
frames per second in all for 1, 4 and 16 agents at 320x240.
"""

from __future__ import annotations

import argparse
import json
import tempfile
import time
from pathlib import Path
from typing import Any

from sailenv_ros.agents import AgentSpec
from sailenv_ros.backends.selection import make_backend
from sailenv_ros.camera import CameraIntrinsics
from sailenv_ros.simulation.core import SimulationCore
from sailenv_ros.simulation.scenes import SceneLibrary

WALLS = (
    ([0, 0, -0.1], [6.4, 6.4, 0.2]),
    ([0, 0, 3.1], [6.4, 6.4, 0.2]),
    ([0, 3.1, 1.5], [6.4, 0.2, 3]),
    ([0, -3.1, 1.5], [6.4, 0.2, 3]),
    ([3.1, 0, 1.5], [0.2, 6, 3]),
    ([-3.1, 0, 1.5], [0.2, 6, 3]),
)

KINDS: dict[str, dict[str, Any]] = {
    "poltergeist": {"mean_interval": 4.0},
    "uniform_movement_random_bounce": {"speed": 1.0},
}


def scene_of(type_: str, count: int) -> str:
    """Describe a closed box with so many cubes that move by a behaviour."""
    objects: list[dict[str, Any]] = [
        {"name": f"wall {n}", "asset": "cube", "static": True, "position": p, "scale": s}
        for n, (p, s) in enumerate(WALLS)
    ]
    for number in range(count):
        row, column, level = number % 8, number // 8 % 8, number // 64
        objects.append(
            {
                "name": f"cube {number}",
                "asset": "cube",
                "scale": 0.2,
                "position": [0.7 * row - 2.45, 0.7 * column - 2.45, 0.3 + 0.6 * level],
                "gravity": type_ == "poltergeist",
                "behaviours": [{"type": type_, **KINDS[type_]}],
            }
        )
    return json.dumps({"version": 1, "objects": objects})


def core_of(text: str, folder: Path) -> SimulationCore:
    """Build a simulation of a scene's text."""
    path = folder / "bench.yaml"
    path.write_text(text, encoding="utf-8")
    return SimulationCore(
        SceneLibrary(),
        path,
        make_backend("auto", None),
        mode="lockstep",
        real_time_factor=1.0,
        seed=0,
        paused=False,
    )


def time_physics(type_: str, count: int, seconds: float, folder: Path) -> None:
    """Print what a simulated second costs."""
    core = core_of(scene_of(type_, count), folder)
    core.step(240)
    began = time.perf_counter()
    core.step(round(240 * seconds))
    wall_s = (time.perf_counter() - began) / seconds
    core.close()
    print(
        f"{count} bodies, {type_}: {1e3 * wall_s:.0f} ms per simulated second, "
        f"real-time factor {1.0 / wall_s:.2f}"
    )


def time_agents(agents: int, frames: int, folder: Path) -> None:
    """Print how many frames of five views are rendered in a second, by all agents together."""
    core = core_of(scene_of("poltergeist", 50), folder)
    lens = CameraIntrinsics(width=320, height=240)
    for number in range(agents):
        core.register_agent(AgentSpec(name=f"agent_{number}", intrinsics=lens))
        core.capture(agent=f"agent_{number}")
    began = time.perf_counter()
    for _ in range(max(1, frames // agents)):
        core.step(8)
        for number in range(agents):
            core.capture(agent=f"agent_{number}")
    wall_s = time.perf_counter() - began
    core.close()
    print(f"{agents} agents at 320x240: {max(1, frames // agents) * agents / wall_s:.1f} frames/s")


def main() -> None:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--bodies", type=int, default=200)
    parser.add_argument("--seconds", type=float, default=5.0, help="simulated, per measurement")
    parser.add_argument("--frames", type=int, default=64)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        for type_ in KINDS:
            time_physics(type_, options.bodies, options.seconds, Path(folder))
        for agents in (1, 4, 16):
            time_agents(agents, options.frames, Path(folder))


if __name__ == "__main__":
    main()
