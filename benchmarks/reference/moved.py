"""Rooms whose furniture was moved: light that was updated beside light baked again.

    python -m benchmarks.reference.moved              # 10 moves a room; bakes what is not there
    python -m benchmarks.reference.moved --no-bake    # with the pictures that are there

Each move puts one large piece of furniture somewhere else, chosen by a seed. Two views show the
place that it left and where it stands now. Pictures of scenes baked again are kept in the cache.
"""

from __future__ import annotations

import argparse
import itertools
import json
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import Image

from benchmarks.reference.scene_export import without_outside
from sailenv_ros.light.bake.fingerprint import fingerprint
from sailenv_ros.light.bake.pipeline import bake
from sailenv_ros.light.relight.baked_scene import BakedScene
from sailenv_ros.light.relight.quality import FINE, QUICK
from sailenv_ros.light.relight.relighting import relit
from sailenv_ros.light.relight.scene_changes import Change
from sailenv_ros.render.contract import RenderRequest
from sailenv_ros.render.cpu.renderer import NativeRenderer
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.system.threads import thread_count
from sailenv_ros.system.user_folders import cache_folder
from sailenv_ros.types.baked_light import BakedLight
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.colour import LINEAR_OF_SRGB8
from sailenv_ros.types.geometry import look_at
from sailenv_ros.types.picture_settings import PictureSettings
from sailenv_ros.types.snapshot import WorldSnapshot

Picture = NDArray[np.uint8]

ROOMS = ("room_01", "room_02", "room_03")
LARGE_M = 0.45
"""Furniture is large if two of its sides are at least this long."""

TRIALS = 400
BLOCK = 16
"""Side of a region [px]."""

DARK = 0.004
"""Regions whose linear luminance is less are black in either picture."""


@dataclass(frozen=True, eq=False, slots=True)
class Move:
    """One piece of furniture at another place."""

    room: str
    number: int
    row: int
    name: str
    pose: NDArray[np.float64]
    cameras: tuple[Camera, Camera]


def main() -> int:
    """Measure; 1 if pictures were missing."""
    arguments = _arguments()
    rows, missing = [], 0
    for room in arguments.rooms:
        snapshot = without_outside(SceneLibrary().snapshot(room))
        baked = snapshot.contents.baked
        if baked is None:
            print(f"{room}: not baked; sailenv scene bake {room}", file=sys.stderr)
            return 1
        began = time.perf_counter()
        scene = BakedScene(baked, snapshot.contents, thread_count())
        print(f"{room}: made ready in {time.perf_counter() - began:.2f} s", file=sys.stderr)
        renderer = NativeRenderer()
        for move in itertools.islice(_moves(room, snapshot, arguments.seed), arguments.moves):
            row = _measured(move, snapshot, scene, renderer, arguments)
            if row is None:
                missing = 1
                continue
            rows.append(row)
            print(json.dumps(row), flush=True)
        renderer.close()
    _summary(rows)
    return missing


def moved_room(
    room: str, snapshot: WorldSnapshot, number: int, *, anew: bool = False
) -> tuple[WorldSnapshot, Move]:
    """Return a baked room after a move of seed 0, with its light refined, and the move.

    Parameters
    ----------
    room : str
        Its name.
    snapshot : WorldSnapshot
        Of the room, baked.
    number : int
        Of the move, from 0.
    anew : bool
        True to bake the light again instead.
    """
    baked = snapshot.contents.baked
    if baked is None:
        raise ValueError(f"{room} is not baked; sailenv scene bake {room}")
    move = next(itertools.islice(_moves(room, snapshot, 0), number, None))
    moved = _after(snapshot, move)
    if anew:
        light = replace(bake(moved), environment=moved.contents.environment)
    else:
        scene = BakedScene(baked, snapshot.contents, thread_count())
        light = relit(scene, [_change(snapshot, move)], FINE, threads=thread_count())
    return replace(moved, contents=replace(moved.contents, baked=light)), move


