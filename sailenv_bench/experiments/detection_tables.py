"""The detection experiment's result as a table, beside the paper's."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from sailenv_bench.experiments.paper import DETECTION, DETECTION_SOURCE
from sailenv_bench.experiments.tables import Table, number

__all__ = ["detection_tables"]

Data = Mapping[str, Any]


def detection_tables(data: Data) -> list[Table]:
    """Return the table of `sailenv eval detection`."""
    masks = data["masks"]
    columns: tuple[str, ...] = ("class", "views", "hit rate", "box IoU", "paper's box IoU")
    if masks:
        columns += ("pixel IoU",)
    columns += ("paper's pixel IoU",)
    rows = [_row(entry, masks) for entry in data["classes"]]
    overall = data["overall"]
    paper_box = sum(DETECTION[e["name"]][2] for e in data["classes"]) / len(data["classes"])
    paper_pixel = sum(DETECTION[e["name"]][0] for e in data["classes"]) / len(data["classes"])
    mean: tuple[str, ...] = (
        "mean of classes",
        str(overall["views"]),
        _percent(overall["hit_rate"]),
    )
    mean += (number(overall["box_iou"], 3), number(paper_box, 3))
    mean += (number(overall["pixel_iou"], 3),) if masks else ()
    rows.append((*mean, number(paper_pixel, 3)))
    return [Table(title="Detection", columns=columns, rows=tuple(rows), notes=_notes(data))]


def _row(entry: Data, masks: bool) -> tuple[str, ...]:
    paper = DETECTION[entry["name"]]
    cells: tuple[str, ...] = (entry["name"], str(entry["views"]), _percent(entry["hit_rate"]))
    cells += (_spread(*entry["box_iou"]), _spread(paper[2], paper[3]))
    if masks:
        cells += (_spread(*entry["pixel_iou"]),)
    return (*cells, _spread(paper[0], paper[1]))


def _notes(data: Data) -> tuple[str, ...]:
    rule = data["rule"]
    notes = [
        f"{data['model']} ({data['format']}), score ≥ {data['score']:g}. Hit: a box of the right "
        f"class with IoU ≥ {data['hit_iou']:g}. Box IoU: the best box of the class against the box "
        "of the object's visible pixels, 0 where the class was not named; mean ± deviation.",
        f"Views by rule: the object covers {100 * rule['cover'][0]:g} to "
        f"{100 * rule['cover'][1]:g} % of the picture, at least {100 * rule['visible']:g} % of it "
        f"is seen, {rule['views']} azimuths and distances each, seed {rule['seed']}, rooms "
        f"{', '.join(rule['rooms'])}.",
    ]
    if not data["baked"]:
        notes.append(
            "The rooms' light was not baked (sailenv scene bake): shadows and bounced light "
            "are plainer than they can be."
        )
    if not data["masks"]:
        notes.append(
            "This network gives no masks, so there is no pixel IoU of ours to stand beside the "
            "paper's."
        )
    notes += data["remarks"]
    for entry in data["classes"]:
        if entry["views"] < rule["views"]:
            notes.append(
                f"{entry['name']}: {entry['views']} of {rule['views']} views meet the rule in the "
                f"rooms (objects of the class: {entry['instances']})."
            )
    return (*notes, DETECTION_SOURCE)


def _percent(share: float | None) -> str:
    return "–" if share is None else f"{100 * share:.0f} %"


def _spread(mean: float | None, deviation: float | None) -> str:
    return "–" if mean is None else f"{mean:.2f} ± {number(deviation, 2)}"
