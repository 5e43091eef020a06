"""Frames and their neighbours → flow data sets that standard loaders read: KITTI and MPI-Sintel.

Flow is forward, to the next frame, as these data sets have it; ``--flow backward`` writes the one
to the frame before, ``both`` both of them. Each with its masks.
"""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from sailenv_ros.dataset.formats.data_files import write_bytes, write_png
from sailenv_ros.dataset.formats.dataset_format import DatasetFormat, Sample, WriteResult
from sailenv_ros.dataset.formats.flow_files import flo_from_backward, kitti_from_backward
from sailenv_ros.dataset.formats.images import scaled_depth
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.motion import Motion, motion

__all__ = ["KittiExport", "SintelExport"]

NO_NEIGHBOUR = "flow: there is no frame of the same epoch on that side"
NO_STATES = "flow: states of instances, depth or instance ids were not recorded"


def motions_of(sample: Sample, flow: str) -> tuple[dict[str, Motion], dict[str, int]]:
    """Return the motion of a frame in each direction that is asked for, and what is left out.

    Parameters
    ----------
    flow : {'forward', 'backward', 'both'}
    """
    found: dict[str, Motion] = {}
    left_out: dict[str, int] = {}
    neighbours = {"forward": sample.following, "backward": sample.previous}
    for direction, other in neighbours.items():
        if flow not in (direction, "both"):
            continue
        if other is None or not _have_one_past(sample.frame, other):
            left_out[NO_NEIGHBOUR] = left_out.get(NO_NEIGHBOUR, 0) + 1
        elif not (_is_complete(sample.frame) and _is_complete(other)):
            left_out[NO_STATES] = left_out.get(NO_STATES, 0) + 1
        else:
            found[direction] = motion(sample.frame, other)
    return found, left_out


class KittiExport(DatasetFormat):
    """KITTI's flow benchmark: pairs of pictures and the flow between them.

    ``image_2/N_10.png`` is a frame, ``N_11.png`` the next one; ``flow_occ/N_10.png`` is the flow
    from the one to the other, ``flow_noc/N_10.png`` the same without what is occluded or leaves
    the picture. Backward flow, from the second picture to the first, lies in
    ``flow_backward_occ/N_11.png`` and ``flow_backward_noc``. ``depth/N_10.png`` is in steps of
    1/256 m, 0 where there is none. Readers match files by their order, so a frame without a next
    one has no picture.
    """

    any_of: ClassVar[tuple[str, ...]] = ("rgb", "depth", "instance")
    needs_neighbours: ClassVar[bool] = True

    def add(self, sample: Sample) -> WriteResult:
        """Write the pair that begins with a frame."""
        frame, following = sample.frame, sample.following
        folder = self.folder / sample.split
        first, second = (f"{sample.stem}_1{number}.png" for number in (0, 1))
        written = {"pictures": 0, "depth maps": 0, "flow fields": 0}
        if "depth" in frame.views:
            write_png(folder / "depth" / first, scaled_depth(frame["depth"], 256.0))
            written["depth maps"] = 1
        if following is None or not _have_one_past(frame, following):
            return WriteResult(written=written, left_out={NO_NEIGHBOUR: 1})
        if "rgb" in frame.views:
            write_png(folder / "image_2" / first, frame["rgb"])
            write_png(folder / "image_2" / second, following["rgb"])
            written["pictures"] = 2
        if not (_is_complete(frame) and _is_complete(following)):
            return WriteResult(written=written, left_out={NO_STATES: 1})
        for direction, begin, end, folder_name, name in (
            ("forward", frame, following, "flow", first),
            ("backward", following, frame, "flow_backward", second),
        ):
            if self.flow in (direction, "both"):
                moved = motion(begin, end)
                visible = np.where(moved.visible[..., None], moved.flow, np.float32(np.nan))
                write_png(folder / f"{folder_name}_occ" / name, kitti_from_backward(moved.flow))
                write_png(folder / f"{folder_name}_noc" / name, kitti_from_backward(visible))
                written["flow fields"] += 1
        return WriteResult(written=written)


class SintelExport(DatasetFormat):
    """MPI-Sintel: ``clean/S/frame_0001.png``, ``flow/S/frame_0001.flo`` and masks, one S an epoch.

    ``occlusions``: 255 where the point is not seen in the other picture, because it is occluded or
    leaves it; ``outofframe``: 255 where it leaves; ``invalid``: 255 where there is no flow.
    Backward flow and its masks lie in folders that end in ``_backward``. The last frame has no flow
    forward and the first none backward, as in the original.
    """

    views: ClassVar[tuple[str, ...]] = ("rgb", "depth", "instance")
    is_sequence: ClassVar[bool] = True
    has_sequences: ClassVar[bool] = True
    needs_neighbours: ClassVar[bool] = True

    def add(self, sample: Sample) -> WriteResult:
        """Write a frame's files."""
        frame = sample.frame
        scene = sample.sequence or f"{frame.scene}_{frame.epoch}"
        # Numbers go on from epoch to epoch; readers sort the files of each scene by name.
        stem = f"frame_{sample.number + 1:04d}"
        write_png(self.folder / "clean" / scene / f"{stem}.png", frame["rgb"])
        motions, left_out = motions_of(sample, self.flow)
        for direction, moved in motions.items():
            end = "" if direction == "forward" else "_backward"
            flow = self.folder / f"flow{end}" / scene / f"{stem}.flo"
            write_bytes(flow, flo_from_backward(moved.flow))
            masks = {
                "occlusions": moved.occluded | moved.out_of_view,
                "outofframe": moved.out_of_view,
                "invalid": ~moved.valid,
            }
            for mask, values in masks.items():
                write_png(self.folder / f"{mask}{end}" / scene / f"{stem}.png", values)
        return WriteResult(written={"pictures": 1, "flow fields": len(motions)}, left_out=left_out)


def _have_one_past(frame: Frame, other: Frame) -> bool:
    return (frame.scene, frame.epoch) == (other.scene, other.epoch)


def _is_complete(frame: Frame) -> bool:
    return frame.states is not None and {"depth", "instance"} <= frame.views.keys()
