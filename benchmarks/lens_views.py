"""Pictures of a board through lenses of every model, for calibrators: `lens_judges.py` reads them.

    python benchmarks/lens_views.py FOLDER [--models NAME ...] [--seed N]

Thirty pictures a model of a ChArUco board in a room. Views are drawn by a rule: the board's middle
lies at a random angle from the axis up to nearly the end of the lens, turned and tilted at random.
Each model's folder gets the pictures and `truth.json`: the lens, and the board's pose in each view.
"""

from __future__ import annotations

import argparse
import io
import json
import math
import zipfile
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from sailenv_ros import AgentSpec, CameraIntrinsics, Pose, Simulation
from sailenv_ros.types.geometry import BODY_FROM_OPTICAL
from sailenv_ros.types.picture_settings import PictureSettings

VIEWS = 30
COLUMNS, ROWS, SQUARE_M, MARKER_M = 12, 9, 0.1, 0.075
TEXELS = 2048

LENSES: dict[str, dict[str, object]] = {
    "pinhole": {"fx_px": 760.0, "fy_px": 742.0},
    "plumb_bob": {
        "fx_px": 690.0,
        "fy_px": 684.0,
        "distortion": (-0.2834, 0.0739, 0.00019, 0.000176, -0.008),
    },
    "rational_polynomial": {
        "fx_px": 640.0,
        "fy_px": 643.0,
        "distortion": (0.5285, -2.6231, 0.00057, -0.00019, 1.5135, 0.4061, -2.4526, 1.4466),
    },
    "equidistant": {
        "fx_px": 285.0,
        "fy_px": 286.5,
        "distortion": (-0.0132, 0.0421, -0.0395, 0.0069),
        "max_angle_deg": 95.0,
    },
    "mei": {
        "fx_px": 660.0,
        "fy_px": 657.0,
        "distortion": (1.25, -0.21, 0.15, 0.0004, -0.0002),
        "max_angle_deg": 95.0,
    },
    "double_sphere": {
        "fx_px": 240.0,
        "fy_px": 239.0,
        "distortion": (-0.18, 0.59),
        "max_angle_deg": 95.0,
    },
}
SIZE = {"width": 960, "height": 720, "cx_offset_px": 7.3, "cy_offset_px": -4.6}

SCENE = """\
version: 1
environment: {ambient: [0.35, 0.35, 0.35], exposure: 0}
room: {size: [6, 6, 3], walls: {material: plaster}, floor: oak_planks}
"""


def charuco_board() -> cv2.aruco.CharucoBoard:
    """Return the board: 12 × 9 squares of 100 mm."""
    dictionary = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_5X5_250)
    return cv2.aruco.CharucoBoard((COLUMNS, ROWS), SQUARE_M, MARKER_M, dictionary)


def board_model() -> bytes:
    """Return the zip of an OBJ: a plate with the board on its front."""
    drawn = charuco_board().generateImage((4 * COLUMNS * 256, 4 * ROWS * 256))
    texture = cv2.resize(drawn, (TEXELS, TEXELS), interpolation=cv2.INTER_AREA)
    wide, high = 0.5 * COLUMNS * SQUARE_M, 0.5 * ROWS * SQUARE_M
    lines = ["mtllib board.mtl", "usemtl board"]
    lines += [
        f"v {x} {y} 0" for x, y in ((-wide, -high), (wide, -high), (wide, high), (-wide, high))
    ]
    lines += ["vt 0 0", "vt 1 0", "vt 1 1", "vt 0 1", "vn 0 0 1"]
    lines += ["f 1/1/1 2/2/1 3/3/1", "f 1/1/1 3/3/1 4/4/1"]
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w") as file:
        file.writestr("board.obj", "\n".join(lines))
        file.writestr("board.mtl", "newmtl board\nmap_Kd board.png\nNs 0\n")
        file.writestr("board.png", cv2.imencode(".png", texture)[1].tobytes())
    return data.getvalue()


def lens_of(model: str) -> CameraIntrinsics:
    """Return the lens of a model."""
    name = {} if model == "pinhole" else {"distortion_model": model}
    return CameraIntrinsics(**SIZE, **name, **LENSES[model])  # type: ignore[arg-type]


