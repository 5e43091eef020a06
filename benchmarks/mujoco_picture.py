"""Picture of an exported MJCF file by MuJoCo's own renderer; called by foreign_pictures.py.

MUJOCO_GL=osmesa python benchmarks/mujoco_picture.py FILE CAMERA WIDTH HEIGHT OUT
"""

from __future__ import annotations

import sys

import mujoco
import numpy as np


def main() -> None:
    """Load, render, save (H, W, 3) uint8."""
    file, camera, width, height, out = sys.argv[1:]
    model = mujoco.MjModel.from_xml_path(file)
    data = mujoco.MjData(model)
    if model.nkey:
        mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    model.vis.global_.offwidth, model.vis.global_.offheight = int(width), int(height)
    with mujoco.Renderer(model, int(height), int(width)) as renderer:
        renderer.update_scene(data, camera=camera)
        np.save(out, renderer.render())


main()