def _after(snapshot: WorldSnapshot, move: Move) -> WorldSnapshot:
    poses = snapshot.world_from_body.copy()
    poses[move.row] = move.pose
    # Clutter that stood on it would hang in the air.
    return replace(snapshot, world_from_body=poses)


def _change(snapshot: WorldSnapshot, move: Move) -> Change:
    return Change(
        id=snapshot.contents.instances[move.row].instance.id,
        before=snapshot.world_from_body[move.row],
        after=move.pose,
    )


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rooms", nargs="+", default=list(ROOMS))
    parser.add_argument("--moves", type=int, default=10)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--size", nargs=2, type=int, default=(640, 480))
    parser.add_argument("--no-bake", action="store_true", help="pass over what is not in the cache")
    parser.add_argument("--output", type=Path, default=Path("build/moved"))
    return parser.parse_args()


# -- moves ---------------------------------------------------------------------------------------


def _moves(room: str, snapshot: WorldSnapshot, seed: int) -> Iterator[Move]:
    """Choose moves: each of another piece than the last, upright, beside what stands there."""
    contents = snapshot.contents
    boxes = _boxes(snapshot)
    assert contents.baked is not None
    inner = _inside(contents.baked)
    static = np.array([drawn.instance.static for drawn in contents.instances])
    size = boxes[:, 1] - boxes[:, 0]
    large = [
        row
        for row, drawn in enumerate(contents.instances)
        if static[row]
        and np.sort(size[row])[1] >= LARGE_M
        and size[row, :2].max() < 2.6
        and 0.2 < size[row, 2] < 2.3
        and boxes[row, 0, 2] < 0.2
        and drawn.instance.category not in ("wall", "floor", "ceiling", "window", "door", "curtain")
    ]
    rng = np.random.default_rng([seed, *room.encode()])
    number, last = 0, -1
    while True:
        row = int(rng.choice(large))
        if row == last and len(large) > 1:
            continue
        pose = _place(rng, snapshot, boxes, inner, row, static)
        if pose is None:
            continue
        last = row
        cameras = _cameras(rng, boxes, inner, row, pose)
        if cameras is None:
            continue
        yield Move(room, number, row, contents.instances[row].instance.name, pose, cameras)
        number += 1


def _boxes(snapshot: WorldSnapshot) -> NDArray[np.float64]:
    """Return (N, 2, 3): lowest and highest corner of each instance, world."""
    return np.array(
        [
            _box(drawn.model.bounds() * np.asarray(drawn.scale), pose)
            for drawn, pose in zip(
                snapshot.contents.instances, snapshot.world_from_body, strict=True
            )
        ]
    )


def _box(bounds: NDArray[np.float64], pose: NDArray[np.float64]) -> NDArray[np.float64]:
    middle, half = bounds.mean(axis=0), np.abs(bounds[1] - bounds[0]) / 2.0
    centre, reach = pose[:3, :3] @ middle + pose[:3, 3], np.abs(pose[:3, :3]) @ half
    return np.stack([centre - reach, centre + reach])


def _inside(baked: BakedLight) -> NDArray[np.float64]:
    grid = baked.probes
    low = np.asarray(grid.origin_m)
    high = low + np.asarray(grid.spacing_m) * (np.asarray(grid.shape[::-1]) - 1)
    return np.stack([low, high])


