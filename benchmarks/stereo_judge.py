"""Let OpenCV's semi-global matcher (SGBM) judge the stereo pictures of a rig against its disparity.

    python benchmarks/stereo_judge.py [--scene NAME] [--size WxH] [--baseline M] [--shift PX]
                                      [--psmnet FOLDER]

A rectified pair looks around in a room. Of the pixels that both cameras see, the share is printed
whose estimated disparity is wrong by more than 2 px (bad-2), without and with those that the
matcher leaves out, and the median error; of the pixels that the left camera alone sees, the share
that the matcher leaves out. `--shift` adds an error to the true disparity, which must be found.
With `--psmnet` a learned matcher judges the same pixels: see `stereo_psmnet.py` for its folder.
"""

from __future__ import annotations

import argparse
import math
from pathlib import Path
from typing import Any

import cv2 as typed_cv2
import numpy as np
from stereo_psmnet import Match, psmnet

from sailenv_ros import AgentSpec, CameraIntrinsics, Pose, RigCamera, look_at
from sailenv_ros.frame.stereo import disparity
from sailenv_ros.render.cpu.renderer import NativeRenderer
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.simulation.synchronous import SynchronousSimulation

cv2: Any = typed_cv2  # whose types lack much of what it has

PLACES = 8
RANGE_PX, BLOCK = 128, 5


def sgbm(left: Any, right: Any) -> Any:
    """Match by SGBM with the penalties that OpenCV's manual recommends; negative where it fails."""
    matcher = cv2.StereoSGBM_create(
        minDisparity=0,
        numDisparities=RANGE_PX,
        blockSize=BLOCK,
        P1=8 * 3 * BLOCK**2,
        P2=32 * 3 * BLOCK**2,
        disp12MaxDiff=1,
        uniquenessRatio=5,
        speckleWindowSize=100,
        speckleRange=2,
        mode=cv2.STEREO_SGBM_MODE_HH,
    )
    return matcher.compute(left, right) / 16.0


def main() -> None:
    """Look around and print the figures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scene", default="room_01")
    parser.add_argument("--size", default="640x480")
    parser.add_argument("--baseline", type=float, default=0.12, metavar="M")
    parser.add_argument("--shift", type=float, default=0.0, metavar="PX")
    parser.add_argument("--psmnet", type=Path, metavar="FOLDER")
    arguments = parser.parse_args()
    matchers: dict[str, Match] = {"SGBM": sgbm}
    if arguments.psmnet is not None:
        matchers["PSMNet"] = psmnet(arguments.psmnet)
    width, height = (int(number) for number in arguments.size.split("x"))
    lens = CameraIntrinsics(width=width, height=height)
    views, right = ("rgb", "depth", "instance"), Pose((0.0, -arguments.baseline, 0.0))
    cameras = {
        "left": RigCamera(intrinsics=lens, views=views),
        "right": RigCamera(intrinsics=lens, extrinsics=right, views=views),
    }
    core = SynchronousSimulation(SceneLibrary(drafts=False), arguments.scene, NativeRenderer())
    core.register_agent(AgentSpec(name="rig", following=False, cameras=cameras))
    errors: dict[str, list[Any]] = {name: [] for name in matchers}
    unseen: dict[str, list[Any]] = {name: [] for name in matchers}
    for number in range(PLACES):
        angle = math.tau * number / PLACES
        eye = (0.9 * math.cos(angle), 0.9 * math.sin(angle), 1.4)
        core.set_pose(look_at(eye, (-eye[0], -eye[1], 0.7)), agent="rig", teleport=True)
        frames = core.capture_rig(agent="rig")
        left, other = (frames[name]["rgb"] for name in cameras)
        true = disparity(*(frames[name] for name in cameras))
        wanted = true.disparity + arguments.shift
        # SGBM finds nothing within its range of the left border.
        searched = (np.arange(width) >= RANGE_PX) & (true.disparity < RANGE_PX - 1)
        seen = true.visible & searched & (true.disparity > 0.0)
        for name, match in matchers.items():
            found = match(left, other)
            errors[name].append(np.where(found >= 0.0, np.abs(found - wanted), np.inf)[seen])
            unseen[name].append((found < 0.0)[true.occluded & searched])
    core.close()
    for name in matchers:
        error, left_out = np.concatenate(errors[name]), np.concatenate(unseen[name])
        estimated = error[np.isfinite(error)]
        print(
            f"{name}: {arguments.scene}, {width} x {height}, {PLACES} pairs, "
            f"{len(error)} pixels seen by both"
        )
        print(f"estimated: {len(estimated) / len(error):.1%}")
        print(f"bad-2: {(estimated > 2.0).mean():.2%} of those, {(error > 2.0).mean():.2%} of all")
        print(f"median error: {np.median(estimated):.3f} px")
        print(f"seen by the left camera alone: {left_out.mean():.1%} left out by the matcher")


if __name__ == "__main__":
    main()
