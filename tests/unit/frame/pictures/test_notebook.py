"""Frames and scenes as HTML, and `show` with and without a notebook."""

from __future__ import annotations

import base64
import io
import re
import subprocess
import sys
import types
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from sailenv_ros import show
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.html import TILE_WIDTH_PX, frame_html, scene_html
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.labels import Category, CategoryTable
from sailenv_ros.types.scene_info import SceneInfo
from sailenv_ros.types.views import FIVE_VIEWS, VIEWS
from tests.support.small_frame import small_frame


def made_frame(width: int = 32, height: int = 24, agent: str = "eye") -> Frame:
    """A frame of the five views whose pixels are all alike."""
    values = {"rgb": 200, "depth": 2.0, "category": 210, "instance": 3, "flow": 4.0}
    views = {
        name: np.full(VIEWS[name].shape(height, width), values[name], VIEWS[name].dtype)
        for name in FIVE_VIEWS
    }
    about = {"agent": agent, "scene": "<room>", "sequence": 7, "stamp_ns": 2_500_000_000}
    return small_frame(views, width, height, dt_ns=33_000_000, **about)


class Parsed(HTMLParser):
    """The pictures and the text of an HTML fragment; raises where a tag is left open."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.text = ""
        self.pictures: dict[str, Image.Image] = {}
        self.feed(text)
        assert self.open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag != "img":
            self.open.append(tag)
            return
        named = dict(attrs)
        kind, _, data = str(named["src"]).partition("base64,")
        assert kind == "data:image/png;"
        self.pictures[str(named["alt"])] = Image.open(io.BytesIO(base64.b64decode(data)))

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.text += data


def test_a_frame_shows_every_view_and_what_it_is() -> None:
    """Its own representation in a notebook: all pictures, numbers, and names that are escaped."""
    frame = made_frame()
    parsed = Parsed(frame._repr_html_() or "")
    assert tuple(parsed.pictures) == FIVE_VIEWS
    assert {picture.size for picture in parsed.pictures.values()} == {(32, 24)}
    assert "eye in <room>: frame 7, t = 2.500 s, Δt = 0.033 s, 32 × 24 px" in parsed.text
    assert parsed.pictures["rgb"].getpixel((5, 5)) == (200, 200, 200)


def test_a_large_frame_is_scaled_without_mixing_ids() -> None:
    """640 px become 320, and no colour appears that the palette lacks."""
    frame = made_frame(640, 480)
    ids = np.arange(640 * 480, dtype=np.uint16).reshape(480, 640) % 2
    both = Frame(**{**vars(frame), "views": {"instance": ids.astype(np.uint16)}})
    picture = Parsed(frame_html(both)).pictures["instance"]
    assert picture.size == (TILE_WIDTH_PX, 240)
    assert len(picture.getcolors()) <= 2


def test_categories_of_a_scene_have_its_colours() -> None:
    """A category above the fixed table is grey unless the scene's table is given."""
    table = CategoryTable([Category(id=210, name="drone", colour=(1, 2, 3))])
    frame = made_frame()
    plain, own = (Parsed(frame_html(frame, categories=t)) for t in (None, table))
    assert plain.pictures["category"].getpixel((0, 0)) == (128, 128, 128)
    assert own.pictures["category"].getpixel((0, 0)) == (1, 2, 3)


def test_a_scene_shows_what_is_in_it() -> None:
    """A table; an agent's views stand beside its name."""
    info = SceneInfo(
        scene="<room>", scenes=(), epoch=1, revision=1, sim_time_ns=0, mode="realtime", paused=True,
        real_time_factor=1.0, seed=4, categories=CategoryTable(), instances=(),
        agents=(AgentSpec(name="eye", views=("rgb", "depth")),), renderer="none",
    )  # fmt: skip
    text = Parsed(scene_html("Simulation", info)).text
    for part in ("Simulation", "<room>", "realtime, paused, seed 4", "640 × 480 px: rgb, depth"):
        assert part in text


def test_outside_of_a_notebook_a_file_is_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where it was asked for, or a new one; nothing is opened where there is no desktop."""
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    assert show(made_frame(), tmp_path / "sheet.png") == tmp_path / "sheet.png"
    written = show(made_frame())
    assert written is not None
    assert written.parent == tmp_path
    with Image.open(written) as sheet:
        assert sheet.width > 3 * 32
    with pytest.raises(InvalidRequest, match=r"ends in \.png or \.jpg"):
        show(made_frame(), tmp_path / "sheet.txt")


def test_the_dict_of_an_agent_is_shown_too(tmp_path: Path) -> None:
    """`main` is BGR there, and `depth_m` is the depth; the sheet is that of the frame."""
    frame = made_frame()
    as_dict = {
        "main": frame["rgb"][..., ::-1], "depth": frame["rgb"], "depth_m": frame["depth"],
        "category": frame["category"], "instance": frame["instance"], "flow": frame["flow"],
        "sizes": {}, "sequence": 7,
    }  # fmt: skip
    paths = show(frame, tmp_path / "a.png"), show(as_dict, tmp_path / "b.png")
    first, second = (path.read_bytes() for path in paths if path is not None)
    assert first == second
    with pytest.raises(InvalidRequest, match="at least one view"):
        show({"sizes": {}})


def test_in_a_notebook_html_is_displayed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without a file; IPython in a terminal counts as none."""
    shown: list[str] = []
    ipython, display = types.ModuleType("IPython"), types.ModuleType("IPython.display")
    kernel = types.SimpleNamespace(kernel=object())
    ipython.get_ipython = lambda: kernel  # type: ignore[attr-defined]  # made here
    display.HTML = lambda text: text  # type: ignore[attr-defined]  # made here
    display.display = shown.append  # type: ignore[attr-defined]  # made here
    monkeypatch.setitem(sys.modules, "IPython", ipython)
    monkeypatch.setitem(sys.modules, "IPython.display", display)
    assert show(made_frame()) is None
    (text,) = shown
    assert tuple(Parsed(text).pictures) == FIVE_VIEWS
    kernel.kernel = None
    assert show(made_frame()) is not None


def test_importing_it_needs_no_ipython() -> None:
    """A plain program that shows frames does not import it."""
    code = "import sys; from sailenv_ros import show; print('IPython' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert re.fullmatch(r"False\s*", done.stdout)
