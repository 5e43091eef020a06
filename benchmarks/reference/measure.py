"""Similarity of two pictures: SSIM, PSNR, FLIP. Runs in the tracer's environment.

    measure.py PAIRS.npz

The file holds ``ours_NAME`` and ``reference_NAME``, (H, W, 3) uint8 each; a JSON object by name is
printed.
"""

from __future__ import annotations

import json
import sys
from typing import Any

import flip_evaluator
import numpy as np
from numpy.typing import NDArray
from skimage.metrics import peak_signal_noise_ratio, structural_similarity


def measured(
    ours: NDArray[np.uint8], reference: NDArray[np.uint8], regions: NDArray[np.uint8] | None
) -> dict[str, Any]:
    """Measure one pair; SSIM with the Gaussian window of its paper, mean over the channels.

    ``lost`` is the share of 1 - SSIM that comes from the pixels of each region, by its number.
    """
    similarity, similarities = structural_similarity(
        reference,
        ours,
        channel_axis=-1,
        data_range=255,
        gaussian_weights=True,
        sigma=1.5,
        use_sample_covariance=False,
        full=True,
    )
    first, second = (image.astype(np.float32) / 255.0 for image in (reference, ours))
    _, flip, _ = flip_evaluator.evaluate(first, second, "LDR", applyMagma=False)
    lost = (1.0 - similarities.mean(axis=-1)) / similarities[..., 0].size
    return {
        "lost": [] if regions is None else np.bincount(regions.ravel(), lost.ravel(), 4).tolist(),
        "ssim": float(similarity),
        "psnr_db": float(peak_signal_noise_ratio(reference, ours, data_range=255)),
        "flip": float(flip),
    }


def main() -> None:
    """Measure all pairs of a file."""
    pairs: Any = np.load(sys.argv[1])
    names = [key.removeprefix("ours_") for key in pairs.files if key.startswith("ours_")]
    result = {
        name: measured(
            pairs[f"ours_{name}"],
            pairs[f"reference_{name}"],
            pairs[f"regions_{name}"] if f"regions_{name}" in pairs.files else None,
        )
        for name in names
    }
    print(json.dumps(result))


if __name__ == "__main__":
    main()
