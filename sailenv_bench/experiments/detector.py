"""A COCO detector from an ONNX file: a picture in, `Detections` in the picture's pixels out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from sailenv_bench.experiments.decoders import DECODERS, class_indices, recognised
from sailenv_bench.experiments.detections import Detections
from sailenv_ros.errors import InvalidRequest, UnknownName
from sailenv_ros.extras import need

__all__ = ["INPUTS", "Detector", "Fitted", "InputStyle", "fitted"]

Size = tuple[int, int]


@dataclass(frozen=True, slots=True, kw_only=True)
class InputStyle:
    """Format of the picture that a network takes as its input.

    Attributes
    ----------
    order : {'rgb', 'bgr'}
    white : float
        What 255 becomes before `mean` is subtracted and `std` divides.
    mean, std : (3,) tuple of float
        In the network's order of channels.
    pad : int
        Value of the border where the picture does not fill the input, 0 to 255.
    """

    order: str
    white: float = 255.0
    mean: tuple[float, float, float] = (0.0, 0.0, 0.0)
    std: tuple[float, float, float] = (1.0, 1.0, 1.0)
    pad: int = 114


INPUTS: Mapping[str, InputStyle] = MappingProxyType(
    {
        "nanodet": InputStyle(
            order="bgr", mean=(103.53, 116.28, 123.675), std=(57.375, 57.12, 58.395), pad=0
        ),
        "centernet": InputStyle(
            order="bgr", white=1.0, mean=(0.408, 0.447, 0.470), std=(0.289, 0.274, 0.278), pad=0
        ),
        "yolo": InputStyle(order="rgb", white=1.0),
        # torchvision's normalises by itself; that of the ONNX model zoo wants BGR without means.
        "maskrcnn": InputStyle(order="rgb", white=1.0, pad=0),
        "maskrcnn-zoo": InputStyle(order="bgr", mean=(102.9801, 115.9465, 122.7717), pad=0),
    }
)
"""Input formats of the published networks, by the format of their outputs."""


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Fitted:
    """A picture in a network's input.

    Attributes
    ----------
    picture : (H, W, 3) uint8
        RGB, of the input's size.
    scale : float
        Input pixels per picture pixel.
    left, top : int
        Border before the picture [px of the input].
    size : (width, height)
        Of the picture itself [px].
    """

    picture: NDArray[np.uint8]
    scale: float
    left: int
    top: int
    size: Size

    def back(self, found: Detections) -> Detections:
        """Bring detections back into the picture."""
        shift = np.array([self.left, self.top, self.left, self.top])
        boxes = (found.boxes - shift) / self.scale
        width, height = self.size
        boxes = np.clip(boxes, 0.0, (width, height, width, height))
        masks = None if found.masks is None else tuple(self._mask(m) for m in found.masks)
        return Detections(boxes=boxes, scores=found.scores, classes=found.classes, masks=masks)

    def _mask(self, mask: NDArray[np.bool_]) -> NDArray[np.bool_]:
        down, across = (round(length * self.scale) for length in self.size[::-1])
        part = mask[self.top : self.top + down, self.left : self.left + across]
        grown = cv2.resize(part.astype(np.uint8), self.size, interpolation=cv2.INTER_NEAREST)
        return np.asarray(grown, np.bool_)


def fitted(picture: NDArray[np.uint8], size: Size, pad: int) -> Fitted:
    """Scale a picture (H, W, 3) into a size, its proportions kept, with equal borders."""
    height, width = picture.shape[:2]
    scale = min(size[0] / width, size[1] / height)
    across, down = round(width * scale), round(height * scale)
    scaled: Any = picture
    if (across, down) != (width, height):
        scaled = cv2.resize(picture, (across, down), interpolation=cv2.INTER_LINEAR)
    left, top = (size[0] - across) // 2, (size[1] - down) // 2
    whole = np.full((size[1], size[0], 3), pad, np.uint8)
    whole[top : top + down, left : left + across] = scaled
    return Fitted(picture=whole, scale=scale, left=left, top=top, size=(width, height))


class Detector:
    """A network.

    Parameters
    ----------
    path : Path
        Of the ONNX file.
    format_ : str
        A name of `INPUTS`; ``auto`` recognises the network by its outputs.
    labels : {'auto', 'coco80', 'coco91'}
        Of Mask R-CNN: the 80 names counted from 1, or ids of COCO's files; ``auto`` takes
        ``coco91``, torchvision's, but for ``maskrcnn-zoo``.

    Attributes
    ----------
    format : str
        A name of `INPUTS`.
    size : (width, height)
        Of the network's input [px].

    Raises
    ------
    MissingPackage
        Without onnxruntime.
    InvalidRequest
        If the file is no such network.
    """

    def __init__(
        self,
        path: Path,
        format_: str = "auto",
        *,
        labels: str = "auto",
        size: Size | None = None,
    ) -> None:
        if format_ != "auto" and format_ not in INPUTS:
            raise UnknownName("format of the detector", format_, ("auto", *INPUTS))
        if not path.is_file():
            raise InvalidRequest("model", str(path), "the path of an ONNX file")
        runtime = need("onnxruntime", "a detector")
        try:
            self._session = runtime.InferenceSession(
                str(path), providers=runtime.get_available_providers()
            )
        except Exception as problem:  # of onnxruntime's own many kinds
            raise InvalidRequest("model", str(path), f"an ONNX file ({problem})") from None
        first = self._session.get_inputs()[0]
        self._name, self._rank = first.name, len(first.shape)
        self.size = size or _declared_size(first.shape) or (640, 640)
        self._names = [output.name for output in self._session.get_outputs()]
        if format_ == "auto":
            empty = np.zeros((3, self.size[1], self.size[0]), np.float32)
            format_ = recognised(self._outputs(empty))
        self.format = format_
        self._of_files = labels == "coco91" or (labels == "auto" and format_ == "maskrcnn")

    def detect(self, picture: NDArray[np.uint8]) -> Detections:
        """Find objects in a picture (H, W, 3) RGB."""
        style = INPUTS[self.format]
        fit = fitted(picture, self.size, style.pad)
        image = fit.picture if style.order == "rgb" else fit.picture[..., ::-1]
        scaled = image.astype(np.float32) * np.float32(style.white / 255.0)
        values = (scaled - np.asarray(style.mean)) / np.asarray(style.std)
        outputs = self._outputs(np.ascontiguousarray(values.transpose(2, 0, 1), np.float32))
        kind = self.format.partition("-")[0]
        found = DECODERS[kind](outputs, self.size)
        if kind == "maskrcnn":
            found = Detections(
                boxes=found.boxes,
                scores=found.scores,
                classes=class_indices(found.classes, of_files=self._of_files),
                masks=found.masks,
            )
        return fit.back(found)

    def _outputs(self, image: NDArray[np.float32]) -> dict[str, Any]:
        fed = image[None] if self._rank == 4 else image
        return dict(zip(self._names, self._session.run(None, {self._name: fed}), strict=True))


def _declared_size(shape: Sequence[Any]) -> Size | None:
    """Return (width, height) of an input (…, 3, H, W) that has one."""
    if len(shape) not in (3, 4) or shape[-3] != 3:
        raise InvalidRequest("input of the detector", list(shape), "(1, 3, H, W) or (3, H, W)")
    down, across = shape[-2:]
    return (across, down) if isinstance(down, int) and isinstance(across, int) else None
