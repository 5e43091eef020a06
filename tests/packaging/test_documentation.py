"""What the documentation says can be followed: links lead somewhere, programs run."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import pytest
import yaml

import sailenv_ros
from sailenv_ros.types.views import FIVE_VIEWS
from tests.packaging.project import ROOT

PAGES = sorted(
    path
    for pattern in ("*.md", "docs/**/*.md", "benchmarks/**/*.md")
    for path in ROOT.glob(pattern)
)
LINK = re.compile(r"(?<!\\)\]\(([^)\s]+)\)|\b(?:src|href|srcset)=\"([^\"]+)\"")
FENCE = re.compile(r"^```.*?^```", re.MULTILINE | re.DOTALL)
CODE = re.compile(r"`[^`]*`")


def anchors(page: Path) -> set[str]:
    """Return the anchors of a page's headings, as GitHub makes them."""
    found = set()
    for heading in re.findall(r"^#+ (.+)$", FENCE.sub("", page.read_text()), re.MULTILINE):
        words = re.sub(r"[^\w\- ]", "", heading.lower().strip())
        found.add(words.replace(" ", "-"))
    return found


def links(page: Path) -> list[str]:
    """Return what a page links to, programs left out."""
    text = CODE.sub("", FENCE.sub("", page.read_text()))
    return [target or attribute for target, attribute in LINK.findall(text)]


def broken_links(page: Path) -> list[str]:
    """Return the relative links of a page that lead to no file, folder or heading."""
    broken = []
    for link in links(page):
        if re.match(r"[a-z]+:", link):
            continue
        path, _, anchor = link.partition("#")
        target = (page.parent / path).resolve() if path else page
        if not target.exists() or (
            anchor and target.suffix == ".md" and anchor not in anchors(target)
        ):
            broken.append(link)
    return broken


def test_links_lead_to_files_and_headings() -> None:
    """Every relative link of every page names a file or folder that exists, and a heading in it."""
    assert len(PAGES) > 20
    assert sum(len(links(page)) for page in PAGES) > 100
    broken = {str(page.relative_to(ROOT)): broken_links(page) for page in PAGES}
    assert {page: links for page, links in broken.items() if links} == {}


def test_every_page_is_linked_from_the_readme_or_the_index() -> None:
    """Readers of the repository find every page below docs/; of the API reference, its index."""
    named = {
        (page.parent / link.partition("#")[0]).resolve()
        for page in (ROOT / "README.md", ROOT / "docs" / "index.md")
        for link in links(page)
    }
    pages = set(ROOT.glob("docs/*.md")) | {ROOT / "docs" / "api" / "index.md"}
    assert pages - named - {ROOT / "docs" / "index.md"} == set()


def test_manifests_name_pages_that_exist() -> None:
    """`docs/x.md` in package.xml and in comments of the configuration."""
    files = [
        ROOT / "package.xml",
        ROOT / "setup.py",
        *ROOT.glob("config/**/*"),
        *ROOT.glob("scripts/*"),
    ]
    files = [file for file in files if file.is_file() and file.suffix != ".png"]
    named = {name for file in files for name in re.findall(r"docs/\w+\.md", file.read_text())}
    assert named
    assert [name for name in named if not (ROOT / name).is_file()] == []


def test_the_citation_and_the_changelog_have_the_version() -> None:
    """Of the package; the changelog names it with the citation's date."""
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text())
    assert citation["version"] == sailenv_ros.__version__
    heading = f"## [{citation['version']}] - {citation['date-released']}"
    assert heading in (ROOT / "CHANGELOG.md").read_text()


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder in which programs run, without arguments."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", ["program"])
    return tmp_path


def run(code: str, capsys: pytest.CaptureFixture[str]) -> str:
    """Run a program in this process; return what it prints."""
    capsys.readouterr()
    exec(compile(code, "program", "exec"), {"__name__": "__main__"})
    return capsys.readouterr().out


@pytest.mark.gl
def test_the_example_of_simulation_runs(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The ball falls faster and faster, and the picture is written."""
    out = run((ROOT / "examples" / "11_simulation.py").read_text(), capsys)
    speeds = [int(speed) for speed in re.findall(r"(-?\d+) px/s downwards", out)]
    assert len(speeds) == 6
    assert speeds == sorted(speeds)
    assert speeds[0] < speeds[-1]
    assert (here / "simulation.png").stat().st_size > 2_000


def test_the_example_of_random_scenes_runs(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Epochs differ, and the frame that is made again does not."""
    out = run((ROOT / "examples" / "13_randomise.py").read_text(), capsys)
    assert out.rstrip().endswith("has the same bytes: True")
    pictures = {(here / f"random_{index}.png").read_bytes() for index in range(4)}
    assert len(pictures) == 4


@pytest.mark.gl
def test_the_example_of_tracks_runs(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Points become hidden and leave; the picture of their trails is written."""
    out = run((ROOT / "examples" / "12_tracks.py").read_text(), capsys)
    seen = [[int(n) for n in row] for row in re.findall(r": (\d+) seen, (\d+) h.*?, (\d+) o", out)]
    assert len(seen) == 4
    assert seen[0][1:] == [0, 0]
    assert min(seen[-1]) > 0
    assert len({sum(row) for row in seen}) == 1
    assert (here / "trails.png").stat().st_size > 20_000


TUTORIAL = sorted((ROOT / "examples" / "tutorial").glob("*.ipynb"))


def shown_by(notebook: Path, folder: Path) -> list[str]:
    """Run a notebook in a kernel of its own; return what its cells display as HTML."""
    code = f"""
import nbformat
from nbclient import NotebookClient
notebook = nbformat.read({str(notebook)!r}, as_version=4)
NotebookClient(notebook, timeout=100, kernel_name="python3").execute()
nbformat.write(notebook, "executed.ipynb")
"""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    command = [sys.executable, "-c", code]
    done = subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, timeout=115
    )
    assert done.returncode == 0, done.stderr
    cells = json.loads((folder / "executed.ipynb").read_text())["cells"]
    return [
        "".join(output["data"]["text/html"])
        for cell in cells
        for output in cell.get("outputs", ())
        if "text/html" in output.get("data", {})
    ]


@pytest.mark.gl
@pytest.mark.slow
@pytest.mark.parametrize("notebook", TUTORIAL, ids=lambda path: path.stem)
def test_a_step_of_the_tutorial_runs(notebook: Path, tmp_path: Path) -> None:
    """No cell fails; a simulation displays as a table, each frame as its pictures."""
    shown = shown_by(notebook, tmp_path)
    tables = [html for html in shown if "<figcaption" not in html]
    frames = [html for html in shown if "<figcaption" in html]
    if notebook.stem.startswith("1_"):
        assert ["optical" in table for table in tables] == [True]
        views = [re.findall(r"<figcaption>(\w+)", frame) for frame in frames]
        assert views == [list(FIVE_VIEWS), ["rgb", "depth"], ["rgb", "depth"]]
    assert frames or notebook.stem.startswith(("5_", "7_"))


def test_the_tutorial_leads_from_step_to_step() -> None:
    """Each notebook ends with a link to the next one, and holds no outputs."""
    assert [int(path.stem.partition("_")[0]) for path in TUTORIAL] == [1, 2, 3, 4, 5, 6, 7]
    for path, following in pairwise(TUTORIAL):
        cells = json.loads(path.read_text())["cells"]
        assert f"]({following.name})" in "".join(cells[-1]["source"])
        assert not any(cell.get("outputs") for cell in cells)
