"""Scores of raw pixels at telling the objects of a stream, and their dependence on the labels.

    python benchmarks/stream_raw_image.py FOLDER --stream solid --drawings 50

FOLDER is what `sailenv export BAG -o FOLDER --format lve` has written, or one of the streams
published with arXiv:2204.12193. Classifies as `exp_runner.py --arch=identity` of
github.com/sailab-code/cl_stochastic_coherence does, in seconds instead of minutes: three labelled
pixels an object, the nearest of them by squared distance, background beyond a threshold, and of
the thresholds the one with the best mean F1. First with the pixels that their policy labels (what
moves, nearest to its centroid, as soon as 100 frames have passed), which tells what their program
tells; then with pixels drawn at random from what moves. Needs NumPy and OpenCV.
"""

from __future__ import annotations

import argparse
import gzip
import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

LABELS = 3
APART = 100
"""Frames between two labels of one object, at least."""

NORMALISED = (1e-6, 2e-4, 3e-4, 5e-4, 7e-4, 1e-3, 0.01, 0.1, 0.25, 0.5, 0.7, 1.0)
PLAIN = (0.1, 2, 10, 18, 25, 50, 75, 100, 125, 150, 175, 200, 250, 300, 400, 500, 600)
"""Their thresholds of the squared distance, in grey levels / 63.75 or between unit vectors."""

Floats = NDArray[np.float32]


@dataclass(frozen=True, slots=True)
class Picture:
    """A frame: features (H W, C) float32, classes and motion (H, W)."""

    features: Floats
    classes: NDArray[np.uint8]
    moves: NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class Labels:
    """Features (N, C) of labelled pixels, and their classes (N,)."""

    features: Floats
    classes: NDArray[np.int64]


class LveStream:
    """A folder of frames, motion and labels as the published streams have."""

    def __init__(self, folder: Path, *, grey: bool, normalised: bool) -> None:
        self._folder, self._grey, self._normalised = folder, grey, normalised
        self._frames = sorted((folder / "frames").glob("*/*.png"))
        if not self._frames:
            raise SystemExit(f"{folder} has no frames/*/*.png")
        named = json.loads(next((folder / "sup").glob("*.json")).read_text())
        self.names = sorted(named, key=named.__getitem__)

    def __len__(self) -> int:
        return len(self._frames)

    def __getitem__(self, index: int) -> Picture:
        """Read a frame."""
        path = self._frames[index]
        read = cv2.imread(str(path), cv2.IMREAD_COLOR)
        if read is None:
            raise SystemExit(f"{path} is not a picture")
        pixels = cv2.cvtColor(read, cv2.COLOR_BGR2GRAY)[..., None] if self._grey else read
        features = (pixels.astype(np.float32) / np.float32(255.0) - np.float32(0.5)) * np.float32(
            4.0
        )
        features = features.reshape(-1, pixels.shape[2])
        if self._normalised:
            features /= np.linalg.norm(features, axis=1, keepdims=True) + 1e-12
        moves = np.abs(self._array("motion", path, ".bin")).sum(axis=2) > 0
        classes = np.full(moves.size, self.names.index("background"), np.uint8)
        indices = self._folder / "sup" / path.parent.name / f"{path.stem}.indices.bin"
        told = self._array("sup", path, ".targets.bin")
        if indices.is_file():
            classes[self._array("sup", path, ".indices.bin")] = told
        else:
            classes[:] = told.reshape(-1)
        return Picture(features, classes.reshape(moves.shape), moves)

    def _array(self, kind: str, frame: Path, suffix: str) -> NDArray[np.generic]:
        with gzip.open(self._folder / kind / frame.parent.name / (frame.stem + suffix)) as file:
            array: NDArray[np.generic] = np.load(file)
        return array


