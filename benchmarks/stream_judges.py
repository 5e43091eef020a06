"""Runs the published programs of SAILab on streams, theirs or ours, and says what they find.

    python benchmarks/stream_judges.py raw-image CLONE FOLDER --stream empty_space
    python benchmarks/stream_judges.py horn-schunck CLONE FOLDER --stream a --frames 1500

CLONE is a clone of github.com/sailab-code/cl_stochastic_coherence or of continual-of, FOLDER what
`sailenv export BAG -o FOLDER --format lve` has written, or one of the clone's own streams. The
first runs `exp_runner.py --arch=identity`, the second `run_baseline.py --arch=none-ihs`, with the
arguments of their `reproduce_runs.txt`, unchanged, in a folder of their own. Packages that they
import and that these two runs do not use (networks, servers, video, other simulators) are stood in
for. Needs PyTorch, OpenCV, SciPy, Pillow and matplotlib; nothing of this package.
"""

from __future__ import annotations

import argparse
import ctypes
import importlib
import importlib.abc
import importlib.machinery
import inspect
import json
import os
import runpy
import sys
import tempfile
import types
from collections.abc import Sequence
from pathlib import Path
from typing import Any
from unittest.mock import MagicMock

import numpy as np

UNUSED = (
    *("dpt_intel", "ffmpeg", "flow_vis", "lve.unity_client", "prettytable", "raft", "sailenv"),
    *("seaborn", "smurf", "tdw", "tensorboard", "tensorflow", "timm", "torch.utils.tensorboard"),
    *("torchinfo", "torchsummary", "torchvision", "wandb"),
)
"""Modules that theirs import and these runs do not need."""

DATA = {"empty_space": "emptyspace", "solid": "solid", "living_room": "livingroom"}
"""Their names of the streams."""

COLOF_DATA = {"a": "stream_a_9424", "b": "stream_b_8714", "c": "stream_c_1235"}

HORN_SCHUNCK = {"a": "0.5", "b": "0.5", "c": "1"}
"""Weights of smoothness with 200 iterations from nothing, and with a warm start for C."""


M_MMAP_THRESHOLD = -3
"""Parameter of glibc's `mallopt`: the size from which a freed block is given back."""


class _StandIns(importlib.abc.MetaPathFinder, importlib.abc.Loader):
    """Imports whatever `UNUSED` names as something that takes every use."""

    def find_spec(self, name: str, path: Any = None, target: Any = None) -> Any:
        if any(name == unused or name.startswith(f"{unused}.") for unused in UNUSED):
            return importlib.machinery.ModuleSpec(name, self, is_package=True)
        return None

    def create_module(self, spec: Any) -> Any:
        module = MagicMock(name=spec.name)
        module.__spec__, module.__path__ = spec, []
        return module

    def exec_module(self, module: types.ModuleType) -> None:
        """Leave it as it is."""


