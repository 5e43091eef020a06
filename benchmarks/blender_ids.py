"""Instance ids of every pixel as Blender sees an exported glTF file; called by judge_export.py.

    blender -b -P benchmarks/blender_ids.py -- room.glb CAMERA WIDTH HEIGHT FOLDER

Objects have the ids of their extras. Cycles sends one ray through each pixel's centre; glass lets
it through, and what is cut out of leaves too. Writes ``ids.npy`` (H, W) uint16 into the folder.
"""

from __future__ import annotations

import importlib
import sys
from typing import Any

import numpy as np

if not hasattr(np, "bool"):  # which Blender 3.4 calls and NumPy 1.24 lacks
    setattr(np, "bool", bool)  # noqa: B010

bpy: Any = importlib.import_module("bpy")


def main() -> None:
    """Import, render, save."""
    file, camera, width, height, folder = sys.argv[sys.argv.index("--") + 1 :]
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=file)
    scene, layer = bpy.context.scene, bpy.context.view_layer
    for shown in scene.objects:
        shown.pass_index = int(shown.get("instance_id", 0))
    for material in bpy.data.materials:
        if material.blend_method == "BLEND":
            nodes = material.node_tree.nodes
            nodes.clear()
            out = nodes.new("ShaderNodeOutputMaterial")
            clear = nodes.new("ShaderNodeBsdfTransparent")
            material.node_tree.links.new(clear.outputs[0], out.inputs[0])
    scene.camera = bpy.data.objects[camera]
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.max_bounces, scene.cycles.use_denoising = 1, 0, False
    scene.cycles.transparent_max_bounces = 64
    scene.cycles.pixel_filter_type, scene.cycles.filter_width = "BLACKMAN_HARRIS", 0.01
    scene.render.resolution_x, scene.render.resolution_y = int(width), int(height)
    layer.use_pass_object_index, layer.pass_alpha_threshold = True, 0.5
    scene.use_nodes = True
    nodes = scene.node_tree.nodes
    nodes.clear()
    layers, file_output = nodes.new("CompositorNodeRLayers"), nodes.new("CompositorNodeOutputFile")
    file_output.base_path = folder
    file_output.format.file_format, file_output.format.color_depth = "OPEN_EXR", "32"
    scene.node_tree.links.new(layers.outputs["IndexOB"], file_output.inputs[0])
    bpy.ops.render.render()
    image = bpy.data.images.load(f"{folder}/Image0001.exr")
    image.colorspace_settings.name = "Non-Color"
    pixels = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(pixels)
    rows = pixels.reshape(image.size[1], image.size[0], -1)[::-1, :, 0]  # from below
    np.save(f"{folder}/ids.npy", np.rint(rows).astype(np.uint16))


main()
