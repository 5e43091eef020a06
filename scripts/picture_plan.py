"""Draws floor plans: python scripts/picture_plan.py FILE [--bake] [SCENE ...].

A camera with parallel rays looks down from below the ceiling; as many pixels a metre as fit.
"""

from __future__ import annotations

import argparse
from itertools import product
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sailenv_ros import CameraIntrinsics, Frame, Pose, Simulation
from sailenv_ros.cli.scene_bake import ensure_baked
from sailenv_ros.frame.pictures.contact_sheet import save_picture

SCENES = ("room_01", "generated:apartment:7")
SIDE_PX = 480
MARGIN_M = 0.3
CUT_M = 2.2
"""Height of the camera's plane: below ceilings, above what stands on the floor."""


def main() -> None:
    """Draw the plans side by side."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("output", type=Path)
    parser.add_argument("scenes", nargs="*", default=SCENES)
    parser.add_argument("--bake", action="store_true", help="bake the rooms' light first")
    args = parser.parse_args()
    if args.bake:
        for scene in args.scenes:
            ensure_baked(scene, allow_modules=False)
    print(save_picture(args.output, np.hstack([plan(scene) for scene in args.scenes])))


def plan(scene: str) -> NDArray[np.uint8]:
    """Return (SIDE_PX, SIDE_PX, 3) uint8: the floor of a scene from above, x upwards."""
    with Simulation(scene, views=("rgb",), mode="lockstep") as simulation:
        low, high = _extent(simulation.capture("instance"))
        per_metre = SIDE_PX / float((high - low)[:2].max() + 2.0 * MARGIN_M)
        lens = CameraIntrinsics(
            width=SIDE_PX,
            height=SIDE_PX,
            distortion_model="orthographic",
            fx_px=per_metre,
            fy_px=per_metre,
        )
        x, y = (0.5 * (low + high))[:2].tolist()
        simulation.set_intrinsics(lens)
        simulation.set_follow(False)
        simulation.set_pose(Pose.from_rpy_deg((x, y, CUT_M), (0.0, 90.0, 0.0)))
        return np.asarray(simulation.capture("rgb")["rgb"])


def _extent(frame: Frame) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the least and the greatest place of all floors [m]."""
    assert frame.states is not None
    assert frame.info is not None
    places = []
    for one in frame.info.instances:
        if one.category == "floor":
            world_from_own = frame.states.matrices[frame.states.row(one.id)]
            for corner in product(*zip(one.low_m, one.high_m, strict=True)):
                places.append((world_from_own @ (*corner, 1.0))[:3])
    return np.min(places, axis=0), np.max(places, axis=0)


if __name__ == "__main__":
    main()
