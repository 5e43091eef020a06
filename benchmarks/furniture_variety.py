"""Pieces from seeds beside the catalogue's: how far apart in a network's eyes, and what it sees.

    python -m benchmarks.furniture_variety --model nanodet_coco_416.onnx --pieces 24

Each piece is pictured on a plain floor. Variety is by cosine distances between pieces of a
category, in the features of the last stage of the network's backbone, averaged over the picture:
`apart` is the mean over all pairs, `nearest` the mean from each piece to the one that is most like
it (which falls as there are more of them), `unlike` how many pieces there are of which no two are
nearer than 0.04. A piece is `named` if the network knows its category and finds it, with a score of
at least 0.3, in one of two views.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import onnxruntime

from sailenv_bench.experiments.coco_classes import COCO_NAMES
from sailenv_bench.experiments.decoders import DECODERS
from sailenv_bench.experiments.detector import INPUTS, fitted
from sailenv_content.families.registry import family_named, family_names
from sailenv_ros.assets.asset_library import AssetLibrary
from sailenv_ros.assets.sources import installed_packs, installed_sources
from sailenv_ros.simulation.models.preview_renderer import PreviewRenderer

AZIMUTHS_DEG = (32.0, -20.0)
LEAST_SCORE = 0.3
UNLIKE = 0.04
"""Cosine distance of two pieces that look unlike."""

TABLE = "  apart  nearest  unlike  named"
SIDE_PX = 416

_GRAPH, _NODE, _OUTPUT, _OF_NODE = 7, 1, 12, 2
"""Numbers of fields in ONNX's protobuf: a model's graph, its nodes and outputs, a node's output."""


class Network:
    """A NanoDet that tells the features of its backbone, too."""

    def __init__(self, path: Path) -> None:
        model = path.read_bytes()
        graph = next(value for number, value in _fields(model) if number == _GRAPH)
        names = [
            value.decode()
            for number, node in _fields(graph)
            if number == _NODE
            for inner, value in _fields(node)
            if inner == _OF_NODE
        ]
        wanted = [name for name in names if name.startswith("/Concat")]
        # Messages that follow one another are merged: this adds outputs to the graph.
        more = b"".join(_field(_OUTPUT, _field(1, name.encode())) for name in wanted)
        self._session = onnxruntime.InferenceSession(model + _field(_GRAPH, more))
        empty = self._run(np.zeros((SIDE_PX, SIDE_PX, 3), np.uint8))
        shapes = {n: v.shape for n, v in empty.items() if v.ndim == 4 and n in wanted}
        self._features = max(shapes, key=lambda name: shapes[name][1])
        self._extra = set(wanted)

    def seen(self, picture: np.ndarray) -> tuple[np.ndarray, dict[str, float]]:
        """Return features (C,) of unit length, and the best score of each class that is found."""
        outputs = self._run(picture)
        features = outputs[self._features][0].mean(axis=(1, 2)).astype(np.float64)
        own = {name: value for name, value in outputs.items() if name not in self._extra}
        found = DECODERS["nanodet"](own, (SIDE_PX, SIDE_PX))
        scores: dict[str, float] = {}
        for number, score in zip(found.classes, found.scores, strict=True):
            name = COCO_NAMES[int(number)]
            scores[name] = max(scores.get(name, 0.0), float(score))
        return features / np.linalg.norm(features), scores

    def _run(self, picture: np.ndarray) -> dict[str, Any]:
        style = INPUTS["nanodet"]
        image = fitted(picture, (SIDE_PX, SIDE_PX), style.pad).picture[..., ::-1]
        values = (image - np.asarray(style.mean)) / np.asarray(style.std)
        fed = np.ascontiguousarray(values.transpose(2, 0, 1)[None], np.float32)
        names = [output.name for output in self._session.get_outputs()]
        return dict(zip(names, self._session.run(None, {"x": fed}), strict=True))


def _varint(data: bytes, at: int) -> tuple[int, int]:
    value = shift = 0
    while True:
        value |= (data[at] & 127) << shift
        shift, at = shift + 7, at + 1
        if data[at - 1] < 128:
            return value, at


def _fields(data: bytes) -> Iterator[tuple[int, bytes]]:
    """Yield the numbers and the bytes of all fields of a message that have a length."""
    at = 0
    while at < len(data):
        key, at = _varint(data, at)
        if key & 7 == 0:
            _, at = _varint(data, at)
        elif key & 7 == 2:
            length, at = _varint(data, at)
            yield key >> 3, data[at : at + length]
            at += length
        else:
            at += 8 if key & 7 == 1 else 4


