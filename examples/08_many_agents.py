"""Several cameras in one simulator, each with its own size, pose and views.

Frames with the same stamp show the same instant of simulated time.
"""

import math
from contextlib import ExitStack

import numpy as np

from sailenv_ros import Agent, look_at

LOCKSTEP = {"scene": "optical", "mode": "lockstep"}
SIZES = [(320, 240), (160, 120), (200, 200), (64, 48)]

with ExitStack() as stack:
    agents = [
        stack.enter_context(
            Agent(width=w, height=h, following=False, namespace="/example", simulator=LOCKSTEP)
        )
        for w, h in SIZES
    ]
    for number, agent in enumerate(agents):
        angle = 2.0 * math.pi * number / len(agents)
        place = (5.0 * math.cos(angle), 5.0 * math.sin(angle), 2.0)
        agent.set_pose(look_at(place, (0.0, 0.0, 0.5)), teleport=True)
    for _ in range(3):
        frames = [agent.get_frame() for agent in agents]
        assert len({frame["stamp_ns"] for frame in frames}) == 1
        everything = set().union(*(np.unique(frame["instance"]).tolist() for frame in frames))
        print(f"t = {frames[0]['stamp_ns'] * 1e-9:.3f} s")
        for agent, frame in zip(agents, frames, strict=True):
            height, width = frame["instance"].shape
            count = len(np.unique(frame["instance"]))
            print(f"  {agent.id}: {width} x {height}, {count} of {len(everything)} ids are seen")
        agents[0].step(8)
