"""Light on and by what can move, kept on disk: what follows from a bake and from places alone."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import fields

import numpy as np

from sailenv_ros.light.relight.baked_scene import BakedScene, albedo_of_model
from sailenv_ros.light.relight.object_light import Place
from sailenv_ros.native.library import native_library
from sailenv_ros.system.array_cache import Arrays, cached_arrays, code_digest
from sailenv_ros.types.baked_light import ObjectLight
from sailenv_ros.types.digests import model_digest

__all__ = ["kept_light", "stacked", "unstacked"]

_ARRAYS = tuple(field.name for field in fields(ObjectLight))

_OF_VERTICES = ("found", "fitted")
"""Arrays whose second side is an object's own: they are joined along it."""


def kept_light(
    kind: str,
    scene: BakedScene,
    places: Iterable[Sequence[Place]],
    find: Callable[[], Arrays],
    *,
    keep: bool = True,
) -> Arrays:
    """Return what was found in a scene as it was baked; see `cached_arrays`.

    Parameters
    ----------
    kind : str
        Of light.
    scene : BakedScene
        Of a bake that is kept itself: it has a checksum.
    places : iterable of sequence of Place
        All that it depends on beside the scene.
    find : callable
    keep : bool
    """
    told = [[_told(place) for place in one] for one in places]
    code = code_digest("light/bake", "light/relight", "native", "rays", "types")
    key = scene.baked.checksum, native_library().digest, *scene.drawn, *told
    return cached_arrays(kind, key, find, code=code, keep=keep)


def stacked(light: Sequence[ObjectLight]) -> Arrays:
    """Return the light on objects of one scene, of one or more, as arrays."""
    arrays = {
        name: np.stack([getattr(one, name) for one in light])
        for name in _ARRAYS
        if name not in _OF_VERTICES
    }
    layers = len(light[0].direct)
    for name in _OF_VERTICES:
        each = [getattr(one, name).reshape(layers, -1, 2) for one in light]
        arrays[name] = np.concatenate(each, axis=1)
    arrays["vertices"] = np.array([one.found.shape[1] for one in light])
    return arrays


def unstacked(arrays: Arrays) -> list[ObjectLight]:
    """Return the light on objects of `stacked`."""
    ends = np.cumsum(arrays["vertices"])[:-1]
    columns = (
        np.split(arrays[name], ends, axis=1) if name in _OF_VERTICES else arrays[name]
        for name in _ARRAYS
    )
    each = zip(*columns, strict=True)
    return [ObjectLight(**dict(zip(_ARRAYS, one, strict=True))) for one in each]


def _told(place: Place) -> tuple[object, ...]:
    """Return what light depends on of an object at a place, as it is told between processes."""
    id_, model, scale, pose = place
    return id_, scale, pose, model_digest(model), albedo_of_model(model).tolist()
