"""Names a scene by everything its baked light depends on. From `WorldSnapshot` to a hash."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable
from dataclasses import asdict

from sailenv_ros.light.bake.settings import BAKE_VERSION, BakeSettings
from sailenv_ros.rays.mirror_faces import CATEGORY as MIRROR
from sailenv_ros.types.digests import add_array, model_digest
from sailenv_ros.types.lights import Environment, Light
from sailenv_ros.types.snapshot import WorldSnapshot

__all__ = ["fingerprint"]

_NOT_BAKED = ("colour", "intensity", "indirect_multiplier")
"""Properties of lights that are not baked: each light has a layer of its own, which they scale."""


def fingerprint(snapshot: WorldSnapshot, settings: BakeSettings | None = None) -> str:
    """Return 32 hexadecimal digits, alike for two snapshots whose baked light is alike."""
    contents = snapshot.contents
    digest = hashlib.blake2b(digest_size=16)
    _add(digest, [BAKE_VERSION, asdict(settings or BakeSettings())])
    _add(digest, [_light(light) for light in contents.lights])
    _add_sky(digest, contents.environment)
    for drawn, pose in zip(contents.instances, snapshot.world_from_body, strict=True):
        if drawn.is_baked:
            _add(digest, [drawn.instance.id, list(drawn.scale), list(drawn.lit_by)])
            _add(digest, [drawn.instance.category == MIRROR])
            add_array(digest, pose)
            digest.update(model_digest(drawn.model))
    return digest.hexdigest()


def _add(digest: hashlib.blake2b, values: Iterable[object]) -> None:
    digest.update(json.dumps(list(values), sort_keys=True).encode())


def _light(light: Light) -> dict[str, object]:
    return {name: value for name, value in asdict(light).items() if name not in _NOT_BAKED}


def _add_sky(digest: hashlib.blake2b, environment: Environment) -> None:
    if environment.background == "colour":
        _add(digest, ["colour", environment.background_colour])
    elif environment.sky is not None:
        add_array(digest, environment.sky.radiance)
    else:
        _add(
            digest,
            [environment.sky_zenith, environment.sky_horizon, environment.sky_ground],
        )
