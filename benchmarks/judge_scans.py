"""Has KISS-ICP find the ways of a robot by its laser scans alone.

    python -m benchmarks.judge_navigation 20 --scans scans.npz
    python -m venv judge && judge/bin/pip install kiss-icp
    judge/bin/python benchmarks/judge_scans.py scans.npz

Prints for each apartment how far the way that it found is from the true one, by the length of it.
Runs without sailenv_ros.
"""

from __future__ import annotations

import sys

import numpy as np
from kiss_icp.config import KISSConfig
from kiss_icp.kiss_icp import KissICP

HEIGHTS = np.arange(-0.2, 0.21, 0.1)
"""A flat scan says nothing of heights: it is repeated, as if walls were upright [m]."""


def way(ranges: np.ndarray) -> np.ndarray:
    """Return (N, 2): places that KISS-ICP finds, from the first one."""
    config = KISSConfig()
    config.data.max_range, config.data.min_range, config.data.deskew = 12.0, 0.1, False
    config.mapping.voxel_size = 0.1
    icp = KissICP(config)
    angles = -np.pi + 2.0 * np.pi / ranges.shape[1] * np.arange(ranges.shape[1])
    places = []
    for one in ranges:
        met = np.isfinite(one)
        flat = np.stack([one[met] * np.cos(angles[met]), one[met] * np.sin(angles[met])], axis=1)
        points = np.concatenate([np.column_stack([flat, np.full(len(flat), z)]) for z in HEIGHTS])
        icp.register_frame(points.astype(np.float64), np.zeros(len(points)))
        places.append(icp.last_pose[:2, 3])
    return np.array(places)


def main(file: str) -> int:
    """Compare; 0 if every way is within 2 % of its length, or 5 cm."""
    kept = np.load(file)
    good = True
    for scene in dict.fromkeys(kept["scene"].tolist()):
        own = kept["scene"] == scene
        ranges, place = kept["ranges"][own], kept["place"][own]
        fresh = np.ones(len(ranges), bool)
        fresh[1:] = [not np.array_equal(a, b) for a, b in zip(ranges[1:], ranges[:-1], strict=True)]
        ranges, place = ranges[fresh], place[fresh]
        x, y, yaw = place[0]
        turn = np.array([[np.cos(yaw), np.sin(yaw)], [-np.sin(yaw), np.cos(yaw)]])
        true = (place[:, :2] - (x, y)) @ turn.T
        error = np.linalg.norm(way(ranges) - true, axis=1)
        length = float(np.linalg.norm(np.diff(true, axis=0), axis=1).sum())
        good &= bool(error.max() <= max(0.05, 0.02 * length))
        print(
            f"{scene}: {length:.1f} m, off by {error.max():.3f} m at most, {error[-1]:.3f} at last"
        )
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
