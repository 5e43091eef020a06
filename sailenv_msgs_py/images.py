"""Views of a frame to and from `sensor_msgs/Image`.

An array of the dtype and shape that `sailenv_ros.types.views.VIEWS` gives becomes a message of that
view's encoding, and the inverse is exact, bit for bit. Truth values travel as 0 and 255.
Receiving copies nothing: the array lies on the message's own bytes.
"""

from __future__ import annotations

import array
import sys
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sensor_msgs.msg import Image
from std_msgs.msg import Header

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.types.view_spec import ViewSpec
from sailenv_ros.types.views import view_spec

__all__ = ["image_from_view", "picture_to_image", "view_from_image"]

_TRUE = 255


def image_from_view(view: str, values: NDArray[Any], header: Header, *, copy: bool = True) -> Image:
    """Make the message of one view.

    Parameters
    ----------
    view : str
        A name in `sailenv_ros.types.views.VIEWS`.
    values : (H, W) or (H, W, C) array
        Of the view's own dtype and channels.
    header : Header
        Shared with the other views of the frame; kept, not copied.
    copy : bool
        False has the message look at the array's own memory where it can: for one that is
        published and let go, of an array that is not written again.

    Returns
    -------
    image : Image
        Row-major, top row first, little-endian.

    Raises
    ------
    UnknownName
        If there is no such view.
    InvalidRequest
        If the array is not of the view's dtype and shape.
    """
    spec = view_spec(view)
    fits = values.ndim >= 2 and values.shape == spec.shape(*values.shape[:2])
    if values.dtype not in spec.dtypes or not fits:
        types = " or ".join(map(str, spec.dtypes))
        wanted = f"an array {_shape_of(spec)} of {types}"
        raise InvalidRequest(f"view {view}", f"{values.shape} of {values.dtype}", wanted)
    if spec.dtype == np.bool_:
        values = values.view(np.uint8) * np.uint8(_TRUE)
    encoding = spec.encoding if spec.dtype == np.bool_ else spec.encoding_of(values.dtype)
    return _image(values, encoding, header, copy=copy)


def picture_to_image(rgb: NDArray[np.uint8], header: Header) -> Image:
    """Make the message of an (H, W, 3) uint8 RGB picture."""
    if rgb.dtype != np.uint8 or rgb.ndim != 3 or rgb.shape[2] != 3:
        raise InvalidRequest("picture", f"{rgb.shape} of {rgb.dtype}", "(H, W, 3) of uint8")
    return _image(rgb, "rgb8", header, copy=True)


def view_from_image(view: str, image: Image) -> NDArray[Any]:
    """Read a view out of its message.

    Returns
    -------
    values : (H, W) or (H, W, C) array
        As `sailenv_ros.types.views.VIEWS` says. It shares the message's bytes (truth values are a
        copy); write to it only if nobody else has the message.

    Raises
    ------
    UnknownName
        If there is no such view.
    InvalidRequest
        If encoding, byte order, step or size do not fit.
    """
    spec = view_spec(view)
    is_wide = spec.wide_dtype is not None and image.encoding == spec.wide_encoding
    held = spec.dtype if spec.wide_dtype is None or not is_wide else spec.wide_dtype
    stored = np.dtype(np.uint8) if spec.dtype == np.bool_ else held
    row_bytes = image.width * spec.channels * stored.itemsize
    if not is_wide:
        _require(view, "encoding", image.encoding, spec.encoding)
    if stored.itemsize > 1:
        _require(view, "is_bigendian", int(image.is_bigendian), int(sys.byteorder == "big"))
    if image.step < row_bytes:
        raise InvalidRequest(f"step of the {view} image", image.step, f"at least {row_bytes} [B]")
    _require(view, "size of the data", len(image.data), image.step * image.height)
    rows = np.frombuffer(image.data, dtype=np.uint8).reshape(image.height, image.step)
    packed = rows[:, :row_bytes]
    # Padded rows (of a foreign publisher) cannot be looked at as wider numbers in place.
    values = (packed if packed.flags.c_contiguous else packed.copy()).view(stored)
    values = values.reshape(spec.shape(image.height, image.width))
    return values != 0 if spec.dtype == np.bool_ else values


def _image(values: NDArray[Any], encoding: str, header: Header, *, copy: bool) -> Image:
    height, width = values.shape[:2]
    contiguous = np.ascontiguousarray(values)
    image = Image(
        header=header,
        height=height,
        width=width,
        encoding=encoding,
        is_bigendian=int(sys.byteorder == "big"),
        step=contiguous.nbytes // height if height else 0,
    )
    own_bytes = contiguous.data.cast("B") if contiguous.size else memoryview(b"")
    if copy:
        # The fastest way by the front door: one copy, and no look at each byte as with `bytes`.
        image.data = array.array("B")
        image.data.frombytes(own_bytes)
    else:
        # Publishing reads any buffer; only the attribute's setter would turn it into an array.
        image._data = own_bytes
    return image


def _require(view: str, what: str, got: object, wanted: object) -> None:
    if got != wanted:
        raise InvalidRequest(f"{what} of the {view} image", got, repr(wanted))


def _shape_of(spec: ViewSpec) -> str:
    return "(H, W)" if spec.channels == 1 else f"(H, W, {spec.channels})"
