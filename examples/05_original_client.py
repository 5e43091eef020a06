"""The SAILenv client: scripts written for SAILenv run with this simulator without changes.

Needs the client (`pip install --no-deps sailenv==0.5b0`, Python up to 3.12) and a simulator that
runs, with or without ROS: `sailenv run room_01 --no-ros`. The program uses only the client.
"""

import sys

import numpy as np
from PIL import Image
from sailenv.agent import Agent

host, port = "127.0.0.1", int((sys.argv[1:] or ["8085"])[0])
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
