"""An object of one's own from a ring of viewpoints on white, for studies of adversarial objects.

Takes the zip of an OBJ with its textures (without one: a vase that is made here), uploads it and
looks at it from all around at two heights, 224 x 224 pixels, timed. Writes all views onto a sheet,
and with a second name pictures, masks, and for each pixel the place on the object [m].

    python examples/15_adversarial_views.py [SHEET.png [VIEWS.npz [MODEL.zip]]]
"""

import io
import math
import sys
import tempfile
import time
import zipfile
from pathlib import Path

import cv2
import numpy as np
from PIL import Image

from sailenv_ros import AgentSpec, CameraIntrinsics, Simulation, look_at
from sailenv_ros.frame.pictures.contact_sheet import save_contact_sheet

AZIMUTHS, ELEVATIONS_DEG = 12, (10.0, 40.0)
HEIGHT_M = 0.4
DEFAULTS = ("adversarial_views.png", "", "")

SCENE = """\
version: 1
gravity: [0, 0, 0]
environment:
  background: colour
  background_colour: [16, 16, 16]  # far beyond white, so that it is 255 in each picture
  ambient: [0.35, 0.35, 0.35]
  sky_share: 0.5
lights:
  - {name: key, type: directional, direction: [-0.5, 0.6, -0.9], intensity: 1.6}
"""


def vase() -> bytes:
    """Return the zip of a vase: a profile that is turned, with stripes as its texture."""
    radii = np.array([0.0, 0.6, 0.62, 0.9, 1.0, 0.85, 0.5, 0.35, 0.4, 0.55, 0.5, 0.3, 0.0])
    heights = np.array([0.0, 0.0, 0.1, 0.5, 0.9, 1.4, 1.8, 2.0, 2.2, 2.4, 2.4, 2.1, 2.1])
    turns = np.linspace(0.0, 2.0 * math.pi, 49)
    lines, rows, columns = ["mtllib vase.mtl", "usemtl glaze"], len(radii), len(turns)
    for row, (radius, height) in enumerate(zip(radii, heights, strict=True)):
        for column, turn in enumerate(turns):
            lines.append(f"v {radius * math.cos(turn)} {height} {-radius * math.sin(turn)}")
            lines.append(f"vt {column / (columns - 1)} {row / (rows - 1)}")
    for row in range(rows - 1):
        for column in range(columns - 1):
            first = row * columns + column + 1
            corners = (first, first + 1, first + columns + 1, first + columns)
            lines.append("f " + " ".join(f"{corner}/{corner}" for corner in corners))
    across = np.arange(256) / 256.0
    wave = 0.5 + 0.5 * np.sin(2.0 * math.pi * (6.0 * across[None] + 2.0 * across[:, None]))
    blue, cream = np.array([30.0, 70.0, 150.0]), np.array([235.0, 220.0, 190.0])
    texture = cream + (wave > 0.6)[..., None] * (blue - cream)
    picture, data = io.BytesIO(), io.BytesIO()
    Image.fromarray(texture.astype(np.uint8)).save(picture, "PNG")
    with zipfile.ZipFile(data, "w") as file:
        file.writestr("vase.obj", "\n".join(lines))
        file.writestr("vase.mtl", "newmtl glaze\nmap_Kd stripes.png\nNs 60\n")
        file.writestr("stripes.png", picture.getvalue())
    return data.getvalue()


if __name__ == "__main__":
    sheet, arrays, model = [*sys.argv[1:], *DEFAULTS[len(sys.argv) - 1 :]]
    content = Path(model).read_bytes() if model else vase()
    views = ("rgb", "instance", "object_coords")
    with tempfile.TemporaryDirectory() as folder:
        scene = Path(folder) / "white.yaml"
        scene.write_text(SCENE)
        with Simulation(scene, mode="lockstep") as simulation:
            began = time.perf_counter()
            name = simulation.upload_model(content, "model.zip", height_m=HEIGHT_M)
            print(f"uploaded in {time.perf_counter() - began:.2f} s: {name}")
            object_id = simulation.spawn_object(name)
            shown = next(one for one in simulation.info.instances if one.id == object_id)
            low, high = np.array(shown.low_m), np.array(shown.high_m)
            pose = np.array(simulation.get_object(object_id).pose.position_m)
            middle, radius = pose + 0.5 * (low + high), 0.5 * float(np.linalg.norm(high - low))
            lens = CameraIntrinsics(width=224, height=224, vertical_fov_deg=40.0)
            # So far away that all of it is in every picture.
            away = 1.05 * radius / math.sin(math.radians(20.0))
            simulation.register_agent(AgentSpec(name="eye", intrinsics=lens, following=False))
            frames, labels = [], []
            began = time.perf_counter()
            for elevation in ELEVATIONS_DEG:
                for azimuth in np.arange(AZIMUTHS) * 360.0 / AZIMUTHS:
                    up, around = math.radians(elevation), math.radians(azimuth)
                    way = (
                        math.cos(up) * math.cos(around),
                        math.cos(up) * math.sin(around),
                        math.sin(up),
                    )
                    eye = middle + away * np.array(way)
                    simulation.set_pose(agent="eye", pose=look_at(eye, middle), teleport=True)
                    frames.append(simulation.capture(views, agent="eye"))
                    labels.append(f"{azimuth:.0f} deg, {elevation:.0f} deg up")
            each_s = (time.perf_counter() - began) / len(frames)
            print(f"{len(frames)} views, {1e3 * each_s:.1f} ms each, {simulation.info.renderer}")
    masks = np.stack([frame["instance"] == object_id for frame in frames])
    pictures = np.stack([frame["rgb"] for frame in frames])
    border = np.concatenate([masks[:, 0], masks[:, -1], masks[:, :, 0], masks[:, :, -1]])
    print(f"covers {100 * masks.mean():.1f} % of the pictures, {border.sum()} pixels at borders")
    # Edges are smooth: what is next to the object is a mixture.
    near = np.stack([cv2.dilate(mask.view(np.uint8), np.ones((7, 7))) > 0 for mask in masks])
    print(f"around it all is {pictures[~near].min()} to {pictures[~near].max()}")
    save_contact_sheet(sheet, dict(zip(labels, pictures, strict=True)), columns=AZIMUTHS // 2)
    print("written:", sheet)
    if arrays:
        places = np.stack([frame["object_coords"] for frame in frames])
        np.savez_compressed(arrays, rgb=pictures, mask=masks, object_coords=places)
        print("written:", arrays)
