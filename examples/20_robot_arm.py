"""A robot arm takes a mug from a table and puts it on a shelf, by contact and friction alone.

    .venv/bin/python examples/20_robot_arm.py [TRIALS] [PICTURE]

The Panda is read from the Python package pybullet_data. A camera in its hand looks on. Each trial
puts the mug elsewhere; the last one leaves a picture, from aside and from the hand.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import numpy as np
from PIL import Image

from sailenv_ros import Simulation
from sailenv_ros.types.geometry import Pose

SCENE = """
version: 1
objects:
  - {name: floor, asset: cube, category: floor, static: true, position: [0, 0, -0.5],
     scale: [8, 8, 1], colour: "#8a7f74", roughness: 0.9}
  - {name: wall, asset: cube, category: wall, static: true, position: [1.6, 0, 1],
     scale: [0.1, 8, 3], colour: "#b9c4bd", roughness: 0.9}
  - {name: stand, asset: cube, static: true, position: [0, 0, 0.2], scale: [0.3, 0.3, 0.4],
     colour: "#50555c"}
  - {name: table, asset: coffee_table_01, static: true, position: [0.62, -0.35, 0]}
  - {name: shelf, asset: cube, category: shelf, static: true, position: [0.5, 0.45, 0.72],
     scale: [0.3, 0.6, 0.03], colour: "#7a5a3a"}
  - {name: mug, asset: cup_02, position: [0.5, -0.2, 0.45], scale: 0.8, friction: 1,
     colour: "#b03020"}
robots:
  - {name: panda, file: "pybullet_data:franka_panda/panda.urdf", parent: stand,
     position: [0, 0, 0.2], joints: [{name: panda_joint1, position: 0},
     {name: panda_joint2, position: -0.8}, {name: panda_joint4, position: -2.4},
     {name: panda_joint6, position: 1.6}, {name: panda_joint7, position: 0.8},
     {name: panda_finger_joint1, position: 0.04}]}
lights:
  - {name: sun, type: directional, direction: [0.7, 0.4, -1], intensity: 2}
agents:
  - {name: aside, position: [-0.9, -1.2, 1.5], rotation: [0, 25, 42], following: false}
  - {name: hand, carrier: panda panda_hand, position: [0.06, 0, 0.02], rotation: [0, -90, 0],
     vertical_fov: 80}
"""
OPEN, CLOSED = 0.04, 0.0
DOWN = Pose.from_rpy_deg((0, 0, 0), (180, 0, 0)).orientation_xyzw
"""The hand's z axis downwards, and its fingers to the left and to the right."""


class Arm:
    """Moves the hand along straight lines."""

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation

    def go(self, place: tuple[float, float, float], seconds: float = 1.0) -> None:
        """Bring what the fingers hold to a place, the hand above it."""
        simulation = self._simulation
        begin = np.array(simulation.link_pose("panda_grasptarget").position_m)
        end = np.array(place)
        steps = max(2, round(seconds * 30))
        for share in np.linspace(0.0, 1.0, steps + 1)[1:]:
            smooth = share * share * (3.0 - 2.0 * share)
            x, y, z = begin + smooth * (end - begin)
            found = simulation.reach_pose("panda_grasptarget", Pose((x, y, z), DOWN))
            simulation.drive_joints({k: v for k, v in found.items() if "finger" not in k})
            simulation.step(8)

    def fingers(self, opening: float) -> None:
        """Open or close them."""
        self._simulation.drive_joints({"panda_finger_joint1": opening})
        self._simulation.step(120)


def carried(simulation: Simulation, seed: int) -> bool:
    """Take the mug from the table to the shelf; tell if it stands there."""
    random = np.random.default_rng(seed)
    simulation.reset()
    x, y = 0.48 + random.uniform(-0.04, 0.04), -0.2 + random.uniform(-0.06, 0.06)
    turn = random.uniform(-15, 15)
    simulation.move_object("mug", (x, y, 0.452), (0, 0, turn), teleport=True)
    simulation.step(60)
    arm = Arm(simulation)
    z = 0.45 + 0.065
    down = simulation.cast_rays((0.5, 0.35, 1.5), (0, 0, -1))
    board = float(down.points_m[0, 2])
    arm.go((x, y, z + 0.15))
    arm.go((x, y, z), 0.7)
    arm.fingers(CLOSED)
    arm.go((x, y, board + 0.15), 0.8)
    arm.go((0.48, 0.35, board + 0.15), 1.2)
    arm.go((0.48, 0.35, board + 0.067), 0.7)
    arm.fingers(OPEN)
    arm.go((0.48, 0.35, board + 0.2), 0.6)
    simulation.step(120)
    mug = simulation.get_object("mug")
    upright = abs(mug.pose.rpy_deg[0]) < 5 and abs(mug.pose.rpy_deg[1]) < 5
    print(
        f"trial {seed}: the mug is at {np.round(mug.pose.position_m, 3)} on a board at {board:.3f}"
    )
    return upright and abs(mug.pose.position_m[2] - board) < 0.01 and mug.pose.position_m[1] > 0.2


def main(trials: int, picture: str) -> int:
    """Carry the mug so many times; 0 if each was a success."""
    with tempfile.TemporaryDirectory() as folder:
        scene = Path(folder) / "arm.yaml"
        scene.write_text(SCENE, encoding="utf-8")
        with Simulation(scene, mode="lockstep", agent=None) as simulation:
            done = sum(carried(simulation, seed) for seed in range(trials))
            print(f"{done} of {trials} mugs stand on the shelf")
            views = [simulation.capture(["rgb"], agent=name)["rgb"] for name in ("aside", "hand")]
            Image.fromarray(np.concatenate(views, axis=1)).save(picture)
            print("written:", picture)
    return 0 if done == trials else 1


if __name__ == "__main__":
    told = [*sys.argv[1:], *("1", "arm.png")[len(sys.argv) - 1 :]]
    sys.exit(main(int(told[0]), told[1]))
