"""Run lengths of masks, as COCO's own library reads them."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from pycocotools import mask as coco_mask

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.frame.truth.run_lengths import crop_runs, mask_of_runs, run_lengths

CROPS = arrays.arrays(np.bool_, st.tuples(st.integers(0, 9), st.integers(0, 9)))


@given(crop=CROPS, around=st.tuples(*[st.integers(0, 4)] * 4))
def test_runs_of_a_crop_are_those_of_the_whole_mask(
    crop: np.ndarray, around: tuple[int, int, int, int]
) -> None:
    """Wherever it lies, also where it fills the picture's height or is empty."""
    left, top, right, bottom = around
    whole = np.pad(crop, ((top, bottom), (left, right)))
    runs = crop_runs(crop, left, top, *whole.shape).tolist()
    if whole.size:
        assert runs == run_lengths(whole)
        assert (mask_of_runs(runs, *whole.shape) == whole).all()


# pycocotools' own, with NumPy 2.
@pytest.mark.filterwarnings("ignore:__array__ implementation doesn't accept:DeprecationWarning")
@given(mask=arrays.arrays(np.bool_, st.tuples(st.integers(1, 40), st.integers(1, 40))))
def test_pycocotools_reads_the_runs(mask: np.ndarray) -> None:
    """As uncompressed run lengths."""
    height, width = mask.shape
    encoded = coco_mask.frPyObjects(
        {"size": [height, width], "counts": run_lengths(mask)}, height, width
    )
    assert (coco_mask.decode(encoded).astype(bool) == mask).all()


def test_runs_of_another_size_are_refused() -> None:
    """They say what they should add up to."""
    with pytest.raises(InvalidRequest, match="add up to 12"):
        mask_of_runs([3, 4], 3, 4)
