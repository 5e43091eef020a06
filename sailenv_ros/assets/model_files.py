"""Model files → parts: OBJ with its MTL, and glTF, read by trimesh.

A path in, `RawPart`s out, in the body frame (x forward, y left, z up). Files have y up and their
front towards +z, as glTF prescribes and furniture catalogues do. Knows no pack.
"""

from __future__ import annotations

import dataclasses
import io
import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, cast

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.assets.gltf_emission import by_glow, description_with_strength, lit_by_picture
from sailenv_ros.assets.meshes import RawMesh
from sailenv_ros.assets.obj_polygons import with_triangles
from sailenv_ros.errors import AssetError
from sailenv_ros.types.colour import linear_from_srgb
from sailenv_ros.types.model import Material, Texture

if TYPE_CHECKING:
    import trimesh
    from PIL import Image

__all__ = ["MAX_TRIANGLES", "MODEL_SUFFIXES", "RawPart", "read_parts", "texture_of"]

MODEL_SUFFIXES = (".glb", ".gltf", ".obj")
MAX_TRIANGLES = 5_000_000
LARGEST_TEXTURE_PX = 8192

_BODY_FROM_FILE = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])


@dataclass(frozen=True, eq=False, kw_only=True)
class RawPart:
    """One mesh of a file with its material.

    Attributes
    ----------
    name : str
        Of the mesh; that of the material stands in `material`.
    mesh : RawMesh
        In the body frame's axes and the file's unit.
    material : Material
    textured : bool
        True if the file gives texture coordinates.
    node : str
        Name of the node that places it; empty where there is none.
    """

    name: str
    mesh: RawMesh
    material: Material
    textured: bool
    node: str = ""


def read_parts(path: Path) -> tuple[RawPart, ...]:
    """Read all meshes of a model file.

    Raises
    ------
    AssetError
        If the file cannot be read, is too large, or holds no triangles.
    """
    scene = _loaded(path)
    try:
        parts = list(_parts(scene))
    except (AssetError, MemoryError, RecursionError):
        raise
    except Exception as problem:  # whatever a broken file makes the reader stumble over
        raise AssetError(path.name, f"it cannot be read ({_one_line(problem)})") from problem
    count = sum(len(part.mesh.triangles) for part in parts)
    if not count:
        raise AssetError(path.name, "it holds no triangles")
    if count > MAX_TRIANGLES:
        raise AssetError(path.name, f"it has {count} triangles, and {MAX_TRIANGLES} are accepted")
    return tuple(parts)


def _parts(scene: trimesh.Scene) -> Iterator[RawPart]:
    import trimesh

    for node in scene.graph.nodes_geometry:
        file_from_part, geometry = scene.graph[node]
        mesh = scene.geometry[geometry]
        if isinstance(mesh, trimesh.Trimesh) and len(mesh.faces):
            pose = np.asarray(file_from_part, dtype=np.float64)
            part = dataclasses.replace(_part(str(geometry), mesh, pose), node=str(node))
            yield from _by_glow(part, getattr(mesh.visual, "material", None))


def _by_glow(part: RawPart, given: Any) -> Iterator[RawPart]:
    """Yield a part, or what of it glows apart from what does not."""
    picture = texture_of(getattr(given, "emissiveTexture", None))
    own = part.material.base_colour_texture
    if picture is None or not any(part.material.emission) or not part.textured:
        yield part
        return
    if own is not None and np.array_equal(own, picture):
        yield part  # its picture is that of its glow already
        return
    for mesh, material in zip(
        by_glow(part.mesh, picture), lit_by_picture(part.material, picture), strict=True
    ):
        if mesh is not None:
            yield dataclasses.replace(part, mesh=mesh, material=material)


def texture_of(picture: Image.Image | None) -> Texture | None:
    """Return a picture as the (H, W, 4) uint8 that materials hold; None for none."""
    if picture is None:
        return None
    if max(picture.size) > LARGEST_TEXTURE_PX:
        raise AssetError("texture", f"its {picture.size} pixels pass {LARGEST_TEXTURE_PX}")
    pixels = np.array(picture.convert("RGBA"))
    pixels.flags.writeable = False
    return pixels


def _loaded(path: Path) -> trimesh.Scene:
    import trimesh

    if path.suffix.lower() not in MODEL_SUFFIXES:
        raise AssetError(path.name, f"a model file must end in one of {', '.join(MODEL_SUFFIXES)}")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # authors' oddities that trimesh copes with
            loaded = _obj(path) if path.suffix.lower() == ".obj" else _gltf(path)
    except Exception as problem:  # whatever a broken file makes the reader stumble over
        raise AssetError(path.name, f"it cannot be read ({_one_line(problem)})") from problem
    return loaded if isinstance(loaded, trimesh.Scene) else trimesh.Scene(loaded)


def _gltf(path: Path) -> Any:
    import trimesh

    data = description_with_strength(path)
    if data is None:
        return trimesh.load(path, process=False)
    return trimesh.load(
        io.BytesIO(data),
        file_type=path.suffix.lower()[1:],
        resolver=trimesh.resolvers.FilePathResolver(str(path)),
        process=False,
    )


def _obj(path: Path) -> Any:
    import trimesh

    text = with_triangles(path.read_text(encoding="utf-8", errors="replace"))
    resolver = trimesh.resolvers.FilePathResolver(str(path))
    return trimesh.load(
        io.StringIO(text), file_type="obj", resolver=resolver, process=False, split_object=False
    )