def _place(
    rng: np.random.Generator,
    snapshot: WorldSnapshot,
    boxes: NDArray[np.float64],
    inner: NDArray[np.float64],
    row: int,
    static: NDArray[np.bool_],
) -> NDArray[np.float64] | None:
    """Return a free place; None if there seems to be none."""
    drawn, old = snapshot.contents.instances[row], snapshot.world_from_body[row]
    pose: NDArray[np.float64]
    bounds = drawn.model.bounds() * np.asarray(drawn.scale)
    others = boxes[static & (np.arange(len(boxes)) != row)]
    # Walls, floor and ceiling are as large as the room; rugs may lie beneath.
    size = others[:, 1] - others[:, 0]
    others = others[(size[:, :2].max(axis=1) < 2.6) & (others[:, 1, 2] > 0.05)]
    for trial in range(TRIALS):
        turn = rng.choice([0, 90, 180, 270]) + rng.uniform(-20, 20)
        c, s = np.cos(np.radians(turn)), np.sin(np.radians(turn))
        pose = old.copy()
        pose[:3, :3] = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ old[:3, :3]
        pose[:2, 3] = rng.uniform(inner[0, :2], inner[1, :2])
        box = _box(bounds, pose)
        wall = 0.16 if trial < TRIALS / 2 else 0.12
        if (box[0, :2] < inner[0, :2] + wall).any() or (box[1, :2] > inner[1, :2] - wall).any():
            continue
        if np.linalg.norm(pose[:2, 3] - old[:2, 3]) < 0.4:
            continue
        overlap = np.minimum(box[1], others[:, 1]) - np.maximum(box[0], others[:, 0])
        if (overlap > 0.02).all(axis=1).any():
            continue
        return pose
    return None


def _cameras(
    rng: np.random.Generator,
    boxes: NDArray[np.float64],
    inner: NDArray[np.float64],
    row: int,
    pose: NDArray[np.float64],
) -> tuple[Camera, Camera] | None:
    """Return a view of the old place and one of the new, from where a person might stand."""
    targets = (boxes[row].mean(axis=0), np.array([*pose[:2, 3], boxes[row, :, 2].mean()]))
    cameras = []
    for target in targets:
        for _ in range(TRIALS):
            eye = np.array([*rng.uniform(inner[0, :2] + 0.4, inner[1, :2] - 0.4), 1.55])
            far = np.linalg.norm(eye[:2] - target[:2])
            held = np.all((eye > boxes[:, 0] - 0.15) & (eye < boxes[:, 1] + 0.15), axis=1)
            small = (boxes[:, 1] - boxes[:, 0])[:, :2].max(axis=1) < 2.6
            if 1.3 < far < 4.0 and not (held & small).any():
                low = np.array([*target[:2], min(float(target[2]), 0.8)])
                lens = CameraIntrinsics(width=640, height=480, vertical_fov_deg=60.0)
                cameras.append(Camera(intrinsics=lens, pose=look_at(eye, low)))
                break
        else:
            return None
    return cameras[0], cameras[1]


# -- pictures ------------------------------------------------------------------------------------


def _measured(
    move: Move,
    snapshot: WorldSnapshot,
    scene: BakedScene,
    renderer: NativeRenderer,
    arguments: argparse.Namespace,
) -> dict[str, object] | None:
    moved = _after(snapshot, move)
    reference = _reference(move, moved, renderer, may_bake=not arguments.no_bake)
    if reference is None:
        return None
    change = _change(snapshot, move)
    row: dict[str, object] = {"room": move.room, "move": move.number, "object": move.name}
    shown = {"stale": [_pictures(renderer, moved, camera) for camera in move.cameras]}
    for name, quality in (("at once", QUICK), ("refined", FINE)):
        began = time.process_time()
        light = relit(scene, [change], quality, threads=thread_count())
        row[f"{name}_s"] = round(time.process_time() - began, 3)
        fresh = replace(moved, contents=replace(moved.contents, baked=light))
        shown[name] = [_pictures(renderer, fresh, camera) for camera in move.cameras]
    for name, pictures in shown.items():
        pairs = list(zip(pictures, reference, strict=True))
        row[f"{name}_ssim"] = [round(ssim(a[0], b[0]), 4) for a, b in pairs]
        row[f"{name}_darkest"] = [round(darkest(a[1], b[1]), 3) for a, b in pairs]
    arguments.output.mkdir(parents=True, exist_ok=True)
    for place, name in enumerate(("old", "new")):
        sheet = np.concatenate([p[place][0] for p in (*shown.values(), reference)], axis=1)
        Image.fromarray(sheet).save(arguments.output / f"{move.room}_{move.number}_{name}.png")
    return row


