"""Flow is exact before cameras that keep looking at what moves, compared with rays."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from sailenv_ros.render.cpu.renderer import NativeRenderer
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.geometry import Pose
from tests.render.test_flow_of_behaviours import scene_of
from tests.render.test_scene_in_motion import check, seen
from tests.support.lockstep_core import lockstep_core


def test_flow_is_exact_before_a_camera_that_keeps_looking(tmp_path: Path) -> None:
    """To 1e-3 px per frame: one that stands, one on rails, also when the object is gone."""
    scene: dict[str, Any] = scene_of("linear_waypoints")
    scene["movers"][0]["keep_looking_at"] = {"object": "first", "point": [0.1, 0.0, 0.1]}
    path = tmp_path / "box.yaml"
    path.write_text(json.dumps(scene), encoding="utf-8")  # JSON is YAML, too
    core = lockstep_core(path, renderer=NativeRenderer(), seed=2)
    lens = CameraIntrinsics(width=96, height=72, vertical_fov_deg=70.0)
    core.register_agent(AgentSpec(name="on_rails", intrinsics=lens, mover="rails"))
    here = Pose((-1.6, 0.3, 1.7))
    core.register_agent(AgentSpec(name="stands", intrinsics=lens, following=False, pose=here))
    core.set_look_at("first", agent="stands")
    agents = ("on_rails", "stands")
    last = {agent: seen(core, agent) for agent in agents}
    for _ in range(4):
        core.step(10)
        for agent in agents:
            now = seen(core, agent)
            assert now[2].pose.orientation_xyzw != last[agent][2].pose.orientation_xyzw
            check(now, last[agent])
            last[agent] = now
    core.despawn_object("first")
    core.step(10)
    then = seen(core, "on_rails")  # the arithmetic wants the same objects in both frames
    core.step(10)
    now = seen(core, "on_rails")
    assert now[2].pose.orientation_xyzw != then[2].pose.orientation_xyzw
    check(now, then)
    core.close()
