"""Frames → BOP: poses of objects, their masks and models, as benchmarks of 6-D pose read them.

The format is that of
https://github.com/thodan/bop_toolkit/blob/master/docs/bop_datasets_format.md ("classic"). Lengths
are in millimetres; depth is stored in steps of `DEPTH_STEP_MM`.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from typing import Any, ClassVar, TypeAlias

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.assets.asset_library import AssetLibrary
from sailenv_ros.assets.sources import installed_sources
from sailenv_ros.dataset.formats.annotated_objects import annotated_objects
from sailenv_ros.dataset.formats.bop_models import MM_PER_M, ObjectModel
from sailenv_ros.dataset.formats.data_files import write_bytes, write_json, write_png
from sailenv_ros.dataset.formats.dataset_format import DatasetFormat, Record, Sample, WriteResult
from sailenv_ros.errors import RecordingError
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.truth.amodal_masks import AmodalMasks
from sailenv_ros.types.labels import PART_MARK

__all__ = ["DEPTH_STEP_MM", "BopExport"]

DEPTH_STEP_MM = 0.2
"""Step of depth: 16 bits reach 13 m; greater and unknown depths are 0 [mm]."""

UNSPLIT = "train"

Numbers: TypeAlias = Mapping[tuple[str, tuple[float, ...]], int]
"""The number of each object, by its asset and scale."""


class BopExport(DatasetFormat):
    """`train/000001/{rgb,depth,mask,mask_visib}`, its `scene_*.json`, `models`, `camera.json`.

    A scene of BOP is an epoch of the simulation, or a clip of a data set. Objects are those of the
    catalogue; the room and what was uploaded are left out, as there is no model of them, but they
    hide what lies behind. An object at another scale is another object.
    """

    views: ClassVar[tuple[str, ...]] = ("rgb", "depth", "instance")

    def add(self, sample: Sample) -> WriteResult:
        """Write the pictures of a frame and take its objects."""
        frame = sample.frame
        found = annotated_objects(sample, "BOP")
        if frame.states is None or found.masks is None:
            raise RecordingError(
                "BOP needs poses and amodal masks, which were not recorded; record with --amodal"
            )
        left_out = Counter(found.left_out)
        number = frame.epoch if sample.sequence_number is None else sample.sequence_number
        scene = self._scene(sample.split, number)
        name = f"{sample.stem}.png"
        write_png(scene / "rgb" / name, frame["rgb"])
        write_png(scene / "depth" / name, _depth_steps(frame["depth"]))
        table = found.table
        truths: list[dict[str, Any]] = []
        infos: list[dict[str, Any]] = []
        for row, instance_id in enumerate(table.ids.tolist()):
            if not self._library.has(table.assets[row].partition(PART_MARK)[0]):
                left_out["not in the catalogue"] += 1
                continue
            mask_name = f"{sample.stem}_{len(truths):06d}.png"
            seen = frame["instance"] == instance_id
            write_png(scene / "mask" / mask_name, found.masks.mask(instance_id))
            write_png(scene / "mask_visib" / mask_name, seen)
            pose = table.camera_from_object[row]
            truths.append(
                {
                    "cam_R_m2c": pose[:3, :3].reshape(-1).tolist(),
                    "cam_t_m2c": (MM_PER_M * pose[:3, 3]).tolist(),
                    "asset": table.assets[row],
                    "scale": frame.states.scales[frame.states.row(instance_id)].tolist(),
                    "instance_id": instance_id,
                    "parent_id": int(table.parents[row]),
                }
            )
            infos.append(_truth_info(frame, found.masks, instance_id, seen))
        lens = frame.camera.intrinsics
        lens.require_pinhole("files of BOP")
        to_world = frame.camera.camera_from_world
        camera = {
            "cam_K": lens.K.reshape(-1).tolist(),
            "depth_scale": DEPTH_STEP_MM,
            "cam_R_w2c": to_world[:3, :3].reshape(-1).tolist(),
            "cam_t_w2c": (MM_PER_M * to_world[:3, 3]).tolist(),
        }
        return WriteResult(
            record={
                "scene": number,
                "camera": camera,
                "size": [lens.width, lens.height],
                "truths": truths,
                "infos": infos,
            },
            written={"pictures": 1, "poses": len(truths)},
            left_out=+left_out,
        )

    def finish(self, records: Sequence[Record]) -> None:
        """Write tables of poses, for which all objects must be known, and the models."""
        numbers = self._write_models(records)
        # All records may be more than fits into memory: a scene is written with its last one.
        left = Counter((record.split, record.value["scene"]) for record in records)
        splits = dict.fromkeys(split for split, _ in left)
        begun: dict[tuple[str, int], list[Record]] = {}
        for record in records:
            key = record.split, record.value["scene"]
            begun.setdefault(key, []).append(record)
            left[key] -= 1
            if not left[key]:
                self._write_scene(*key, begun.pop(key), numbers)
        for split in splits:
            listed = (
                target
                for record in records
                if record.split == split
                for target in _targets(record, numbers)
            )
            write_json(self.folder / f"{split or UNSPLIT}_targets_bop19.json", listed)
        if records:
            first = records[0].value
            k = first["camera"]["cam_K"]
            camera = {
                "cx": k[2], "cy": k[5], "fx": k[0], "fy": k[4], "depth_scale": DEPTH_STEP_MM,
                "width": first["size"][0], "height": first["size"][1],
            }  # fmt: skip
            write_json(self.folder / "camera.json", camera)

    def _write_scene(
        self, split: str, scene: int, records: Sequence[Record], numbers: Numbers
    ) -> None:
        folder = self._scene(split, scene)
        cameras, truths, infos = {}, {}, {}
        for record in records:
            image, value = str(record.number), record.value
            cameras[image] = value["camera"]
            truths[image] = [
                {
                    "cam_R_m2c": truth["cam_R_m2c"],
                    "cam_t_m2c": truth["cam_t_m2c"],
                    "obj_id": numbers[_key(truth)],
                    "instance_id": truth["instance_id"],
                    "parent_id": truth["parent_id"],
                }
                for truth in value["truths"]
            ]
            infos[image] = value["infos"]
        write_json(folder / "scene_camera.json", cameras)
        write_json(folder / "scene_gt.json", truths)
        write_json(folder / "scene_gt_info.json", infos)

    def _write_models(self, records: Sequence[Record]) -> Numbers:
        """Write a model for each asset and scale; return their numbers."""
        keys = sorted({_key(truth) for record in records for truth in record.value["truths"]})
        infos: dict[str, dict[str, Any]] = {}
        names: dict[str, dict[str, Any]] = {}
        numbers = {}
        for number, key in enumerate(keys, 1):
            asset, scale = key
            model = ObjectModel(self._library.drawn_model(asset), np.array(scale))
            data = model.ply()
            # The same mesh serves to draw and to measure.
            for folder in ("models", "models_eval"):
                write_bytes(self.folder / folder / f"obj_{number:06d}.ply", data)
            infos[str(number)] = model.info()
            names[str(number)] = {"asset": asset, "scale": list(scale)}
            numbers[key] = number
        for folder in ("models", "models_eval"):
            write_json(self.folder / folder / "models_info.json", infos)
        write_json(self.folder / "models" / "names.json", names)
        return numbers

    def _scene(self, split: str, number: int) -> Any:
        return self.folder / (split or UNSPLIT) / f"{number:06d}"

    @cached_property
    def _library(self) -> AssetLibrary:
        return AssetLibrary(installed_sources())


def _key(truth: Mapping[str, Any]) -> tuple[str, tuple[float, ...]]:
    return truth["asset"], tuple(round(float(side), 9) for side in truth["scale"])


def _targets(record: Record, numbers: Numbers) -> Iterator[dict[str, int]]:
    """Yield how often each object is in a picture."""
    counts = Counter(numbers[_key(truth)] for truth in record.value["truths"])
    for obj_id, count in sorted(counts.items()):
        yield {
            "im_id": record.number,
            "inst_count": count,
            "obj_id": obj_id,
            "scene_id": record.value["scene"],
        }


def _depth_steps(depth_m: NDArray[np.float32]) -> NDArray[np.uint16]:
    with np.errstate(invalid="ignore"):
        steps = np.rint(depth_m.astype(np.float64) * (MM_PER_M / DEPTH_STEP_MM))
        fits = (steps >= 1) & (steps <= 65535)
    return np.where(fits, steps, 0.0).astype(np.uint16)


def _truth_info(
    frame: Frame, masks: AmodalMasks, instance_id: int, seen: NDArray[np.bool_]
) -> dict[str, Any]:
    """Return what `scene_gt_info.json` says of an object; see the format's description."""
    row, table_row = masks.row(instance_id), frame.objects.row(instance_id)
    measured = _depth_steps(frame["depth"]) > 0
    visible, whole = int(seen.sum()), int(masks.whole_pixels[row])
    return {
        "bbox_obj": _bbox(masks.whole_boxes[row]),
        "bbox_visib": _bbox(frame.objects.visible_boxes[table_row]),
        "px_count_all": whole,
        "px_count_valid": int((masks.mask(instance_id) & measured).sum()),
        "px_count_visib": visible,
        "visib_fract": visible / whole if whole else 0.0,
    }


def _bbox(box: NDArray[np.int32]) -> list[int]:
    left, top, right, bottom = (int(edge) for edge in box)
    return [left, top, right - left + 1, bottom - top + 1]
