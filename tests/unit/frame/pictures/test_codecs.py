"""Pictures as files: exact where nothing may be lost, refused in one sentence."""

from __future__ import annotations

import inspect
import io
import struct
from typing import get_args

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from PIL import Image

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.frame.pictures.codecs import (
    PngEffort,
    decode_picture,
    encode_inverse_depth,
    encode_jpeg,
    encode_png,
)
from sailenv_ros.native.library import native_library, using_instruction_set
from sailenv_ros.native.png_kernel import png_rows
from tests.support import allocator
from tests.support.programs import run

RANDOM = np.random.default_rng(1)
PICTURES: list[np.ndarray] = [
    RANDOM.integers(256, size=(37, 53, 3), dtype=np.uint8),
    RANDOM.integers(256, size=(37, 53), dtype=np.uint8),
    RANDOM.integers(65536, size=(37, 53), dtype=np.uint16),
    RANDOM.integers(65536, size=(37, 53, 3), dtype=np.uint16),
    np.kron(RANDOM.integers(300, size=(5, 7)), np.ones((9, 11), int)).astype(np.uint16),
    np.zeros((48, 64), np.uint8),
    RANDOM.random((37, 53)) < 0.5,
]


@pytest.mark.parametrize("effort", get_args(PngEffort))
@pytest.mark.parametrize("picture", PICTURES, ids=lambda one: f"{one.shape} {one.dtype}")
def test_pictures_are_kept_exactly(picture: np.ndarray, effort: PngEffort) -> None:
    data = encode_png(picture, effort)
    wanted = picture.astype(np.uint8) * 255 if picture.dtype == np.bool_ else picture
    found = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)
    assert found is not None
    assert np.array_equal(found[..., ::-1] if picture.ndim == 3 else found, wanted)
    again = decode_picture(data)
    assert again.dtype == wanted.dtype
    assert np.array_equal(again, wanted)


