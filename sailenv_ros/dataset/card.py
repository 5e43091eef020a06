"""Card of a data set, for people: ``README.md`` with pictures, counts and histograms."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.dataset.content_counts import ContentCounts, content_counts
from sailenv_ros.dataset.findings import finding_lines
from sailenv_ros.dataset.formats.data_files import write_bytes
from sailenv_ros.dataset.job import Job
from sailenv_ros.dataset.manifest import ShardSummary
from sailenv_ros.dataset.merging import frame_records
from sailenv_ros.dataset.shard_writer import PICTURES_FOLDER
from sailenv_ros.dataset.storage import Storage
from sailenv_ros.frame.pictures.codecs import decode_picture, encode_jpeg
from sailenv_ros.frame.pictures.contact_sheet import contact_sheet

__all__ = ["CARD_FILE", "write_card"]

CARD_FILE = "README.md"
SHEET_FILE = "pictures.jpg"
MOST_PICTURES = 24
SHEET_COLUMNS = 4


def write_card(
    job: Job, storage: Storage, shards: Mapping[int, ShardSummary], folder: Path
) -> None:
    """Write the card of a data set whose shards are whole."""
    found = content_counts(frame_records(storage, shards))
    sheet = _sheet(_pictures(storage, shards))
    if sheet is not None:
        write_bytes(folder / SHEET_FILE, sheet)
    for name, drawing in found.histograms().items():
        write_bytes(folder / f"{name}.svg", drawing.encode())
    text = _text(job, shards, found, has_sheet=sheet is not None)
    write_bytes(folder / CARD_FILE, text.encode())


def _text(
    job: Job, shards: Mapping[int, ShardSummary], found: ContentCounts, *, has_sheet: bool
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
    told = list(finding_lines(one.findings for one in shards.values()))
    if told:
        lines += ["Look at these:", "", *told, ""]
    if found.objects:
        lines += ["| category | objects | frames |", "|---|---:|---:|"]
        lines += [
            f"| {name} | {count} | {found.frames_with[name]} |"
            for name, count in sorted(found.objects.items(), key=lambda pair: (-pair[1], pair[0]))
        ]
        lines += [""]
    for name in found.histograms():
        lines += [f"![{name}]({name}.svg)", ""]
    return "\n".join(lines)


def _pictures(storage: Storage, shards: Mapping[int, ShardSummary]) -> dict[str, NDArray[np.uint8]]:
    """Return small pictures of frames, from all over the data set, by their labels."""
    paths = [
        (f"{one.split} {Path(path).stem}", path)
        for one in shards.values()
        for path in one.files
        if path.startswith(f"{PICTURES_FOLDER}/")
    ]
    found: dict[str, NDArray[np.uint8]] = {}
    if not paths:
        return found
    for index in np.unique(np.linspace(0, len(paths) - 1, MOST_PICTURES).astype(int)):
        label, path = paths[index]
        data = storage.read(path)
        if data is not None:
            found[label] = decode_picture(data)
    return found


def _sheet(pictures: Mapping[str, NDArray[np.uint8]]) -> bytes | None:
    """Return the pictures beside and below each other as one JPEG; None if there are none."""
    if not pictures:
        return None
    return encode_jpeg(contact_sheet(pictures, columns=SHEET_COLUMNS), quality=88)
