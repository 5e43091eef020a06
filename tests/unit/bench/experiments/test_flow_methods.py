"""Estimators of flow: direction and sign of what they give, networks by their file."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

from sailenv_bench.experiments.flow_methods import FlowMethod, opencv_methods
from sailenv_bench.experiments.flow_network import flow_network, network_input
from sailenv_bench.experiments.flow_scenes import texture
from sailenv_ros.errors import InvalidRequest
from tests.support.tiny_onnx import slice_network


@pytest.mark.parametrize("method", opencv_methods(), ids=lambda method: method.name)
def test_a_shifted_picture_flows_by_the_shift(method: FlowMethod) -> None:
    """What goes 2 px to the right and 1 px down has flow (2, 1) away from the borders."""
    first = np.ascontiguousarray(texture(160))
    second = np.roll(first, (1, 2), (0, 1))
    flow = method.compute(first, second)[30:-30, 30:-30]
    assert np.abs(np.median(flow, axis=(0, 1)) - (2.0, 1.0)).max() < 0.15


def test_a_networks_input_is_rgb_in_its_range() -> None:
    """Blue, green, red of 0 to 255 become red, green, blue up to what white is."""
    bgr = np.zeros((4, 6, 3), np.uint8)
    bgr[..., 2] = 255
    array = network_input(bgr, (6, 4), 1.0)
    assert array.shape == (1, 3, 4, 6)
    assert array.dtype == np.float32
    assert (array[0, 0] == 1.0).all()
    assert not array[0, 1:].any()


def test_an_onnx_network_is_run_at_its_own_size_and_scaled_back(tmp_path: Path) -> None:
    """Flow in pixels of a smaller picture becomes flow in pixels of the picture itself.

    The network gives the first picture's red and green as its flow.
    """
    path = tmp_path / "net.onnx"
    path.write_bytes(slice_network(height=32, width=64))
    method = flow_network(path)
    first = np.zeros((64, 128, 3), np.uint8)
    first[..., 2], first[..., 1] = 10, 20
    flow = method.compute(first, first)
    assert method.label == "net"
    assert flow.shape == (64, 128, 2)
    np.testing.assert_allclose(flow[..., 0], 20.0)
    np.testing.assert_allclose(flow[..., 1], 40.0)


@pytest.mark.parametrize("name", ["missing.onnx", "net.txt", "broken.onnx"])
def test_what_is_no_network_is_refused(tmp_path: Path, name: str) -> None:
    """In one sentence that names the file."""
    if name != "missing.onnx":
        (tmp_path / name).write_bytes(b"no network")
    with pytest.raises(InvalidRequest, match="flow network"):
        flow_network(tmp_path / name)


def test_the_texture_has_detail_at_every_scale() -> None:
    """An estimator that needs structure finds it near and far."""
    picture = cv2.cvtColor(texture(), cv2.COLOR_BGR2GRAY).astype(np.float64)
    for factor in (1, 4, 16):
        small = cv2.resize(picture, None, fx=1 / factor, fy=1 / factor, interpolation=3)
        assert np.abs(np.diff(small, axis=1)).mean() > 2.0
