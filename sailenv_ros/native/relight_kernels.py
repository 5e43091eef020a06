"""Changes of baked light by moved things, by src/kernels/relight_*.cpp.

See `light.relight.relighting`.

Arrays of structures hold addresses; the caller keeps what they point to alive.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.bake_types import Record
from sailenv_ros.native.library import Kernel, checked
from sailenv_ros.native.ray_types import RAY_INSTANCE, RAY_LIGHT
from sailenv_ros.native.relight_types import HalfMaps, MappedTexels, PatchMap

__all__ = [
    "gather_change",
    "gather_probe_change",
    "light_of_probes",
    "direct_light_delta",
    "reached_points",
    "smooth_change",
    "spread_change",
]

Floats = NDArray[np.float32]

_GATHER = Kernel("gather_change", "iaaa")
_REACHED = Kernel("reached_points", "iaiaaaniaa")
_SMOOTH = Kernel("smooth_change", "iaiiaaiaaa")
_PROBES = Kernel("gather_probe_change", "iaiaiaiaa")
_DELTA = Kernel("direct_light_delta", "iaaiaaaaaiaaaa")
_INTERPOLATE = Kernel("light_of_probes", "iiiiiaaaiaaa")
_SPREAD = Kernel("spread_change", "iaaaaa")


MOST_CHANGED = 0.25
"""Share of a patch's rays beyond which little of what was baked is of use."""


def gather_change(
    scene: NDArray[np.void],
    positions: Floats,
    normals: Floats,
    wanted: NDArray[np.uint8],
    pattern: Floats,
    area_lights: NDArray[np.void],
    shot_pattern: Floats,
    least: float,
    *,
    inside_share: float,
    most_changed: float = MOST_CHANGED,
    numbers: NDArray[np.uint32] | None = None,
    own: NDArray[np.void] | None = None,
    threads: int,
) -> tuple[NDArray[np.uint8], Floats, Floats, Floats]:
    """Gather what arrives at patches from others, and straight from area lights.

    Parameters
    ----------
    scene : (1,) RAY_SCENE
    positions, normals : (P, 3) float32
        World frame [m].
    wanted : (P,) uint8
        0 nothing, 1 the change, 2 all of the light.
    pattern, shot_pattern : (M, 2) float32
        Points of the unit square, for rays to everywhere and to each light.
    area_lights : (A,) RAY_LIGHT
    least : float
        Patches of whose view changed things may take less than this share are skipped.
    inside_share : float
        A patch that sees more backs of surfaces than this share lies inside of something.
    most_changed : float
        Where more of the rays than this share meet a change, all of the light is gathered.
    numbers : (P,) uint32 or None
        Seeds of the patches' random numbers; None counts from 0.
    own : (1,) RAY_INSTANCE or None
        What the points lie on, if that was not baked: it takes light from what is near.

    Returns
    -------
    found : (P,) uint8
        0 nothing has changed, 1 the change was found, 2 all of the light, 3 nothing can be known
        because the patch lies inside of something.
    change : (P, C) float32
        Irradiance / pi.
    direct : (P, A) float32
        The same from each area light, for white light of radiance 1.
    nearness : (P,) float32
        Harmonic mean of the distances of what was looked at [m].
    """
    count, channels = len(positions), int(scene["channels"][0])
    rays, lights, shots = len(pattern), len(area_lights), len(shot_pattern)
    asked: dict[str, NDArray[Any] | None] = {
        "positions": checked("positions", positions, np.float32, (None, 3)),
        "normals": checked("normals", normals, np.float32, (count, 3)),
        "wanted": checked("wanted", wanted, np.uint8, (count,)),
        "numbers": _numbers(numbers, count),
        "pattern": checked("pattern", pattern, np.float32, (rays, 2)),
        "lights": checked("area lights", area_lights, RAY_LIGHT, (lights,)),
        "shot_pattern": checked("pattern of shots", shot_pattern, np.float32, (shots, 2)),
        "own": None if own is None else checked("own", own, RAY_INSTANCE, (1,)),
    }
    counts = {"count": count, "rays": rays, "light_count": lights, "shots": shots}
    shares = {"least": least, "most_changed": most_changed, "inside_share": inside_share}
    query = Record(asked, {**counts, **{name: float(share) for name, share in shares.items()}})
    found, nearness = np.zeros(count, np.uint8), np.zeros(count, np.float32)
    change = np.zeros((count, channels), np.float32)
    direct = np.zeros((count, lights), np.float32)
    result = Record({"found": found, "bounced": change, "direct": direct, "nearness": nearness}, {})
    _GATHER(threads, scene, query.record, result.record)
    return found, change, direct, nearness


def smooth_change(
    patches: PatchMap,
    radius: int,
    found: NDArray[np.uint8],
    nearness: Floats,
    change: Floats,
    *,
    step: int = 4,
    threads: int,
) -> tuple[NDArray[np.uint8], Floats]:
    """Average what was found over neighbouring patches, up to `radius` of them to each side.

    Parameters
    ----------
    patches : PatchMap
    found : (P,) uint8
    nearness : (P,) float32
    change : (P, C) float32
    step : int
        Texels from one to the next; 1 where each texel is a patch of its own.

    Returns
    -------
    found : (P,) uint8
    change : (P, C) float32
    """
    checked("found", found, np.uint8, (patches.count,))
    checked("nearness", nearness, np.float32, (patches.count,))
    checked("change", change, np.float32, (patches.count, None))
    smooth_found, smooth = np.zeros_like(found), np.zeros_like(change)
    if change.size:
        _SMOOTH(
            threads, patches.record, radius, step, found, nearness, change.shape[1], change,
            smooth_found, smooth,
        )  # fmt: skip
    return smooth_found, smooth


