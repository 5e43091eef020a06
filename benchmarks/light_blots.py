"""Look for black blots of baked light: every asset alone under an even sky, or in scenes.

    python -m benchmarks.light_blots [ASSET_OR_SCENE ...] [--views N] [--output FOLDER]

Without names: each asset of the standard pack, from twelve sides. A scene, as `room_02` or
`generated:kitchen:7`, is baked in full and looked at from plausible views. What counts as a blot
says `dark_blots` in `tests/support/light_faults.py`; things are shown white and matt. Prints those
that have any, and a sum. With `--output` their pictures are written, blots in red.
"""

from __future__ import annotations

import argparse
import itertools
import math
from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np

from benchmarks.reference.scene_export import without_outside
from sailenv_ros.assets.asset_library import AssetLibrary
from sailenv_ros.assets.sources import installed_sources
from sailenv_ros.light.bake.pipeline import bake
from sailenv_ros.render.contract import RenderRequest
from sailenv_ros.render.cpu.renderer import NativeRenderer
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.geometry import look_at
from sailenv_ros.types.lights import Environment
from sailenv_ros.types.model import Model
from sailenv_ros.types.snapshot import WorldSnapshot
from tests.support.bake_scenes import still
from tests.support.light_faults import dark_blots
from tests.support.plausible_views import plausible_views, room_at_rest
from tests.support.tiny_scenes import Thing

VIEWS = ("rgb", "albedo", "normals", "instance")
WHITE = (1.0, 1.0, 1.0)
EVEN = Environment(sky_zenith=WHITE, sky_horizon=WHITE, sky_ground=WHITE, exposure=-1.0)
LENS = CameraIntrinsics(width=480, height=480, vertical_fov_deg=40.0, near_m=0.001)
SIDES = tuple(itertools.product((25.0, 65.0, -35.0), (30.0, 120.0, 210.0, 300.0)))
"""Elevations and azimuths of the cameras [deg]."""


def alone(name: str, library: AssetLibrary) -> tuple[WorldSnapshot, list[Camera]]:
    """Return an asset baked under an even sky, and cameras around it."""
    model = library.get(name).model
    snapshot = still([Thing(model)], environment=EVEN, lights=())
    baked = bake(snapshot)
    snapshot = whitened(replace(snapshot, contents=replace(snapshot.contents, baked=baked)))
    low, high = model.bounds()
    middle, reach = (low + high) / 2.0, 1.5 * float(np.linalg.norm(high - low))
    cameras = []
    for up, around in SIDES:
        a, b = math.radians(up), math.radians(around)
        towards = np.array([math.cos(a) * math.cos(b), math.cos(a) * math.sin(b), math.sin(a)])
        cameras.append(Camera(intrinsics=LENS, pose=look_at(middle + reach * towards, middle)))
    return snapshot, cameras


def whitened(snapshot: WorldSnapshot) -> WorldSnapshot:
    """Return the scene in its light, all things white and matt: what is dark then lacks light."""
    models: dict[int, Model] = {}

    def white(model: Model) -> Model:
        parts = tuple(
            replace(
                part,
                material=replace(
                    part.material,
                    base_colour=(*WHITE, part.material.base_colour[3]),
                    base_colour_texture=None,
                    metallic=0.0,
                    roughness=1.0,
                    metallic_roughness_texture=None,
                    normal_texture=None,
                ),
            )
            if part.material.alpha == "opaque"
            else part
            for part in model.parts
        )
        return models.setdefault(id(model), replace(model, parts=parts))

    contents = snapshot.contents
    drawn = tuple(replace(one, model=white(one.model)) for one in contents.instances)
    return replace(snapshot, contents=replace(contents, instances=drawn))


def in_scene(name: str, renderer: NativeRenderer) -> tuple[WorldSnapshot, Iterator[Camera]]:
    """Return a scene in its finished light, and plausible cameras."""
    room = without_outside(room_at_rest(name))
    return whitened(room), plausible_views(room, renderer, f"blots{name}", width=1024, height=768)


def counted(
    name: str, snapshot: WorldSnapshot, cameras: Iterable[Camera], output: Path | None
) -> int:
    """Return how many pixels of blots there are in all views."""
    renderer, total = NativeRenderer(), 0
    try:
        for number, camera in enumerate(cameras):
            seen = renderer.render(RenderRequest(snapshot, camera, VIEWS)).views
            blots = dark_blots(seen["rgb"], seen["albedo"], seen["normals"], seen["instance"])
            total += int(blots.sum())
            if output is not None and blots.any():
                picture = np.ascontiguousarray(seen["rgb"][..., ::-1])
                edge = cv2.dilate(blots.astype(np.uint8), np.ones((5, 5), np.uint8)) > blots
                picture[edge] = 0, 0, 255
                cv2.imwrite(str(output / f"{name.replace(':', '_')}_{number:02}.png"), picture)
    finally:
        renderer.close()
    return total


def main() -> None:
    """Look, and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*")
    parser.add_argument("--views", type=int, default=20, help="of each scene")
    parser.add_argument("--output", type=Path)
    args = parser.parse_args()
    if args.output is not None:
        args.output.mkdir(parents=True, exist_ok=True)
    library, blotted, pixels = AssetLibrary(installed_sources()), [], 0
    names = args.names or library.names
    for name in names:
        if name in library.names:
            snapshot, cameras = alone(name, library)
            found = counted(name, snapshot, cameras, args.output)
        else:
            renderer = NativeRenderer()
            snapshot, views = in_scene(name, renderer)
            found = counted(name, snapshot, itertools.islice(views, args.views), args.output)
            renderer.close()
        if found:
            blotted.append(name)
            print(f"{name}: {found} px", flush=True)
        pixels += found
    print(f"{len(blotted)} of {len(names)} have blots, {pixels} px")


if __name__ == "__main__":
    main()