def labels_of_policy(stream: LveStream) -> Labels:
    """Label what their policy labels, within two laps."""
    given: dict[int, list[int]] = {}
    features, classes = [], []
    for lap_frame in range(2 * len(stream)):
        picture = stream[lap_frame % len(stream)]
        moving = np.argwhere(picture.moves)
        if not len(moving):
            continue
        moved = int(picture.classes[tuple(moving[0])])
        frames = given.setdefault(moved, [])
        if len(frames) == LABELS or (frames and frames[-1] + APART >= lap_frame):
            continue
        frames.append(lap_frame)
        centre = np.round(moving.mean(axis=0))
        row, column = moving[np.argmin(np.linalg.norm(moving - centre, axis=1))]
        features.append(picture.features[row * picture.moves.shape[1] + column])
        classes.append(moved)
    return Labels(np.array(features), np.array(classes))


def drawn_labels(pictures: Sequence[Picture], count: int, rng: np.random.Generator) -> Labels:
    """Label pixels of what moves, drawn at random."""
    features, classes = [], []
    background = count - 1
    of_class: dict[int, list[int]] = {}
    for index, picture in enumerate(pictures):
        moved = picture.classes[picture.moves]
        for found in np.unique(moved[moved != background]):
            of_class.setdefault(int(found), []).append(index)
    for found, indices in sorted(of_class.items()):
        for index in rng.choice(indices, LABELS, replace=len(indices) < LABELS):
            picture = pictures[index]
            of_it = np.flatnonzero(picture.moves & (picture.classes == found))
            features.append(picture.features[rng.choice(of_it)])
            classes.append(found)
    return Labels(np.array(features), np.array(classes))


def best_f1(
    pictures: Sequence[Picture], labels: Labels, count: int, thresholds: Sequence[float]
) -> tuple[float, NDArray[np.float64]]:
    """Return the best mean F1 over thresholds, and the F1 (count,) of each class there."""
    found = np.zeros((len(thresholds), count, count))
    for picture in pictures:
        distances = ((picture.features[:, None] - labels.features) ** 2).sum(axis=2)
        nearest = distances.argmin(axis=1)
        least = distances[np.arange(len(nearest)), nearest]
        true = picture.classes.reshape(-1).astype(np.int64) * count
        for row, threshold in enumerate(thresholds):
            told = np.where(least <= threshold, labels.classes[nearest], count - 1)
            found[row] += np.bincount(true + told, minlength=count**2).reshape(count, count)
    hits = np.diagonal(found, axis1=1, axis2=2)
    f1 = 2 * hits / np.maximum(found.sum(axis=1) + found.sum(axis=2), 1)
    best = f1[f1.mean(axis=1).argmax()]
    return float(best.mean()), best


def main() -> None:
    """Run and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--stream", required=True, choices=("empty_space", "solid", "living_room"))
    parser.add_argument("--drawings", type=int, default=50)
    parser.add_argument("--every", type=int, default=10, help="frames of which one is classified")
    options = parser.parse_args()
    normalised = options.stream == "empty_space"
    stream = LveStream(options.folder, grey=options.stream == "solid", normalised=normalised)
    count, thresholds = len(stream.names), NORMALISED if normalised else PLAIN
    pictures = [stream[index] for index in range(0, len(stream), options.every)]
    mean, of_class = best_f1(pictures, labels_of_policy(stream), count, thresholds)
    told = ", ".join(f"{name} {f1:.3f}" for name, f1 in zip(stream.names, of_class, strict=True))
    print(f"labels of their policy: F1 {mean:.3f} ({told})")
    rng = np.random.default_rng(0)
    drawn = [
        best_f1(pictures, drawn_labels(pictures, count, rng), count, thresholds)[0]
        for _ in range(options.drawings)
    ]
    low, middle, high = np.percentile(drawn, (10, 50, 90))
    print(
        f"{options.drawings} drawings: F1 {np.mean(drawn):.3f} ± {np.std(drawn):.3f},"
        f" median {middle:.3f}, 10 to 90 %: {low:.3f} to {high:.3f}"
    )


if __name__ == "__main__":
    main()
