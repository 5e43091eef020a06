"""Result files, tables, plots and the page made of them."""

from __future__ import annotations

import io
import re
import sys
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from sailenv_bench.experiments.machine import cpu_name, provenance
from sailenv_bench.experiments.paper import DETECTION, FLOW_MS
from sailenv_bench.experiments.plots import plot_names, plot_png
from sailenv_bench.experiments.report_page import write_report
from sailenv_bench.experiments.result_tables import tables_of
from sailenv_bench.experiments.results import EXPERIMENTS, load_result, save_result
from sailenv_bench.experiments.statistics import mean_and_deviation, summary_ms
from sailenv_bench.experiments.tables import Table, number
from sailenv_ros.errors import InvalidRequest, MissingPackage
from sailenv_ros.extras import need
from tests.unit.bench.experiments.samples import DATA, TOLD


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with a result of each experiment and one picture."""
    for name, data in DATA.items():
        save_result(tmp_path, name, TOLD, data)
    Image.new("RGB", (8, 6)).save(tmp_path / "flow_pictures.jpg")
    return tmp_path


def test_a_result_comes_back_as_it_was_written(tmp_path: Path) -> None:
    """NumPy's numbers as plain ones, what is not finite as null; no result is None."""
    data = {"a": np.float64(1.5), "b": (1, np.array([2, 3])), "c": float("nan"), "d": "é"}
    save_result(tmp_path, "flow_speed", TOLD, data)
    result = load_result(tmp_path, "flow_speed")
    assert result is not None
    assert result["data"] == {"a": 1.5, "b": [1, [2, 3]], "c": None, "d": "é"}
    assert result["provenance"] == TOLD
    assert load_result(tmp_path, "detection") is None
    assert [path.name for path in tmp_path.iterdir()] == ["flow_speed.json"]


@pytest.mark.parametrize("text", ["", "[]", '{"version": 99, "experiment": "detection"}'])
def test_what_is_no_result_is_refused(tmp_path: Path, text: str) -> None:
    """In a sentence with the file's name."""
    (tmp_path / "detection.json").write_text(text)
    with pytest.raises(InvalidRequest, match=r"detection\.json"):
        load_result(tmp_path, "detection")


def test_the_interval_is_students() -> None:
    """Of 10, 12 and 14 ms: 12 ± 4.303 · 2 / √3, the quantile of two degrees of freedom."""
    told = summary_ms([0.010, 0.012, 0.014])
    assert told["mean"] == pytest.approx(12.0)
    assert told["half_interval"] == pytest.approx(4.302653 * 2.0 / np.sqrt(3.0))
    assert told["count"] == 3
    assert summary_ms([0.01])["half_interval"] == float("inf")
    assert np.isnan(summary_ms([])["mean"])
    assert mean_and_deviation([1.0, 0.0]) == (0.5, 0.5)


def test_provenance_names_machine_and_command() -> None:
    """Everything that a figure has to be read with is there."""
    told = provenance(["sailenv", "bench"])
    assert told["command"] == "sailenv bench"
    assert {"machine", "cpu", "commit", "began", "load", "versions"} <= set(told)
    assert all(told[name] for name in ("cpu", "cpus", "system", "python", "began"))


def test_a_processor_without_a_name_is_named_by_its_kind(tmp_path: Path) -> None:
    """As on ARM, whose list has no model name."""
    (tmp_path / "cpuinfo").write_text("processor : 0\nmodel name\t: Great CPU\n")
    assert cpu_name(tmp_path / "cpuinfo") == "Great CPU"
    assert cpu_name(tmp_path / "missing")


def test_the_papers_numbers_are_those_of_its_tables() -> None:
    """All 14 classes and six sizes; two of them by hand."""
    assert len(DETECTION) == 14
    assert DETECTION["laptop"] == (0.9551, 0.0098, 0.9476, 0.0207)
    assert next(iter(FLOW_MS)) == (240, 180)
    assert len(FLOW_MS) == 6


