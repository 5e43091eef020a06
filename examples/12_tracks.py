"""Points followed through occlusion, out of the picture and back: exact tracks of what moves.

Balls fall and roll through a room while the camera moves; points of the first picture are followed
through all frames. Prints how many are seen, and writes a picture of their trails, to a file whose
name may be given on the command line: bright where a point is seen, thin where it is hidden.
"""

import sys
import time

import cv2
import numpy as np

from sailenv_ros import AgentSpec, CameraIntrinsics, Pose, Simulation, look_at
from sailenv_ros.frame.motion import SceneGeometry, Tracks, motion, track

FRAMES, STEPS = 40, 6  # 6 steps of 1/240 s between two frames
WIDTH, HEIGHT = 640, 480


def draw_trails(picture: np.ndarray, tracks: Tracks) -> np.ndarray:
    """Draw where each point went; hue by where it began."""
    canvas = (0.6 * picture).astype(np.uint8)
    for pixels, visible in zip(tracks.pixels, tracks.visible, strict=True):
        if not np.isfinite(pixels).all():
            continue
        hue = int(179 * pixels[0, 0] / WIDTH)
        colour = cv2.cvtColor(np.array([[[hue, 200, 255]]], np.uint8), cv2.COLOR_HSV2RGB)[
            0, 0
        ].tolist()
        places = np.rint(16 * pixels).astype(int)  # in sixteenths of a pixel
        for k in range(1, len(places)):
            seen = bool(visible[k - 1] and visible[k])
            shade = colour if seen else [channel // 3 for channel in colour]
            cv2.line(canvas, places[k - 1], places[k], shade, 1, cv2.LINE_AA, 4)
        if visible[-1]:
            cv2.circle(canvas, places[-1], 16 * 2, colour, -1, cv2.LINE_AA, 4)
    return canvas


with Simulation("optical", mode="lockstep", seed=1) as simulation:
    lens = CameraIntrinsics(width=WIDTH, height=HEIGHT)
    simulation.register_agent(AgentSpec(name="eye", intrinsics=lens, following=False))
    for number in range(6):
        place = Pose((-2.6 + 0.5 * number, 1.4 - 0.55 * number, 1.2 + 0.2 * number))
        ball = simulation.spawn_object("sphere", pose=place, scale=0.5, mass_kg=1.0)
    frames = []
    for number in range(FRAMES):
        eye = (-5.5, -0.2 + 0.012 * number, 1.9)
        simulation.set_pose(agent="eye", pose=look_at(eye, (0.0, 0.0, 1.0)))
        simulation.step(STEPS)
        frames.append(simulation.capture(("rgb", "depth", "instance"), agent="eye"))
    geometry = SceneGeometry.of_contents(simulation.contents)

columns, rows = np.meshgrid(np.arange(8, WIDTH, 16), np.arange(8, HEIGHT, 16))
points = np.stack([np.zeros(columns.size), columns.ravel(), rows.ravel()], axis=1)
began = time.perf_counter()
tracks = track(points, frames, geometry)
wall_s = time.perf_counter() - began
known = int((tracks.instances > 0).sum())
print(f"{known} points through {FRAMES} frames in {wall_s:.2f} s")
for number in range(0, FRAMES, 13):
    seen, here = tracks.visible[:, number].sum(), tracks.in_view[:, number].sum()
    print(f"frame {number:2}: {seen} seen, {here - seen} hidden, {known - here} out of view")
lost = motion(frames[0], frames[-1])
print(
    f"of the first picture's pixels {lost.occluded.mean():.1%} are occluded in the last one and "
    f"{lost.out_of_view.mean():.1%} out of view"
)
path = (sys.argv[1:] or ["trails.png"])[0]
cv2.imwrite(path, draw_trails(frames[-1]["rgb"], tracks)[..., ::-1])
print("written:", path)
