"""Flow is exact for every kind of motion: each behaviour before a camera on rails and a driven one.

Objects in a closed box of cubes; what is seen is compared with rays and rigid-body arithmetic.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sailenv_ros.render.cpu.renderer import NativeRenderer
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics
from tests.render.test_scene_in_motion import check, seen
from tests.support.lockstep_core import lockstep_core

TRACK = [
    {"position": [0.0, -0.5, 1.5]},
    {"position": [0.3, 0.5, 1.6], "rotation": [0, 20, 60]},
    {"position": [-0.2, 0.2, 1.3], "rotation": [40, 0, 100]},
]

BEHAVIOURS: dict[str, dict[str, Any]] = {
    "rotate_rigidbody": {"angular_velocity": [20, 0, 70]},
    "poltergeist": {"mean_interval": 0.05, "acceleration": 60.0},
    "wander_plane": {"waypoints": [[0, -1, 1.5], [0, 1, 1.6], [0.5, 0, 1.2]], "turn_rate": 300},
    "uniform_movement_random_bounce": {"speed": 3.0, "angular_speed": 90.0},
    "linear_waypoints": {"waypoints": TRACK, "total_time": 2.0},
    "catmull_waypoints": {"waypoints": TRACK, "total_time": 2.0},
}

WALLS = {
    "floor": ([0, 0, -0.1], [4.4, 4.4, 0.2]),
    "ceiling": ([0, 0, 3.1], [4.4, 4.4, 0.2]),
    "north": ([0, 2.1, 1.5], [4.4, 0.2, 3]),
    "south": ([0, -2.1, 1.5], [4.4, 0.2, 3]),
    "east": ([2.1, 0, 1.5], [0.2, 4, 3]),
    "west": ([-2.1, 0, 1.5], [0.2, 4, 3]),
}


def scene_of(type_: str) -> dict[str, Any]:
    """Two objects with the behaviour in a closed box, a mover on rails and one that is driven."""
    objects: list[dict[str, Any]] = [
        {"name": name, "asset": "cube", "static": True, "position": place, "scale": scale}
        for name, (place, scale) in WALLS.items()
    ]
    for name, y in (("first", -0.5), ("second", 0.6)):
        objects.append(
            {
                "name": name,
                "asset": "cube",
                "position": [0.2, y, 1.5],
                "scale": [0.5, 0.3, 0.4],
                "gravity": False,
                "behaviours": [{"type": type_, **BEHAVIOURS[type_]}],
            }
        )
    rails = [
        {"position": [-1.7, -0.4, 1.4], "rotation": [0, 0, 5]},
        {"position": [-1.4, 0.4, 1.6], "rotation": [0, 5, -10]},
    ]
    movers = [
        {"name": "rails", "waypoints": rails, "total_time": 1.2},
        {"name": "cart", "position": [-1.5, 0.2, 1.5], "controller": "rigidbody"},
    ]
    return {"version": 1, "objects": objects, "movers": movers}


@pytest.mark.parametrize("type_", BEHAVIOURS)
def test_flow_is_exact_whatever_moves(type_: str, tmp_path: Path) -> None:
    """To 1e-3 px per frame, for a camera on waypoints and for one that commands drive."""
    path = tmp_path / "box.yaml"
    path.write_text(json.dumps(scene_of(type_)), encoding="utf-8")  # JSON is YAML, too
    core = lockstep_core(path, renderer=NativeRenderer(), seed=2)
    lens = CameraIntrinsics(width=96, height=72, vertical_fov_deg=70.0)
    agents = ("on_rails", "driven")
    for agent, mover in zip(agents, ("rails", "cart"), strict=True):
        core.register_agent(AgentSpec(name=agent, intrinsics=lens, mover=mover))
    last = {agent: seen(core, agent) for agent in agents}
    for _ in range(5):
        core.drive_mover(linear_m_s=(-0.3, 0.4, 0.2), angular_rad_s=(0, 0.1, -0.6), mover="cart")
        core.step(10)
        for agent in agents:
            now = seen(core, agent)
            check(now, last[agent])
            last[agent] = now
    # The objects did move, and are seen: otherwise nothing would have been shown.
    still = SceneLibrary().load(path).objects[6:]
    for number, entry in enumerate(still):
        body = last["driven"][1].world_from_body[6 + number]
        assert np.abs(body - entry.pose.matrix()).max() > 0.02
    core.close()
