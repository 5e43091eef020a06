"""Hello, frame: one camera in the simulator, all its views, and a picture of them.

Connects to the running simulator, or starts one. Prints shape, type and range of every view, and
writes all views to one PNG file, whose name may be given on the command line.
"""

import sys

import numpy as np

from sailenv_ros import Agent

with Agent(width=640, height=480) as agent:
    agent.get_frame()  # flow is measured from one frame to the next
    frame = agent.get_frame()
    print(f"{agent.id} in scene {agent.scene!r}, t = {frame['stamp_ns'] * 1e-9:.3f} s")
    for name, view in frame.items():
        if isinstance(view, np.ndarray) and view.shape[:2] == (480, 640):
            seen = view[np.isfinite(view)]
            print(f"{name:<11} {view.shape!s:<14} {view.dtype!s:<8} {seen.min()} … {seen.max()}")
    print("objects:", ", ".join(agent.instances[i].name for i in np.unique(frame["instance"]) if i))
    print("written:", agent.save_contact_sheet((sys.argv[1:] or ["hello_frame.png"])[0], frame))
