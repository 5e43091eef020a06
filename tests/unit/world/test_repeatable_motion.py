"""Two processes that run the same scene with every behaviour have the same bytes."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

SCENE = """
version: 1
room: {size: [6, 6, 3], skirting: false}
objects:
  - {name: spinner, asset: cube, position: [-2, -2, 1], scale: 0.3, gravity: false,
     behaviours: [{type: rotate_rigidbody, angular_velocity: [10, 20, 30]}]}
  - {name: pushed, asset: cube, position: [0, 0, 0.16], scale: 0.3,
     behaviours: [{type: poltergeist, mean_interval: 0.5}]}
  - {name: also pushed, asset: cylinder, position: [0.5, 0.2, 0.21], scale: 0.4,
     behaviours: [{type: poltergeist, mean_interval: 0.3}, {type: poltergeist, mean_interval: 1}]}
  - {name: bouncer, asset: sphere, position: [1, 1, 1], scale: 0.3, gravity: false,
     behaviours: [{type: uniform_movement_random_bounce, speed: 3, angular_speed: 90}]}
  - {name: plane, asset: cube, position: [0, -1, 2], scale: [0.3, 0.2, 0.1], gravity: false,
     behaviours: [{type: wander_plane, waypoints: [[2, 2, 2], [-2, 2, 1.5], [0, -2, 2.2]]}]}
  - {name: straight, asset: cube, position: [2, -2, 1], scale: 0.2, gravity: false,
     behaviours: [{type: linear_waypoints, total_time: 5,
                   waypoints: [{position: [2, -2, 1]}, {position: [2, 2, 1]}]}]}
  - {name: curved, asset: cube, position: [-2, 2, 1], scale: 0.2, gravity: false,
     behaviours: [{type: catmull_waypoints, total_time: 6, waypoints: [{position: [-2, 2, 1]},
                   {position: [-1, 2, 2]}, {position: [-2, 1, 1]}]}]}
"""

PROGRAM = """
import hashlib, sys
from pathlib import Path
from sailenv_ros.simulation.scenes import SceneLibrary
world = SceneLibrary().build(Path(sys.argv[1]), seed=11, epoch=1)
digest = hashlib.sha256()
for _ in range(2000):
    world.step(1)
    digest.update(world.snapshot().world_from_body.tobytes())
print(digest.hexdigest())
"""


@pytest.mark.slow
def test_two_processes_agree_over_2000_steps(tmp_path: Path) -> None:
    """Every pose of every step is the same to the last bit, whatever the hash seed."""
    scene = tmp_path / "all.yaml"
    scene.write_text(SCENE)
    digests = {
        subprocess.run(
            [sys.executable, "-c", PROGRAM, str(scene)],
            env={**os.environ, "PYTHONHASHSEED": hash_seed},
            capture_output=True,
            text=True,
            check=True,
            timeout=100,
        ).stdout
        for hash_seed in ("1", "2")
    }
    assert len(digests) == 1
    assert len(digests.pop().strip()) == 64
