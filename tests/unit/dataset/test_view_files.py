"""Views as files: exact by default, as small as a recipe asks for, told where it is wrong."""

from __future__ import annotations

import io
import tracemalloc
import zipfile
from pathlib import Path
from typing import Any, get_args

import numpy as np
import pytest
import zstandard

from sailenv_ros import dataset
from sailenv_ros.dataset import RecipeError, engine_of, load_job, make_dataset, verify_dataset
from sailenv_ros.dataset.formats.view_files import (
    COMPRESSIONS,
    ENDINGS,
    Compression,
    as_kept,
    compression_fault,
    decoded,
    encoded,
)
from sailenv_ros.dataset.showing import save_sheet
from sailenv_ros.types.picture_settings import MAX_SIZE_PX
from sailenv_ros.types.views import RENDERED_VIEWS, VIEWS
from tests.unit.dataset.conftest import written_recipe

RANDOM = np.random.default_rng(2)
CASES: list[tuple[str, Compression | None]] = [
    (view, kind)
    for view in RENDERED_VIEWS
    for kind in (None, *get_args(Compression))
    if kind is None or not compression_fault(view, kind)
]


def values_of(view: str) -> Any:
    spec = VIEWS[view]
    shape = spec.shape(13, 17)
    if np.issubdtype(spec.dtype, np.floating):
        made = RANDOM.uniform(0.1, 60.0, shape).astype(spec.dtype)
        made[0], made[1, 2] = np.inf, 1e6
        return made
    return RANDOM.integers(2 if spec.dtype == np.bool_ else 200, size=shape).astype(spec.dtype)


@pytest.mark.parametrize(("view", "kind"), CASES)
def test_a_view_comes_back(view: str, kind: Compression | None) -> None:
    """Exactly where that is said, else as near as is said; in the type that frames have."""
    values = values_of(view)
    ending, contents = encoded(view, values, kind)
    assert ending in ENDINGS
    data = b"".join(bytes(one) for one in contents)
    again = decoded(view, ending, data)
    assert again.dtype == values.dtype
    assert np.array_equal(as_kept(view, values, kind), again)
    if kind is None or COMPRESSIONS[kind].startswith("exact"):
        assert again.tobytes() == values.tobytes()
        return
    assert COMPRESSIONS[kind].startswith("lossy")
    near = values < 60.5
    assert np.isinf(again[~near]).all()
    gap = np.abs(again[near] - values[near])
    assert gap.max() <= (0.0005001 if kind == "png16" else 60.5 / 2048)


def test_the_files_are_those_of_numpy() -> None:
    """And the same bytes each time."""
    values = values_of("depth")
    _, (npz,) = encoded("depth", values, "npz")
    with np.load(io.BytesIO(bytes(npz))) as file:
        assert np.array_equal(file["depth"], values)
    for kind in (None, *get_args(Compression)):
        one, other = ([bytes(part) for part in encoded("depth", values, kind)[1]] for _ in range(2))
        assert one == other


def test_a_file_that_is_damaged_is_refused() -> None:
    _, (data,) = encoded("depth", values_of("depth"), "zstd")
    with pytest.raises(ValueError, match="depth"):
        decoded("depth", "npy.zst", bytes(data)[:-9])


@pytest.mark.parametrize("ending", ["npy.zst", "npz"])
def test_a_file_that_unpacks_to_more_than_any_picture_is_refused(ending: str) -> None:
    """Before it takes memory; a frame that does not tell its size, too."""
    zeros = bytes(MAX_SIZE_PX * MAX_SIZE_PX * 4 + 2048)
    if ending == "npz":
        file = io.BytesIO()
        with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
            archive.writestr("depth.npy", zeros)
        files = [file.getvalue()]
    else:
        packing = zstandard.ZstdCompressor()
        untold = zstandard.ZstdCompressor(write_content_size=False)
        files = [packing.compress(zeros), untold.compress(zeros)]
    for data in files:
        tracemalloc.start()
        try:
            with pytest.raises(ValueError, match="depth"):
                decoded("depth", ending, data)
            assert tracemalloc.get_traced_memory()[1] < MAX_SIZE_PX * MAX_SIZE_PX * 4 + 2**20
        finally:
            tracemalloc.stop()


def test_a_data_set_is_read_again_and_is_smaller(tmp_path: Path) -> None:
    """Opened, checked, shown and streamed; what is not named is as it was."""
    camera = {
        "type": "fixed", "name": "eye", "position": [5.0, 0.0, 2.0], "look_at": [0, 0, 1],
        "width": 96, "height": 64,
    }  # fmt: skip
    settings = {"cameras": [camera], "formats": ["webdataset"], "light": "plain"}
    compression = [
        {"views": ["depth"], "kind": "png16"}, {"views": ["flow", "instance"], "kind": "zstd"},
        {"views": ["normals"], "kind": "float16_zstd"}, {"views": ["category"], "kind": "npz"},
    ]  # fmt: skip
    views = ["rgb", "depth", "category", "instance", "flow", "normals"]
    made, jobs = {}, {}
    for name, more in (("plain", {}), ("small", {"compression": compression})):
        path = written_recipe(tmp_path / name, views=views, **settings, **more)
        jobs[name] = load_job(path)
        made[name] = make_dataset(jobs[name], tmp_path / name / "made", engine_of(1, None))
    assert made["small"].bytes < 0.5 * made["plain"].bytes
    assert verify_dataset(tmp_path / "small" / "made") == []
    assert save_sheet(tmp_path / "small" / "made", tmp_path / "sheet.png", frames=2) == 2
    plain, small = (dataset.open(tmp_path / name / "made") for name in ("plain", "small"))
    for one, other, streamed in zip(plain, small, dataset.stream(jobs["small"]), strict=True):
        for view in views:
            assert other.frame[view].dtype == one.frame[view].dtype
            assert np.array_equal(other.frame[view], streamed.frame[view], equal_nan=True)
        for view in ("rgb", "category", "instance", "flow"):
            assert np.array_equal(one.frame[view], other.frame[view], equal_nan=True)
        hit = np.isfinite(one.frame["depth"])
        assert np.abs(one.frame["depth"][hit] - other.frame["depth"][hit]).max() <= 0.0006
        assert np.abs(one.frame["normals"] - other.frame["normals"]).max() < 0.001


def test_what_cannot_be_compressed_so_is_told(tmp_path: Path) -> None:
    """Each with its place in the recipe."""
    wrong = [
        {"views": ["depth", "uv"], "kind": "zstd"}, {"views": ["depth"], "kind": "npz"},
        {"views": ["instance"], "kind": "float16"}, {"views": ["flow"], "kind": "png16"},
    ]  # fmt: skip
    path = written_recipe(tmp_path, compression=wrong)
    with pytest.raises(RecipeError) as caught:
        load_job(path)
    assert [one.field for one in caught.value.diagnostics] == [
        "compression[0].views[1]", "compression[1].views[0]", "compression[2].views[0]",
        "compression[3].views[0]",
    ]  # fmt: skip
    for text in (
        "is not among",
        "named twice",
        "real numbers alone",
        "takes depth, range, measured_depth alone",
    ):
        assert text in str(caught.value)
    path = written_recipe(tmp_path, formats=["coco"], compression=[wrong[1]])
    with pytest.raises(RecipeError, match="is known to the format webdataset alone"):
        load_job(path)
