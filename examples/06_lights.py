"""Lights by name: colour, strength, direction, type; ambient light and background.

Prints how bright the picture is after each change, and writes the pictures side by side, to a file
whose name may be given on the command line.
"""

import sys

import cv2
import numpy as np

from sailenv_ros import Agent

LOCKSTEP = {"scene": "optical", "mode": "lockstep"}

with Agent(width=320, height=240, namespace="/example", simulator=LOCKSTEP) as agent:
    pictures = []

    def look(what: str) -> None:
        """Take a picture and say how bright it is."""
        picture = agent.get_frame()["main"]
        blue, green, red = picture.reshape(-1, 3).mean(axis=0)
        print(f"{what:<32} red {red:5.1f}  green {green:5.1f}  blue {blue:5.1f}")
        pictures.append(picture)

    sun = agent.lights_names[0]
    print("lights:", ", ".join(f"{n} ({agent.get_light_type(n)})" for n in agent.lights_names))
    look("as the scene is")
    agent.set_light_color(sun, 255, 96, 32)  # red, green, blue, 0 to 255
    look("an evening sun")
    agent.set_light_intensity(sun, 0.2 * agent.get_light_intensity(sun))
    look("a fifth of it")
    agent.set_ambient_light_color(64, 64, 160)
    look("with blue light from everywhere")
    # Everything at once, by the names of sailenv_ros.types.lights.Light: linear colours, metres.
    agent.set_light(sun, type="point", position_m=(0, 0, 4), colour=(1, 1, 1), intensity=40.0)
    look("as a lamp above the middle")
    agent.change_main_camera_clear_flags(0, 0, 0)  # a colour instead of the sky
    look("before a black background")

    path = (sys.argv[1:] or ["lights.png"])[0]
    cv2.imwrite(path, np.hstack(pictures))
    print("written:", path)