@pytest.mark.parametrize("experiment", EXPERIMENTS)
def test_each_result_has_tables_and_plots(experiment: str, folder: Path) -> None:
    """Rows as wide as the heads; plots in the colours of light and dark pages."""
    result = load_result(folder, experiment)
    assert result is not None
    tables = tables_of(result)
    assert tables
    for table in tables:
        assert all(len(row) == len(table.columns) for row in table.rows)
    for name in plot_names(experiment):
        light, dark = (
            np.asarray(Image.open(io.BytesIO(plot_png(result, name, theme))).convert("L"))
            for theme in ("light", "dark")
        )
        assert light[2, 2] > 200
        assert dark[2, 2] < 60
        assert light.std() > 5


def test_what_is_missing_is_said(folder: Path) -> None:
    """A peer that is not installed, a class with too few views, a transport that failed."""
    texts = {}
    for name in EXPERIMENTS:
        result = load_result(folder, name)
        assert result is not None
        tables = tables_of(result)
        cells = [cell for table in tables for row in table.rows for cell in row]
        texts[name] = " ".join([*cells, *(note for table in tables for note in table.notes)])
    assert "not installed" in texts["throughput"]
    assert "over DDS: no ROS." in texts["throughput"]
    assert "images of 2 frames were lost" in texts["throughput"]
    assert "tv: 3 of 5 views meet the rule" in texts["detection"]
    assert "no masks" in texts["detection"]


def test_a_table_has_as_many_cells_as_heads() -> None:
    """A row that is too short is an error of ours, found at once; a missing number is a dash."""
    with pytest.raises(InvalidRequest, match="2 cells"):
        Table(title="t", columns=("a", "b"), rows=(("1",),))
    assert (number(None), number(float("nan")), number(1.26)) == ("–", "–", "1.3")


class _Page(HTMLParser):
    """Notes what a page loads, its tags that were not closed, and its headings."""

    def __init__(self) -> None:
        super().__init__()
        self.loaded: list[str] = []
        self.tags: list[str] = []
        self.open: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.loaded += [str(v) for k, v in attrs if k in ("src", "srcset") and v]
        if tag not in ("meta", "img", "source"):
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


def test_the_report_is_one_file_that_loads_nothing(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Plots and pictures lie in it; light and dark; well-formed; texts are escaped."""
    drawn: list[tuple[str, str]] = []

    def draw(_: object, name: str, theme: str) -> bytes:
        drawn.append((name, theme))
        return b"a plot"

    monkeypatch.setattr("sailenv_bench.experiments.report_page.plot_png", draw)
    path = write_report(folder, folder / "out" / "report.html")
    text = path.read_text(encoding="utf-8")
    page = _Page()
    page.feed(text)
    assert page.open == []
    assert page.loaded
    assert all(source.startswith("data:image/") for source in page.loaded)
    assert not re.search(r"https?://", text)
    assert "script" not in page.tags
    assert "prefers-color-scheme: dark" in text
    assert "A &lt;fast&gt; CPU" in text
    assert page.tags.count("h2") == len(EXPERIMENTS)
    names = [name for experiment in EXPERIMENTS for name in plot_names(experiment)]
    assert drawn == [(name, theme) for name in names for theme in ("light", "dark")]


def test_the_report_names_what_was_not_measured(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With the command that would; a folder without any result is refused."""
    monkeypatch.setattr("sailenv_bench.experiments.report_page.plot_png", lambda *_: b"a plot")
    save_result(tmp_path, "detection", TOLD, DATA["detection"])
    text = write_report(tmp_path, tmp_path / "report.html").read_text(encoding="utf-8")
    assert "Not measured yet: <code>sailenv bench flow-speed</code>" in text
    (tmp_path / "empty").mkdir()
    with pytest.raises(InvalidRequest, match="folder of results"):
        write_report(tmp_path / "empty", tmp_path / "none.html")


def test_a_missing_package_is_named_with_its_command(monkeypatch: pytest.MonkeyPatch) -> None:
    """One sentence: what needs it, what it is, how to get it."""
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    monkeypatch.delitem(sys.modules, "matplotlib.figure", raising=False)
    with pytest.raises(MissingPackage) as missed:
        need("matplotlib.figure", "a plot")
    assert str(missed.value) == (
        "a plot needs matplotlib, which is not installed: pip install 'sailenv_ros[bench]'"
    )
