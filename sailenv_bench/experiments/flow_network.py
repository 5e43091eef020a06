"""A flow network from a file as a `FlowMethod`: ONNX or TorchScript.

A path in, a method out. Networks want two RGB pictures as float, each (1, 3, H, W), or both in one
(1, 6, H, W), and give (1, 2, H, W) or (1, H, W, 2); other outputs before the last are ignored.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from sailenv_bench.experiments.flow_methods import Flow, FlowMethod, Picture
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.extras import need

__all__ = ["flow_network", "network_input"]

MULTIPLE_PX = 64
"""Sizes that networks without one of their own are fed with are multiples of this."""


def flow_network(path: Path, *, value_range: float = 255.0) -> FlowMethod:
    """Load a network.

    Parameters
    ----------
    path : Path
        ``.onnx``, or ``.pt`` / ``.pth`` / ``.torchscript`` of TorchScript.
    value_range : float
        What white is in the network's input: 255 (RAFT) or 1 (LiteFlowNet, PWC-Net).

    Raises
    ------
    InvalidRequest
        If there is no such file, or it is no network with such an input.
    MissingPackage
        If onnxruntime or torch is not installed.
    """
    if not path.is_file():
        raise InvalidRequest("flow network", str(path), "the path of an .onnx or .pt file")
    if path.suffix.lower() == ".onnx":
        run, size = _onnx(path)
    elif path.suffix.lower() in (".pt", ".pth", ".torchscript"):
        run, size = _torch(path), None
    else:
        raise InvalidRequest("flow network", path.name, "an .onnx or .pt file")

    def compute(first: Picture, second: Picture) -> Flow:
        height, width = first.shape[:2]
        across, down = size or (_whole(width), _whole(height))
        pair = [network_input(picture, (across, down), value_range) for picture in (first, second)]
        flow = _channels_last(run(pair[0], pair[1]))
        scale = np.array([width / flow.shape[1], height / flow.shape[0]], np.float32)
        resized = cv2.resize(flow, (width, height), interpolation=cv2.INTER_LINEAR)
        return np.asarray(resized * scale, np.float32)

    return FlowMethod(name=path.stem, label=path.stem, compute=compute)


def network_input(bgr: Picture, size: tuple[int, int], value_range: float) -> NDArray[np.float32]:
    """Turn a picture into (1, 3, H, W) float32, RGB from 0 to `value_range`, of size (W, H)."""
    rgb = cv2.cvtColor(bgr, cv2.COLOR_BGR2RGB)
    if (rgb.shape[1], rgb.shape[0]) != size:
        rgb = cv2.resize(rgb, size, interpolation=cv2.INTER_LINEAR)
    scaled = rgb.astype(np.float32) * np.float32(value_range / 255.0)
    return np.ascontiguousarray(scaled.transpose(2, 0, 1)[None])


def _whole(length_px: int) -> int:
    return -(-length_px // MULTIPLE_PX) * MULTIPLE_PX


def _onnx(path: Path) -> tuple[Callable[[Any, Any], Any], tuple[int, int] | None]:
    """Return what runs a network, and the size (W, H) it was made for, if any."""
    runtime = need("onnxruntime", "a flow network")
    try:
        session = runtime.InferenceSession(str(path), providers=runtime.get_available_providers())
    except Exception as problem:  # of onnxruntime's own many kinds
        raise InvalidRequest("flow network", str(path), f"an ONNX file ({problem})") from None
    inputs = session.get_inputs()
    channels = [entry.shape[1] if len(entry.shape) == 4 else None for entry in inputs]
    if channels not in ([3, 3], [6]):
        got = ", ".join(str(entry.shape) for entry in inputs)
        accepted = "two of (1, 3, H, W) or one of (1, 6, H, W)"
        raise InvalidRequest("inputs of the flow network", got, accepted)
    names = [entry.name for entry in inputs]

    def run(first: Any, second: Any) -> Any:
        arrays = (first, second) if len(names) == 2 else (np.concatenate([first, second], 1),)
        return session.run(None, dict(zip(names, arrays, strict=True)))[-1]

    down, across = inputs[0].shape[2:]
    fixed = isinstance(down, int) and isinstance(across, int)
    return run, (across, down) if fixed else None


def _torch(path: Path) -> Callable[[Any, Any], Any]:
    torch = need("torch", "a flow network")
    device = "cuda" if torch.cuda.is_available() else "cpu"
    try:
        network = torch.jit.load(str(path), map_location=device).eval()
    except RuntimeError as problem:
        raise InvalidRequest("flow network", str(path), f"TorchScript ({problem})") from None

    def run(first: Any, second: Any) -> Any:
        with torch.no_grad():
            arrays = (torch.from_numpy(array).to(device) for array in (first, second))
            flow = network(*arrays)
            flow = flow[-1] if isinstance(flow, list | tuple) else flow
            return flow.cpu().numpy()

    return run


def _channels_last(output: Any) -> Flow:
    """Turn (1, 2, H, W) or (1, H, W, 2) into (H, W, 2)."""
    array = np.asarray(output, np.float32)
    if array.ndim == 4 and array.shape[1] == 2:
        return np.ascontiguousarray(array[0].transpose(1, 2, 0))
    if array.ndim == 4 and array.shape[3] == 2:
        return np.ascontiguousarray(array[0])
    raise InvalidRequest("output of the flow network", array.shape, "(1, 2, H, W) or (1, H, W, 2)")
