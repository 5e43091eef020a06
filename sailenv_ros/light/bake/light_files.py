"""Keeps baked light in the user's cache, by fingerprint. From `BakedLight` to a file and back.

A file is a line that names the format, a checksum of the rest, and arrays, each coded by
`array_coding`, as `np.savez` writes them. One that cannot be used counts as none: it is reported
once and baked again.
"""

from __future__ import annotations

import hashlib
import io
import json
import logging
import os
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import AbstractContextManager, suppress
from dataclasses import asdict, replace
from functools import partial
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.light.bake.array_coding import LEVEL, QUICK_LEVEL, coded, decoded
from sailenv_ros.system.files import (
    file_lock,
    make_folder,
    remove_unfinished,
    storage_errors,
    write_file,
    written_file,
)
from sailenv_ros.system.threads import thread_count
from sailenv_ros.system.user_folders import cache_folder, remove_oldest
from sailenv_ros.types.baked_light import (
    BakedLight,
    LightChart,
    LightLayer,
    ProbeGrid,
    SunEdges,
    Unwrapping,
)
from sailenv_ros.types.lights import Light

__all__ = [
    "baked_file",
    "damaged_light",
    "forget_oldest",
    "is_baked",
    "light_folder",
    "load_baked",
    "load_draft",
    "remember",
    "remembered",
    "store_baked",
    "store_draft",
]

FORMAT = 5
MAGIC = b"sailenv_ros baked light\n"
DIGEST_BYTES = 32

SUFFIX = ".light"

DRAFT_SUFFIX = ".draft"
"""Suffix of draft light: right but rough, used until the light itself is baked."""

MOST_BYTES = 4 << 30
"""Cache limit [bytes], about 100 rooms; least recently used entries are removed first."""

MOST_NOTES = 1024
"""Greatest number of notes that tell which light belongs to which scene file."""

_LAYER_ARRAYS = ("direct", "bounced", "probe_direct", "probe_bounced", "visibility")
_EDGE_ARRAYS = ("index", "blocks")
_CHART_ARRAYS = ("vertices", "triangles", "uvs")

_log = logging.getLogger(__name__)


def baked_file(fingerprint: str) -> Path:
    """Return the file for a fingerprint, whether it exists or not."""
    return light_folder() / f"{fingerprint}{SUFFIX}"


def light_folder() -> Path:
    """Return the folder of all baked light."""
    return cache_folder() / "light"


def store_baked(baked: BakedLight) -> Path:
    """Keep baked light; a reader sees all of it or nothing.

    Raises
    ------
    StorageError
        If the file cannot be written.
    DeadlineExceeded
        If another process kept writing to the folder.
    """
    path = _stored(baked, baked_file(baked.fingerprint), LEVEL)
    path.with_suffix(DRAFT_SUFFIX).unlink(missing_ok=True)
    return path


def store_draft(baked: BakedLight) -> Path:
    """Keep rough light until `store_baked` is called with the light itself; errors as of that."""
    path = baked_file(baked.fingerprint).with_suffix(DRAFT_SUFFIX)
    return _stored(baked, path, QUICK_LEVEL)


def _coded_arrays(baked: BakedLight, level: int) -> memoryview:
    """Return what follows the checksum of a file."""
    arrays = io.BytesIO()
    given = _arrays_of(baked)
    with ThreadPoolExecutor(thread_count()) as pool:
        few = dict(zip(given, pool.map(partial(coded, level=level), given.values()), strict=True))
    np.savez(arrays, allow_pickle=False, **few)
    return arrays.getbuffer()


def _stored(baked: BakedLight, path: Path, level: int) -> Path:
    payload = _coded_arrays(baked, level)
    with storage_errors("the baked light", path), _lock():
        remove_unfinished(path.parent)
        with written_file(path) as file:
            file.write(MAGIC)
            file.write(_digest(payload))
            file.write(payload)
        forget_oldest(path.parent)
    return path


