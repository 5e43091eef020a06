"""Reads a stream's folders with the reader of SAILab's own code, and says what it found.

    python benchmarks/lve_judge.py CLONE FOLDER

CLONE is a clone of github.com/sailab-code/cl_stochastic_coherence, FOLDER what
`sailenv export BAG -o FOLDER --format lve` has written, or one of the clone's own streams
(`CLONE/data/emptyspace`). Told are what their `InputStream` returns: frames, rate, classes, moving
pixels; and the factor by which the stored motion must be multiplied for the picture before, warped
by it, to be most like the present one (the median over frames; 1 for motion in true units), with
the share of the difference that is left then.
"""

from __future__ import annotations

import argparse
import sys
import types
from pathlib import Path
from typing import Any

import cv2
import numpy as np

FACTORS = np.concatenate([np.arange(0.5, 1.5, 0.01), np.arange(1.5, 8.0, 0.1)])

LEAST_PIXELS = 200
"""Frames in which fewer pixels move are not asked."""

LEAST_MOTION = 0.15
"""Least motion that is judged [px]: interpolation blurs more than less motion shows."""


def main() -> None:
    """Read and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("clone", type=Path)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--every", type=int, default=10, help="frames between two that are asked")
    options = parser.parse_args()
    stream = _input_stream(options.clone)(str(options.folder))
    frames, moving, best, left = 0, 0, [], []
    before: Any = None
    while True:
        picture, motion, supervision, _ = stream.get_next()
        if picture is None:
            break
        frames += 1
        moves = (motion != 0.0).any(axis=-1)
        moving += int(moves.sum())
        fast = np.hypot(motion[..., 0], motion[..., 1]) > LEAST_MOTION
        if before is not None and frames % options.every == 0 and fast.sum() >= LEAST_PIXELS:
            factor, share = _best_factor(before, picture, motion, fast)
            best.append(factor)
            left.append(share)
        before = picture
        assert supervision[0].size == moves.size
    print(f"{frames} frames of {picture_size(motion, before)} at {stream.fps:g} per second")
    print(f"classes: {stream.sup_map}")
    print(f"{moving / frames:.0f} moving pixels in a frame")
    if best:
        low, middle, high = np.percentile(best, (25, 50, 75))
        print(
            f"factor of the motion: {middle:.2f} ({low:.2f} to {high:.2f}), "
            f"{np.median(left):.2f} of the difference is left, {len(best)} frames"
        )


def picture_size(motion: Any, picture: Any) -> str:
    """Return width and height as people write them."""
    shape = (picture if motion is None else motion).shape
    return f"{shape[1]}x{shape[0]}"


def _best_factor(before: Any, now: Any, motion: Any, moves: Any) -> tuple[float, float]:
    """Return the factor, and the difference that is left as a share of that without a warp."""
    rows, columns = np.mgrid[: motion.shape[0], : motion.shape[1]].astype(np.float32)
    # What no warp explains, where the object uncovers something, is left out by a margin.
    inside = cv2.erode(moves.astype(np.uint8), np.ones((3, 3), np.uint8)).astype(bool)
    inside = inside if inside.sum() > LEAST_PIXELS // 2 else moves
    errors = []
    for factor in (0.0, *FACTORS):
        x = columns + np.float32(factor) * motion[..., 0]
        y = rows - np.float32(factor) * motion[..., 1]
        warped = cv2.remap(before, x, y, cv2.INTER_LINEAR)
        errors.append(np.abs(warped.astype(np.float64) - now)[inside].mean())
    place = int(np.argmin(errors[1:]))
    return float(FACTORS[place]), float(errors[1 + place] / max(errors[0], 1e-9))


def _input_stream(clone: Path) -> Any:
    """Import their reader without what it imports for videos and for Unity."""
    sys.path.insert(0, str(clone))
    package = types.ModuleType("lve")
    package.__path__ = [str(clone / "lve")]
    client = types.ModuleType("lve.unity_client")
    client.Agent = object  # type: ignore[attr-defined]
    sys.modules.update(
        {"lve": package, "lve.unity_client": client, "ffmpeg": types.ModuleType("ffmpeg")}
    )
    from lve.in_stream import InputStream

    return InputStream


if __name__ == "__main__":
    main()
