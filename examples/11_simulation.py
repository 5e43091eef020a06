"""The simulator in this process: no ROS, no second program, the fastest way to get frames.

Builds a small scene, lets a ball fall, and prints how it moves as its own pixels show it. Writes
all views of the last frame, to a file whose name may be given on the command line.
"""

import sys
import time

import numpy as np

from sailenv_ros import AgentSpec, CameraIntrinsics, Pose, Simulation, look_at, show

FRAMES, STEPS = 6, 8  # 8 steps of 1/240 s between two frames

with Simulation("optical", mode="lockstep", seed=1) as simulation:
    lens = CameraIntrinsics(width=320, height=240, vertical_fov_deg=60.0)
    simulation.register_agent(AgentSpec(name="eye", intrinsics=lens, following=False))
    place = look_at((-5.0, 0.0, 2.0), (-2.0, 0.0, 1.2))
    simulation.set_pose(agent="eye", pose=place, teleport=True)
    ball = simulation.spawn_object("sphere", pose=Pose((-2.0, 0.0, 2.5)), scale=0.4, mass_kg=1.0)

    frame = simulation.capture(agent="eye")  # flow is measured from one frame to the next
    began = time.perf_counter()
    for _ in range(FRAMES):
        simulation.step(STEPS)
        frame = simulation.capture(agent="eye")
        seen = frame["instance"] == ball
        depth, speed = frame["depth"][seen].mean(), np.nanmedian(frame["flow"][seen][:, 1])
        print(
            f"t = {frame.stamp_ns * 1e-9:.3f} s: ball {seen.sum():4} px, {depth:.2f} m away, "
            f"{speed:4.0f} px/s downwards"
        )
    wall_s = time.perf_counter() - began
    print(f"{1e3 * wall_s / FRAMES:.0f} ms a frame with physics, {simulation.info.renderer}")
    print("written:", show(frame, (sys.argv[1:] or ["simulation.png"])[0]))
