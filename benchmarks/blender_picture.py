"""Radiance of an exported USD file as Blender's Cycles sees it; called by foreign_pictures.py.

    python benchmarks/blender_picture.py FILE CAMERA WIDTH HEIGHT SAMPLES SKY OUT

Needs PyPI's bpy 4.5. SKY is a picture of the sky (EXR), or a dash for none. Writes (H, W, 3)
float32 as ``.npy``.
"""

from __future__ import annotations

import importlib
import sys
import tempfile
from typing import Any

import numpy as np

bpy: Any = importlib.import_module("bpy")


def main() -> None:
    """Import, render, save."""
    file, camera, width, height, samples, sky, out = sys.argv[1:]
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.usd_import(filepath=file, import_subdiv=False)
    scene = bpy.context.scene
    scene.camera = next(
        one for one in scene.objects if one.type == "CAMERA" and camera in (one.name, one.data.name)
    )
    for lamp in bpy.data.lights:
        if lamp.type == "SUN":
            lamp.energy /= 4.0  # Blender 4.5 takes the irradiance of a UsdLux light fourfold
    scene.world = bpy.data.worlds.new("sky")
    scene.world.use_nodes = True
    nodes, links = scene.world.node_tree.nodes, scene.world.node_tree.links
    if sky != "-":
        around = nodes.new("ShaderNodeTexEnvironment")
        around.image = bpy.data.images.load(sky)
        links.new(around.outputs["Color"], nodes["Background"].inputs["Color"])
    else:
        nodes["Background"].inputs["Strength"].default_value = 0.0
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.use_denoising = int(samples), int(samples) > 1
    scene.render.resolution_x, scene.render.resolution_y = int(width), int(height)
    scene.render.resolution_percentage = 100
    scene.render.threads_mode, scene.render.threads = "FIXED", 1
    scene.view_settings.view_transform = "Raw"
    scene.render.image_settings.file_format = "OPEN_EXR"
    with tempfile.TemporaryDirectory() as folder:
        scene.render.filepath = f"{folder}/seen.exr"
        bpy.ops.render.render(write_still=True)
        image = bpy.data.images.load(scene.render.filepath)
        image.colorspace_settings.name = "Non-Color"
        pixels = np.empty(len(image.pixels), np.float32)
        image.pixels.foreach_get(pixels)
    rows = pixels.reshape(image.size[1], image.size[0], -1)[::-1, :, :3]  # from below
    np.save(out, rows)


main()
