"""Frames of recipes that show hardly more than walls, floor and ceiling.

Run ``python -m benchmarks.empty_views RECIPE... [--clips 120] [--seeds 10]``. Each recipe is made
with small frames and plain light into a temporary folder: so many clips over its scenes, of
generated ones the first seeds of each kind, all for training, with the recipe's own seed. A frame
is empty when walls, floor and ceiling cover more than 90 % of its pixels.
"""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from numpy.typing import NDArray

from sailenv_ros import dataset
from sailenv_ros.assets.categories import load_categories
from sailenv_ros.dataset import engine_of, load_job, make_dataset

PARTS = ("wall", "floor", "ceiling")
EMPTY = 0.9
LONG_SIDE_PX = 160


def main() -> None:
    """Print a row of a table for each recipe."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("recipes", type=Path, nargs="+")
    parser.add_argument("--clips", type=int, default=120)
    parser.add_argument("--seeds", type=int, default=10, help="of each kind of generated room")
    parser.add_argument("--frames", type=int, default=8, help="most of a clip")
    args = parser.parse_args()
    print("| recipe | frames | empty | above 80 % | above 70 % | median | clips left out |")
    print("|---|---:|---:|---:|---:|---:|---:|")
    for path in args.recipes:
        with tempfile.TemporaryDirectory(prefix="empty-views-") as folder:
            small = Path(folder) / path.name
            wanted = _small(yaml.safe_load(path.read_text()), args.clips, args.seeds, args.frames)
            small.write_text(yaml.safe_dump(wanted))
            made = make_dataset(load_job(small), Path(folder) / "set", engine_of(2, None))
            shares = _shares(Path(folder) / "set")
        above = " | ".join(f"{(shares > limit).mean():.1%}" for limit in (EMPTY, 0.8, 0.7))
        left_out = sum(made.skipped.values())
        print(
            f"| {path.stem} | {len(shares)} | {above} | {np.median(shares):.2f} | {left_out} |",
            flush=True,
        )


def _small(recipe: dict[str, Any], clips: int, seeds: int, frames: int) -> dict[str, Any]:
    """Return a recipe of few small frames in the same scenes."""
    clip = dict(recipe.get("clip", {}))
    clip["rate"] = clip.get("rate", 30.0) * min(1.0, frames / clip.get("frames", 1))
    clip["frames"] = min(frames, clip.get("frames", 1))
    for camera in recipe["cameras"]:
        share = LONG_SIDE_PX / max(camera["width"], camera["height"])
        camera.update({side: round(share * camera[side]) for side in ("width", "height")})
    scenes = [
        {**one, "seeds": [one["seeds"][0], min(one["seeds"][1], one["seeds"][0] + seeds - 1)]}
        if "generate" in one
        else one
        for one in recipe["scenes"]
        if "train" in one.get("splits", ["train"])
    ]
    return {
        **recipe,
        "scenes": scenes,
        "clip": clip,
        "clips": {"train": clips},
        "light": "plain",
        "views": ["category"],
        "amodal": False,
        "formats": ["webdataset"],
        "flow": "forward",
        "shard": {"clips": 20},
    }


def _shares(folder: Path) -> NDArray[np.float64]:
    """Return the share of each frame that parts of the room cover."""
    ids = [load_categories().named(name).id for name in PARTS]
    with dataset.open(folder) as frames:
        return np.array([np.isin(one.frame["category"], ids).mean() for one in frames])


if __name__ == "__main__":
    main()