def _one_line(problem: Exception) -> str:
    return " ".join(f"{type(problem).__name__}: {problem}".split())[:200]


def _part(name: str, mesh: trimesh.Trimesh, file_from_part: NDArray[np.float64]) -> RawPart:
    axes = _BODY_FROM_FILE @ file_from_part[:3, :3]
    with np.errstate(invalid="ignore", over="ignore"):  # refused below
        positions = np.asarray(mesh.vertices, dtype=np.float64) @ axes.T
        positions += _BODY_FROM_FILE @ file_from_part[:3, 3]
    triangles = np.asarray(mesh.faces, dtype=np.int64)
    if np.linalg.det(axes) < 0.0:
        triangles = triangles[:, ::-1]
    if not np.isfinite(positions).all():
        raise AssetError(name, "its vertices are not all finite numbers")
    if triangles.min() < 0 or triangles.max() >= len(positions):
        raise AssetError(name, f"a triangle names a vertex that is none of its {len(positions)}")
    uv = getattr(mesh.visual, "uv", None)
    textured = uv is not None and len(uv) == len(positions) and bool(np.isfinite(uv).all())
    uvs = np.asarray(uv, dtype=np.float64)[:, :2] if textured else np.zeros((len(positions), 2))
    return RawPart(
        name=name,
        mesh=RawMesh(
            positions=positions, uvs=uvs, triangles=triangles, normals=_normals(mesh, axes)
        ),
        material=_material(getattr(mesh.visual, "material", None), name),
        textured=textured,
    )


def _normals(mesh: trimesh.Trimesh, axes: NDArray[np.float64]) -> NDArray[np.float64] | None:
    """Return the file's own normals; trimesh would make up smooth ones."""
    if "vertex_normals" not in mesh._cache.cache:
        return None
    normals = np.asarray(mesh.vertex_normals, dtype=np.float64)
    with np.errstate(all="ignore"):  # what is not finite is left out below
        turned = normals @ np.linalg.inv(axes)  # rows times the inverse are the inverse transpose
    return turned if np.isfinite(turned).all() else None


def _material(given: Any, name: str) -> Material:
    import trimesh

    if isinstance(given, trimesh.visual.material.PBRMaterial):
        return _from_gltf(given, name)
    if isinstance(given, trimesh.visual.material.SimpleMaterial):
        return _from_mtl(given, name)
    return Material(name=name)


def _from_gltf(given: Any, name: str) -> Material:
    colour = given.baseColorFactor
    rgba = np.ones(4) if colour is None else np.asarray(colour, dtype=np.float64)
    if colour is not None and np.asarray(colour).dtype == np.uint8:
        rgba = rgba / 255.0
    emission = given.emissiveFactor
    modes: dict[str, Literal["opaque", "mask", "blend"]] = {"MASK": "mask", "BLEND": "blend"}
    return Material(
        name=str(given.name or name),
        base_colour=cast(tuple[float, float, float, float], tuple(map(float, rgba))),
        metallic=_factor(given.metallicFactor),
        roughness=_factor(given.roughnessFactor),
        emission=(0.0, 0.0, 0.0) if emission is None else _three(emission),
        base_colour_texture=texture_of(given.baseColorTexture),
        metallic_roughness_texture=texture_of(given.metallicRoughnessTexture),
        normal_texture=texture_of(given.normalTexture),
        alpha=modes.get(given.alphaMode or "", "opaque"),
        alpha_cutoff=0.5 if given.alphaCutoff is None else float(given.alphaCutoff),
        double_sided=bool(given.doubleSided),
    )


def _factor(value: object) -> float:
    """Metal and roughness of glTF are 1 where they are not given."""
    return 1.0 if value is None else float(cast(float, value))


def _three(values: Any) -> tuple[float, float, float]:
    red, green, blue = (float(value) for value in values)
    return red, green, blue


def _from_mtl(given: Any, name: str) -> Material:
    """Read a Wavefront material; its colours are what a screen shows, so sRGB."""
    numbers = given.kwargs
    red, green, blue = linear_from_srgb(np.asarray(_list(numbers.get("kd"), 3, 0.8)))
    opacity = _list(numbers.get("d"), 1, 1.0)[0]
    texture = texture_of(given.image)
    if texture is not None:
        red = green = blue = 1.0
    cut_out = texture is not None and bool((texture[..., 3] < 128).any())
    return Material(
        name=str(given.name or name),
        base_colour=(float(red), float(green), float(blue), opacity),
        metallic=0.0,
        roughness=_roughness(_list(numbers.get("ns"), 1, 10.0)[0], _list(numbers.get("ks"), 3, 0)),
        base_colour_texture=texture,
        alpha="mask" if cut_out else "blend" if opacity < 0.95 else "opaque",
    )


def _list(given: Any, count: int, default: float) -> list[float]:
    try:
        values = [float(value) for value in np.ravel(given)[:count]]
    except (TypeError, ValueError):
        values = []
    return values if len(values) == count and np.isfinite(values).all() else [default] * count


def _roughness(exponent: float, specular: list[float]) -> float:
    """Return the roughness of a Phong exponent, whose highlight is as wide; dull if it has none."""
    if max(specular) < 0.05:
        return 0.9
    return float(np.clip((2.0 / (max(exponent, 0.0) + 2.0)) ** 0.25, 0.15, 0.95))
