"""Error of the bounced light of a bake, against one with many more rays.

    python benchmarks/bake_error.py [--scene NAME ...] [--rays N]

Both have the same texels. Errors are those of luminance, relative to the bake with more rays, at
texels that have at least a twentieth of the mean. No light is read from the cache or written to it.
"""

from __future__ import annotations

import argparse
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.light.bake.pipeline import bake
from sailenv_ros.light.bake.settings import BakeSettings
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.types.baked_light import BakedLight
from sailenv_ros.types.colour import LUMINANCE

PASS_RAYS = 256
LEAST = 0.05
PERCENTILES = (50, 95, 99)


def bounced(light: BakedLight) -> NDArray[np.float64]:
    """Return (H, W): the luminance of all bounced light, as bright as the lights are."""
    total = np.zeros(light.layers[0].direct.shape)
    for layer in light.layers:
        one = layer.light
        colour = np.ones(3) if one is None else np.asarray(one.colour) * one.intensity
        total += layer.bounced.astype(np.float64) @ (LUMINANCE * colour)
    return total


def main() -> None:
    """Print a line for each scene."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--scene", action="append", help="room_03 by default; may be repeated")
    parser.add_argument("--rays", type=int, default=1024, help="of the bake that is believed")
    arguments = parser.parse_args()
    many = replace(BakeSettings(), rays=arguments.rays, pass_rays=PASS_RAYS)
    for scene in arguments.scene or ["room_03"]:
        snapshot = SceneLibrary().snapshot(scene)
        seen, wanted = bounced(bake(snapshot)), bounced(bake(snapshot, settings=many))
        counted = wanted >= LEAST * wanted[wanted > 0.0].mean()
        error = np.abs(seen[counted] / wanted[counted] - 1.0)
        parts = ", ".join(f"{p}th {np.percentile(error, p):.1%}" for p in PERCENTILES)
        print(
            f"{scene}: error of bounced light beside {arguments.rays} rays at {counted.sum()} "
            f"texels: mean {error.mean():.1%}, percentiles {parts}; "
            f"bias {seen[counted].sum() / wanted[counted].sum() - 1.0:+.2%}",
            flush=True,
        )


if __name__ == "__main__":
    main()
