"""Flow in other programs' conventions: known motions by hand, and there and back."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from sailenv_ros.dataset.formats.flow_files import (
    backward_from_flo,
    backward_from_kitti,
    backward_px,
    carla_from_flow,
    flo_from_backward,
    flow_from_backward,
    flow_from_carla,
    flow_from_kubric,
    kitti_from_backward,
    kubric_from_flow,
)
from sailenv_ros.errors import InvalidRequest

number = st.floats(-500.0, 500.0, width=32) | st.just(float("nan"))
flows = arrays.arrays(np.float32, st.tuples(st.integers(1, 4), st.integers(1, 5), st.just(2)),
                      elements=number)  # fmt: skip


def test_a_known_motion_in_every_convention() -> None:
    """A point that went 4 px right and 2 px down in 0.1 s, in a picture of 8 x 4."""
    flow = np.zeros((4, 8, 2), np.float32)
    flow[1, 2] = (40.0, 20.0)
    np.testing.assert_allclose(backward_px(flow, 0.1)[1, 2], (-4.0, -2.0), rtol=1e-6)
    np.testing.assert_allclose(kubric_from_flow(flow, 0.1)[1, 2], (2.0, 4.0), rtol=1e-6)
    # Half of the width is 4 px and half of the height 2 px; y is up.
    np.testing.assert_allclose(carla_from_flow(flow, 0.1)[1, 2], (1.0, -1.0), rtol=1e-6)


def test_backward_displacement_finds_the_previous_pixel() -> None:
    """OpenCV's remap of the previous picture by it gives the present one."""
    noise = np.random.default_rng(3)
    before = noise.integers(0, 255, (20, 30)).astype(np.uint8)
    now = np.roll(before, (3, 5), (0, 1))
    flow = np.full((20, 30, 2), (50.0, 30.0), np.float32)
    grid = np.stack(np.meshgrid(np.arange(30), np.arange(20)), axis=-1).astype(np.float32)
    back = cv2.remap(before, grid + backward_px(flow, 0.1), None, cv2.INTER_NEAREST)
    assert (back[3:, 5:] == now[3:, 5:]).all()


@given(flow=flows, dt_s=st.floats(0.001, 1.0))
def test_conventions_there_and_back(flow: np.ndarray, dt_s: float) -> None:
    """Every convention keeps the flow, and where there is none."""
    for there, back in (
        (backward_px, flow_from_backward),
        (kubric_from_flow, flow_from_kubric),
        (carla_from_flow, flow_from_carla),
    ):
        np.testing.assert_allclose(back(there(flow, dt_s), dt_s), flow, rtol=1e-5, atol=1e-3)


@given(flow=flows)
def test_files_there_and_back(flow: np.ndarray) -> None:
    """.flo keeps every bit where there is flow; KITTI keeps it to half a step of 1/64 px."""
    gone = np.isnan(flow).any(axis=-1)
    read = backward_from_flo(flo_from_backward(flow))
    assert np.isnan(read[gone]).all()
    assert (read[~gone] == flow[~gone]).all()
    kitti = backward_from_kitti(kitti_from_backward(flow))
    assert np.isnan(kitti[gone]).all()
    assert np.abs(kitti[~gone] - flow[~gone]).max(initial=0.0) <= 1 / 128


def test_opencv_reads_flo_files(tmp_path: Path) -> None:
    """The file that OpenCV reads has our displacements, and its own is read by us."""
    flow = np.random.default_rng(1).normal(0, 30, (6, 9, 2)).astype(np.float32)
    path = tmp_path / "a.flo"
    path.write_bytes(flo_from_backward(flow))
    assert (cv2.readOpticalFlow(str(path)) == flow).all()
    cv2.writeOpticalFlow(str(path), flow)
    assert (backward_from_flo(path.read_bytes()) == flow).all()


def test_what_is_too_fast_for_kitti_is_not_valid() -> None:
    """Beyond ±512 px there is no number for it, so it is marked as unknown."""
    flow = np.array([[[600.0, 0.0], [511.9, -512.0], [0.0, 0.0]]], np.float32)
    assert kitti_from_backward(flow)[..., 2].tolist() == [[0, 1, 1]]
    assert kitti_from_backward(flow)[0, 2].tolist() == [32768, 32768, 1]


def test_what_is_no_flo_file_is_refused() -> None:
    """Another tag, a cut file, a time that is none."""
    whole = flo_from_backward(np.zeros((2, 3, 2), np.float32))
    for data in (b"", b"PIEX" + whole[4:], whole[:-1], whole[:8]):
        with pytest.raises(InvalidRequest, match=r"\.flo file"):
            backward_from_flo(data)
    with pytest.raises(InvalidRequest, match="dt_s"):
        flow_from_backward(np.zeros((2, 3, 2), np.float32), 0.0)
