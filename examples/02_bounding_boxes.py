"""Bounding boxes of all visible objects, with names and categories, as used to train a detector.

Prints the box of each object and the number of its visible pixels. Writes the picture with the
boxes, to a file whose name may be given on the command line.
"""

import sys

import cv2

from sailenv_ros import Agent

LOCKSTEP = {"scene": "optical", "mode": "lockstep"}

with Agent(width=640, height=480, namespace="/example", simulator=LOCKSTEP) as agent:
    frame = agent.get_frame()
    picture = frame["main"].copy()
    for id_, (left, top, right, bottom), pixels in agent.boxes(frame):
        instance = agent.instances[id_]
        print(
            f"{id_:3} {instance.name:<20} {instance.category:<14} "
            f"({left}, {top}) to ({right}, {bottom}), {pixels} pixels"
        )
        colour = tuple(int(c) for c in frame["object"][frame["instance"] == id_][0])
        cv2.rectangle(picture, (left, top), (right, bottom), colour, 2)
        place = (left + 3, top + 14)
        cv2.putText(picture, instance.name, place, cv2.FONT_HERSHEY_SIMPLEX, 0.45, colour, 1)
    path = (sys.argv[1:] or ["boxes.png"])[0]
    cv2.imwrite(path, picture)
    print("written:", path)
