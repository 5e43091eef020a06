"""Models ↔ binary glTF files, with the convex pieces they collide as.

Axes are glTF's in the file (y up, front towards +z) and the body frame's in memory. Collision
pieces are meshes named ``collision_<n>`` beside the drawn ones.
"""

from __future__ import annotations

import io
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.assets.gltf_emission import write_strength
from sailenv_ros.assets.meshes import smooth_mesh
from sailenv_ros.assets.model_files import read_parts
from sailenv_ros.types.model import ConvexShape, Material, Mesh, ModelPart, Texture

if TYPE_CHECKING:
    import trimesh
    from PIL import Image

__all__ = ["DRAWN", "glb_bytes", "read_glb"]

DRAWN = "part_"
"""Begins the names that `glb_bytes` gives meshes; their places in the model follow."""

COLLISION = "collision_"
JPEG_QUALITY = 92

_FILE_FROM_BODY = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])


def read_glb(path: Path) -> tuple[tuple[ModelPart, ...], tuple[ConvexShape, ...]]:
    """Read a file that `glb_bytes` made, or any other glTF.

    Returns
    -------
    parts : tuple of ModelPart
    hulls : tuple of ConvexShape
        Empty where the file has no meshes of that name.

    Raises
    ------
    AssetError
        If it cannot be read.
    """
    parts, hulls = [], []
    materials: dict[int, Material] = {}
    for raw in read_parts(path):
        if raw.name.startswith(COLLISION):
            hulls.append((_number(raw.name), ConvexShape(points=raw.mesh.positions)))
        else:
            material = materials.setdefault(id(raw.material), raw.material)
            names = tuple(dict.fromkeys((raw.name, raw.node)))
            parts.append(ModelPart(mesh=smooth_mesh(raw.mesh), material=material, names=names))
    return tuple(parts), tuple(hull for _, hull in sorted(hulls, key=lambda entry: entry[0]))


def glb_bytes(parts: Sequence[ModelPart], hulls: Sequence[ConvexShape]) -> bytes:
    """Return the bytes of a binary glTF file; the same model gives the same bytes."""
    import trimesh

    scene = trimesh.Scene()
    for number, part in enumerate(parts):
        _add(scene, f"{DRAWN}{number}", _drawn(part))
    for number, hull in enumerate(hulls):
        solid = trimesh.convex.convex_hull(hull.points @ _FILE_FROM_BODY.T)
        solid.visual = trimesh.visual.ColorVisuals()
        _add(scene, f"{COLLISION}{number}", solid)
    data: bytes = scene.export(
        file_type="glb", include_normals=True, tree_postprocessor=write_strength
    )
    return data


def _number(name: str) -> int:
    digits = name[len(COLLISION) :]
    return int(digits) if digits.isdigit() else 0


def _add(scene: trimesh.Scene, name: str, mesh: trimesh.Trimesh) -> None:
    scene.add_geometry(mesh, node_name=name, geom_name=name)


def _drawn(part: ModelPart) -> trimesh.Trimesh:
    import trimesh

    mesh: Mesh = part.mesh
    return trimesh.Trimesh(
        vertices=mesh.positions @ _FILE_FROM_BODY.T,
        faces=mesh.triangles,
        vertex_normals=mesh.normals @ _FILE_FROM_BODY.T,
        visual=trimesh.visual.TextureVisuals(uv=mesh.uvs, material=_pbr(part.material)),
        process=False,
    )


def _pbr(material: Material) -> Any:
    import trimesh

    lossless = material.alpha != "opaque"
    return trimesh.visual.material.PBRMaterial(
        name=material.name,
        baseColorFactor=np.asarray(material.base_colour, dtype=np.float64),
        metallicFactor=material.metallic,
        roughnessFactor=material.roughness,
        emissiveFactor=np.asarray(material.emission) if any(material.emission) else None,
        baseColorTexture=_picture(material.base_colour_texture, lossless=lossless),
        metallicRoughnessTexture=_picture(material.metallic_roughness_texture),
        normalTexture=_picture(material.normal_texture),
        alphaMode=material.alpha.upper(),
        alphaCutoff=material.alpha_cutoff if material.alpha == "mask" else None,
        doubleSided=material.double_sided,
    )


def _picture(texture: Texture | None, *, lossless: bool = False) -> Image.Image | None:
    """Return a texture as a picture that says how it is to be stored; JPEG where none sees it."""
    if texture is None:
        return None
    from PIL import Image

    picture = Image.fromarray(np.asarray(texture)).convert("RGBA" if lossless else "RGB")
    stored = io.BytesIO()
    if lossless:
        picture.save(stored, format="PNG")
    else:
        picture.save(stored, format="JPEG", quality=JPEG_QUALITY, subsampling=0)
    stored.seek(0)
    return Image.open(stored)


def triangle_count(parts: Sequence[ModelPart]) -> int:
    """Return the number of triangles of all parts."""
    return sum(len(part.mesh.triangles) for part in parts)


def body_bounds(parts: Sequence[ModelPart]) -> NDArray[np.float64]:
    """Return (2, 3) float64: lowest and highest corner in the body frame."""
    low = np.min([part.mesh.positions.min(axis=0) for part in parts], axis=0)
    high = np.max([part.mesh.positions.max(axis=0) for part in parts], axis=0)
    return np.stack([low, high]).astype(np.float64)
