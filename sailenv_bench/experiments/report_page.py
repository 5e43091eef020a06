"""All results of a folder as one page: tables, plots and pictures in a single HTML file.

JSON files and pictures in, a text out. The page loads nothing, runs no script, and follows the
reader's choice of light or dark.
"""

from __future__ import annotations

import base64
import html
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

from sailenv_bench.experiments.plots import plot_names, plot_png
from sailenv_bench.experiments.result_tables import tables_of
from sailenv_bench.experiments.results import EXPERIMENTS, load_result
from sailenv_bench.experiments.tables import Table
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.system.files import make_folder, storage_errors, write_file

__all__ = ["page_of", "write_report"]

HEADINGS: Mapping[str, tuple[str, str, str]] = MappingProxyType(
    {
        "flow_speed": (
            "Optical flow: speed",
            "What a frame costs when its flow comes from the simulator, and when it is estimated "
            "from pictures.",
            "sailenv bench flow-speed",
        ),
        "flow_accuracy": (
            "Optical flow: accuracy",
            "End-point errors against the motion field that plain arithmetic gives. Colours: hue "
            "is direction, brightness is speed.",
            "sailenv bench flow-accuracy",
        ),
        "detection": (
            "Detection",
            "What a network trained on photographs makes of the rooms' objects. Green: the "
            "object; red: the class's best box.",
            "sailenv eval detection --model FILE.onnx",
        ),
        "throughput": (
            "Throughput",
            "Frames per second by size, views, agents, scene and transport, and other renderers "
            "on the same geometry.",
            "sailenv bench throughput",
        ),
        "streams": (
            "Streams of continual learning",
            "The published streams, made here: whether flow explains the pictures, beside what was "
            "measured on the published files, and what a classifier of raw pixels makes of them.",
            "sailenv bench streams",
        ),
        "endless": (
            "Learning without an end",
            "Small baselines that classify pixels of a stream whose world changes slowly: before "
            "they are told, and in rooms that they were never shown.",
            "sailenv bench endless",
        ),
    }
)
"""Title, purpose and command of each experiment."""

MAX_PICTURE_BYTES = 4 * 2**20

STYLE = """
:root { --paper: #ffffff; --card: #f6f8fa; --ink: #1f2328; --quiet: #59636e; --line: #d8dee4;
  --accent: #c8363b; color-scheme: light dark; }
@media (prefers-color-scheme: dark) { :root { --paper: #0d1117; --card: #15191f; --ink: #e6edf3;
  --quiet: #9198a1; --line: #30363d; --accent: #ff7b72; } }
* { box-sizing: border-box; }
body { margin: 0; background: var(--paper); color: var(--ink);
  font: 16px/1.55 system-ui, -apple-system, "Segoe UI", Roboto, sans-serif; }
main { max-width: 1080px; margin: 0 auto; padding: 2.5rem 1.25rem 5rem; }
h1 { font-size: 2rem; line-height: 1.2; margin: 0 0 .4rem; letter-spacing: -.02em; }
h2 { font-size: 1.4rem; margin: 3.2rem 0 .3rem; padding-top: 1.6rem;
  border-top: 1px solid var(--line); letter-spacing: -.01em; }
h3 { font-size: 1rem; margin: 1.8rem 0 .5rem; }
p { margin: .4rem 0 1rem; max-width: 74ch; }
.quiet, .notes li, footer { color: var(--quiet); font-size: .875rem; }
nav a { margin-right: 1.2rem; }
a { color: var(--accent); text-decoration: none; } a:hover { text-decoration: underline; }
figure { margin: 1.2rem 0; }
figure img { display: block; max-width: 100%; height: auto; border: 1px solid var(--line);
  border-radius: 8px; }
.scroll { overflow-x: auto; border: 1px solid var(--line); border-radius: 8px; }
table { border-collapse: collapse; width: 100%; font-size: .86rem;
  font-variant-numeric: tabular-nums; }
th, td { padding: .42rem .75rem; text-align: right; white-space: nowrap; }
th:first-child, td:first-child { text-align: left; position: sticky; left: 0;
  background: inherit; }
thead tr { background: var(--card); } tbody tr { background: var(--paper);
  border-top: 1px solid var(--line); }
th { font-weight: 600; } td.long { white-space: normal; text-align: left; min-width: 18ch; }
td.part { padding-left: 2rem; color: var(--quiet); }
ul.notes { padding-left: 1.1rem; margin: .7rem 0 1.2rem; }
code { background: var(--card); border: 1px solid var(--line); border-radius: 5px;
  padding: .08em .35em; font: .86em/1.5 ui-monospace, "SF Mono", Consolas, monospace; }
dl { display: grid; grid-template-columns: max-content 1fr; gap: .15rem 1rem; margin: .8rem 0;
  font-size: .875rem; } dt { color: var(--quiet); } dd { margin: 0; overflow-wrap: anywhere; }
details summary { cursor: pointer; color: var(--quiet); font-size: .875rem; }
@media print { .scroll { overflow: visible; } h2 { break-before: page; } }
"""


