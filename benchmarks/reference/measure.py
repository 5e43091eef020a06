"""Similarity of two pictures: SSIM, PSNR, FLIP, objects' colours. Runs in the tracer's environment.

    measure.py PAIRS.npz

The file holds ``ours_NAME`` and ``reference_NAME``, (H, W, 3) uint8 each, and may hold
``regions_NAME`` and ``objects_NAME``, (H, W); a JSON object by name is printed.
"""

from __future__ import annotations

import json
import sys
from typing import Any

import flip_evaluator
import numpy as np
from numpy.typing import NDArray
from skimage.color import deltaE_ciede2000, rgb2xyz, xyz2lab
from skimage.metrics import peak_signal_noise_ratio, structural_similarity

LEAST_PX = 150
"""Objects that cover fewer pixels are not measured."""


def differences_of_objects(
    ours: NDArray[np.uint8], reference: NDArray[np.uint8], ids: NDArray[Any]
) -> list[dict[str, Any]]:
    """Return what is known of the mean colours (CIE XYZ, D65) of each object but 0.

    Its id, pixels, ΔE2000, and ours less the reference's lightness, chroma and hue (CIE L*C*H*).
    """
    first, second = rgb2xyz(ours), rgb2xyz(reference)
    found = []
    for number, count in zip(*np.unique(ids[ids > 0], return_counts=True), strict=True):
        if count < LEAST_PX:
            continue
        own = ids == number
        means = [xyz2lab(xyz[own].mean(axis=0)) for xyz in (first, second)]
        parts = dict(zip(("lightness", "chroma", "hue"), _parts(*means), strict=True))
        difference = float(deltaE_ciede2000(*means))
        found.append({"id": int(number), "pixels": int(count), "delta_e": difference, **parts})
    return found


def _parts(ours: NDArray[np.float64], reference: NDArray[np.float64]) -> tuple[float, ...]:
    """Return by how much L*, C* and H* of the first of two colours in CIE L*a*b* are larger."""
    (_, a, b), (_, c, d) = ours, reference
    first, second = np.hypot(a, b), np.hypot(c, d)
    across = np.sqrt(max(2.0 * (first * second - a * c - b * d), 0.0))
    return (
        float(ours[0] - reference[0]),
        float(first - second),
        float(np.copysign(across, b * c - a * d)),
    )


def measured(
    ours: NDArray[np.uint8], reference: NDArray[np.uint8], regions: NDArray[np.uint8] | None
) -> dict[str, Any]:
    """Measure one pair; SSIM with the Gaussian window of its paper, mean over the channels.

    ``lost`` and ``flip_lost`` are the parts of 1 - SSIM and of FLIP that come from the pixels of
    each region, by its number.
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
    flips, flip, _ = flip_evaluator.evaluate(first, second, "LDR", applyMagma=False)
    lost = 1.0 - similarities.mean(axis=-1)
    return {
        "lost": [] if regions is None else _by_region(lost, regions),
        "flip_lost": [] if regions is None else _by_region(np.asarray(flips)[..., 0], regions),
        "ssim": float(similarity),
        "psnr_db": float(peak_signal_noise_ratio(reference, ours, data_range=255)),
        "flip": float(flip),
    }


def _by_region(map_: NDArray[Any], regions: NDArray[np.uint8]) -> list[float]:
    """Return the parts of a map's mean by region; there are four."""
    return [float(part) for part in np.bincount(regions.ravel(), map_.ravel(), 4) / map_.size]


def main() -> None:
    """Measure all pairs of a file."""
    pairs: Any = np.load(sys.argv[1])
    given = set(pairs.files)
    names = [key.removeprefix("ours_") for key in pairs.files if key.startswith("ours_")]
    result = {
        name: measured(
            pairs[f"ours_{name}"],
            pairs[f"reference_{name}"],
            pairs[f"regions_{name}"] if f"regions_{name}" in given else None,
        )
        for name in names
    }
    for name in names:
        if f"objects_{name}" in given:
            pair = pairs[f"ours_{name}"], pairs[f"reference_{name}"]
            result[name]["objects"] = differences_of_objects(*pair, pairs[f"objects_{name}"])
    print(json.dumps(result))


if __name__ == "__main__":
    main()
