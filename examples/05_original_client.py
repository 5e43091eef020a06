"""The SAILenv client: scripts written for SAILenv run with this simulator without changes.

Needs the client (`pip install --no-deps sailenv==0.5b0`, Python up to 3.12). Uses the simulator
that listens on the port, which may be given on the command line, and starts one without ROS if none
does. All but that is done with the client alone.
"""

import atexit
import socket
import subprocess
import sys
import time

import numpy as np
from PIL import Image

try:
    from sailenv.agent import Agent
except ImportError as missing:
    raise SystemExit(
        f"This example needs the SAILenv client ({missing}): pip install --no-deps sailenv==0.5b0"
    ) from missing

host, port = "127.0.0.1", int((sys.argv[1:] or ["8085"])[0])


def listens() -> bool:
    """Return whether a simulator answers on the port."""
    with socket.socket() as probe:
        return probe.connect_ex((host, port)) == 0


if not listens():
    print(f"no simulator listens on port {port}, so one is started")
    command = [sys.executable, "-m", "sailenv_ros.cli.main", "run", "--no-ros", "--no-build"]
    simulator = subprocess.Popen([*command, "--port", str(port), "--viewer-port", "0"])
    atexit.register(simulator.wait)
    atexit.register(simulator.terminate)  # called first
    deadline = time.monotonic() + 120.0
    while not listens():
        if simulator.poll() is not None or time.monotonic() > deadline:
            raise SystemExit("the simulator did not start; see above")
        time.sleep(0.1)

agent = Agent(width=320, height=240, host=host, port=port, use_gzip=False)
agent.register()
print(f"agent {agent.id}; scenes: {', '.join(agent.scenes)}")
agent.change_scene(agent.scenes[1])

agent.toggle_follow()  # off: from now on the script says where the camera is
agent.set_position((0.0, 1.5, -4.0))  # Unity's axes: x right, y up, z forward
agent.set_rotation((10.0, 0.0, 0.0))  # degrees about them

cube = agent.spawn_object("Cube", position=(0.0, 0.6, -2.0), rotation=(0.0, 30.0, 0.0))
for step in range(10):
    agent.set_position((0.02 * step, 1.5, -4.0))
    frame = agent.get_frame()
speed = np.linalg.norm(frame["flow"], axis=-1)
print(f"flow: at most {speed.max():.0f} px/s, Δt = {frame['deltaTime']:.3f} s")
print("seen:", ", ".join(agent.categories[number] for number in np.unique(frame["category"])))

picture = (sys.argv[2:] or ["original_client.png"])[0]
Image.fromarray((frame["main"] * 255).astype(np.uint8)).save(picture)
print("written:", picture)
agent.despawn_object(cube)
agent.delete()
agent.socket.close()
