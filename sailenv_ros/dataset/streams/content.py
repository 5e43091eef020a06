"""Fingerprints of the light and the models of a stream's scene."""

from __future__ import annotations

import hashlib
from pathlib import Path

from sailenv_ros.light.bake.fingerprint import fingerprint
from sailenv_ros.simulation.finished_light import bake_missing
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.types.light_choice import SteadyLight

__all__ = ["PLAIN", "scene_content"]

PLAIN = "plain"
"""Stands for light that is not baked."""


def scene_content(scene: Path, seed: int, light: SteadyLight) -> dict[str, str]:
    """Return fingerprints of a scene's light and models; bake the light that is not there yet.

    Parameters
    ----------
    scene : Path
    seed : int
        Of the simulation.
    light : {'baked', 'plain'}

    Raises
    ------
    SailenvError
        If the scene cannot be built, or its light not be baked.
    """
    library = SceneLibrary(baked_light=light != PLAIN, drafts=False)
    world = library.build(scene, seed, epoch=1)
    try:
        if light != PLAIN:
            bake_missing(world)
        # Of all that stands still, materials and lights too.
        models = hashlib.blake2b(fingerprint(world.snapshot()).encode(), digest_size=16)
        baked = world.contents.baked
    finally:
        world.close()
    for name in sorted({entry.asset for entry in library.load(scene).objects}):
        asset = library.canonical_asset(name)
        models.update(f" {asset} {library.asset_fingerprint(asset)}".encode())
    return {"light": PLAIN if baked is None else baked.fingerprint, "models": models.hexdigest()}
