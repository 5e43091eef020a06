"""Annotated objects of a frame: those with a category and at least one visible pixel."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from sailenv_ros.dataset.formats.dataset_format import Sample
from sailenv_ros.errors import RecordingError
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.truth.amodal_masks import AmodalMasks
from sailenv_ros.frame.truth.object_table import ObjectTable
from sailenv_ros.types.labels import BACKGROUND, UNLABELLED_CATEGORY

__all__ = [
    "NO_CATEGORY",
    "AnnotatedObjects",
    "annotated_objects",
    "categories_of",
    "merged_categories",
    "stuff_of",
]

NO_CATEGORY = (BACKGROUND, UNLABELLED_CATEGORY)


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class AnnotatedObjects:
    """Objects of one frame.

    Attributes
    ----------
    table : ObjectTable
        A row for each.
    masks : AmodalMasks or None
        Of the frame; None if they were not recorded.
    left_out : mapping of str to int
        How many objects of the scene are not among them, by the reason.
    """

    table: ObjectTable
    masks: AmodalMasks | None
    left_out: Mapping[str, int]


def annotated_objects(sample: Sample, format_name: str) -> AnnotatedObjects:
    """Choose the objects of a frame.

    Raises
    ------
    RecordingError
        If the scene of the frame is not known, which a format of that name needs.
    """
    sample.scene_info(format_name)
    frame: Frame = sample.frame
    masks = None if frame.draw_amodal is None else frame.amodal
    table = frame.objects if masks is None else frame.objects.with_amodal(masks)
    labelled = ~np.isin(table.category_ids, NO_CATEGORY)
    seen, rules = table.visible, sample.rules
    found = labelled & seen
    stuff = found & np.array([name in rules.stuff for name in table.categories], bool)
    wanted = found & np.array([rules.has(name) for name in table.categories], bool)
    large = wanted & (table.visible_pixels >= rules.least_pixels)
    reasons = Counter(
        {
            "no category": int((~labelled & seen).sum()),
            "no pixel is visible": int((~seen).sum()),
            "stuff": int(stuff.sum()),
            "other category": int((found & ~stuff & ~wanted).sum()),
            f"fewer than {rules.least_pixels} pixels": int((wanted & ~large).sum()),
        }
    )
    return AnnotatedObjects(table=table.select(large), masks=masks, left_out=+reasons)


def categories_of(sample: Sample, format_name: str) -> dict[str, str]:
    """Return the names of the scene's categories whose objects are annotated, by their ids.

    As JSON holds them, with ids as texts.
    """
    known = sample.scene_info(format_name).categories.values()
    return {
        str(one.id): one.name
        for one in known
        if one.id not in NO_CATEGORY and sample.rules.has(one.name)
    }


def stuff_of(sample: Sample, format_name: str) -> dict[str, str]:
    """Return the names of the scene's categories that are stuff, like `categories_of`."""
    known = sample.scene_info(format_name).categories.values()
    return {str(one.id): one.name for one in known if one.name in sample.rules.stuff}


def merged_categories(tables: Iterable[Mapping[str, str]]) -> dict[int, str]:
    """Join the `categories_of` many frames; return all names by their ids, in order.

    Raises
    ------
    RecordingError
        If two scenes have another category of the same id.
    """
    names: dict[int, str] = {}
    for table in tables:
        for text, name in table.items():
            known = names.setdefault(int(text), name)
            if known != name:
                raise RecordingError(
                    f"category {text} is {known!r} in one scene and {name!r} in another; give the "
                    "scenes' own categories different ids"
                )
    return dict(sorted(names.items()))
