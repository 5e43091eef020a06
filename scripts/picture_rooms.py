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
SEEDS = (2, 3, 5, 7)
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
        wholes = np.arange(65536)
        for instance in simulation.info.instances:
            wholes[instance.id] = 0 if instance.category in SHELL else instance.id
            if instance.parent:
                wholes[instance.id] = wholes[instance.parent]  # a book counts as its bookcase
        waypoints = [pose.position_m for pose in simulation.info.movers[0].waypoints]
        step = max(1, len(waypoints) // MOST_PLACES)
        best, chosen = -1.0, Pose()
        for x, y, z in waypoints[::step]:
            for turn in range(TURNS):
                yaw = 2.0 * math.pi * turn / TURNS
                pose = look_at((x, y, z), (x + math.cos(yaw), y + math.sin(yaw), z - 0.22))
                simulation.set_pose(pose, teleport=True, agent="probe")
                frame = simulation.capture(("instance", "depth"), agent="probe")
                score = _score(wholes[frame.views["instance"]], frame.views["depth"])
                if score > best:
                    best, chosen = score, pose
        simulation.set_pose(chosen, teleport=True, agent="eye")
        picture: NDArray[np.uint8] = simulation.capture(("rgb",), agent="eye").views["rgb"]
        return picture.copy()


def _score(ids: NDArray[np.intp], depth: NDArray[np.float32]) -> float:
    """Return how much furniture is seen, each piece up to a fifteenth of the view, and how far."""
    _, counts = np.unique(ids[ids > 0], return_counts=True)
    shares = counts / ids.size
    seen = float(np.sqrt(np.minimum(shares, 1 / 15)).sum())
    near = float((depth < NEAR_M).mean())
    largest = float(shares.max(initial=0.0))
    far = min(3.5, float(np.median(depth)))
    return seen + 0.35 * far - 3.0 * max(0.0, near - 0.05) - 2.0 * max(0.0, largest - 0.15)


if __name__ == "__main__":
    main()
