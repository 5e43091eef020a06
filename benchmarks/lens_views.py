"""Pictures of boards through lenses of every model, for judges: `lens_judges.py`, `lens_tags.py`.

    python benchmarks/lens_views.py FOLDER [--models NAME ...] [--boards NAME ...] [--topics]

Thirty pictures a model of a ChArUco board in a room, and as many of a board of AprilTags; both are
models that are drawn here and uploaded. Views follow a rule: the board's middle lies in each of
6 x 5 parts of the picture that the lens sees, at a random distance, turned and tilted at random.
Boards reach beyond the picture, so corners lie up to its border, and to the image circle's rim.
Each model's folder gets the pictures and `truth.json`: the lens, and the board's pose in each view.
With `--topics` the pictures and the lens are those of the ROS topics `rgb` and `camera_info`.
"""

from __future__ import annotations

import argparse
import io
import json
import math
import zipfile
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from lens_corners import SIDE_M, charuco
from numpy.typing import NDArray

from sailenv_ros import Agent, AgentSpec, CameraIntrinsics, Pose, Simulation
from sailenv_ros.types.geometry import BODY_FROM_OPTICAL
from sailenv_ros.types.picture_settings import PictureSettings

ACROSS, DOWN = 6, 5
TEXELS = 1024
"""A whole number for each square of the ChArUco board, also in coarser levels."""
MODULE_TEXELS, TAG_MODULES, TAGS = 32, 8, 3
FINER = 3
"""As often as boards have texels they are drawn, before they are made soft."""

LENSES: dict[str, dict[str, Any]] = {
    "pinhole": {"fx_px": 1010.0, "fy_px": 989.0},
    "plumb_bob": {
        "fx_px": 920.0,
        "fy_px": 912.0,
        "distortion": (-0.2834, 0.0739, 0.00019, 0.000176),
    },
    "rational_polynomial": {
        "fx_px": 853.0,
        "fy_px": 857.0,
        "distortion": (0.5285, -2.6231, 0.00057, -0.00019, 1.5135, 0.4061, -2.4526, 1.4466),
    },
    "thin_prism": {
        "fx_px": 853.0,
        "fy_px": 857.0,
        "distortion_model": "rational_polynomial",
        "distortion": (
            *(0.5285, -2.6231, 0.00057, -0.00019, 1.5135, 0.4061, -2.4526, 1.4466),
            *(0.0021, -0.0008, -0.0013, 0.0005),
        ),
    },
    "equidistant": {
        "fx_px": 380.0,
        "fy_px": 382.0,
        "distortion": (-0.0132, 0.0421, -0.0395, 0.0069),
        "max_angle_deg": 95.0,
    },
    "mei": {
        "fx_px": 880.0,
        "fy_px": 876.0,
        "distortion": (1.25, -0.21, 0.15, 0.0004, -0.0002),
        "max_angle_deg": 95.0,
    },
}
SIZE = {"width": 1280, "height": 960, "cx_offset_px": 7.3, "cy_offset_px": -4.6}

SCENE = """\
version: 1
environment: {ambient: [0.35, 0.35, 0.35], exposure: 0}
room: {size: [6, 6, 3], walls: {material: plaster}, floor: oak_planks}
"""
PICTURE = PictureSettings(smooth_edges=False, tone_curve="linear")

BOARD_AT = (0.0, 0.0, 1.0)
"""Where the lower edge's middle stands [m]."""

BOARD_IN_WORLD = np.array(
    [
        [0.0, 0.0, -1.0, 0.0],
        [1.0, 0.0, 0.0, 0.0],
        [0.0, -1.0, 0.0, BOARD_AT[2] + 0.5 * SIDE_M],
        [0.0, 0.0, 0.0, 1.0],
    ]
)
"""(4, 4): the board's middle; x to the right as it is read, y down, z away from the reader."""

CHARUCO_BLUR, TAG_BLUR = 2.0, 1.0
"""Standard deviation of edges [texels]: pixels can tell where soft ones lie. AprilTag's detector
looks for an edge within few pixels, where all of it must lie in the largest tags."""

Look = Callable[[Pose], NDArray[np.uint8]]
"""From the camera's pose to its picture, RGB."""


def charuco_texture() -> NDArray[np.uint8]:
    """Return the ChArUco board."""
    size = FINER * TEXELS
    return blurred(np.asarray(charuco().generateImage((size, size)), np.uint8), CHARUCO_BLUR)


def tags_texture() -> NDArray[np.uint8]:
    """Return 3 x 3 tags of the family 36h11, two modules apart."""
    dictionary = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_APRILTAG_36h11)
    module = FINER * MODULE_TEXELS
    size = TAG_MODULES * module
    texture = np.full((FINER * TEXELS, FINER * TEXELS), 255, np.uint8)
    for number in range(TAGS * TAGS):
        row, column = divmod(number, TAGS)
        top, left = (module * (2 + (TAG_MODULES + 2) * k) for k in (row, column))
        tag = cv2.aruco.generateImageMarker(dictionary, number, size)
        texture[top : top + size, left : left + size] = tag
    return blurred(texture, TAG_BLUR)


