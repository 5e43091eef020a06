"""Results as plots: the data of a result file in, figures for light and dark pages out.

matplotlib is used without its global state, so that nothing has to be closed or restored.
"""

from __future__ import annotations

import io
from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

from PIL import Image

from sailenv_bench.experiments.paper import DETECTION, FLOW_MS
from sailenv_ros.extras import need
from sailenv_ros.system.files import storage_errors, write_file

__all__ = ["THEMES", "plot_names", "plot_png", "save_plots"]

Data = Mapping[str, Any]

THEMES: Mapping[str, Mapping[str, str]] = MappingProxyType(
    {
        "light": {"paper": "#ffffff", "ink": "#1f2328", "grid": "#d8dee4", "quiet": "#8c959f"},
        "dark": {"paper": "#15191f", "ink": "#e6edf3", "grid": "#30363d", "quiet": "#7d8590"},
    }
)
ACCENT = "#e5484d"
COLOURS = ("#3b82c4", "#e0a030", "#3aa675", "#9a6dd7", "#c46a3b", "#5aa9c9", "#b0577f")


def plot_names(experiment: str) -> tuple[str, ...]:
    """Return the names of an experiment's plots."""
    return tuple(_PLOTS[experiment])


def plot_png(result: Data, name: str, theme: str = "light") -> bytes:
    """Draw a plot of a result as a PNG.

    Raises
    ------
    MissingPackage
        Without matplotlib.
    """
    need("matplotlib", "a plot")
    data = result["data"]
    draw = _PLOTS[result["experiment"]][name]
    canvas = _Canvas(THEMES[theme])
    draw(canvas, data)
    return canvas.png()


def save_plots(result: Data, folder: Path) -> list[Path]:
    """Write every plot of a result, light and dark (``…_dark.png``); return the paths."""
    paths = []
    for name in plot_names(result["experiment"]):
        for theme in THEMES:
            path = folder / f"{name}{'' if theme == 'light' else '_' + theme}.png"
            with storage_errors("the plot", path):
                write_file(path, plot_png(result, name, theme))
            paths.append(path)
    return paths


class _Canvas:
    """A figure in the colours of a page."""

    def __init__(self, theme: Mapping[str, str]) -> None:
        self.theme = theme
        self._figure: Any = None

    def axes(self, title: str, *, width: float = 8.65, height: float = 4.2) -> Any:
        """Begin a figure of inches; return its axes."""
        figure_module = need("matplotlib.figure", "a plot")
        theme = self.theme
        self._figure = figure_module.Figure(
            figsize=(width, height), facecolor=theme["paper"], layout="constrained"
        )
        axes = self._figure.add_subplot()
        axes.set_facecolor(theme["paper"])
        axes.set_title(title, loc="left", color=theme["ink"], fontsize=11, fontweight="bold")
        axes.tick_params(colors=theme["ink"], which="both", labelsize=9)
        for side in ("top", "right"):
            axes.spines[side].set_visible(False)
        for side in ("left", "bottom"):
            axes.spines[side].set_color(theme["quiet"])
        axes.grid(True, color=theme["grid"], linewidth=0.7)
        axes.set_axisbelow(True)
        return axes

    def label(self, axes: Any, x: str = "", y: str = "") -> None:
        """Name the axes."""
        axes.set_xlabel(x, color=self.theme["ink"], fontsize=9)
        axes.set_ylabel(y, color=self.theme["ink"], fontsize=9)

    def legend(self, axes: Any, **kwargs: Any) -> None:
        """Draw the legend beside the axes."""
        kwargs = {"loc": "center left", "bbox_to_anchor": (1.01, 0.5), **kwargs}
        axes.legend(frameon=False, fontsize=8.5, labelcolor=self.theme["ink"], **kwargs)

    def png(self) -> bytes:
        """Return the figure as a file, of so few colours that it is small."""
        drawn = io.BytesIO()
        self._figure.savefig(drawn, format="png", dpi=120, facecolor=self.theme["paper"])
        file = io.BytesIO()
        picture = Image.open(drawn).convert("RGB").quantize(128, dither=Image.Dither.NONE)
        picture.save(file, format="PNG", optimize=True)
        return file.getvalue()