def _field(number: int, content: bytes) -> bytes:
    length, text = len(content), bytes([number << 3 | 2])
    while length > 127:
        text, length = text + bytes([length & 127 | 128]), length >> 7
    return text + bytes([length]) + content


def groups(count: int) -> Iterator[tuple[str, list[str], list[str]]]:
    """Yield categories with names of the catalogue's objects and of pieces from seeds."""
    listed: dict[str, list[str]] = {}
    for pack in installed_packs():
        for name, entry in pack.entries.items():
            listed.setdefault(entry.category, []).append(name)
    styles: dict[str, list[str]] = {}
    for family in map(family_named, family_names()):
        for name, style in family.styles.items():
            styles.setdefault(style.category or family.category, []).append(f"{family.name}~{name}")
    for category, mine in sorted(styles.items()):
        seeded = [f"{mine[k % len(mine)]}:{900_000 + k}" for k in range(count)]
        yield category, sorted(listed.get(category, ())), seeded


@dataclass(frozen=True, slots=True)
class Found:
    """Likeness of the pieces of a category, and how many are named.

    Attributes
    ----------
    apart, nearest : float
        Mean distance of two pieces, and of a piece from the one most like it; NaN of one piece.
    unlike : int
        Pieces of which no two are alike.
    named : float
        Share that the network names; NaN of a category that it does not know.
    """

    apart: float
    nearest: float
    unlike: int
    named: float

    def __str__(self) -> str:
        """Return the columns of `TABLE`."""
        apart, nearest, named = (
            f"{'-':>7}" if np.isnan(value) else told
            for value, told in (
                (self.apart, f"{self.apart:7.3f}"),
                (self.nearest, f"{self.nearest:7.3f}"),
                (self.named, f"{self.named:7.0%}"),
            )
        )
        return f"{apart}  {nearest}{self.unlike:8d}{named}"


def judged(
    names: Sequence[str], category: str, library: AssetLibrary, net: Network, eyes: Any
) -> Found:
    """Return what the network makes of pieces of a category."""
    known = category in COCO_NAMES
    features, named = [], 0
    for name in names:
        views = [
            net.seen(
                eyes.thumbnail(library.get(name), width=SIDE_PX, height=SIDE_PX, azimuth_deg=a)
            )
            for a in (AZIMUTHS_DEG if known else AZIMUTHS_DEG[:1])
        ]
        features.append(views[0][0])
        named += any(scores.get(category, 0.0) >= LEAST_SCORE for _, scores in views)
    apart = 1.0 - np.array(features) @ np.array(features).T
    pairs = apart[np.triu_indices(len(names), 1)]
    kept: list[int] = []
    for number in range(len(names)):
        if all(apart[number, other] >= UNLIKE for other in kept):
            kept.append(number)
    single = len(names) == 1
    return Found(
        np.nan if single else float(pairs.mean()),
        np.nan if single else float((apart + 9.0 * np.eye(len(names))).min(axis=1).mean()),
        len(kept),
        named / len(names) if known else np.nan,
    )


def main() -> int:
    """Print a line for each category, and means over those that have what is compared."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--model", type=Path, required=True, help="a NanoDet of COCO, .onnx")
    parser.add_argument("--pieces", type=int, default=24, help="pieces from seeds of each category")
    parser.add_argument("--categories", nargs="*", default=(), help="(default: all)")
    args = parser.parse_args()
    net = Network(args.model)
    library = AssetLibrary(installed_sources(installed_packs()))
    print(f"{'category':<14}{'catalogue':>10}{TABLE}{'seeds':>10}{TABLE}")
    found: list[list[Found | None]] = []
    with PreviewRenderer() as eyes:
        for category, listed, seeded in groups(args.pieces):
            if args.categories and category not in args.categories:
                continue
            pair = [
                judged(names, category, library, net, eyes) if names else None
                for names in (listed, seeded)
            ]
            found.append(pair)
            columns = (
                f"{len(names):10d}{of or ''!s:{len(TABLE)}}"
                for names, of in zip((listed, seeded), pair, strict=True)
            )
            print(f"{category:<14}{''.join(columns)}".rstrip(), flush=True)
    for key in ("apart", "nearest", "unlike", "named"):
        rows = [[getattr(of, key) if of else np.nan for of in pair] for pair in found]
        values = np.array(rows, float)
        both = values[~np.isnan(values).any(axis=1)]
        print(f"mean {key} of {len(both)} categories: {both.mean(axis=0).round(3)}")
    print(f"mean named of all pieces from seeds: {np.nanmean(values[:, 1]):.3f}")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
