"""Whether variety helps: a small net learns from rooms of one kind, or of another.

    python -m benchmarks.variety make DIR         # data sets, with sailenv_ros
    judges/bin/python benchmarks/variety.py train DIR [SEED]   # with PyTorch alone

Two comparisons. Rooms: three fixed ones against a hundred from seeds; the test is of other seeds.
Pieces: a hundred rooms with the catalogue's furniture against the same rooms with pieces from
seeds. Their tests are rooms of other seeds, half of them with catalogue furniture that no room of
training has (that of even numbers), half with pieces of other seeds.

All nets are the same, begin with the same numbers and see as many frames in as many steps. Frames
are 160 x 120, light is plain (not baked). The net works on half of that, and a class weighs in its
loss by the root of how rare its pixels are: else it learns walls, windows and doors alone.
"""

from __future__ import annotations

import json
import sys
import tarfile
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

CLASSES = ("chair", "bed", "couch", "window", "door")
KINDS = ("living_room", "bedroom")
FRAMES, TEST_FRAMES = 2000, 400
ROOMS, TEST_ROOMS = 100, 20
STEPS, BATCH = 2500, 16
COMPARISONS = (
    (("fixed", "generated"), ("test",)),
    (("catalogue", "seeds"), ("other_catalogue", "other_seeds")),
)
WORKERS = 2


def make(folder: Path) -> None:
    """Make the data sets, each into a folder of its own."""

    def generated(first: int, count: int) -> list[dict[str, Any]]:
        half = count // len(KINDS)
        return [{"generate": kind, "seeds": [first, first + half - 1]} for kind in KINDS]

    folder.mkdir(parents=True, exist_ok=True)
    rooms = [{"scene": f"room_0{number}"} for number in (1, 2, 3)]
    for name, scenes, frames in (
        ("test", generated(10_000, TEST_ROOMS), TEST_FRAMES),
        ("fixed", rooms, FRAMES),
        ("generated", generated(0, ROOMS), FRAMES),
        ("catalogue", _furnished(folder, "catalogue", 20_000, ROOMS), FRAMES),
        ("seeds", _furnished(folder, "seeds", 20_000, ROOMS), FRAMES),
        ("other_catalogue", _furnished(folder, "other_catalogue", 30_000, TEST_ROOMS), TEST_FRAMES),
        ("other_seeds", _furnished(folder, "seeds", 30_000, TEST_ROOMS), TEST_FRAMES),
    ):
        _make_set(folder, name, scenes, frames)


def _make_set(folder: Path, name: str, scenes: list[dict[str, Any]], frames: int) -> None:
    import yaml

    from sailenv_ros.dataset import engine_of, load_job, make_dataset

    recipe = {
        "version": 1,
        "scenes": scenes,
        "light": "plain",
        "clips": {"train": frames},
        "clip": {"per_scene": 20, "gap": 0.1},
        "cameras": [{"type": "rule", "rule": "free_view", "width": 160, "height": 120}],
        "views": ["rgb", "category", "instance"],
        "formats": ["webdataset"],
        "shard": {"clips": 100},
    }
    path = folder / f"{name}.yaml"
    path.write_text(yaml.safe_dump(recipe))
    began = time.monotonic()
    made = make_dataset(load_job(path), folder / name, engine_of(WORKERS, None))
    print(f"{name}: {made.frames} frames in {time.monotonic() - began:.0f} s", flush=True)


