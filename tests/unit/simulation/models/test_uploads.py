"""Uploaded models: into the catalogue beside the running simulation, or refused without a trace."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sailenv_ros.errors import (
    AssetError,
    InvalidRequest,
    InvalidState,
    NameTaken,
    SailenvError,
    SimulationClosed,
    UnknownName,
)
from sailenv_ros.simulation import Simulation
from sailenv_ros.simulation.models import upload_queue as queue_module
from sailenv_ros.simulation.models.upload_queue import UploadQueue
from sailenv_ros.simulation.models.uploads import asset_from_upload, name_from_filename
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.validation import IDENTIFIER
from tests.support.upload_files import box_zip
from tests.support.waiting import until


@pytest.fixture(scope="module")
def simulation() -> Iterator[Simulation]:
    with Simulation("optical", mode="lockstep", backend="native") as simulation:
        yield simulation


def test_an_uploaded_model_can_be_spawned(simulation: Simulation) -> None:
    """It is in scene_info's catalogue, has the size that was asked for, and its category."""
    name = simulation.upload_model(
        box_zip(), name="crate", filename="box.ZIP", category="chair", height_m=0.5
    )
    assert name == "crate"
    assert "crate" in simulation.info.spawnables
    id_ = simulation.spawn_object("crate", pose=Pose((0.0, 0.0, 20.0)), remove_dynamics=False)
    state = simulation.get_object(id_)
    assert state.size_m == pytest.approx((0.5, 0.5, 0.5))
    assert state.category == "chair"


def test_a_name_of_the_files_is_made_free(simulation: Simulation) -> None:
    """Two uploads of one file are two models; a name that was asked for is not changed."""
    first, second = (
        simulation.upload_model(box_zip(), name="", filename="My Box (1).zip") for _ in range(2)
    )
    assert (first, second) == ("my_box_1", "my_box_1_2")
    with pytest.raises(NameTaken):
        simulation.upload_model(box_zip(), name=first, filename="a.zip")


@pytest.mark.parametrize(
    ("arguments", "error", "words"),
    [
        ({"filename": "box.exe"}, InvalidRequest, "ends in .zip or .glb"),
        ({"filename": 3}, InvalidRequest, "filename must be a text"),
        ({"name": "My Box"}, InvalidRequest, "lower-case letters, digits"),
        ({"name": None}, InvalidRequest, "name must be a text"),
        ({"name": "cube"}, NameTaken, "not in use"),
        ({"category": "chairr"}, UnknownName, "did you mean 'chair'"),
        ({"height_m": -1.0}, InvalidRequest, "height_m must be"),
        ({"height_m": float("nan")}, InvalidRequest, "height_m must be"),
        ({"data": b""}, InvalidRequest, "at least one"),
        ({"data": "text"}, InvalidRequest, "the bytes of the file"),
        ({"data": b"PK\3\4 no zip at all"}, AssetError, "zip"),
        ({"data": bytes(64 * 2**20 + 1)}, InvalidRequest, "at most 64 MB"),
        ({"data": b"glTF", "filename": "a.glb"}, AssetError, "."),
    ],
)
def test_a_refused_upload_leaves_the_catalogue(
    simulation: Simulation, arguments: dict[str, Any], error: type[SailenvError], words: str
) -> None:
    """In one sentence, and no new scene_info comes of it."""
    info = simulation.info
    upload = {"data": box_zip(), "name": "refused", "filename": "box.zip", **arguments}
    with pytest.raises(error, match=words):
        simulation.upload_model(upload.pop("data"), **upload)
    assert simulation.info.spawnables == info.spawnables
    assert simulation.info.revision == info.revision


@settings(max_examples=60)
@given(
    data=st.one_of(
        st.binary(max_size=400),
        st.binary(max_size=60).map(lambda tail: b"PK\3\4" + tail),
        st.text(st.characters(codec="utf-8"), max_size=200).map(box_zip),
        st.lists(st.sampled_from(["v 1 2 3", "f 1 2 3", "v nan 0 0", "f -1 9 2", "vn 0 0 0"])).map(
            lambda lines: box_zip("\n".join(lines))
        ),
    ),
    filename=st.sampled_from(["a.zip", "b.glb", "../../c.zip", "/etc/d.glb"]),
)
def test_hostile_files_are_assets_or_refused(data: bytes, filename: str) -> None:
    """Nothing but a typed error comes of bytes that are no model."""
    try:
        asset = asset_from_upload(data, name="", filename=filename)
    except SailenvError:
        return
    assert asset.model.triangle_count


@given(filename=st.text(max_size=90))
def test_any_file_name_gives_a_catalogue_name(filename: str) -> None:
    """Whatever the file is called, its model has a name that can be typed."""
    assert IDENTIFIER.fullmatch(name_from_filename(filename))


def test_a_closed_queue_refuses_those_that_wait(monkeypatch: pytest.MonkeyPatch) -> None:
    """Uploads have an end with the simulation; too many at a time are refused."""
    hold, begun = threading.Event(), threading.Event()

    def slow(**arguments: Any) -> Any:
        begun.set()
        hold.wait(20.0)
        raise AssetError("a", "it was held")

    monkeypatch.setattr(queue_module, "import_upload_apart", slow)
    uploads = UploadQueue(lambda asset, rename: pytest.fail("nothing is added"))
    first = uploads.begin(b"1", name="", filename="a.zip")
    until(begun.is_set, "the first upload")
    others = [uploads.begin(b"1", name="", filename="a.zip") for _ in range(8)]
    with pytest.raises(InvalidState, match="8 uploads are waiting"):
        uploads.begin(b"1", name="", filename="a.zip")
    uploads.close()
    for other in others:
        assert isinstance(other.exception(20.0), SimulationClosed)
    hold.set()
    assert isinstance(first.exception(20.0), AssetError)
    with pytest.raises(SimulationClosed):
        uploads.begin(b"1", name="", filename="a.zip")
