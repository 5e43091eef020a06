"""Draws a contact sheet of generated rooms: python scripts/picture_rooms.py FILE [--bake].

Each room is seen from the place on its camera's way, and in the direction, that shows the most
furniture without standing right before it.
"""

from __future__ import annotations

import argparse
import math
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sailenv_ros import Simulation
from sailenv_ros.agents import AgentSpec
from sailenv_ros.camera import CameraIntrinsics
from sailenv_ros.cli.scene_bake import ensure_baked
from sailenv_ros.geometry import Pose, look_at
from sailenv_ros.pictures.contact_sheet import save_picture

KINDS = ("living_room", "kitchen", "bedroom", "office", "bathroom", "apartment")
SEEDS = (1, 2, 3, 4)
TILE = CameraIntrinsics(width=400, height=300, vertical_fov_deg=62.0)
PROBE = CameraIntrinsics(width=80, height=60, vertical_fov_deg=62.0)
TURNS = 8
MOST_PLACES = 6
NEAR_M = 1.1
SHELL = {"wall", "floor", "ceiling", "skirting", "window", "door", "curtain"}


def main() -> None:
    """Draw the sheet."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("output", type=Path)
    parser.add_argument("--bake", action="store_true", help="bake the rooms' light first")
    parser.add_argument("--seeds", type=int, nargs="+", default=SEEDS)
    args = parser.parse_args()
    rows = []
    for seed in args.seeds:
        tiles = []
        for kind in KINDS:
            scene = f"generated:{kind}:{seed}"
            if args.bake:
                ensure_baked(scene, allow_modules=False)
            tiles.append(_picture(scene))
            print(scene, flush=True)
        rows.append(np.hstack(tiles))
    print(save_picture(args.output, np.vstack(rows)))


def _picture(scene: str) -> NDArray[np.uint8]:
    with Simulation(scene=scene, mode="lockstep") as simulation:
        for name, lens in (("probe", PROBE), ("eye", TILE)):
            simulation.register_agent(
                AgentSpec(name=name, intrinsics=lens, rate_hz=0.0, following=False, pose=Pose())
            )
        shell = {i.id for i in simulation.info.instances if i.category in SHELL} | {0}
        waypoints = [pose.position_m for pose in simulation.info.movers[0].waypoints]
        step = max(1, len(waypoints) // MOST_PLACES)
        best, chosen = -1.0, Pose()
        for x, y, z in waypoints[::step]:
            for turn in range(TURNS):
                yaw = 2.0 * math.pi * turn / TURNS
                pose = look_at((x, y, z), (x + math.cos(yaw), y + math.sin(yaw), z - 0.22))
                simulation.set_pose(pose, teleport=True, agent="probe")
                frame = simulation.capture(("instance", "depth"), agent="probe")
                score = _score(frame.views["instance"], frame.views["depth"], shell)
                if score > best:
                    best, chosen = score, pose
        simulation.set_pose(chosen, teleport=True, agent="eye")
        picture: NDArray[np.uint8] = simulation.capture(("rgb",), agent="eye").views["rgb"]
        return picture.copy()


def _score(ids: NDArray[np.uint16], depth: NDArray[np.float32], shell: set[int]) -> float:
    """Return how much furniture is seen, each piece counted up to a fifteenth of the picture."""
    found, counts = np.unique(ids, return_counts=True)
    shares = {
        int(number): count / ids.size
        for number, count in zip(found, counts, strict=True)
        if int(number) not in shell
    }
    seen = sum(math.sqrt(min(share, 1 / 15)) for share in shares.values())
    near = float((depth < NEAR_M).mean())
    return seen - 3.0 * max(0.0, near - 0.08) - max(0.0, max(shares.values(), default=0.0) - 0.2)


if __name__ == "__main__":
    main()
