"""Frames → the pickles of TAP-Vid: videos, tracks of points through them, and what is hidden.

C. Doersch et al., "TAP-Vid: A Benchmark for Tracking Any Point in a Video", 2022: a dict of
videos by name, each with ``video`` (T, H, W, 3) uint8, ``points`` (N, T, 2) float32 and
``occluded`` (N, T) bool. Points are in raster coordinates: (0, 0) is the upper left corner of the
picture, (1, 1) the lower right one.
"""

from __future__ import annotations

import pickle
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.dataset.formats.data_files import write_bytes, write_png
from sailenv_ros.dataset.formats.dataset_format import DatasetFormat, Record, Sample, WriteResult
from sailenv_ros.errors import InvalidRequest, RecordingError
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.motion import SceneGeometry, Tracks, track
from sailenv_ros.frame.pictures.codecs import decode_picture
from sailenv_ros.simulation.recorded_geometry import recorded_geometry, with_skin

__all__ = ["TapVidExport", "tapvid_entry"]

POINTS = 256
"""Tracks of each video."""

LONGEST = 250
"""Frames of one video; a longer recording becomes several."""


class TapVidExport(DatasetFormat):
    """``tapvid.pkl``, and the pictures that it is made of in ``frames/``.

    The tracked points are what random pixels of random frames show, the same for the same
    recording. What was spawned from models that are not in the catalogue cannot be tracked.
    """

    views: ClassVar[tuple[str, ...]] = ("rgb",)
    is_sequence: ClassVar[bool] = True
    resumable: ClassVar[bool] = False

    def __init__(self, folder: Path) -> None:
        super().__init__(folder)
        self._frames: list[Frame] = []

    def add(self, sample: Sample) -> WriteResult:
        """Write a frame's picture and keep where everything was."""
        frame = sample.frame
        if frame.states is None:
            raise RecordingError("TAP-Vid needs the states of instances, which were not recorded")
        sample.scene_info("TAP-Vid")
        write_png(self._picture(sample.number), frame["rgb"])
        self._frames.append(with_skin(replace(frame, views={})))
        return WriteResult(written={"pictures": 1})

    def finish(self, records: Sequence[Record]) -> None:
        """Follow the points and write the pickle."""
        videos: dict[str, dict[str, NDArray[Any]]] = {}
        for first, frames in _videos(self._frames):
            info = frames[-1].info
            assert info is not None
            pictures = np.stack([self._read(first + k) for k in range(len(frames))])
            geometry = recorded_geometry(info)
            name = f"{frames[0].scene}_{frames[0].epoch}_{first:06d}"
            videos[name] = tapvid_entry(pictures, frames, geometry, seed=first)
        write_bytes(self.folder / "tapvid.pkl", pickle.dumps(videos, protocol=4))

    def _picture(self, number: int) -> Path:
        return self.folder / "frames" / f"{number:06d}.png"

    def _read(self, number: int) -> NDArray[np.uint8]:
        path = self._picture(number)
        try:
            return decode_picture(path.read_bytes())
        except (OSError, InvalidRequest) as problem:
            raise RecordingError(f"{path} cannot be read: {problem}") from None


def tapvid_entry(
    pictures: NDArray[np.uint8],
    frames: Sequence[Frame],
    geometry: SceneGeometry,
    *,
    count: int = POINTS,
    seed: int = 0,
) -> dict[str, NDArray[Any]]:
    """Return one video of a TAP-Vid pickle.

    Parameters
    ----------
    pictures : (T, H, W, 3) uint8
        Red, green, blue.
    frames : sequence of Frame
        T frames, of which no view is read.
    geometry : SceneGeometry
    count : int
        Tracks; pixels that show nothing have none, so there may be fewer.
    seed : int
        Of the choice of points.

    Returns
    -------
    video : dict
        ``video``, ``points``, ``occluded``.

    Raises
    ------
    InvalidRequest
        As `track`.
    """
    rng = np.random.default_rng(seed)
    lens = frames[0].camera.intrinsics
    queries = np.stack(
        [
            rng.integers(0, len(frames), count),
            rng.integers(0, lens.width, count),
            rng.integers(0, lens.height, count),
        ],
        axis=1,
    )
    tracks = track(queries, frames, geometry)
    return {"video": pictures, **_of_tracks(tracks, lens.width, lens.height)}


def _of_tracks(tracks: Tracks, width: int, height: int) -> dict[str, NDArray[Any]]:
    known = tracks.instances > 0
    # Behind the camera a point has no place; readers want numbers where it is occluded, too.
    pixels = np.nan_to_num(tracks.pixels[known], nan=-0.5)
    points = (pixels + 0.5) / np.array([width, height])
    return {"points": points.astype(np.float32), "occluded": tracks.occluded[known]}


def _videos(frames: Sequence[Frame]) -> list[tuple[int, list[Frame]]]:
    """Cut frames into videos: where the epoch changes, and where one becomes too long."""
    videos: list[tuple[int, list[Frame]]] = []
    for number, frame in enumerate(frames):
        last = videos[-1][1] if videos else []
        same = last and (last[0].scene, last[0].epoch) == (frame.scene, frame.epoch)
        if same and len(last) < LONGEST:
            last.append(frame)
        else:
            videos.append((number, [frame]))
    return videos