def write_report(folder: Path, path: Path) -> Path:
    """Write the page of a folder's results.

    Raises
    ------
    InvalidRequest
        If the folder holds no result.
    MissingPackage
        Without matplotlib.
    StorageError
        If it cannot be written.
    """
    results = {name: load_result(folder, name) for name in EXPERIMENTS}
    if not any(results.values()):
        accepted = "a folder that `sailenv bench` or `sailenv eval` has written results to"
        raise InvalidRequest("folder of results", str(folder), accepted)
    text = page_of(results, lambda name: _picture(folder / name))
    with storage_errors("the report", path):
        make_folder(path.parent)
        write_file(path, text.encode())
    return path


def page_of(
    results: Mapping[str, Mapping[str, Any] | None], picture_of: Callable[[str], str]
) -> str:
    """Make the page.

    Parameters
    ----------
    results : mapping of str to mapping or None
        By experiment; None for one that was not made yet.
    picture_of : callable
        Gives the ``data:`` address of a picture of the results by its file's name; empty if it is
        not available.

    Returns
    -------
    html : str
    """
    found = [name for name in EXPERIMENTS if results.get(name)]
    links = "".join(f'<a href="#{name}">{_text(HEADINGS[name][0])}</a>' for name in found)
    sections = "".join(_section(name, results.get(name), picture_of) for name in EXPERIMENTS)
    return (
        '<!doctype html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>sailenv_ros: experiments</title><style>{STYLE}</style></head><body><main>"
        "<h1>The paper’s experiments on sailenv_ros</h1>"
        "<p>Measured by the commands named with each result, on the machine named with it. "
        "Figures of different machines are not comparable; ratios within one table are.</p>"
        f"<nav>{links}</nav>{sections}"
        "<footer><p>After <i>SAILenv: Learning in Virtual Visual Environments Made Simple</i>, "
        "arXiv:2007.08224.</p></footer></main></body></html>\n"
    )


def _section(name: str, result: Mapping[str, Any] | None, picture_of: Callable[[str], str]) -> str:
    title, purpose, command = HEADINGS[name]
    head = f'<section id="{name}"><h2>{_text(title)}</h2><p>{_text(purpose)}</p>'
    if result is None:
        return f"{head}<p class=quiet>Not measured yet: <code>{_text(command)}</code></p></section>"
    plots = "".join(_plot(result, plot) for plot in plot_names(name) if _has_plot(result, plot))
    tables = "".join(_table(table) for table in tables_of(result))
    pictures = "".join(
        f'<figure><img alt="{_text(file)}" src="{source}"></figure>'
        for file in result["data"].get("pictures", ())[:1]
        if (source := picture_of(file))
    )
    return f"{head}{plots}{tables}{pictures}{_provenance(result)}</section>"


def _has_plot(result: Mapping[str, Any], plot: str) -> bool:
    return plot != "renderers" or any(row.get("ratio") for row in result["data"]["baselines"])


def _plot(result: Mapping[str, Any], name: str) -> str:
    light, dark = (_data(plot_png(result, name, theme), "png") for theme in ("light", "dark"))
    return (
        f'<figure><picture><source srcset="{dark}" media="(prefers-color-scheme: dark)">'
        f'<img alt="{_text(name)}" src="{light}"></picture></figure>'
    )


def _table(table: Table) -> str:
    head = "".join(f"<th>{_text(column)}</th>" for column in table.columns)
    body = "".join(f"<tr>{''.join(map(_cell, row))}</tr>" for row in table.rows)
    notes = "".join(f"<li>{_text(note)}</li>" for note in table.notes)
    return (
        f"<h3>{_text(table.title)}</h3><div class=scroll><table><thead><tr>{head}</tr></thead>"
        f"<tbody>{body}</tbody></table></div>" + (f"<ul class=notes>{notes}</ul>" if notes else "")
    )


def _cell(text: str) -> str:
    kind = " class=long" if len(text) > 45 else " class=part" if text.startswith("  ") else ""
    return f"<td{kind}>{_text(text)}</td>"


def _provenance(result: Mapping[str, Any]) -> str:
    origin = result["provenance"]
    versions = ", ".join(f"{name} {version}" for name, version in origin["versions"].items())
    entries: Iterable[tuple[str, str]] = (
        ("command", origin["command"]),
        ("machine", f"{origin['machine']}: {origin['cpu']}, {origin['cpus']} CPUs, "
         f"{origin['memory_gib']:g} GiB"),
        ("load before", ", ".join(f"{value:g}" for value in origin["load"])),
        ("renderer", result["data"].get("renderer") or "–"),
        ("system", f"{origin['system']}, Python {origin['python']}"),
        ("versions", versions),
        ("commit", origin["commit"] or "–"),
        ("begun", origin["began"]),
    )  # fmt: skip
    rows = "".join(
        f"<dt>{_text(name)}</dt><dd>{f'<code>{value}</code>' if name == 'command' else value}</dd>"
        for name, value in ((name, _text(value)) for name, value in entries)
    )
    return f"<details open><summary>Measured with</summary><dl>{rows}</dl></details>"


def _picture(path: Path) -> str:
    """Return a picture's data address; empty if there is none or it is too large for a page."""
    try:
        data = path.read_bytes()
    except OSError:
        return ""
    kind = "jpeg" if path.suffix == ".jpg" else "png"
    return _data(data, kind) if len(data) <= MAX_PICTURE_BYTES else ""


def _data(data: bytes, kind: str) -> str:
    return f"data:image/{kind};base64,{base64.b64encode(data).decode('ascii')}"


def _text(text: str) -> str:
    return html.escape(text)
