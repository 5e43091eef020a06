"""The protocol of raw pixels gives what arithmetic gives, on a stream of flat colours."""

from __future__ import annotations

import gzip
import json
from pathlib import Path

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from benchmarks.stream_raw_image import (
    PLAIN,
    LveStream,
    best_f1,
    drawn_labels,
    labels_of_policy,
)

FRAMES = 210
BOX, BALL, BACKGROUND = range(3)


def save(path: Path, array: NDArray[np.generic]) -> None:
    """Write an array as their files are."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with gzip.open(path, "wb") as file:
        np.save(file, array)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A box that moves in frames 0 to 104, then a ball: a left and a right column of 8 × 8 px."""
    classes = np.full((8, 8), BACKGROUND, np.uint8)
    classes[:, :2], classes[:, 6:] = BOX, BALL
    grey = np.choose(classes, np.array([0, 255, 128], np.uint8))
    names = {"box": BOX, "ball": BALL, "background": BACKGROUND}
    for index in range(FRAMES):
        place = Path("00000001", f"{index + 1:08d}")
        path = tmp_path / "frames" / place.with_suffix(".png")
        path.parent.mkdir(parents=True, exist_ok=True)
        cv2.imwrite(str(path), grey)
        moved = BOX if index < FRAMES // 2 else BALL
        motion = np.where(classes == moved, 1.5, 0.0).astype(np.float32)
        save(tmp_path / "motion" / f"{place}.bin", np.stack([motion, motion], axis=2))
        save(tmp_path / "sup" / f"{place}.targets.bin", classes.reshape(-1))
    (tmp_path / "sup" / "map.json").write_text(json.dumps(names))
    return tmp_path


def test_three_colours_are_told_apart(folder: Path) -> None:
    """Labels lie on what moves, over 100 frames apart; each pixel of each class is found."""
    stream = LveStream(folder, grey=True, normalised=False)
    assert stream.names == ["box", "ball", "background"]
    labels = labels_of_policy(stream)
    # Box in frames 0, 101 and, in the second lap, 210; ball in 105, 206 and 315.
    assert labels.classes.tolist() == [BOX, BOX, BALL, BALL, BOX, BALL]
    assert labels.features.tolist() == [[-2.0], [-2.0], [2.0], [2.0], [-2.0], [2.0]]
    mean, of_class = best_f1([stream[0]], labels, 3, PLAIN)
    assert (mean, of_class.tolist()) == (1.0, [1.0, 1.0, 1.0])


def test_a_label_of_the_background_s_colour_takes_the_background(folder: Path) -> None:
    """One label of 128 of a box: all 32 pixels of background are boxes, of which 16 are found."""
    stream = LveStream(folder, grey=True, normalised=False)
    labels = labels_of_policy(stream)
    labels.features[0] = stream[0].features[3]
    _, of_class = best_f1([stream[0]], labels, 3, PLAIN)
    assert of_class.tolist() == [2 * 16 / (16 + 48), 1.0, 0.0]


def test_drawn_labels_lie_on_what_moves(folder: Path) -> None:
    """Three of each object, none of the background."""
    stream = LveStream(folder, grey=True, normalised=False)
    pictures = [stream[index] for index in range(0, FRAMES, 10)]
    labels = drawn_labels(pictures, 3, np.random.default_rng(1))
    assert labels.classes.tolist() == [BOX] * 3 + [BALL] * 3
    assert labels.features[:, 0].tolist() == [-2.0] * 3 + [2.0] * 3
