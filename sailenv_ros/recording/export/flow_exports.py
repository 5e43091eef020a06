"""Frames and their neighbours → flow data sets that standard loaders read: KITTI and MPI-Sintel.

Flow is forward, to the next frame, as these data sets have it; ``--flow backward`` writes the one
to the frame before, ``both`` both of them. Each with its masks.
"""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.frame import Frame
from sailenv_ros.motion import Motion, motion
from sailenv_ros.recording.export.data_files import write_bytes, write_png
from sailenv_ros.recording.export.dataset_format import DatasetFormat, Made, Sample
from sailenv_ros.recording.export.image_formats import scaled_depth
from sailenv_ros.recording.flow_formats import flo_from_backward, kitti_from_backward

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
    """KITTI's flow benchmark: a pair of pictures for each frame, and its flow.

    ``image_2/N_10.png`` is the frame, ``N_11.png`` the next one; ``flow_occ/N_10.png`` is the flow
    from the one to the other, ``flow_noc/N_10.png`` the same without what is occluded or leaves
    the picture. Backward flow, from the frame to the one before, lies in ``flow_backward_occ`` and
    ``flow_backward_noc``. ``depth/N_10.png`` is in steps of 1/256 m, 0 where there is none.
    """

    any_of: ClassVar[tuple[str, ...]] = ("rgb", "depth", "instance")
    needs_neighbours: ClassVar[bool] = True

    def add(self, sample: Sample) -> Made:
        """Write a frame's files."""
        folder, frame, name = self.folder / sample.split, sample.frame, f"{sample.stem}_10.png"
        pictures = 0
        if "rgb" in frame.views:
            write_png(folder / "image_2" / name, frame["rgb"])
            pictures += 1
            following = sample.following
            if following is not None and _have_one_past(frame, following):
                write_png(folder / "image_2" / f"{sample.stem}_11.png", following["rgb"])
        if "depth" in frame.views:
            write_png(folder / "depth" / name, scaled_depth(frame["depth"], 256.0))
            pictures += 1
        motions, left_out = motions_of(sample, self.flow)
        for direction, moved in motions.items():
            begin = "flow" if direction == "forward" else "flow_backward"
            visible = np.where(moved.visible[..., None], moved.flow, np.float32(np.nan))
            write_png(folder / f"{begin}_occ" / name, kitti_from_backward(moved.flow))
            write_png(folder / f"{begin}_noc" / name, kitti_from_backward(visible))
        written = {"pictures": pictures, "flow fields": len(motions)}
        return Made(written=written, left_out=left_out)


class SintelExport(DatasetFormat):
    """MPI-Sintel: ``clean/S/frame_0001.png``, ``flow/S/frame_0001.flo`` and masks, one S an epoch.

    ``occlusions``: 255 where the point is not seen in the other picture, because it is occluded or
    leaves it; ``outofframe``: 255 where it leaves; ``invalid``: 255 where there is no flow.
    Backward flow and its masks lie in folders that end in ``_backward``. The last frame has no flow
    forward and the first none backward, as in the original.
    """

    views: ClassVar[tuple[str, ...]] = ("rgb", "depth", "instance")
    is_sequence: ClassVar[bool] = True
    needs_neighbours: ClassVar[bool] = True

    def add(self, sample: Sample) -> Made:
        """Write a frame's files."""
        frame = sample.frame
        scene = f"{frame.scene}_{frame.epoch}"
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
                write_png(self.folder / f"{mask}{end}" / scene / f"{stem}.png", _mask(values))
        return Made(written={"pictures": 1, "flow fields": len(motions)}, left_out=left_out)


def _mask(values: NDArray[np.bool_]) -> NDArray[np.uint8]:
    return values.astype(np.uint8) * np.uint8(255)


def _have_one_past(frame: Frame, other: Frame) -> bool:
    return (frame.scene, frame.epoch) == (other.scene, other.epoch)


def _is_complete(frame: Frame) -> bool:
    return frame.states is not None and {"depth", "instance"} <= frame.views.keys()
