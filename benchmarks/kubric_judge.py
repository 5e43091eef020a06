"""Runs Kubric's point tracker on arrays: kubric_judge.py DATASET.PY GIVEN.npz TAKEN.npz.

Runs in an interpreter with TensorFlow, without this package; `motion_judges.py` starts it. Of what
Kubric's module imports, what its tracker does not use is left out.
"""

from __future__ import annotations

import importlib.util
import sys
import types
from typing import Any

import numpy as np
import tensorflow as tf


def from_quaternion(quaternion: Any) -> Any:
    """Return the rotation matrix of x, y, z, w, as tensorflow_graphics does."""
    x, y, z, w = tf.unstack(quaternion, axis=-1)
    return tf.stack(
        [
            tf.stack([1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)]),
            tf.stack([2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)]),
            tf.stack([2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]),
        ]
    )


def load(path: str) -> Any:
    """Load Kubric's module."""
    names = ["matplotlib", "matplotlib.pyplot", "mediapy", "tensorflow_datasets"]
    names += ["tensorflow_graphics", "tensorflow_graphics.geometry"]
    names += ["tensorflow_graphics.geometry.transformation"]
    for name in names:
        sys.modules[name] = types.ModuleType(name)
    sys.modules["matplotlib"].pyplot = sys.modules["matplotlib.pyplot"]  # type: ignore[attr-defined]
    turning = types.ModuleType("rotation_matrix_3d")
    turning.from_quaternion = from_quaternion  # type: ignore[attr-defined]
    transformation = sys.modules["tensorflow_graphics.geometry.transformation"]
    transformation.rotation_matrix_3d = turning  # type: ignore[attr-defined]
    spec = importlib.util.spec_from_file_location("kubric_dataset", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def main(path: str, given: str, taken: str) -> None:
    """Track."""
    module = load(path)
    with np.load(given) as arrays:
        a = {name: tf.convert_to_tensor(arrays[name]) for name in arrays.files}
    height, width = a["segmentations"].shape[1:3]
    tf.random.set_seed(0)
    queries, places, hidden, *_ = module.track_points(
        *(a["object_coordinates"], a["depth"], a["depth_range"], a["segmentations"]),
        *(tf.cast(a["normal"], tf.float32), a["bboxes_3d"], a["quaternions"]),
        *(a["focal_length"], a["camera_positions"], a["camera_quaternions"], a["sensor_width"]),
        tf.constant([0, 0, height, width]),
    )
    np.savez(taken, queries=queries.numpy(), places=places.numpy(), hidden=hidden.numpy())


if __name__ == "__main__":
    main(*sys.argv[1:])