def _furnished(folder: Path, furniture: str, first: int, count: int) -> list[dict[str, Any]]:
    """Make scene files of rooms whose furniture is of one source, and return their entries."""
    from sailenv_content.generation.generator import Generator
    from sailenv_content.generation.pieces import PieceChooser
    from sailenv_ros.authoring.room_rules.rule_files import ANY_SEED

    def wanted(name: str) -> bool:
        if furniture == "seeds" or name.endswith(ANY_SEED):
            return furniture == "seeds" and name.endswith(ANY_SEED)
        number = name.rpartition("_")[2]
        even = number.isdigit() and int(number) % 2 == 0
        return even == (furniture == "other_catalogue")

    def one_of(self: PieceChooser, names: Sequence[str]) -> str:
        listed = [name for name in names if not name.endswith(ANY_SEED)]
        some = [name for name in names if wanted(name)] or listed or names
        return self.chosen(self._dice.one(some))

    entries = []
    generator, kept = Generator(), PieceChooser.one_of
    PieceChooser.one_of = one_of  # type: ignore[method-assign]  # the one place that chooses
    try:
        for kind in KINDS:
            for seed in range(first, first + count // len(KINDS)):
                path = folder / f"{furniture}_{kind}_{seed}.yaml"
                if not path.exists():
                    path.write_text(generator.generate(kind, seed).text)
                entries.append({"scene": path.name})
    finally:
        PieceChooser.one_of = kept  # type: ignore[method-assign]
    return entries


def load(folder: Path) -> tuple[Any, Any]:
    """Return pictures (N, 3, H, W) uint8 and labels (N, H, W): 0, or 1 + the class."""
    import cv2

    pictures, labels = [], []
    for path in sorted((folder / "webdataset").glob("*.tar")):
        with tarfile.open(path) as tar:
            members: dict[str, dict[str, bytes]] = {}
            for member in tar:
                name, _, ending = member.name.partition(".")
                file = tar.extractfile(member)
                assert file is not None
                members.setdefault(name, {})[ending] = file.read()
        for parts in members.values():
            told = json.loads(parts["json"])
            picture, category = (
                np.asarray(cv2.imdecode(np.frombuffer(parts[name], np.uint8), flag))
                for name, flag in (("rgb.png", 1), ("category.png", -1))
            )
            label = np.zeros(category.shape, np.int64)
            for entry in told["objects"]:
                if entry["category"] in CLASSES:
                    number = 1 + CLASSES.index(entry["category"])
                    label[category == entry["category_id"]] = number
            pictures.append(picture[..., ::-1].transpose(2, 0, 1))
            labels.append(label)
    return np.stack(pictures), np.stack(labels)


def train(folder: Path, seed: int = 0) -> None:
    """Train on either set of a comparison and print what each net reaches on its tests.

    Parameters
    ----------
    seed : int
        Of what the nets begin with, and of the order of frames.
    """
    print(f"| trained on | tested on | mean IoU | {' | '.join(CLASSES)} |")
    print("|---|---|" + "---:|" * (1 + len(CLASSES)))
    for sets, tests in COMPARISONS:
        for name in sets:
            began = time.monotonic()
            net = _trained(load(folder / name), seed)
            for test in tests:
                scores = _tested(net, load(folder / test))
                row = " | ".join(f"{score:.3f}" for score in (np.nanmean(scores), *scores))
                print(f"| {name} | {test} | {row} |", flush=True)
            print(f"trained in {time.monotonic() - began:.0f} s", file=sys.stderr, flush=True)


def _trained(data: tuple[Any, Any], seed: int) -> Any:
    import torch
    from torch import nn

    torch.manual_seed(seed)
    random = np.random.default_rng(seed)

    def block(inside: int, outside: int) -> Any:
        return nn.Sequential(
            nn.Conv2d(inside, outside, 3, padding=1), nn.BatchNorm2d(outside), nn.ReLU(),
            nn.Conv2d(outside, outside, 3, padding=1), nn.BatchNorm2d(outside), nn.ReLU(),
        )  # fmt: skip

    class Net(nn.Module):
        """An encoder and a decoder with shortcuts, on pictures of half the size."""

        def __init__(self) -> None:
            super().__init__()
            widths = (16, 32, 64, 96)
            self.down = nn.ModuleList(
                block(a, b) for a, b in zip((3, *widths), widths, strict=False)
            )
            self.up = nn.ModuleList(block(a + b, b) for a, b in ((96, 64), (64, 32), (32, 16)))
            self.head = nn.Conv2d(16, 1 + len(CLASSES), 1)

        def forward(self, x: Any) -> Any:
            kept = []
            x = nn.functional.avg_pool2d(x, 2)
            for number, layer in enumerate(self.down):
                x = layer(x if number == 0 else nn.functional.max_pool2d(x, 2))
                kept.append(x)
            for layer, short in zip(self.up, kept[-2::-1], strict=True):
                x = nn.functional.interpolate(x, size=short.shape[2:], mode="nearest")
                x = layer(torch.cat([x, short], 1))
            return self.head(x)

    net = Net()
    optimiser = torch.optim.AdamW(net.parameters(), 2e-3, weight_decay=1e-4)
    schedule = torch.optim.lr_scheduler.OneCycleLR(optimiser, 4e-3, total_steps=STEPS)
    pictures, labels = data
    shares = np.bincount(labels.ravel(), minlength=1 + len(CLASSES)) / labels.size
    weights = torch.from_numpy(1.0 / np.sqrt(np.maximum(shares, 1e-4))).float()
    net.train()
    for _ in range(STEPS):
        rows = random.integers(len(pictures), size=BATCH)
        x = torch.from_numpy(pictures[rows]).float() / 255.0
        y = torch.from_numpy(labels[rows, ::2, ::2])
        if random.random() < 0.5:
            x, y = x.flip(3), y.flip(2)
        x = x * (0.7 + 0.6 * torch.rand(BATCH, 3, 1, 1))
        loss = nn.functional.cross_entropy(net(x), y, weights)
        optimiser.zero_grad()
        loss.backward()
        optimiser.step()
        schedule.step()
    return net.eval()


def _tested(net: Any, data: tuple[Any, Any]) -> list[float]:
    """Return each class's intersection over union, over all pixels of the test."""
    import torch
    from torch import nn

    both, either = np.zeros(len(CLASSES)), np.zeros(len(CLASSES))
    pictures, labels = data
    with torch.no_grad():
        for at in range(0, len(pictures), BATCH):
            x = torch.from_numpy(pictures[at : at + BATCH]).float() / 255.0
            found = nn.functional.interpolate(net(x), scale_factor=2, mode="bilinear")
            found = found.argmax(1).numpy()
            truth = labels[at : at + BATCH]
            for number in range(len(CLASSES)):
                one, other = found == number + 1, truth == number + 1
                both[number] += (one & other).sum()
                either[number] += (one | other).sum()
    return [float(a / b) if b else float("nan") for a, b in zip(both, either, strict=True)]


if __name__ == "__main__":
    if sys.argv[1] == "make":
        make(Path(sys.argv[2]))
    else:
        train(Path(sys.argv[2]), *map(int, sys.argv[3:]))
