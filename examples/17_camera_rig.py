"""A rig: colour, depth and a pair of fisheyes on one body, captured at one instant.

The body moves through a scene. Each frame prints its stamp, how many of the colour camera's pixels
the depth camera sees too, and how many of the left fisheye's the right one does, both exactly.
Writes the last instant to a picture, whose name may be given on the command line.
"""

import sys

import cv2
import numpy as np

from sailenv_ros import AgentSpec, CameraIntrinsics, Pose, RigCamera, Simulation, look_at
from sailenv_ros.frame.motion import motion
from sailenv_ros.frame.pictures.colours import view_picture

COLOUR = CameraIntrinsics(width=480, height=360)
DEPTH = CameraIntrinsics(width=424, height=240, fx_px=215.0, fy_px=215.0)  # as of a D435
FISHEYE = CameraIntrinsics(
    width=360,
    height=360,
    fx_px=110.0,
    fy_px=110.0,
    distortion_model="equidistant",
    distortion=(-0.007, 0.04, -0.04, 0.007),
    max_angle_deg=85.0,
)
TRUTH = ("rgb", "depth", "instance")

# Poses in the frame of the body: x forward, y left, z up.
rig = {
    "colour": RigCamera(intrinsics=COLOUR, extrinsics=Pose((0.0, 0.0, 0.0)), views=TRUTH),
    "depth": RigCamera(
        intrinsics=DEPTH, extrinsics=Pose((0.0, 0.015, 0.0)), views=("depth", "instance")
    ),
    "fisheye_left": RigCamera(
        intrinsics=FISHEYE, extrinsics=Pose((-0.02, 0.032, 0.05)), views=TRUTH
    ),
    "fisheye_right": RigCamera(
        intrinsics=FISHEYE, extrinsics=Pose((-0.02, -0.032, 0.05)), views=TRUTH
    ),
}

head = AgentSpec(name="head", following=False, rate_hz=0.0, cameras=rig)
with Simulation("optical", mode="lockstep", agent=head) as simulation:
    for number in range(5):
        simulation.set_pose(look_at((-4.0 + 0.1 * number, -0.4, 1.5), (0.0, 0.3, 0.8)))
        simulation.step(8)
        frames = simulation.capture_rig()
        stamps = {frame.stamp_ns for frame in frames.values()}
        registered = motion(frames["colour"], frames["depth"]).visible
        matched = motion(frames["fisheye_left"], frames["fisheye_right"])
        print(
            f"t = {max(stamps) * 1e-9:.3f} s, {len(stamps)} instant: the depth camera sees "
            f"{registered.mean():.1%} of the colour picture, the right fisheye "
            f"{matched.visible.sum() / matched.valid.sum():.1%} of the left one"
        )

panes = []
for frame in frames.values():
    assert frame.info is not None, "frames of a simulation tell their scene"
    view = "rgb" if "rgb" in frame else "depth"
    lens = frame.camera.intrinsics
    picture = view_picture(
        view, frame[view], table=frame.info.categories, near_m=lens.near_m, depth_range_m=6.0
    )
    panes.append(cv2.resize(picture, (lens.width * 360 // lens.height, 360)))
path = sys.argv[1] if len(sys.argv) > 1 else "rig.png"
cv2.imwrite(path, cv2.cvtColor(np.hstack(panes), cv2.COLOR_RGB2BGR))
print(f"wrote {path}")
