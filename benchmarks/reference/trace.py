"""Traces the views of a job with Mitsuba 3, in the environment that `setup` makes.

    trace.py JOB.json

A job names a scene of `export`, the folder of its parts, and views with the file each is to be
written to. Each file (.npz) holds linear radiance before and after denoising, and what is known of
the noise. Nothing here knows sailenv_ros.
"""

from __future__ import annotations

import json
import os
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

PASS_SAMPLES = 32
"""Samples per pixel that are traced at once: memory grows with them."""

GUIDE_PASSES, GUIDE_SEED = 8, 100
"""Passes and seed of the pictures that guide the denoiser, enough to be free of noise: with 16
samples the denoiser did not trust them, and blurred edges and textures."""

MOSTLY_CLEAR, ALL = 0.2, 2.0
"""Faces of a lower opacity do not guide the denoiser: what lies behind them does. Of others both
do, by half each: guided by a net curtain alone, it blurs the window behind."""

_GUIDES = {"type": "aov", "aovs": "albedo:albedo,normal:sh_normal"}

Dict = dict[str, Any]
Image = NDArray[np.float32]


def use_llvm() -> None:
    """Point Mitsuba's compiler to the LLVM that was fetched beside this environment."""
    beside = sorted(Path(sys.prefix).parent.glob("llvm/usr/lib/*/libLLVM.so.*"))
    if beside:
        os.environ.setdefault("DRJIT_LIBLLVM_PATH", str(beside[-1]))


use_llvm()

import mitsuba as mi  # noqa: E402

mi.set_variant("llvm_ad_rgb")

import pyoidn  # noqa: E402

sys.path.insert(0, str(Path(__file__).parent))
import lit_surface  # noqa: E402
import reference_lamps as lamps  # noqa: E402
import see_through  # noqa: E402


def loaded(description: Any, parts: Path) -> Any:
    """Turn what `export` wrote into what Mitsuba loads: arrays, file names, transforms."""
    if not isinstance(description, dict):
        return description
    made = {key: loaded(value, parts) for key, value in description.items()}
    if "to_world" in made:
        made["to_world"] = mi.ScalarTransform4f(np.asarray(made["to_world"]))
    if "filename" in made:
        made["filename"] = str(parts / made["filename"])
    if "array" in made:
        made["bitmap"] = mi.Bitmap(np.load(parts / made.pop("array")))
    return made


def traced(scene: Any, solids: list[Any], sensor: Any, samples: int) -> dict[str, Image]:
    """Trace one view; the two halves of its samples tell how noisy it is.

    What guides the denoiser is the mean of what is seen in `solids`, the scene without its glass:
    it would blur what lies behind.
    """
    seen = mi.load_dict(_GUIDES)
    guides = np.mean(
        [
            _shot(solids[number % len(solids)], sensor, seen, PASS_SAMPLES, GUIDE_SEED + number)
            for number in range(GUIDE_PASSES)
        ],
        axis=0,
    )
    halves: list[list[Image]] = [[], []]
    for number in range(max(2, round(samples / PASS_SAMPLES))):
        shot = _shot(scene, sensor, scene.integrator(), PASS_SAMPLES, number)
        halves[number % 2].append(shot[..., :3])
    first, second = (np.mean(half, axis=0) for half in halves)
    mean = np.mean([*halves[0], *halves[1]], axis=0)
    clean, clean_first, clean_second = (
        denoised(image, guides[..., :3], guides[..., 3:6]) for image in (mean, first, second)
    )
    return {
        "radiance": clean,
        "raw": mean,
        "halves": np.stack((clean_first, clean_second)),
        "noise": _noise(first, second),
        "noise_denoised": _noise(clean_first, clean_second),
    }


def without_glass(scene: Dict, opacity: float) -> Dict:
    """Return a scene without what is see-through and of a lower opacity."""
    return {name: part for name, part in scene.items() if not _is_clear(part, opacity)}


def _is_clear(part: Any, opacity: float) -> bool:
    surface = part.get("bsdf", {}) if isinstance(part, dict) else {}
    if surface.get("type") != "sailenv_see_through":
        return False
    return max(surface["opacity"]["value"]) < opacity


def _shot(scene: Any, sensor: Any, integrator: Any, samples: int, seed: int) -> Image:
    shot = mi.render(scene, sensor=sensor, integrator=integrator, spp=samples, seed=seed)
    return np.asarray(shot, dtype=np.float32)


def denoised(radiance: Image, albedo: Image, normal: Image) -> Image:
    """Denoise by Open Image Denoise, guided by what is seen first, which is without noise."""
    colour, first, second = (
        np.ascontiguousarray(np.nan_to_num(image), dtype=np.float32)
        for image in (radiance, np.clip(albedo, 0.0, 1.0), normal)
    )
    clean = pyoidn.denoise(colour, first, second, hdr=True, clean_aux=True)
    result: Image = np.maximum(clean, 0.0)
    return result


def _noise(first: Image, second: Image) -> Image:
    """Estimate the median over pixels of the mean's relative error from two halves."""
    light = np.maximum((first + second).mean(axis=-1) / 2.0, 1e-3)
    error = np.abs(first - second).mean(axis=-1) / 2.0
    return np.asarray(np.median(error / light), dtype=np.float32)


def run(job: Dict) -> None:
    """Trace what is wanted of one job."""
    lamps.register()
    lit_surface.register()
    see_through.register()
    parts = Path(job["parts"])
    began = time.monotonic()
    scene = mi.load_dict(loaded(job["scene"], parts))
    guiding = [without_glass(job["scene"], opacity) for opacity in (MOSTLY_CLEAR, ALL)]
    if guiding[0] == guiding[1]:
        guiding.pop()
    solids = [mi.load_dict(loaded(one, parts)) for one in guiding]
    print(f"{job['name']}: loaded in {time.monotonic() - began:.1f} s", flush=True)
    for view in job["views"]:
        began = time.monotonic()
        images = traced(scene, solids, mi.load_dict(loaded(view["sensor"], parts)), job["samples"])
        seconds = time.monotonic() - began
        target = Path(view["output"])
        part = target.with_suffix(".part.npz")
        np.savez_compressed(part, **images, seconds=np.float32(seconds), samples=job["samples"])
        part.rename(target)
        print(
            f"  {view['name']}: {seconds:.1f} s, median noise {images['noise']:.1%}, "
            f"{images['noise_denoised']:.1%} denoised",
            flush=True,
        )


if __name__ == "__main__":
    if sys.argv[1:] == ["--version"]:
        print(f"Mitsuba {mi.__version__}, {mi.variant()}, 1 + 1 = {(mi.Float(1) + 1)[0]:g}")
        sys.exit()
    run(json.loads(Path(sys.argv[1]).read_text(encoding="utf-8")))