def main() -> None:
    """Run and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("judge", choices=("raw-image", "horn-schunck"))
    parser.add_argument("clone", type=Path)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--stream", required=True, choices=(*DATA, *COLOF_DATA))
    parser.add_argument("--gray", action="store_true", help="raw-image: their gray run, not colour")
    parser.add_argument("--frames", type=int, help="fewer frames of each lap, to see that it works")
    options = parser.parse_args()
    clone, folder = options.clone.resolve(), options.folder.resolve()
    sys.meta_path.insert(0, _StandIns())
    sys.path.insert(0, str(clone))
    vars(np).setdefault("bool", bool)  # gone from some versions
    # Their small matrices, one a frame, lie between large pictures on the heap, which could never
    # shrink then: 10 MB a frame.
    ctypes.CDLL(None).mallopt(M_MMAP_THRESHOLD, 1 << 16)
    with tempfile.TemporaryDirectory() as scratch:
        os.chdir(scratch)
        os.mkdir("data")
        if options.judge == "raw-image":
            _raw_image(clone, folder, options)
        else:
            _horn_schunck(clone, folder, options)


def _raw_image(clone: Path, folder: Path, options: argparse.Namespace) -> None:
    """Let `exp_runner.py` classify raw pixels by three templates an object."""
    data = DATA[options.stream]
    os.symlink(folder, f"data/{data}")
    _patch(options.frames)
    gray = options.gray or options.stream == "solid"
    normalize = "yes" if options.stream == "empty_space" and not gray else "no"
    _run(
        clone / "exp_runner.py",
        f"--arch=identity --dataset={data} --force_gray={'yes' if gray else 'no'}"
        f" --normalize={normalize} --num_pairs=10 --laps_metrics=2 --laps_sup=2 --laps_unsup=0"
        " --train=no --seed=1234".split(),
    )
    found = json.loads(Path("model_folder/results.json").read_text())
    whole, focus = found["f1_window_whole_global"], found["f1_window_foa_global"]
    print(f"F1 of the raw image, whole frame: {whole:.3f}, focus of attention: {focus:.3f}")


def _horn_schunck(clone: Path, folder: Path, options: argparse.Namespace) -> None:
    """Let `run_baseline.py` estimate flow, and compare it with the stored one."""
    for data in (*COLOF_DATA.values(), "1917-cut"):
        # Their program ends with the first minute of the others; here that is this one again.
        os.symlink(folder, f"data/{data}")
    _patch(options.frames)
    warm = "yes" if options.stream == "c" else "no"
    _run(
        clone / "run_baseline.py",
        f"--arch=none-ihs --experience={options.stream} --iter_ihs=200"
        f" --lambda_s={HORN_SCHUNCK[options.stream]} --warm_ihs={warm}".split(),
    )
    found = json.loads(Path("model_folder/results_tuning_all_stream.json").read_text())
    accuracies = ", ".join(f"{one:.3f}" for one in found["recon_acc"].values())
    # Of stream C their program tells no Motion-F1: all of it moves.
    score = found.get("moving_f1")
    print(f"Motion-F1: {'–' if score is None else f'{score:.3f}'}, reconstruction: {accuracies}")


def _patch(frames: int | None) -> None:
    """Have their streams end early, without a page for browsers, and find their own focus."""
    import cv2
    import lve

    if not hasattr(lve, "InputStream"):
        _complete(lve)
    # For faces, which are given no weight; OpenCV 5 has none.
    vars(cv2).setdefault("CascadeClassifier", MagicMock())
    read = lve.InputStream.__init__
    signature = inspect.signature(read)

    def init(self: Any, *args: Any, **kwargs: Any) -> None:
        given = signature.bind(self, *args, **kwargs)
        if not Path(given.arguments.get("foa_file") or "").is_file():
            given.arguments["foa_file"] = None
        if frames is not None:
            given.arguments["max_frames"] = frames
        read(*given.args, **given.kwargs)

    lve.InputStream.__init__ = init
    lve.VisualizationServer = MagicMock(name="VisualizationServer")


def _complete(package: types.ModuleType) -> None:
    """Give continual-of's package the names that it uses: its `__init__.py` is not published."""
    package.__file__ = str(Path(next(iter(package.__path__))) / "__init__.py")
    for module, names in (
        ("in_stream", ("InputStream", "InputType")),
        ("out_stream", ("OutputStream", "OutputType")),
        ("worker", ("Worker",)),
        ("opticalflow_cv", ("OpticalFlowCV",)),
        ("visuserver", ("VisualizationServer",)),
        ("vprocessor", ("VProcessor",)),
        ("net_hs", ("NetHS",)),
        ("worker_hs", ("WorkerHS",)),
    ):
        found = importlib.import_module(f"lve.{module}")
        for name in names:
            setattr(package, name, getattr(found, name))


def _run(program: Path, arguments: Sequence[str]) -> None:
    print(program.name, *arguments, flush=True)
    sys.argv = [str(program), *arguments]
    runpy.run_path(str(program), run_name="__main__")


if __name__ == "__main__":
    main()
