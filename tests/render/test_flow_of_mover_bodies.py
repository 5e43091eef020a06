"""Flow is exact before a camera that a body carries, compared with rays."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from sailenv_ros.render.cpu.renderer import NativeRenderer
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics
from tests.render.test_flow_of_behaviours import WALLS, scene_of
from tests.render.test_scene_in_motion import check, seen
from tests.support.lockstep_core import lockstep_core


def test_flow_is_exact_before_a_body_that_bounces(tmp_path: Path) -> None:
    """To 1e-3 px per frame, before and after the strike, of one that spins; then it rests: 0."""
    scene: dict[str, Any] = scene_of("linear_waypoints")
    scene["gravity"] = [0, 0, 0]
    rails = scene["movers"][0]
    body = {"gravity": False, "restitution": 0.8, "friction": 0.2}
    motion = {"velocity": [-1.0, 0.3, 0.1], "angular_velocity": [20, 30, -40]}
    position = [-1.6, 0.0, 1.2]
    scene["movers"] = [{"name": rails["name"], "position": position, "body": {**body, **motion}}]
    path = tmp_path / "box.yaml"
    path.write_text(json.dumps(scene), encoding="utf-8")  # JSON is YAML, too
    core = lockstep_core(path, renderer=NativeRenderer(), seed=2)
    lens = CameraIntrinsics(width=96, height=72, vertical_fov_deg=70.0)
    core.register_agent(AgentSpec(name="rider", intrinsics=lens, mover=rails["name"]))
    last, signs = seen(core, "rider"), set()
    for _ in range(6):
        core.step(30)
        signs.add(bool(core.get_mover_velocity()[0][0] > 0.0))
        now = seen(core, "rider")
        assert now[2].pose != last[2].pose
        check(now, last)
        last = now
    assert signs == {False, True}
    # Who is put somewhere stands there, and what does not move has no flow.
    core.set_position(core.get_pose(agent="rider").position_m, agent="rider")
    core.capture(agent="rider")
    core.step(10)
    frame = core.capture(["flow", "instance"], agent="rider")
    walls = frame["instance"] <= len(WALLS)
    assert walls.mean() > 0.3
    assert not np.any(frame["flow"][walls])
    core.close()