@settings(deadline=None, max_examples=60)
@given(
    shape=st.tuples(st.integers(1, 70), st.integers(1, 300)),
    colours=st.booleans(),
    wide=st.booleans(),
    kinds=st.integers(1, 65536),
    repeat=st.integers(1, 300),
    seed=st.integers(0, 1000),
)
def test_our_own_encoder_is_read_by_others(
    shape: tuple[int, int], colours: bool, wide: bool, kinds: int, repeat: int, seed: int
) -> None:
    """By two decoders that check sums; runs of any length, few and many values, any size."""
    random = np.random.default_rng(seed)
    height, width = shape
    count = height * width * (3 if colours else 1)
    values = np.repeat(random.integers(kinds, size=count // repeat + 1), repeat)[:count]
    picture = values.astype(np.uint16 if wide else np.uint8)
    picture = picture.reshape((height, width, 3) if colours else shape)
    data = encode_png(picture, "fastest")
    assert np.array_equal(decode_picture(data), picture)
    if not (colours and wide):  # which Pillow does not hold
        with Image.open(io.BytesIO(data)) as found:
            found.load()
            assert np.array_equal(np.asarray(found), picture)


def test_our_own_encoder_keeps_skewed_counts_within_the_longest_code() -> None:
    """Counts like Fibonacci's numbers make codes of more than 15 bits, which are not allowed."""
    counts = [1, 1]
    while len(counts) < 24:
        counts.append(counts[-1] + counts[-2])
    values = np.repeat(np.arange(24, dtype=np.uint8) * 7, counts)
    picture = np.random.default_rng(4).permutation(values)[: 300 * 400].reshape(300, 400)
    data = encode_png(np.cumsum(picture, axis=0, dtype=np.uint8), "fastest")
    assert np.array_equal(decode_picture(data), np.cumsum(picture, axis=0, dtype=np.uint8))


def test_our_own_encoder_writes_the_same_bytes_on_every_instruction_set() -> None:
    picture = PICTURES[0]
    made = set()
    for name in native_library().instruction_sets:
        with using_instruction_set(name):
            made.add(encode_png(picture, "fastest"))
    assert len(made) == 1


@pytest.mark.parametrize("picture", PICTURES, ids=lambda one: f"{one.shape} {one.dtype}")
def test_our_own_files_are_read_without_opencv(
    picture: np.ndarray, monkeypatch: pytest.MonkeyPatch
) -> None:
    """On every instruction set; what is read may be written to."""
    data = encode_png(picture, "fastest")
    wanted = decode_picture(encode_png(picture))
    monkeypatch.setattr(cv2, "imdecode", None)
    for name in native_library().instruction_sets:
        with using_instruction_set(name):
            found = decode_picture(data)
        assert (found.dtype, found.flags.writeable) == (wanted.dtype, True)
        assert found.dtype.isnative
        np.testing.assert_array_equal(found, wanted)


@pytest.mark.parametrize("picture", PICTURES[:3], ids=lambda one: f"{one.shape} {one.dtype}")
def test_damaged_files_are_read_or_refused_as_by_opencv(picture: np.ndarray) -> None:
    """Wherever a byte is another one, lacks or is too much."""
    data = encode_png(picture[:9, :7], "fastest")
    for place in range(len(data)):
        for changed in (
            data[:place] + bytes([data[place] ^ 0x21]) + data[place + 1 :],
            data[:place] + data[place + 1 :],
            data[:place],
            data[:place] + b"\x00" + data[place:],
        ):
            found = cv2.imdecode(np.frombuffer(changed, np.uint8), -1) if changed else None
            if found is None:
                with pytest.raises(InvalidRequest, match="a PNG or JPEG file"):
                    decode_picture(changed)
            else:
                wanted = found[..., ::-1] if found.ndim == 3 else found
                np.testing.assert_array_equal(decode_picture(changed), wanted)


def filtered_rows(rows: NDArray[np.uint8], step: int, filters: list[int]) -> bytes:
    """Filter rows as the PNG specification says (9.2)."""
    wide = np.pad(rows.astype(int), ((1, 0), (step, 0)))
    here, left = wide[1:, step:], wide[1:, :-step]
    up, corner = wide[:-1, step:], wide[:-1, :-step]
    far = np.abs(np.stack([left, up, corner]) - (left + up - corner))
    nearest = np.choose(far.argmin(axis=0), [left, up, corner])
    guesses = np.stack([0 * left, left, up, (left + up) // 2, nearest])
    data = np.empty((rows.shape[0], rows.shape[1] + 1), np.uint8)
    data[:, 0] = filters
    data[:, 1:] = (here - guesses[filters, np.arange(rows.shape[0])]) & 255
    return data.tobytes()


@settings(deadline=None, max_examples=150)
@given(
    shape=st.tuples(st.integers(1, 40), st.integers(1, 130)),
    step=st.integers(1, 8),
    filters=st.sampled_from([[0], [1], [2], [3], [4], [0, 1, 2, 3, 4], [4] * 9 + [2]]),
    spread=st.sampled_from([0.0, 1.0, 8.0, 300.0]),
    seed=st.integers(0, 1000),
)
def test_rows_are_read_by_every_filter(
    shape: tuple[int, int],
    step: int,
    filters: list[int],
    spread: float,
    seed: int,
) -> None:
    """As the specification has them, on every instruction set."""
    height, width = shape[0], shape[1] * step
    random = np.random.default_rng(seed)
    rows = random.normal(0.0, spread, (height, width)).astype(np.int64).astype(np.uint8)
    told = filtered_rows(rows, step, [filters[y % len(filters)] for y in range(height)])
    data = np.frombuffer(told, np.uint8).reshape(height, 1 + width)
    for name in native_library().instruction_sets:
        with using_instruction_set(name):
            np.testing.assert_array_equal(png_rows(data, step), rows)


def test_rows_without_a_filter_are_refused() -> None:
    assert png_rows(np.full((2, 9), 5, np.uint8), 1) is None


def test_labels_are_small() -> None:
    labels = np.kron(np.arange(48).reshape(6, 8), np.ones((80, 80), int)).astype(np.uint16)
    assert len(encode_png(labels, "fastest")) < 0.01 * labels.nbytes


def test_jpeg_has_the_colours_in_their_order() -> None:
    """Red stays red; a greater quality is nearer."""
    picture = np.full((32, 32, 3), (200, 40, 90), np.uint8)
    picture[8:24, 8:24] = (10, 180, 60)
    errors = []
    for quality in (20, 95):
        found = decode_picture(encode_jpeg(picture, quality))
        errors.append(np.abs(found.astype(int) - picture).mean())
        np.testing.assert_allclose(found.mean((0, 1)), picture.mean((0, 1)), atol=8.0)
    assert errors[1] < errors[0]


@pytest.mark.parametrize(
    "picture",
    [
        np.zeros((4, 4), np.float32), np.zeros((4, 4, 5), np.uint8), np.zeros(4, np.uint8),
        np.zeros((0, 4), np.uint8),
    ],
)  # fmt: skip
def test_what_is_no_picture_is_refused(picture: np.ndarray) -> None:
    for encode in (encode_png, lambda one: encode_jpeg(one, 90)):
        with pytest.raises(InvalidRequest, match="picture must be an array"):
            encode(picture)
    with pytest.raises(InvalidRequest, match="uint16"):
        encode_jpeg(np.zeros((4, 4), np.uint16), 90)
    with pytest.raises(InvalidRequest, match="picture must be an array"):
        encode_jpeg(np.zeros((4, 4, 4), np.uint8), 90)


def test_png_keeps_alpha() -> None:
    picture = np.arange(64, dtype=np.uint8).reshape(4, 4, 4)
    read = cv2.imdecode(np.frombuffer(encode_png(picture), np.uint8), cv2.IMREAD_UNCHANGED)
    np.testing.assert_array_equal(read[..., [2, 1, 0, 3]], picture)


@pytest.mark.parametrize("data", [b"", b"no picture", encode_png(PICTURES[0])[:20]])
def test_what_is_no_file_is_refused(data: bytes) -> None:
    with pytest.raises(InvalidRequest, match="a PNG or JPEG file"):
        decode_picture(data)


@pytest.mark.parametrize(
    "depth",
    [
        np.full((2, 3), np.inf, np.float32),
        np.full((2, 3), 2.5, np.float32),
        np.array([[0.05, 100.0, np.nan], [np.inf, 0.0, 3.0]], np.float32),
    ],
)
def test_inverse_depth_has_all_depths_to_half_a_step(depth: NDArray[np.float32]) -> None:
    """Also of a picture of one depth, of none, and of the greatest range."""
    data = encode_inverse_depth(depth)
    kind, scale, offset = struct.unpack("<iff", data[:12])
    levels = cv2.imdecode(np.frombuffer(data[12:], np.uint8), cv2.IMREAD_UNCHANGED)
    known = np.isfinite(depth) & (depth > 0)
    assert kind == 0
    assert np.array_equal(levels > 0, known)
    found = scale / (levels[known].astype(float) - offset)
    wanted = depth[known].astype(float)
    assert (np.abs(found - wanted) <= 1.01 * wanted**2 / (2 * scale) + 1e-6 * wanted).all()


# The package may be an installed one, beside which no `tests` stand: the program brings its own.
_THREADS = f"""{inspect.getsource(allocator)}
import threading
import numpy as np
from sailenv_ros.frame.pictures.codecs import decode_picture, encode_png
def work():
    decode_picture(encode_png(np.zeros((48, 64, 3), np.uint8), "quick"))
def in_threads(count):
    for _ in range(count):
        thread = threading.Thread(target=work)
        thread.start()
        thread.join()
    return allocations().uordblks
before = in_threads(20)
print((in_threads(200) - before) / 200)
"""


def test_threads_that_encode_leave_nothing() -> None:
    """OpenCV kept 0.9 kB of each thread that shared the change of the order of colours."""
    assert float(run(_THREADS)) < 200.0