def load_baked(fingerprint: str) -> BakedLight | None:
    """Return the light kept for a fingerprint; None if there is none that can be used."""
    return _loaded(baked_file(fingerprint), fingerprint)


def load_draft(fingerprint: str) -> BakedLight | None:
    """Return the rough light kept for a fingerprint; None if there is none that can be used."""
    return _loaded(baked_file(fingerprint).with_suffix(DRAFT_SUFFIX), fingerprint)


def _loaded(path: Path, fingerprint: str) -> BakedLight | None:
    if not path.is_file():
        return None
    try:
        payload, checksum = _payload(path)
        with np.load(io.BytesIO(payload), allow_pickle=False) as file:
            few = dict(file)
        with ThreadPoolExecutor(thread_count()) as pool:
            arrays = dict(zip(few, pool.map(decoded, few.values()), strict=True))
        baked = replace(_baked_of(arrays), checksum=checksum.hex())
        if baked.fingerprint != fingerprint:
            raise ValueError("it was made for another scene")
    except Exception as problem:  # whatever a damaged file leads to: the light is baked anew
        _log.warning("baked light in %s cannot be used (%s)", path, problem)
        return None
    with suppress(OSError):
        os.utime(path)  # in use: not the first to be thrown away
    return baked


def damaged_light() -> dict[Path, str]:
    """Check every file of baked light; return what is wrong, in words, by file."""
    problems = {}
    files = (light_folder().glob(f"*{suffix}") for suffix in (SUFFIX, DRAFT_SUFFIX))
    for path in sorted(chain(*files)):
        try:
            _payload(path)
        except (OSError, ValueError) as problem:
            problems[path] = str(problem)
    return problems


def remember(stamp: str, fingerprint: str) -> None:
    """Keep in mind which light belongs to a scene file, so that nobody need build the scene."""
    note = baked_file(fingerprint).with_name(f"{stamp}.known")
    with suppress(OSError):
        make_folder(note.parent)
        with _lock():
            write_file(note, fingerprint.encode("ascii"))
            forget_oldest(note.parent)


def remembered(stamp: str) -> str | None:
    """Return the fingerprint of the light that a scene file had; None if it is not known."""
    note = baked_file(stamp).with_suffix(".known")
    try:
        fingerprint = note.read_text(encoding="ascii")
    except (OSError, UnicodeDecodeError):
        return None
    return fingerprint if _is_fingerprint(fingerprint) else None


def is_baked(stamp: str) -> bool:
    """Return whether the light of a scene file is known, there, and whole."""
    fingerprint = remembered(stamp)
    if fingerprint is None:
        return False
    try:
        _payload(baked_file(fingerprint))
    except (OSError, ValueError):
        return False
    return True


def _payload(path: Path) -> tuple[memoryview, bytes]:
    """Read a file's arrays and their checksum; ValueError if they are not what was written."""
    data = memoryview(path.read_bytes())
    if data[: len(MAGIC)] != MAGIC:
        raise ValueError("it is no file of baked light")
    payload = data[len(MAGIC) + DIGEST_BYTES :]
    checksum = _digest(payload)
    if data[len(MAGIC) : len(MAGIC) + DIGEST_BYTES] != checksum:
        raise ValueError("its checksum is wrong")
    return payload, checksum


def _digest(payload: memoryview) -> bytes:
    return hashlib.blake2b(payload, digest_size=DIGEST_BYTES).digest()


def _lock() -> AbstractContextManager[None]:
    return file_lock(light_folder() / ".lock", "the folder of baked light")


def _is_fingerprint(text: str) -> bool:
    return len(text) == 32 and all(c in "0123456789abcdef" for c in text)


def forget_oldest(folder: Path, most_bytes: int = MOST_BYTES) -> None:
    """Remove the light that has not been used for longest beyond so many bytes of a kind.

    What was used last remains, however large it is.
    """
    for kind in (SUFFIX, DRAFT_SUFFIX):
        remove_oldest(folder.glob(f"*{kind}"), most_bytes=most_bytes)
    remove_oldest(folder.glob("*.known"), most_files=MOST_NOTES)


