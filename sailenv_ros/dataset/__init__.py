"""Data sets by recipe: what is seen how often, written by any number of machines, read again.

What is named here is imported when it is first used: who writes files needs no simulation.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sailenv_ros.dataset.engines import engine_of
    from sailenv_ros.dataset.job import Job, RecipeError, load_job, load_recipe
    from sailenv_ros.dataset.making import MadeDataset, Progress, make_dataset
    from sailenv_ros.dataset.opening import make, open_dataset, stream_dataset
    from sailenv_ros.dataset.opening import open_dataset as open
    from sailenv_ros.dataset.opening import stream_dataset as stream
    from sailenv_ros.dataset.reader import Dataset, DatasetFrame
    from sailenv_ros.dataset.samples import DatasetSamples
    from sailenv_ros.dataset.streaming import DatasetStream
    from sailenv_ros.dataset.verifying import Difference, verify_dataset

__all__ = [
    "Dataset",
    "DatasetFrame",
    "DatasetSamples",
    "DatasetStream",
    "Difference",
    "Job",
    "MadeDataset",
    "Progress",
    "RecipeError",
    "engine_of",
    "load_job",
    "load_recipe",
    "make",
    "make_dataset",
    "open",
    "open_dataset",
    "stream",
    "stream_dataset",
    "verify_dataset",
]

_HOMES = {
    "engines": ("engine_of",),
    "job": ("Job", "RecipeError", "load_job", "load_recipe"),
    "making": ("MadeDataset", "Progress", "make_dataset"),
    "opening": ("make", "open_dataset", "stream_dataset"),
    "reader": ("Dataset", "DatasetFrame"),
    "samples": ("DatasetSamples",),
    "streaming": ("DatasetStream",),
    "verifying": ("Difference", "verify_dataset"),
}


def __getattr__(name: str) -> Any:
    wanted = {"open": "open_dataset", "stream": "stream_dataset"}.get(name, name)
    for module, names in _HOMES.items():
        if wanted in names:
            value = getattr(importlib.import_module(f"sailenv_ros.dataset.{module}"), wanted)
            globals()[name] = value
            return value
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