def _pictures(
    renderer: NativeRenderer, snapshot: WorldSnapshot, camera: Camera
) -> tuple[Picture, Picture]:
    """Return the picture, and one without tone curve."""
    plain = replace(camera, picture=PictureSettings(tone_curve="linear", exposure=-1.0))
    first, second = (
        renderer.render(RenderRequest(snapshot, one, ("rgb",))).views["rgb"].copy()
        for one in (camera, plain)
    )
    return first, second


def _reference(
    move: Move, moved: WorldSnapshot, renderer: NativeRenderer, *, may_bake: bool
) -> list[tuple[Picture, Picture]] | None:
    folder = cache_folder() / "reference" / "moved"
    name = fingerprint(moved)
    files = [folder / f"{name}_{view}_{kind}.png" for view in (0, 1) for kind in ("as_is", "plain")]
    if not all(file.is_file() for file in files):
        if not may_bake:
            return None
        light = replace(bake(moved), environment=moved.contents.environment)
        fresh = replace(moved, contents=replace(moved.contents, baked=light))
        folder.mkdir(parents=True, exist_ok=True)
        made = [p for camera in move.cameras for p in _pictures(renderer, fresh, camera)]
        for file, picture in zip(files, made, strict=True):
            Image.fromarray(picture).save(file)
    pictures = [np.asarray(Image.open(file)) for file in files]
    return [(pictures[0], pictures[1]), (pictures[2], pictures[3])]


# -- measures ------------------------------------------------------------------------------------


def ssim(ours: Picture, reference: Picture) -> float:
    """Structural similarity, Gaussian window of 1.5 px, mean of the channels (Wang et al. 2004)."""
    a, b = ours.astype(np.float64), reference.astype(np.float64)

    def mean(values: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.asarray(cv2.GaussianBlur(values, (11, 11), 1.5))

    ma, mb = mean(a), mean(b)
    va, vb, vab = mean(a * a) - ma * ma, mean(b * b) - mb * mb, mean(a * b) - ma * mb
    c1, c2 = (0.01 * 255) ** 2, (0.03 * 255) ** 2
    value = (2 * ma * mb + c1) * (2 * vab + c2) / ((ma * ma + mb * mb + c1) * (va + vb + c2))
    return float(value[5:-5, 5:-5].mean())


def darkest(ours: Picture, reference: Picture) -> float:
    """Return the least share that a region has of the luminance that it should have."""
    light = [LINEAR_OF_SRGB8[p] @ np.array([0.2126, 0.7152, 0.0722]) for p in (ours, reference)]
    size = [n // BLOCK * BLOCK for n in light[0].shape]
    blocks = [
        x[: size[0], : size[1]]
        .reshape(size[0] // BLOCK, BLOCK, size[1] // BLOCK, BLOCK)
        .mean(axis=(1, 3))
        for x in light
    ]
    return float(((blocks[0] + DARK) / (blocks[1] + DARK)).min())


def _summary(rows: list[dict[str, object]]) -> None:
    for room in sorted({str(row["room"]) for row in rows}):
        for name in ("stale", "at once", "refined"):
            own = [row for row in rows if row["room"] == room]
            similar = np.array([row[f"{name}_ssim"] for row in own])
            dark = np.array([row[f"{name}_darkest"] for row in own])
            took = np.median([row.get(f"{name}_s", 0.0) for row in own])
            print(
                f"{room} {name}: SSIM mean {similar.mean():.3f}, least {similar.min():.3f}; "
                f"darkest region {dark.min():.2f}; {took:.2f} s of one core"
            )


if __name__ == "__main__":
    sys.exit(main())