def turn(axis: NDArray[np.float64], angle: float) -> NDArray[np.float64]:
    """Return the (3, 3) rotation about an axis."""
    matrix, _ = cv2.Rodrigues(axis / np.linalg.norm(axis) * angle)
    return np.asarray(matrix, np.float64)


def views(lens: CameraIntrinsics, seed: int) -> list[NDArray[np.float64]]:
    """Return (4, 4) poses of the board in the optical frame, its z axis away from the camera."""
    random = np.random.default_rng(seed)
    valid = lens.valid_pixels()
    rays = lens.unit_rays()[valid]
    found: list[NDArray[np.float64]] = []
    while len(found) < VIEWS:
        # A random pixel is seen at the middle of the board.
        ray = rays[random.integers(len(rays))]
        distance = random.uniform(0.5, 1.1)
        facing = -ray
        # The board's z axis leads away from us.
        away = turn(random.normal(size=3), math.radians(random.uniform(0, 35))) @ ray
        side = np.cross([0.0, 1.0, 0.0] if abs(ray[1]) < 0.9 else [1.0, 0.0, 0.0], away)
        side /= np.linalg.norm(side)
        pose = np.eye(4)
        pose[:3, :3] = np.stack([side, np.cross(away, side), away], axis=1)
        pose[:3, :3] = pose[:3, :3] @ turn(np.array([0.0, 0.0, 1.0]), random.uniform(-0.6, 0.6))
        pose[:3, 3] = distance * ray
        if away @ facing < -0.6:
            found.append(pose)
    return found


def main() -> None:
    """Render all views."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("output", type=Path)
    parser.add_argument("--models", nargs="+", default=list(LENSES), choices=list(LENSES))
    parser.add_argument("--seed", type=int, default=1)
    args = parser.parse_args()
    args.output.mkdir(parents=True, exist_ok=True)
    scene = args.output / "scene.yaml"
    scene.write_text(SCENE)
    with Simulation(scene, mode="lockstep", light="plain") as simulation:
        name = simulation.upload_model(board_model(), "board.zip", height_m=ROWS * SQUARE_M)
        board = simulation.spawn_object(name, position=BOARD_AT, remove_dynamics=True)
        info = next(one for one in simulation.info.instances if one.id == board)
        print("board:", info.low_m, info.high_m)
        for model in args.models:
            lens = lens_of(model)
            folder = args.output / model
            folder.mkdir(exist_ok=True)
            picture = PictureSettings(supersampling=2, smooth_edges=False, tone_curve="linear")
            agent = AgentSpec(
                name=model, intrinsics=lens, following=False, picture=picture, rate_hz=0.0
            )
            simulation.register_agent(agent)
            poses = views(lens, args.seed)
            for number, board_pose in enumerate(poses):
                # The board stays; the camera goes to where it is seen as drawn.
                world = BOARD_IN_WORLD @ np.linalg.inv(board_pose) @ BODY_FROM_OPTICAL.T
                simulation.set_pose(agent=model, pose=Pose.from_matrix(world), teleport=True)
                frame = simulation.capture(("rgb",), agent=model)
                cv2.imwrite(str(folder / f"{number:02}.png"), frame["rgb"][..., ::-1])
            valid = lens.valid_pixels()
            places = np.argwhere(valid)[::97, ::-1].astype(np.float64)
            np.save(folder / "rays.npy", np.hstack([places, lens.unit_rays()[valid][::97]]))
            numbers = dict(SIZE)
            truth = {
                "lens": {**numbers, **LENSES[model], "K": lens.K.tolist()},
                "poses": [pose.tolist() for pose in poses],
            }
            (folder / "truth.json").write_text(json.dumps(truth))
            print(model, "done")


BOARD_AT = (0.0, 0.0, 1.05)
"""Where the lower edge's middle stands [m]."""

BOARD_IN_WORLD = np.array(
    [[0.0, 0.0, -1.0, 0.0], [1.0, 0.0, 0.0, 0.0], [0.0, -1.0, 0.0, 1.5], [0.0, 0.0, 0.0, 1.0]]
)
"""(4, 4): the board's middle; x to the right as it is read, y down, z away from the reader."""


if __name__ == "__main__":
    main()
