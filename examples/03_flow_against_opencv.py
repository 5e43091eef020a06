"""The simulator's exact flow compared with OpenCV's estimate from two pictures.

Prints the mean end-point error of Farneback's method, and writes both flows as one picture, whose
name may be given on the command line.
"""

import sys

import cv2
import numpy as np

from sailenv_ros import Agent

LOCKSTEP = {"scene": "optical", "mode": "lockstep"}

with Agent(width=320, height=240, namespace="/example", simulator=LOCKSTEP) as agent:
    before = agent.get_frame()
    agent.step(8)
    frame = agent.get_frame()

    # The exact flow is the velocity of each pixel's surface point [px/s]. Times -dt, it is the
    # displacement from this picture back to the one before, as OpenCV estimates it.
    exact = -frame["flow"] * frame["dt"]
    grey, grey_before = (cv2.cvtColor(f["main"], cv2.COLOR_BGR2GRAY) for f in (frame, before))
    estimated = cv2.calcOpticalFlowFarneback(grey, grey_before, None, 0.5, 4, 21, 5, 7, 1.5, 0)

    valid = frame["flow_valid"]
    error = np.linalg.norm(estimated - exact, axis=-1)[valid]
    length = np.linalg.norm(exact, axis=-1)[valid]
    print(f"exact flow: {length.mean():.3f} px between the frames, at most {length.max():.2f} px")
    print(f"end-point error of the estimate: {error.mean():.3f} px")

    full = float(length.max()) or 1.0
    maps = [agent.draw_flow_map(flow, full_px_s=full) for flow in (-exact, -estimated)]
    path = (sys.argv[1:] or ["flow.png"])[0]
    cv2.imwrite(path, np.hstack(maps))
    print("written:", path, "(exact, estimated)")
