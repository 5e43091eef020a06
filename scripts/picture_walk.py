"""Draw a walk through a room as a moving picture: python scripts/picture_walk.py FILE.

The picture is large, what is known of each pixel is small beside it. FILE ends in ``.webp``.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import Image

from sailenv_ros import Simulation
from sailenv_ros.cli.scene_bake import ensure_baked
from sailenv_ros.frame.pictures.colours import view_picture
from sailenv_ros.types.labels import CategoryTable

Rgb = NDArray[np.uint8]

LENGTH_S, RATE_HZ = 14, 10
STEPS = 240 // RATE_HZ
SIZE_PX = (480, 360)
BESIDE = ("depth", "category", "flow")
QUALITY = 55
"""Of the pictures, 0 to 100: the file is to stay below 3 MB."""


def main() -> None:
    """Draw the walk."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("output", type=Path)
    parser.add_argument("--scene", default="room_02")
    parser.add_argument("--start", type=float, default=0.0, help="when the walk begins [s]")
    args = parser.parse_args()
    ensure_baked(args.scene, allow_modules=False)
    width, height = SIZE_PX
    views = ("rgb", *BESIDE)
    with Simulation(args.scene, mode="lockstep", seed=1, width=width, height=height) as simulation:
        simulation.step(max(1, round(240 * args.start)))
        simulation.capture(views)
        table, pictures = CategoryTable(simulation.info.categories.values()), []
        for _ in range(LENGTH_S * RATE_HZ):
            simulation.step(STEPS)
            frame = simulation.capture(views)
            shown = {name: view_picture(name, frame[name], table=table) for name in views}
            pictures.append(_sheet(shown))
    first, *others = [Image.fromarray(picture) for picture in pictures]
    first.save(
        args.output,
        save_all=True,
        append_images=others,
        duration=1000 // RATE_HZ,
        loop=0,
        quality=QUALITY,
        method=6,
    )
    print(f"{args.output}: {len(pictures)} pictures, {args.output.stat().st_size / 1e6:.1f} MB")


def _sheet(pictures: dict[str, Rgb]) -> Rgb:
    """Return the picture with the views beside it, one below another."""
    height = SIZE_PX[1] // len(BESIDE)
    width = SIZE_PX[0] // len(BESIDE)
    small = [
        cv2.resize(pictures[name], (width, height), interpolation=cv2.INTER_AREA) for name in BESIDE
    ]
    return np.hstack([pictures["rgb"], np.vstack(small)]).astype(np.uint8)


if __name__ == "__main__":
    main()