def blurred(texture: NDArray[np.uint8], blur: float) -> NDArray[np.uint8]:
    """Return a pattern of black and white in sRGB, whose edges are soft.

    The root of light passes alike from black to white on either side of an edge. Renderers filter
    textures in this measure, so an edge stays where it is, seen from near or from far.
    """
    blur *= FINER
    root = cv2.GaussianBlur(texture / 255.0, (0, 0), blur, borderType=cv2.BORDER_REPLICATE)
    light = cv2.resize(root, (TEXELS, TEXELS), interpolation=cv2.INTER_AREA) ** 2
    encoded = np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)
    return np.rint(255.0 * encoded).astype(np.uint8)


def board_model(texture: NDArray[np.uint8]) -> bytes:
    """Return the zip of an OBJ: a plate with the texture on its front."""
    half = 0.5 * SIDE_M
    lines = ["mtllib board.mtl", "usemtl board"]
    lines += [f"v {x} {y} 0" for x, y in ((-half, -half), (half, -half), (half, half))]
    lines += [f"v {-half} {half} 0", "vt 0 0", "vt 1 0", "vt 1 1", "vt 0 1", "vn 0 0 1"]
    lines += ["f 1/1/1 2/2/1 3/3/1", "f 1/1/1 3/3/1 4/4/1"]
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w") as file:
        file.writestr("board.obj", "\n".join(lines))
        file.writestr("board.mtl", "newmtl board\nmap_Kd board.png\nNs 0\n")
        file.writestr("board.png", cv2.imencode(".png", texture)[1].tobytes())
    return data.getvalue()


def lens_of(model: str) -> CameraIntrinsics:
    """Return the lens of a folder's name."""
    name = {} if model == "pinhole" else {"distortion_model": model}
    return CameraIntrinsics(**{**SIZE, **name, **LENSES[model]})


def turn(axis: NDArray[np.float64], angle: float) -> NDArray[np.float64]:
    """Return the (3, 3) rotation about an axis."""
    matrix, _ = cv2.Rodrigues(axis / np.linalg.norm(axis) * angle)
    return np.asarray(matrix, np.float64)


def views(lens: CameraIntrinsics, seed: int) -> list[NDArray[np.float64]]:
    """Return (4, 4) poses of the board in the optical frame, its z axis away from the camera.

    Boards are nearer to lenses that make things small.
    """
    random = np.random.default_rng(seed)
    rows, columns = np.nonzero(lens.valid_pixels())
    left, top = columns.min(), rows.min()
    wide, high = np.ptp(columns) / ACROSS, np.ptp(rows) / DOWN
    per_rad = 1e3 * (lens.project([1e-3, 0.0, 1.0])[0] - lens.cx)
    near = min(1.0, per_rad / 700.0)
    found: list[NDArray[np.float64]] = []
    while len(found) < ACROSS * DOWN:
        down, across = divmod(len(found), ACROSS)
        corner = np.array([left + across * wide, top + down * high])
        place = corner + random.uniform(size=2) * (wide, high)
        ray = lens.unit_rays_through(place)
        # Parts beside the image circle: the nearest place on the way to the middle that is seen.
        while np.isnan(ray[0]):
            place += 0.02 * (np.array([lens.cx, lens.cy]) - place)
            ray = lens.unit_rays_through(place)
        distance = near * random.uniform(0.5, 1.2)
        # The board's z axis leads away from us.
        away = turn(random.normal(size=3), math.radians(random.uniform(10, 40))) @ ray
        if away @ ray < 0.6:
            continue
        side = np.cross([0.0, 1.0, 0.0] if abs(ray[1]) < 0.9 else [1.0, 0.0, 0.0], away)
        side /= np.linalg.norm(side)
        pose = np.eye(4)
        pose[:3, :3] = np.stack([side, np.cross(away, side), away], axis=1)
        pose[:3, :3] = pose[:3, :3] @ turn(np.array([0.0, 0.0, 1.0]), random.uniform(-0.6, 0.6))
        pose[:3, 3] = distance * ray
        found.append(pose)
    return found


@contextmanager
def in_process(scene: Path, texture: NDArray[np.uint8]) -> Iterator[Callable[[str], Look]]:
    """Yield what makes cameras that look at a board, within this process."""
    with Simulation(scene, mode="lockstep", light="plain") as simulation:
        name = simulation.upload_model.within(600.0)(
            board_model(texture), "board.zip", height_m=SIDE_M
        )
        simulation.spawn_object(name, position=BOARD_AT, remove_dynamics=True)

        def camera(model: str) -> Look:
            agent = AgentSpec(
                name=model, intrinsics=lens_of(model), following=False, picture=PICTURE, rate_hz=0.0
            )
            simulation.register_agent(agent)

            def look(pose: Pose) -> NDArray[np.uint8]:
                simulation.set_pose(agent=model, pose=pose, teleport=True)
                frame = simulation.capture.within(300.0)(("rgb",), agent=model)
                return np.asarray(frame["rgb"])

            return look

        yield camera


