"""Cosmos Transfer's own code reads our controls: for its inference, and for its training.

    python benchmarks/judge_videos.py write FOLDER
    python benchmarks/judge_videos.py judge FOLDER SOURCE

`write` exports 33 pictures of `room_01` from a walk. `judge`, in an environment with torch, decord,
OpenCV, imageio-ffmpeg, einops and pycocotools and without this project, runs functions of the
repository `cosmos-transfer1` that lies in SOURCE. Of its inference: the specification is valid; for
each video, how many frames, how many a second and what size it reads; by how much depths differ;
how many pixels of segments have their object's colour. Of its data set for training: the depth that
its loader gives, and how many pixels of masks differ from our ids.
"""

from __future__ import annotations

import ast
import json
import os
import pickle
import sys
import traceback
import types
import typing
import warnings
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

PICTURES = 33
RATE_HZ = 24.0
NEAREST_M, FARTHEST_M = 0.4, 12.0
"""As the format has them: depth is grey by its inverse."""


def write(folder: Path) -> None:
    """Export a clip, and keep the depths and ids that it was made of."""
    from sailenv_ros import AgentSpec, CameraIntrinsics, Simulation, look_at
    from sailenv_ros.dataset.formats import DatasetWriter

    lens = CameraIntrinsics(width=640, height=480)
    spec = AgentSpec(name="eye", intrinsics=lens, following=False)
    depths, ids = [], []
    with (
        Simulation("room_01", mode="lockstep", light="plain", agent=spec) as simulation,
        DatasetWriter(folder / "cosmos", ["cosmos"]) as writer,
    ):
        for turn in np.linspace(0.0, 0.6, PICTURES):
            c, s = float(np.cos(turn)), float(np.sin(turn))
            simulation.set_pose(look_at((1.3 * c, 1.1 * s, 1.5), (-0.6 * c, -0.6 * s, 0.8)))
            simulation.step(round(240 / RATE_HZ))
            frame = simulation.capture()
            writer.add(frame)
            depths.append(frame["depth"])
            ids.append(frame["instance"])
        writer.finish()
    np.savez_compressed(folder / "truth.npz", depths=depths, ids=ids)


def judge(folder: Path, source: Path) -> None:
    """Print what its code finds."""
    os.chdir(folder / "cosmos")
    with np.load(folder / "truth.npz") as kept:
        depths, ids = kept["depths"], kept["ids"]
    package = source / "cosmos_transfer1"
    _inference(package, depths, ids)
    for kind in ("depth", "seg"):
        _training(package, kind, depths, ids)


def _inference(package: Path, depths: Any, ids: Any) -> None:
    import cv2
    import einops
    import imageio
    import torch

    log = types.SimpleNamespace(**dict.fromkeys(("info", "debug", "warning"), lambda *_: None))
    given = {"cv2": cv2, "einops": einops, "imageio": imageio, "torch": torch, "log": log}
    given |= {"default_model_names": {name: name for name in ("vis", "seg", "edge", "depth")}}
    given |= _parts(package / "utils/io.py", {"load_from_fileobj"}, given)
    names = {
        "VIDEO_RES_SIZE_INFO", "valid_hint_keys", "detect_aspect_ratio", "resize_video",
        "read_and_resize_input", "read_video_or_image_into_frames_BCTHW", "load_controlnet_specs",
        "validate_controlnet_specs",
    }  # fmt: skip
    theirs = _parts(package / "diffusion/inference/inference_utils.py", names, given)
    asked = types.SimpleNamespace(
        controlnet_specs="specs/0000.json", checkpoint_dir="", sigma_max=70.0, use_distilled=False
    )
    specs, told = theirs["load_controlnet_specs"](asked)
    asked.input_video_path = told["input_video_path"]
    theirs["validate_controlnet_specs"](asked, specs)
    print(f"specification: {', '.join(specs)}; prompt of {len(told['prompt'].split())} words")
    files = {"video": told["input_video_path"]}
    files |= {name: one["input_control"] for name, one in specs.items()}
    for name, file in files.items():
        frames, rate = theirs["read_video_or_image_into_frames_BCTHW"](
            file, normalize=False, max_frames=5000, also_return_fps=True
        )
        sized, _, aspect = theirs["read_and_resize_input"](file, 5000, cv2.INTER_AREA)
        _, _, count, height, width = frames.shape
        said = f"{name}: {count} frames of {width}×{height}, {rate} a second; as {aspect} "
        said += f"{tuple(sized.shape)}"
        pictures = np.asarray(frames)[0].transpose(1, 2, 3, 0)
        if name == "depth":
            said += f"; {_depths_differ(pictures, depths)}"
        if name == "seg":
            said += f"; {_own_colours(pictures, ids):.2f} % of pixels have their object's colour"
        print(said)


def _depths_differ(pictures: Any, depths: Any) -> str:
    near, far = 1.0 / NEAREST_M, 1.0 / FARTHEST_M
    shown = pictures[..., 0].astype(np.float64) / 255.0 * (near - far) + far
    meant = 1.0 / np.nan_to_num(depths, posinf=FARTHEST_M).clip(NEAREST_M, FARTHEST_M)
    off = np.abs(shown - meant) / (near - far) * 255.0
    return f"inverse depth differs by {off.mean():.2f} of 255 in the mean, 99 %: {_most(off):.1f}"


