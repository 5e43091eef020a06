"""What is in a data set, for people: ``README.md`` with pictures, counts and histograms."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.dataset.histograms import histogram_svg
from sailenv_ros.dataset.job import Job
from sailenv_ros.dataset.manifest import ShardSummary
from sailenv_ros.dataset.merging import frame_records
from sailenv_ros.dataset.shard_writer import PICTURES_FOLDER
from sailenv_ros.dataset.stores import Store
from sailenv_ros.recording.export.data_files import write_bytes

__all__ = ["CARD_FILE", "write_card"]

CARD_FILE = "README.md"
SHEET_FILE = "pictures.jpg"
MOST_PICTURES = 24
SHEET_COLUMNS = 4

SIZE_EDGES = (1, 16, 64, 256, 1024, 4096, 16384, 65536, 262144)
"""Of the histogram of visible pixels."""

SHARE_EDGES = tuple(0.1 * step for step in range(11))
DISTANCE_EDGES = (0.0, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 20.0)


@dataclass(eq=False, slots=True)
class _Statistics:
    frames: Counter[str] = field(default_factory=Counter)
    scenes: Counter[str] = field(default_factory=Counter)
    objects: Counter[str] = field(default_factory=Counter)
    frames_with: Counter[str] = field(default_factory=Counter)
    sizes: Counter[int] = field(default_factory=Counter)
    shares: Counter[int] = field(default_factory=Counter)
    distances: Counter[int] = field(default_factory=Counter)


def write_card(job: Job, store: Store, shards: Mapping[int, ShardSummary], folder: Path) -> None:
    """Write the card of a data set whose shards are whole."""
    found = _statistics(frame_records(store, shards))
    sheet = _sheet(_pictures(store, shards))
    if sheet is not None:
        write_bytes(folder / SHEET_FILE, sheet)
    for name, edges, counts, title in (
        ("sizes", SIZE_EDGES, found.sizes, "visible pixels of an object"),
        ("visible_shares", SHARE_EDGES, found.shares, "visible share of an object"),
        ("distances", DISTANCE_EDGES, found.distances, "distance of an object [m]"),
    ):
        if counts:
            heights = [counts.get(index, 0) for index in range(len(edges) - 1)]
            write_bytes(folder / f"{name}.svg", histogram_svg(heights, edges, title).encode())
    text = _text(job, shards, found, has_sheet=sheet is not None)
    write_bytes(folder / CARD_FILE, text.encode())


def _statistics(records: Iterable[Mapping[str, Any]]) -> _Statistics:
    found = _Statistics()
    for record in records:
        found.frames[record["split"]] += 1
        found.scenes[record["scene"]] += 1
        names = [entry[0] for entry in record["objects"]]
        found.objects.update(names)
        found.frames_with.update(set(names))
        for _, pixels, share, distance in record["objects"]:
            found.sizes[_bin(SIZE_EDGES, pixels)] += 1
            if share is not None:
                found.shares[_bin(SHARE_EDGES, share)] += 1
            if distance is not None:
                found.distances[_bin(DISTANCE_EDGES, distance)] += 1
    return found


def _bin(edges: Sequence[float], value: float) -> int:
    last = len(edges) - 2
    return int(np.clip(np.searchsorted(edges, value, side="right") - 1, 0, last))


def _text(
    job: Job, shards: Mapping[int, ShardSummary], found: _Statistics, *, has_sheet: bool
) -> str:
    recipe = job.recipe
    lines = [f"# {recipe.name}", ""]
    if recipe.description:
        lines += [recipe.description.strip(), ""]
    if has_sheet:
        lines += [f"![Frames of the data set]({SHEET_FILE})", ""]
    splits = ", ".join(f"{count} {split}" for split, count in found.frames.items())
    cameras = ", ".join(f"{one.name} ({one.width}×{one.height})" for one in recipe.cameras)
    lines += [
        f"- {sum(found.frames.values())} frames ({splits}) in {len(shards)} shards",
        f"- scenes: {len(found.scenes)}",
        f"- cameras: {cameras}; clips of {recipe.clip.frames} frames",
        f"- views: {', '.join(recipe.views)}",
        f"- formats: {', '.join(recipe.formats)}, each in its folder",
        f"- made by sailenv_ros {job.head['sailenv_ros']} from [recipe.yaml](recipe.yaml); "
        "`sailenv dataset verify` makes parts of it anew and compares",
        "",
    ]
    skipped: Counter[str] = Counter()
    for one in shards.values():
        skipped.update(one.skipped)
    if skipped:
        lines += ["Clips that could not be made:", ""]
        lines += [f"- {reason}: {count}" for reason, count in sorted(skipped.items())]
        lines += [""]
    if found.objects:
        lines += ["| category | objects | frames |", "|---|---:|---:|"]
        lines += [
            f"| {name} | {count} | {found.frames_with[name]} |"
            for name, count in sorted(found.objects.items(), key=lambda pair: (-pair[1], pair[0]))
        ]
        lines += [""]
    for name, counts in (
        ("sizes", found.sizes),
        ("visible_shares", found.shares),
        ("distances", found.distances),
    ):
        if counts:
            lines += [f"![{name}]({name}.svg)", ""]
    return "\n".join(lines)


def _pictures(store: Store, shards: Mapping[int, ShardSummary]) -> Iterator[NDArray[np.uint8]]:
    """Yield small pictures of frames, from all over the data set."""
    paths = [
        path
        for one in shards.values()
        for path in one.files
        if path.startswith(f"{PICTURES_FOLDER}/")
    ]
    for index in np.unique(np.linspace(0, len(paths) - 1, MOST_PICTURES).astype(int)):
        data = store.read(paths[index]) if paths else None
        picture = None if data is None else cv2.imdecode(np.frombuffer(data, np.uint8), 1)
        if picture is not None:
            yield np.asarray(picture, np.uint8)


def _sheet(pictures: Iterable[NDArray[np.uint8]]) -> bytes | None:
    """Return the pictures beside and below each other as one JPEG; None if there are none."""
    found = list(pictures)
    if not found:
        return None
    height, width = found[0].shape[:2]
    columns = min(SHEET_COLUMNS, len(found))
    rows = -(-len(found) // columns)
    sheet = np.full((rows * height, columns * width, 3), 255, np.uint8)
    for index, picture in enumerate(found):
        row, column = divmod(index, columns)
        fitted = cv2.resize(picture, (width, height), interpolation=cv2.INTER_AREA)
        top, left = row * height, column * width
        sheet[top : top + height, left : left + width] = fitted
    _, data = cv2.imencode(".jpg", sheet, [cv2.IMWRITE_JPEG_QUALITY, 88])
    return bytes(data)
