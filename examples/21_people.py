"""People in a room: one lies down, one sits, one carries a mug, one moves as a recorded person did.

Prints what each does and how many of its keypoints are seen, and writes the picture with them, to a
file whose name may be given on the command line: filled where a point is seen, hollow where hidden.

    sailenv assets people    # makes the people, once
"""

import sys
import tempfile
from pathlib import Path

import cv2
import numpy as np

from sailenv_ros import AgentSpec, CameraIntrinsics, Simulation, look_at
from sailenv_ros.types.skeleton import COCO_SKELETON

SCENE = """
version: 1
room: {size: [6.4, 5, 2.6]}
objects:
  - {name: bed, asset: bed_01, position: [-1.9, -1.3, 0], static: true}
  - {name: sofa, asset: couch_02, position: [-0.6, 2.0, 0], rotation: [0, 0, -90], static: true}
  - {name: table, asset: coffee_table_01, position: [0.6, 0.4, 0], static: true}
  - {name: shelf, asset: cabinet_01, position: [2.0, 2.1, 0], rotation: [0, 0, -90], static: true}
  - {name: mug, asset: cup_02, position: [0.6, 0.4, 0.46], colour: "#b03020"}
  - {name: anna, asset: person_01, position: [-0.1, -0.6, 0],
     behaviours: [{type: lie, beds: [bed]}]}
  - {name: ben, asset: person_20, position: [-0.8, 0.9, 0],
     behaviours: [{type: sit, seats: [sofa]}]}
  - {name: cleo, asset: person_05, position: [0.9, -0.6, 0],
     behaviours: [{type: fetch, objects: [mug], to: [shelf], times: 100}]}
  - {name: dan, asset: person_02, position: [0.2, -1.1, 0], rotation: [0, 0, -30], behaviours:
     [{type: play_clip, clip: "pybullet_data:data/motions/humanoid3d_punch.txt", facing: -30}]}
lights:
  - {name: sun, type: directional, direction: [-0.6, 0.5, -1], intensity: 1.5}
  - {name: lamp, type: point, position: [0.6, 0, 2.4], intensity: 12}
"""
SECONDS = 22
COLOURS = ((255, 170, 40), (60, 220, 120), (70, 150, 255), (240, 90, 200))

with tempfile.TemporaryDirectory() as folder:
    scene = Path(folder) / "people.yaml"
    scene.write_text(SCENE)
    lens = CameraIntrinsics(width=960, height=720, vertical_fov_deg=62.0)
    eye = AgentSpec(name="eye", intrinsics=lens, following=False)
    with Simulation(scene, mode="lockstep", agent=eye) as simulation:
        simulation.set_pose(look_at((3.0, -2.1, 2.1), (-0.7, 0.3, 0.6)), teleport=True)
        simulation.step(SECONDS * 240)
        frame = simulation.capture(["rgb", "depth", "category", "instance"])
        names = dict(zip(frame.objects.ids.tolist(), frame.objects.names, strict=True))

assert frame.states is not None
picture = np.ascontiguousarray(frame["rgb"][..., ::-1])
for id_, colour in zip(frame.states.skeletons, COLOURS, strict=True):
    points = frame.keypoints(id_)
    seen = points.hidden_by == 0
    print(f"{names[id_]}: {int(seen.sum())} of {len(seen)} keypoints are seen")
    inside = points.hidden_by >= 0
    for first, second in COCO_SKELETON:
        if inside[first - 1] and inside[second - 1]:
            ends = np.rint(points.pixels[[first - 1, second - 1]]).astype(int)
            cv2.line(picture, ends[0], ends[1], colour[::-1], 1, cv2.LINE_AA)
    for place, is_seen in zip(points.pixels[inside], seen[inside], strict=True):
        fill = cv2.FILLED if is_seen else 1
        cv2.circle(picture, np.rint(place).astype(int), 4, colour[::-1], fill, cv2.LINE_AA)
path = (sys.argv[1:] or ["people.png"])[0]
cv2.imwrite(path, picture)
print("written:", path)
