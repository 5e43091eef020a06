"""The table of data set formats: names, and where each is found; loaded when it is used."""

from __future__ import annotations

import importlib
from collections.abc import Iterable, Mapping
from types import MappingProxyType

from sailenv_ros.dataset.formats.dataset_format import DatasetFormat
from sailenv_ros.errors import InvalidRequest, UnknownName

__all__ = ["FORMATS", "check_views", "format_class", "wanted_formats"]

FORMATS: Mapping[str, str] = MappingProxyType(
    {
        "png": "images.PngExport",
        "coco": "coco.CocoExport",
        "kitti": "flow.KittiExport",
        "sintel": "flow.SintelExport",
        "flo": "images.FloExport",
        "movi": "movi.MoviExport",
        "tapvid": "tapvid.TapVidExport",
        "mp4": "video.VideoExport",
        "bop": "bop.BopExport",
        "mot": "mot.MotExport",
        "yolo": "yolo.YoloExport",
        "yolo_segments": "yolo.YoloSegmentsExport",
        "lve": "lve.LveExport",
        "voc": "voc.VocExport",
        "webdataset": "webdataset.WebDatasetExport",
        "parquet": "parquet.ParquetExport",
        "lerobot": "lerobot.LeRobotExport",
        "mcap": "mcap.McapExport",
        "colmap": "colmap.ColmapExport",
        "nerfstudio": "nerfstudio.NerfstudioExport",
        "instant-ngp": "nerfstudio.InstantNgpExport",
        "3dgs": "gaussians.GaussiansExport",
        "scannet": "scans.ScanNetExport",
        "replica": "scans.ReplicaExport",
        "hypersim": "hypersim.HypersimExport",
        "vqa": "vqa.VqaExport",
        "cosmos": "cosmos.CosmosExport",
        "vqa_parquet": "vqa_parquet.VqaParquetExport",
    }
)
"""Module in this folder and class of each format, by its name."""


def wanted_formats(formats: Iterable[str]) -> list[str]:
    """Return each name of some formats once.

    Raises
    ------
    InvalidRequest
        If there is none.
    """
    names = list(dict.fromkeys(formats))
    if not names:
        raise InvalidRequest("formats", (), f"at least one of: {', '.join(FORMATS)}")
    return names


def format_class(name: str) -> type[DatasetFormat]:
    """Load a format.

    Raises
    ------
    UnknownName
        If there is none of that name.
    """
    if name not in FORMATS:
        raise UnknownName("format", name, FORMATS)
    module, _, cls = FORMATS[name].partition(".")
    loaded = importlib.import_module(f"sailenv_ros.dataset.formats.{module}")
    made: type[DatasetFormat] = getattr(loaded, cls)
    return made


def check_views(name: str, views: Iterable[str]) -> None:
    """Refuse frames that lack views which a format needs.

    Raises
    ------
    InvalidRequest
    """
    made, there = format_class(name), list(views)
    lacking = [view for view in made.views if view not in there]
    none_of = made.any_of and not set(made.any_of) & set(there)
    if lacking or none_of:
        needed = ", ".join(made.views or made.any_of)
        which = "the views" if made.views else "one of the views"
        accepted = f"recorded with {which} that {name} needs: {needed}"
        raise InvalidRequest("recording", f"the views {', '.join(there)}", accepted)