@contextmanager
def through_topics(scene: Path, texture: NDArray[np.uint8]) -> Iterator[Callable[[str], Look]]:
    """Yield the same, whose pictures are what a subscriber of the topics gets."""
    import rclpy
    from rclpy.qos import qos_profile_sensor_data
    from sensor_msgs.msg import CameraInfo, Image

    rclpy.init()
    node = rclpy.create_node("board_viewer")
    simulator = {"scene": str(scene), "mode": "lockstep", "light": "plain"}

    def camera(model: str) -> Look:
        lens = lens_of(model)
        agent = stack.enter_context(
            Agent(intrinsics=lens, picture=PICTURE, name=model, simulator=simulator)
        )
        name = agent.upload_model(board_model(texture), "board.zip", height_m=SIDE_M)
        agent.spawn_object(name, position=BOARD_AT, remove_dynamics=True)
        pictures: list[Any] = []
        lenses: list[Any] = []
        for kind, view, kept in ((Image, "rgb", pictures), (CameraInfo, "camera_info", lenses)):
            topic = f"/sailenv/{model}/{view}"
            node.create_subscription(kind, topic, kept.append, qos_profile_sensor_data)

        def look(pose: Pose) -> NDArray[np.uint8]:
            agent.set_pose(pose=pose, teleport=True)
            agent.step(8)
            stamp = None
            while stamp is None or not any(_stamp_ns(m) == stamp for m in pictures):
                stamp = agent.capture(("rgb",)).stamp_ns
                for _ in range(20):
                    rclpy.spin_once(node, timeout_sec=0.05)
            message = next(m for m in pictures if _stamp_ns(m) == stamp)
            told = lenses[-1]
            if not np.array_equal(np.reshape(told.k, (3, 3)), lens.K):
                raise SystemExit(f"camera_info has K = {told.k}")
            if not np.array_equal(told.d, lens.D):
                raise SystemExit(f"camera_info has D = {told.d}")
            shape = message.height, message.width, 3
            return np.frombuffer(bytes(message.data), np.uint8).reshape(shape)

        return look

    with ExitStack() as stack:
        yield camera
    rclpy.shutdown()


def _stamp_ns(message: Any) -> int:
    stamp = message.header.stamp
    return int(stamp.sec) * 1_000_000_000 + int(stamp.nanosec)


def write_views(folder: Path, lens: CameraIntrinsics, look: Look, seed: int) -> None:
    """Write the pictures of one board through one lens, and what is true of them."""
    folder.mkdir(parents=True, exist_ok=True)
    poses, size = views(lens, seed), (lens.width, lens.height)
    for number, board_pose in enumerate(poses):
        # The board stays; the camera goes to where it is seen as drawn.
        world = BOARD_IN_WORLD @ np.linalg.inv(board_pose) @ BODY_FROM_OPTICAL.T
        picture = look(Pose.from_matrix(world))
        cv2.imwrite(str(folder / f"{number:02}.png"), picture[..., ::-1])
    # Pixels in a grid from border to border.
    columns, rows = np.meshgrid(*(np.rint(np.linspace(0, n - 1, n // 6)) for n in size))
    places = np.stack([columns, rows], axis=-1).reshape(-1, 2)
    rays = lens.unit_rays_through(places)
    seen = ~np.isnan(rays[:, 0])
    np.save(folder / "rays.npy", np.hstack([places, rays])[seen])
    numbers = {"width": lens.width, "height": lens.height, "model": lens.distortion_model}
    truth = {"lens": {**numbers, "K": lens.K.tolist(), "D": lens.D.tolist()}}
    found = {**truth, "poses": [pose.tolist() for pose in poses]}
    (folder / "truth.json").write_text(json.dumps(found))


def main() -> None:
    """Render all views."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("output", type=Path)
    parser.add_argument("--models", nargs="+", default=list(LENSES), choices=list(LENSES))
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument(
        "--boards", nargs="+", default=["charuco", "tags"], choices=["charuco", "tags"]
    )
    parser.add_argument("--topics", action="store_true")
    args = parser.parse_args()
    args.output.mkdir(parents=True, exist_ok=True)
    scene = args.output.resolve() / "scene.yaml"
    scene.write_text(SCENE)
    boards = {"charuco": charuco_texture, "tags": tags_texture}
    open_room = through_topics if args.topics else in_process
    for board in args.boards:
        with open_room(scene, boards[board]()) as camera:
            for model in args.models:
                folder = args.output / board / model
                write_views(folder, lens_of(model), camera(model), args.seed)
                print(board, model)


if __name__ == "__main__":
    main()
