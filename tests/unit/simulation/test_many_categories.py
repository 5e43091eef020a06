"""Scenes with category ids above 255: sixteen bits, from the scene file to every reader."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sailenv_bench.experiments.coco_classes import COCO_NAMES
from sailenv_msgs_py.frame_info import header_of_frame
from sailenv_msgs_py.images import image_from_view, view_from_image
from sailenv_ros.assets.categories import load_categories
from sailenv_ros.assets.category_names import NAMING_SCHEMES, names_in
from sailenv_ros.errors import SceneError, UnknownName
from sailenv_ros.gateway.payloads import packed_frame
from sailenv_ros.simulation import Simulation
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics

pytestmark = pytest.mark.ros

SCENE = """
version: 1
categories:
{categories}
objects:
  - {{name: box, asset: cube, position: [3, 0, 0], static: true, category: kind {last}}}
  - {{name: ball, asset: sphere, position: [3, 1.5, 0], static: true, category: kind 200}}
"""
VIEWS = ("category", "instance", "depth")


def scene(folder: Path, last: int) -> Path:
    numbers = [n for n in range(200, last + 1) if n != 255]
    lines = "\n".join(f"  - {{name: kind {n}, id: {n}}}" for n in numbers)
    path = folder / "kinds.yaml"
    path.write_text(SCENE.format(categories=lines, last=last))
    return path


@pytest.mark.parametrize(
    ("last", "dtype", "encoding"), [(254, "uint8", "8UC1"), (600, "uint16", "16UC1")]
)
def test_the_category_view_has_the_bits_that_the_ids_need(
    tmp_path: Path, last: int, dtype: str, encoding: str
) -> None:
    """Pixels, messages and the SAILenv client's bytes; eight bits unless an id needs more."""
    spec = AgentSpec(name="eye", intrinsics=CameraIntrinsics(width=64, height=48), views=VIEWS)
    with Simulation(scene(tmp_path, last), mode="lockstep", agent=spec) as simulation:
        simulation.set_position((0.0, 0.0, 0.0))
        for views in (VIEWS, ("category",)):
            frame = simulation.capture(views)
            category = frame["category"]
            assert category.dtype == dtype
            assert set(np.unique(category).tolist()) == {0, 200, last}
        frame = simulation.capture()
        box = next(i.id for i in frame.info.instances if i.name == "box")  # type: ignore[union-attr]  # a live frame has it
        assert ((frame["category"] == last) == (frame["instance"] == box)).all()
        image = image_from_view("category", frame["category"], header_of_frame(frame))
        assert image.encoding == encoding
        read = view_from_image("category", image)
        assert read.dtype == dtype
        assert (read == frame["category"]).all()
        sent = packed_frame(frame, ("category",), depth_range_m=10.0, use_gzip=False)[1]
        red = np.frombuffer(sent, np.uint8).reshape(48, 64, 3)[::-1, :, 0]
        assert (red == np.minimum(frame["category"], 255)).all()
        assert frame.objects.category_ids.tolist() == [last, 200]


def test_the_id_of_what_has_no_category_is_refused(tmp_path: Path) -> None:
    """255 means something else already."""
    path = tmp_path / "wrong.yaml"
    path.write_text("version: 1\ncategories: [{name: odd, id: 255}]\n")
    with pytest.raises(SceneError, match="255"):
        Simulation(path, mode="lockstep")


def test_a_part_must_have_its_whole(tmp_path: Path) -> None:
    """A parent that is not there, or the part itself, is refused with its line."""
    path = tmp_path / "parts.yaml"
    for parent, message in (("cupbord", "no object 'cupbord'"), ("door", "another object")):
        path.write_text(
            "version: 1\nobjects:\n  - {name: cupboard, asset: cube}\n"
            f"  - {{name: door, asset: cube, position: [2, 0, 0], part_of: {parent}}}\n"
        )
        with pytest.raises(SceneError, match=message):
            Simulation(path, mode="lockstep")


def test_our_categories_have_the_names_of_other_data_sets() -> None:
    """Every name of the table is one of ours, and those of COCO are COCO's own."""
    ours = {category.name for category in load_categories().values()}
    for scheme in NAMING_SCHEMES:
        assert set(names_in(scheme)) <= ours
    assert set(names_in("coco").values()) <= set(COCO_NAMES)
    assert {n for n in ours if n in COCO_NAMES} == set(names_in("coco"))
    assert len(set(names_in("nyu40").values())) <= 40
    with pytest.raises(UnknownName, match="nyu40"):
        names_in("nyu")  # type: ignore[arg-type]  # what a typist writes
