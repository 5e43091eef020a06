"""Scenes drawn at random: epochs by seed and index, and a frame made again from its record.

Run it with: python examples/13_randomise.py [FOLDER]    (it writes PNG files there)
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from PIL import Image

from sailenv_ros import Simulation


def main() -> None:
    """Draw four scenes, save their pictures, and make the second again."""
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else ".")
    frames = []
    with Simulation("random_shapes", mode="lockstep") as simulation:
        for index in range(4):
            simulation.randomise(seed=7, index=index)
            frame = simulation.capture(["rgb", "instance"], agent="eye")
            frames.append(frame)
            Image.fromarray(frame["rgb"]).save(folder / f"random_{index}.png")
            names = [instance.name for instance in simulation.info.instances]
            print(f"epoch {index}: {', '.join(names)}")

        record = frames[1].randomised
        simulation.randomise(record=record)
        again = simulation.capture(["rgb", "instance"], agent="eye")
        same = all(np.array_equal(again[view], frames[1][view]) for view in ("rgb", "instance"))
        print(f"the second frame, made again from its record, has the same bytes: {same}")


if __name__ == "__main__":
    main()
