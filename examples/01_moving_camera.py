"""A camera that moves in a circle around the scene and looks at its middle.

Writes a contact sheet of the last frame, whose name may be given on the command line. The flow of
a frame is the motion since the frame before, including the motion of the camera.
"""

import math
import sys

import numpy as np

from sailenv_ros import Agent, look_at

LOCKSTEP = {"scene": "optical", "mode": "lockstep"}
STEPS = 8  # 1/30 s of simulated time between two frames

with Agent(width=320, height=240, following=False, namespace="/example", simulator=LOCKSTEP) as eye:
    for count in range(10):
        angle = math.radians(3.0 * count)
        place = (5.0 * math.cos(angle), 5.0 * math.sin(angle), 2.0)
        # Without teleport, a set pose is motion; before the first frame there is none.
        eye.set_pose(look_at(place, (0.0, 0.0, 0.5)), teleport=count == 0)
        frame = eye.get_frame()
        speed = np.hypot(frame["flow"][..., 0], frame["flow"][..., 1])
        x, y, z = frame["world_from_camera"][:3, 3]
        print(
            f"t = {frame['stamp_ns'] * 1e-9:.3f} s at ({x:5.2f}, {y:5.2f}, {z:5.2f}) m: "
            f"flow {speed.mean():6.1f} px/s on average, {frame['flow_valid'].mean():4.0%} valid"
        )
        eye.step(STEPS)
    print("written:", eye.save_contact_sheet((sys.argv[1:] or ["moving_camera.png"])[0], frame))
