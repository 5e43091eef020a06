"""Scores our Horn–Schunck on the first frames of a stream's bag, as `stream_judges.py` does theirs.

python benchmarks/stream_horn_schunck.py BAG --frames 20
"""

from __future__ import annotations

import argparse
from pathlib import Path

import cv2
import numpy as np

from sailenv_bench.experiments.horn_schunck import MOVING_PX, MotionScore, horn_schunck_flow
from sailenv_ros.recording.frames import RecordedFrames
from sailenv_ros.recording.reader import RecordingReader


def main() -> None:
    """Estimate, compare and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("bag", type=Path)
    parser.add_argument("--frames", type=int, default=20, help="default: %(default)s")
    options = parser.parse_args()
    score, before = MotionScore(), None
    with RecordingReader(options.bag) as reader:
        frames = RecordedFrames(reader, "")
        for number in range(min(options.frames, len(frames))):
            frame = frames[number]
            now = cv2.cvtColor(frame["rgb"], cv2.COLOR_RGB2GRAY).astype(np.float32)
            now /= np.float32(255.0)
            if before is not None:
                way = np.nan_to_num(frame["flow"]) * frame.dt_s
                moves = np.abs(way).max(axis=-1) > MOVING_PX
                score.add(before, now, horn_schunck_flow(before, now), moves)
            before = now
    accuracies = ", ".join(f"{one:.3f}" for one in score.accuracies)
    print(f"Motion-F1: {score.motion_f1:.3f}, reconstruction: {accuracies}")


if __name__ == "__main__":
    main()