def _plain(axis: Any) -> None:
    ticker = need("matplotlib.ticker", "a plot")
    axis.set_major_formatter(ticker.FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_formatter(ticker.NullFormatter())


def _flow_speed(canvas: _Canvas, data: Data) -> None:
    axes = canvas.axes("A frame with its optical flow")
    sizes = data["sizes"]
    places = range(len(sizes))
    colours = iter(COLOURS)
    for method in data["methods"]:
        total = [entry["times"][method["name"]]["total"] for entry in sizes]
        ours = method["kind"] == "ours"
        quiet = method["kind"] == "picture"
        axes.errorbar(
            places,
            [time["mean"] for time in total],
            yerr=[time["half_interval"] or 0.0 for time in total],
            label=method["label"],
            color=ACCENT if ours else canvas.theme["quiet"] if quiet else next(colours),
            linestyle=":" if quiet else "-",
            linewidth=2.6 if ours else 1.5,
            marker="o",
            markersize=6 if ours else 4,
            capsize=3,
            zorder=3 if ours else 2,
        )
    paper = [FLOW_MS.get((entry["width"], entry["height"])) for entry in sizes]
    known = [(place, value) for place, value in zip(places, paper, strict=True) if value]
    if known:
        axes.plot(
            *zip(*known, strict=True),
            label="the paper's SAILenv (GTX 1080)",
            color=canvas.theme["quiet"],
            linestyle="--",
            linewidth=1.3,
            marker="s",
            markersize=3.5,
        )
    axes.set_yscale("log")
    axes.set_xticks(list(places), [f"{entry['width']}×{entry['height']}" for entry in sizes])
    ticker = need("matplotlib.ticker", "a plot")
    axes.yaxis.set_major_locator(ticker.LogLocator(subs=(1, 2, 5)))
    _plain(axes.yaxis)
    canvas.label(axes, y="time of a frame [ms], mean and 95 % interval")
    canvas.legend(axes)


def _flow_accuracy(canvas: _Canvas, data: Data) -> None:
    scenarios = data["scenarios"]
    axes = canvas.axes(
        "Mean end-point error against arithmetic", height=1.4 + 0.42 * len(scenarios)
    )
    methods = data["methods"]
    colours = [ACCENT, *COLOURS]
    for number, method in enumerate(methods):
        errors = [max(e["errors"][method["name"]]["mean"] or 0.0, 1e-9) for e in scenarios]
        places = [row + 0.12 * (number - 0.5 * (len(methods) - 1)) for row in range(len(errors))]
        axes.plot(
            errors,
            places,
            linestyle="none",
            marker="D" if number == 0 else "o",
            markersize=7 if number == 0 else 5.5,
            color=colours[number % len(colours)],
            label=method["label"],
        )
    axes.set_xscale("log")
    axes.axvline(0.01, color=canvas.theme["quiet"], linestyle="--", linewidth=1)
    axes.text(
        0.0105, -0.62, "0.01 px", color=canvas.theme["quiet"], fontsize=8, va="center", ha="left"
    )
    axes.set_yticks(range(len(scenarios)), [entry["label"] for entry in scenarios])
    axes.set_ylim(len(scenarios) - 0.4, -0.8)
    canvas.label(axes, x="px per frame (logarithmic)")
    canvas.legend(axes)


def _detection(canvas: _Canvas, data: Data) -> None:
    classes = data["classes"]
    axes = canvas.axes("Box IoU by class, mean and deviation over the views", width=8.65)
    places = range(len(classes))
    width = 0.38
    theirs = [DETECTION[entry["name"]] for entry in classes]
    bars = {
        data["model"]: ([(e["box_iou"][0] or 0.0, e["box_iou"][1] or 0.0) for e in classes], 0),
        "the paper: Mask R-CNN on its own objects": ([(t[2], t[3]) for t in theirs], 1),
    }
    for label, (values, side) in bars.items():
        axes.bar(
            [place + (side - 0.5) * width for place in places],
            [mean for mean, _ in values],
            width,
            yerr=[deviation for _, deviation in values],
            color=ACCENT if side == 0 else canvas.theme["quiet"],
            ecolor=canvas.theme["ink"],
            error_kw={"linewidth": 0.8, "capsize": 2},
            label=label,
        )
    axes.set_ylim(0, 1.05)
    axes.set_xticks(list(places), [entry["name"] for entry in classes], rotation=38, ha="right")
    axes.grid(False, axis="x")
    canvas.legend(axes, loc="upper center", bbox_to_anchor=(0.5, -0.28), ncols=2)


def _transports(canvas: _Canvas, data: Data) -> None:
    rows = [row for row in data["cases"] if row["vary"] in ("size", "transport")]
    base = data["base"]
    kinds = [k for k in data["transports"] if any(r["transport"] == k for r in rows)]
    axes = canvas.axes(f"Time of a frame, {base['scene']}, {len(base['views'])} views")
    for number, kind in enumerate(kinds):
        found = {
            (r["width"], r["height"]): r["frame"]
            for r in rows
            if r["transport"] == kind and r.get("frame")
        }
        sizes = sorted(found)
        axes.plot(
            [f"{w}×{h}" for w, h in sizes],
            [found[size]["median"] for size in sizes],
            marker="o",
            markersize=5,
            linewidth=2.4 if number == 0 else 1.5,
            color=[ACCENT, *COLOURS][number],
            label=kind,
        )
    axes.set_yscale("log")
    ticker = need("matplotlib.ticker", "a plot")
    axes.yaxis.set_major_locator(ticker.LogLocator(subs=(1, 2, 5)))
    _plain(axes.yaxis)
    canvas.label(axes, y="median [ms]")
    canvas.legend(axes)


def _baselines(canvas: _Canvas, data: Data) -> None:
    baselines = [entry for entry in data["baselines"] if entry.get("frame")]
    axes = canvas.axes(
        "The same geometry by other renderers, as multiples of our time",
        height=1.2 + 0.38 * len(baselines),
    )
    ratios = [entry["ratio"] for entry in baselines]
    colours = [ACCENT if entry["ours"] else canvas.theme["quiet"] for entry in baselines]
    axes.barh(range(len(baselines)), ratios, color=colours, height=0.62)
    for place, ratio in enumerate(ratios):
        axes.text(
            ratio, place, f" {ratio:.2f}", va="center", fontsize=8.5, color=canvas.theme["ink"]
        )
    axes.set_yticks(range(len(baselines)), [f"{e['label']}, {e['size']}" for e in baselines])
    axes.invert_yaxis()
    axes.grid(False, axis="y")
    canvas.label(axes, x="median time ÷ that of sailenv_ros, picture + depth + instance")


def _streams(canvas: _Canvas, data: Data) -> None:
    streams = data["streams"]
    axes = canvas.axes("What is left of the difference of two pictures after warping", height=3.8)
    kinds = [
        ("flow of sailenv_ros", ACCENT, [entry["left"]["ours"] for entry in streams]),
        ("DIS", COLOURS[0], [entry["left"]["dis"] for entry in streams]),
    ]
    published = [(entry.get("published") or {}).get("left_stored") for entry in streams]
    kinds.append(("flow of the published stream", canvas.theme["quiet"], published))
    for place, (label, colour, values) in enumerate(kinds):
        axes.bar(
            [number + 0.27 * (place - 1) for number in range(len(streams))],
            [value or 0.0 for value in values],
            width=0.25,
            color=colour,
            label=label,
        )
    axes.set_xticks(range(len(streams)), [entry["label"] for entry in streams])
    axes.grid(False, axis="x")
    canvas.label(axes, y="share of the difference, 1 = no warp")
    canvas.legend(axes)


def _endless(canvas: _Canvas, data: Data) -> None:
    axes = canvas.axes("Share of pixels classified right, fading over a thousand", height=3.8)
    for number, entry in enumerate(data["learners"]):
        points = entry["checkpoints"]
        colour = [ACCENT, *COLOURS][number % (1 + len(COLOURS))]
        at = [point["at"] for point in points]
        axes.plot(at, [point["recent"] for point in points], color=colour, label=entry["name"])
        other = [point["tests"].get("other") or float("nan") for point in points]
        axes.plot(at, other, color=colour, linestyle=":", marker="o", markersize=4)
    axes.set_ylim(0, 1)
    canvas.label(axes, x="number of the frame; dotted: rooms never visited")
    canvas.legend(axes)


_PLOTS: Mapping[str, Mapping[str, Callable[[_Canvas, Data], None]]] = MappingProxyType(
    {
        "flow_speed": {"flow_speed": _flow_speed},
        "flow_accuracy": {"flow_accuracy": _flow_accuracy},
        "detection": {"detection": _detection},
        "throughput": {"throughput": _transports, "renderers": _baselines},
        "streams": {"streams": _streams},
        "endless": {"endless": _endless},
    }
)