def _arrays_of(baked: BakedLight) -> dict[str, NDArray[Any]]:
    arrays: dict[str, NDArray[Any]] = {}
    unwrappings = list({id(c.unwrapping): c.unwrapping for c in baked.charts.values()}.values())
    for u, unwrapping in enumerate(unwrappings):
        for name in _CHART_ARRAYS:
            for part, array in enumerate(getattr(unwrapping, name)):
                arrays[f"unwrapping_{u}_{part}_{name}"] = array
    for place, layer in enumerate(baked.layers):
        for name in _LAYER_ARRAYS:
            array = getattr(layer, name)
            if array is not None:
                arrays[f"layer_{place}_{name}"] = array
        if layer.edges is not None:
            for name in _EDGE_ARRAYS:
                arrays[f"layer_{place}_edges_{name}"] = getattr(layer.edges, name)
    number = {id(unwrapping): u for u, unwrapping in enumerate(unwrappings)}
    description = {
        "format": FORMAT,
        "fingerprint": baked.fingerprint,
        "probes": asdict(baked.probes),
        "lights": [None if y.light is None else asdict(y.light) for y in baked.layers],
        "clear": [layer.clear for layer in baked.layers],
        "parts": [len(unwrapping.vertices) for unwrapping in unwrappings],
        "charts": {
            str(instance): [
                number[id(chart.unwrapping)],
                chart.offset,
                chart.scale,
                chart.world_from_body.tolist(),
            ]
            for instance, chart in baked.charts.items()
        },
    }
    arrays["seen"] = baked.seen
    arrays["description"] = np.frombuffer(json.dumps(description).encode(), dtype=np.uint8)
    return arrays


def _baked_of(arrays: Mapping[str, NDArray[Any]]) -> BakedLight:
    description = json.loads(arrays["description"].tobytes())
    if description["format"] != FORMAT:
        raise ValueError(f"its format is {description['format']}, not {FORMAT}")
    unwrappings = [
        Unwrapping(**{
            name: tuple(_frozen(arrays[f"unwrapping_{u}_{p}_{name}"]) for p in range(parts))
            for name in _CHART_ARRAYS
        })
        for u, parts in enumerate(description["parts"])
    ]  # fmt: skip
    layers = [
        LightLayer(
            light=None if light is None else Light(**_with_tuples(light)),
            clear=clear,
            edges=_edges_of(arrays, place),
            **{
                name: _frozen(arrays[f"layer_{place}_{name}"])
                for name in _LAYER_ARRAYS
                if f"layer_{place}_{name}" in arrays
            },
        )
        for place, (light, clear) in enumerate(
            zip(description["lights"], description["clear"], strict=True)
        )
    ]
    return BakedLight(
        fingerprint=description["fingerprint"],
        charts={
            int(instance): LightChart(
                unwrapping=unwrappings[u],
                offset=tuple(offset),
                scale=tuple(scale),
                world_from_body=_frozen(np.array(pose)),
            )
            for instance, (u, offset, scale, pose) in description["charts"].items()
        },
        layers=tuple(layers),
        probes=ProbeGrid(**_with_tuples(description["probes"])),
        seen=_frozen(arrays["seen"]),
    )


def _edges_of(arrays: Mapping[str, NDArray[Any]], place: int) -> SunEdges | None:
    names = {name: f"layer_{place}_edges_{name}" for name in _EDGE_ARRAYS}
    if any(name not in arrays for name in names.values()):
        return None
    edges = SunEdges(**{name: _frozen(arrays[key]) for name, key in names.items()})
    if edges.index.size and not -1 <= edges.index.min() <= edges.index.max() < len(edges.blocks):
        raise ValueError("it names edges of shadows that it does not have")
    return edges


def _with_tuples(values: dict[str, Any]) -> dict[str, Any]:
    return {k: tuple(v) if isinstance(v, list) else v for k, v in values.items()}


def _frozen(array: NDArray[Any]) -> NDArray[Any]:
    array.flags.writeable = False
    return array