def gather_probe_change(
    scene: NDArray[np.void],
    positions: Floats,
    directions: Floats,
    *,
    with_far: bool = True,
    threads: int,
) -> tuple[Floats, Floats]:
    """Gather the change of light at points in the air.

    Parameters
    ----------
    scene : (1,) RAY_SCENE
    positions, directions : (N, 3), (M, 3) float32
        World frame [m].
    with_far : bool
        False leaves `far` at 0, which saves nearly all the work.

    Returns
    -------
    far, near : (N, 4, C) float32
        As in `LightLayer.probe_bounced`: by rays that meet the same surface before and after, and
        by the others.
    """
    count, channels = len(positions), int(scene["channels"][0])
    checked("positions", positions, np.float32, (None, 3))
    checked("directions", directions, np.float32, (None, 3))
    far = np.zeros((count, 4, channels), np.float32)
    near = np.zeros_like(far)
    _PROBES(threads, scene, count, positions, len(directions), directions, int(with_far), far, near)
    return far, near


def direct_light_delta(
    scene: NDArray[np.void],
    light: NDArray[np.void],
    positions: Floats,
    normals: Floats,
    patch_of_texel: NDArray[np.int32],
    found: NDArray[np.uint8],
    pattern: Floats,
    *,
    numbers: NDArray[np.uint32] | None = None,
    threads: int,
) -> tuple[NDArray[np.uint8], Floats, Floats]:
    """Find what changes of one light's direct part at texels; `numbers` as in `gather_change`.

    Returns
    -------
    state : (N,) uint8
        0 nothing, 1 the numbers are to be added, 2 they are all of it.
    direct : (N,) float32
        Irradiance / pi.
    share : (N,) float32
        Of the light's rays that arrive.
    """
    count = len(positions)
    checked("positions", positions, np.float32, (None, 3))
    checked("normals", normals, np.float32, (count, 3))
    checked("patches of texels", patch_of_texel, np.int32, (count,))
    checked("found", found, np.uint8, (int(scene["patch_count"][0]),))
    state = np.zeros(count, np.uint8)
    direct, share = np.zeros(count, np.float32), np.zeros(count, np.float32)
    _DELTA(
        threads, scene, light, count, positions, normals, patch_of_texel, _numbers(numbers, count),
        found, len(pattern), pattern, state, direct, share,
    )  # fmt: skip
    return state, direct, share


def reached_points(
    scene: NDArray[np.void],
    positions: Floats,
    normals: Floats,
    margins: Floats,
    lights: NDArray[np.void],
    *,
    least: float,
    threads: int,
) -> NDArray[np.uint8]:
    """Find at which points what changes may change the light.

    Parameters
    ----------
    margins : (N,) float32
        What is within this distance of a point, or of its way to a light, counts [m].
    lights : (L,) RAY_LIGHT
    least : float
        Things that may take less of a point's view than this share do not.

    Returns
    -------
    found : (N,) uint8
        1 in its view, 2 only between it and a light, 0 neither.
    """
    count = len(positions)
    checked("positions", positions, np.float32, (None, 3))
    checked("normals", normals, np.float32, (count, 3))
    checked("margins", margins, np.float32, (count,))
    checked("lights", lights, RAY_LIGHT, (None,))
    found = np.zeros(count, np.uint8)
    _REACHED(
        threads, scene, count, positions, normals, margins, least, len(lights), lights, found
    )  # fmt: skip
    return found


def light_of_probes(
    probes: Floats,
    origin_m: tuple[float, float, float],
    spacing_m: tuple[float, float, float],
    positions: Floats,
    normals: Floats,
    *,
    threads: int,
) -> Floats:
    """Return (N, C) float32: what (Z, Y, X, 4, C) probes say of surfaces; may be below 0."""
    depth, rows, columns, four, channels = probes.shape
    checked("probes", probes, np.float32, (depth, rows, columns, 4, channels))
    checked("positions", positions, np.float32, (None, 3))
    checked("normals", normals, np.float32, (len(positions), 3))
    assert four == 4
    result = np.zeros((len(positions), channels), np.float32)
    _INTERPOLATE(
        threads, depth, rows, columns, channels, probes, np.array(origin_m, np.float32),
        np.array(spacing_m, np.float32), len(positions), positions, normals, result,
    )  # fmt: skip
    return result


def spread_change(
    texels: MappedTexels,
    patches: PatchMap,
    found: NDArray[np.uint8],
    change: Floats,
    layers: list[NDArray[np.float16]],
    *,
    threads: int,
) -> None:
    """Bring the texels of layers up to date with what was found at patches.

    Parameters
    ----------
    texels : MappedTexels
    patches : PatchMap
    found : (P,) uint8
    change : (P, C) float32
        What was found: the layers' channels in their order.
    layers : list of (side, side, 3) or (side, side) float16
        At least one; written to.
    """
    maps = HalfMaps(layers, patches.side)
    checked("found", found, np.uint8, (patches.count,))
    checked("change", change, np.float32, (patches.count, maps.channels))
    _SPREAD(threads, texels.record, patches.record, found, change, maps.record)


def _numbers(numbers: NDArray[np.uint32] | None, count: int) -> NDArray[np.uint32]:
    if numbers is None:
        return np.arange(count, dtype=np.uint32)
    return checked("numbers", numbers, np.uint32, (count,))