def _most(values: Any) -> float:
    return float(np.percentile(values, 99.0))


def _own_colours(pictures: Any, ids: Any) -> float:
    """Return the share of pixels that are nearest to the mean colour of their object [%]."""
    known = np.unique(ids)
    means = np.array([pictures[ids == one].mean(axis=0) for one in known])
    right = 0
    for picture, own in zip(pictures, ids, strict=True):
        off = np.stack([((picture - mean) ** 2).sum(axis=-1) for mean in means])
        # Neighbours in the table of colours may look alike after coding: their colour is right.
        right += int((off.min(axis=0) + 64.0 >= _at(off, np.searchsorted(known, own))).sum())
    return 100.0 * right / float(ids.size)


def _at(off: Any, place: Any) -> Any:
    return np.take_along_axis(off, place[None], axis=0)[0]


def _training(package: Path, kind: str, depths: Any, ids: Any) -> None:
    import pycocotools.mask
    import torch

    given = {"torch": torch, "pycocotools": pycocotools, "Any": Any}
    names = {
        "Augmentor", "AddControlInputSeg", "AddControlInputDepth", "segmentation_color_mask",
        "decode_partial_rle_width1", "VIDEO_RES_SIZE_INFO", "generate_distinct_colors",
    }  # fmt: skip
    augmentors = package / "diffusion/datasets/augmentors/control_input.py"
    colours: list[Any] = []
    theirs = _parts(augmentors, names, {**given, "log": None})

    def kept(masks: Any, *_: Any) -> Any:
        """Keep the masks, and give them colours as it does."""
        colours.append(masks)
        return np.zeros((3, *masks.shape[1:]), np.uint8)

    theirs["segmentation_color_mask"] = kept
    theirs["AddControlInputSeg"].__call__.__globals__["segmentation_color_mask"] = kept
    made = {
        "seg": lambda: theirs["AddControlInputSeg"](["", "video"], random_sample_num_masks=False),
        "depth": lambda: theirs["AddControlInputDepth"](["", "video"]),
    }[kind]
    options = {f"video_ctrlnet_augmentor_control_input_{kind}": lambda resolution: {"own": made()}}
    from decord import VideoReader, cpu
    from torch.utils.data import Dataset

    inference = package / "diffusion/inference/inference_utils.py"
    given |= _parts(inference, {"detect_aspect_ratio"}, given)
    given |= {"VideoReader": VideoReader, "cpu": cpu, "Dataset": Dataset, "os": os}
    given |= {"AUGMENTOR_OPTIONS": options, "instantiate": lambda one: one, "pickle": pickle}
    given |= {"VIDEO_RES_SIZE_INFO": theirs["VIDEO_RES_SIZE_INFO"]}
    given |= {"traceback": traceback, "warnings": warnings}
    data = _parts(
        package / "diffusion/datasets/example_transfer_dataset.py",
        {"CTRL_TYPE_INFO", "ExampleTransferDataset"},
        given,
    )
    # Its network makes these of the captions.
    Path("t5_xxl").mkdir(exist_ok=True)
    Path("t5_xxl/0000.pickle").write_bytes(pickle.dumps(np.zeros((512, 1024), np.float32)))
    read = data["ExampleTransferDataset"](".", PICTURES, "720", f"control_input_{kind}")
    item = read[0]
    control = np.asarray(item[f"control_input_{kind}"])
    said = f"training, {kind}: video {tuple(item['video'].shape)}, control {control.shape}, "
    said += f"{item['fps']:g} a second"
    if kind == "depth":
        said += f"; {_depths_differ(control.transpose(1, 2, 3, 0), depths)}"
    else:
        phrases = item["segmentation_phrase_all"].split(";")
        known = {int(one) for one in np.unique(ids)} - {0}
        differ = 0
        for mask in colours[-1]:
            (own,) = {int(one) for one in np.unique(ids[mask > 0])}
            differ += int(((mask > 0) != (ids == own)).sum())
            known.remove(own)
        assert not known
        said += f"; {len(phrases)} masks, of which {differ} pixels differ"
    print(said)


def _parts(path: Path, names: set[str], given: dict[str, Any]) -> dict[str, Any]:
    """Run some functions, classes and constants of a file whose other parts need a GPU."""

    def own(one: ast.stmt) -> bool:
        if isinstance(one, ast.FunctionDef | ast.ClassDef):
            return one.name in names
        targets = one.targets if isinstance(one, ast.Assign) else [getattr(one, "target", None)]
        return any(isinstance(target, ast.Name) and target.id in names for target in targets)

    kept = [one for one in ast.parse(path.read_text()).body if own(one)]
    made: dict[str, Any] = {"np": np, "json": json, "os": os, "BytesIO": BytesIO, **given}
    made |= {name: getattr(typing, name) for name in ("Dict", "Optional", "Tuple")}
    exec(compile(ast.Module(kept, []), str(path), "exec"), made)
    return {name: made[name] for name in names}


if __name__ == "__main__":
    if sys.argv[1] == "write":
        write(Path(sys.argv[2]))
    else:
        judge(Path(sys.argv[2]).absolute(), Path(sys.argv[3]).absolute())
