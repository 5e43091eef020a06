"""Programs' own readers read our exports: by their conventions, pixels must see our points.

    python benchmarks/judge_readers.py write FOLDER
    python benchmarks/judge_readers.py judge FOLDER SOURCES

`write` exports twelve pictures of `room_01`, with the points that pixels see. `judge`, in an
environment with torch, OpenCV, h5py, pandas, nerfstudio, tqdm, trimesh, scipy and without this
project, runs code of repositories that lie in SOURCES under their names: `2d-gaussian-splatting`
(its loader and projection are 3DGS's), `torch-ngp`, `nice-slam` and `ml-hypersim`. For each it
prints by how much, at most, a pixel's ray or a projected point misses [px], and by how much its
depth differs [mm].
"""

from __future__ import annotations

import json
import math
import sys
import types
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

PICTURES = 12
FORMATS = ["3dgs", "nerfstudio", "instant-ngp", "scannet", "replica", "hypersim", "cosmos"]
STEP = 7
"""Every so many columns and rows a pixel is judged."""

FARTHEST_M = 9.9

Floats = NDArray[np.float64]


def write(folder: Path) -> None:
    """Export pictures and their points."""
    from sailenv_ros import AgentSpec, CameraIntrinsics, Simulation, look_at
    from sailenv_ros.dataset.formats import DatasetWriter

    views = ("rgb", "depth", "range", "instance", "category", "normals")
    lens = CameraIntrinsics(width=320, height=240, fx_px=260.0, fy_px=261.0)
    spec = AgentSpec(name="eye", intrinsics=lens, views=views, following=False)
    poses, depths = [], []
    with (
        Simulation("room_01", mode="lockstep", light="plain", agent=spec) as simulation,
        DatasetWriter(folder, FORMATS) as writer,
    ):
        for turn in np.linspace(0.0, 2.0 * np.pi, PICTURES, endpoint=False):
            c, s = float(np.cos(turn)), float(np.sin(turn))
            simulation.set_pose(look_at((1.3 * c, 1.1 * s, 1.5), (-0.6 * c, -0.6 * s, 0.8)))
            simulation.step(8)
            frame = simulation.capture()
            writer.add(frame)
            poses.append(frame.camera.world_from_camera)
            depths.append(frame["depth"])
        writer.finish()
    np.savez(folder / "truth.npz", poses=poses, depths=depths, matrix=lens.K)


class Truth:
    """Poses, depth and lens of what was exported."""

    def __init__(self, folder: Path) -> None:
        with np.load(folder / "truth.npz") as kept:
            self.poses, self.depths, self.matrix = kept["poses"], kept["depths"], kept["matrix"]
        self.height, self.width = self.depths.shape[1:]
        rows, columns = np.mgrid[3 : self.height : STEP, 3 : self.width : STEP]
        # Windows show what has no place; Replica's depth ends at 10 m.
        near = (self.depths[:, rows, columns] < FARTHEST_M).all(axis=0)
        self.rows, self.columns = rows[near], columns[near]
        self.focal = float(self.matrix[0, 0])

    def depth(self, number: int) -> Floats:
        """Depths of the pixels that are judged [m]."""
        return np.asarray(self.depths[number][self.rows, self.columns], np.float64)

    def places(self, number: int) -> Floats:
        """Places that these pixels see."""
        across = (self.columns - self.matrix[0, 2]) / self.matrix[0, 0]
        down = (self.rows - self.matrix[1, 2]) / self.matrix[1, 1]
        local = np.stack([across, down, np.ones_like(across)], axis=1) * self.depth(number)[:, None]
        pose = self.poses[number]
        return np.asarray(local @ pose[:3, :3].T + pose[:3, 3])

    def missed(self, number: int, origins: Any, directions: Any) -> float:
        """Return by how much rays of the pixels miss what these see [px]."""
        meant = self.places(number) - np.asarray(origins, np.float64)
        meant /= np.linalg.norm(meant, axis=1, keepdims=True)
        looks = np.asarray(directions, np.float64)
        looks = looks / np.linalg.norm(looks, axis=1, keepdims=True)
        return float(np.linalg.norm(np.cross(looks, meant), axis=1).max() * self.focal)


def by_gaussians(folder: Path, sources: Path, truth: Truth) -> Iterator[tuple[float, float]]:
    """Project by the loader and the matrices of 3D Gaussian splatting."""
    import torch

    loader = _module(sources / "2d-gaussian-splatting/scene/colmap_loader.py")
    graphics = _module(sources / "2d-gaussian-splatting/utils/graphics_utils.py")
    model = folder / "3dgs/sparse/0"
    lenses = loader.read_intrinsics_text(model / "cameras.txt")
    images = loader.read_extrinsics_text(model / "images.txt")
    for number, image in enumerate(sorted(images.values(), key=lambda one: one.name)):
        lens = lenses[image.camera_id]
        # As readColmapCameras and Camera do.
        turn = np.transpose(loader.qvec2rotmat(image.qvec))
        angles = [graphics.focal2fov(lens.params[0], lens.width),
                  graphics.focal2fov(lens.params[1], lens.height)]  # fmt: skip
        view = torch.tensor(graphics.getWorld2View2(turn, image.tvec)).transpose(0, 1)
        lens_matrix = graphics.getProjectionMatrix(0.01, 100.0, *angles).transpose(0, 1)
        places = torch.tensor(truth.places(number), dtype=torch.float32)
        ends = torch.cat([places, torch.ones(len(places), 1)], 1) @ view @ lens_matrix
        shares = (ends[:, :2] / ends[:, 3:]).numpy()
        # ndc2Pix of its rasteriser.
        pixels = ((shares + 1.0) * (lens.width, lens.height) - 1.0) * 0.5
        off = np.linalg.norm(pixels - np.stack([truth.columns, truth.rows], 1), axis=1)
        yield float(off.max()), math.nan


def by_instant_ngp(folder: Path, sources: Path, truth: Truth) -> Iterator[tuple[float, float]]:
    """Cast rays by torch-ngp, which reads instant-ngp's table."""
    sys.path.insert(0, str(sources / "torch-ngp"))
    package = types.ModuleType("nerf")
    package.__path__ = [str(sources / "torch-ngp/nerf")]
    sys.modules["nerf"] = package
    utils = _parts(sources / "torch-ngp/nerf/utils.py", ("custom_meshgrid", "get_rays"))
    sys.modules["nerf.utils"] = utils
    from nerf.provider import NeRFDataset  # type: ignore[import-not-found]

    asked = types.SimpleNamespace(
        path=str(folder / "instant-ngp"), preload=False, scale=1.0, offset=[0, 0, 0], bound=4,
        fp16=False, num_rays=-1, rand_pose=-1, error_map=False, color_space="srgb", patch_size=1,
    )  # fmt: skip
    read = NeRFDataset(asked, "cpu", type="all")
    order = truth.rows * truth.width + truth.columns
    for number in range(PICTURES):
        rays = utils.get_rays(read.poses[[number]], read.intrinsics, read.H, read.W)
        # Its axes are ours in another order.
        origins, directions = (rays[key][0][order].numpy()[:, [2, 0, 1]]
                               for key in ("rays_o", "rays_d"))  # fmt: skip
        yield truth.missed(number, origins, directions), math.nan


def by_nice_slam(folder: Path, sources: Path, truth: Truth) -> Iterator[tuple[float, float]]:
    """Read Replica's folder by NICE-SLAM, and cast its rays."""
    common = _parts(sources / "nice-slam/src/common.py", ("as_intrinsics_matrix", "get_rays"))
    sys.modules["src"], sys.modules["src.common"] = types.ModuleType("src"), common
    datasets = _module(sources / "nice-slam/src/utils/datasets.py")
    lens = json.loads((folder / "replica/cam_params.json").read_text())["camera"]
    camera = {"H": lens["h"], "W": lens["w"], "png_depth_scale": lens["scale"], "crop_edge": 0,
              **{key: lens[key] for key in ("fx", "fy", "cx", "cy")}}  # fmt: skip
    asked = types.SimpleNamespace(input_folder=str(folder / "replica"))
    read = datasets.Replica({"dataset": "replica", "cam": camera}, asked, 1.0, device="cpu")
    for number in range(PICTURES):
        _, _, depth, pose = read[number]
        rays = common.get_rays(
            lens["h"], lens["w"], *(camera[key] for key in ("fx", "fy", "cx", "cy")), pose, "cpu"
        )
        origins, directions = (one[truth.rows, truth.columns].numpy() for one in rays)
        apart = np.abs(depth.numpy()[truth.rows, truth.columns] - truth.depth(number)).max()
        yield truth.missed(number, origins, directions), 1000.0 * float(apart)


def by_hypersim(folder: Path, sources: Path, truth: Truth) -> Iterator[tuple[float, float]]:
    """Cast rays by the code of Hypersim's notebook."""
    import h5py
    import pandas as pd  # type: ignore[import-untyped]

    notebook = json.loads(
        (sources / "ml-hypersim/contrib/mikeroberts3000/jupyter"
         / "01_casting_rays_that_match_hypersim_images.ipynb").read_text()
    )  # fmt: skip
    cells = ["".join(cell["source"]) for cell in notebook["cells"] if cell["cell_type"] == "code"]
    lens_cell = next(cell for cell in cells if "M_cam_from_uv = matrix" in cell)
    rays_cell = next(cell for cell in cells if "half_du" in cell)
    begun = rays_cell.index("# create grid of uv-values")
    rays_cell = rays_cell[begun : rays_cell.index("# get intersection distances")]
    own = folder / "hypersim"
    table = own / "_detail/metadata_camera_parameters.csv"
    names = {
        key: getattr(np, key) for key in ("matrix", "meshgrid", "linspace", "dstack", "ones_like")
    }
    names |= {
        "np": np,
        "pd": pd,
        "scene_name": "scene",
        "metadata_camera_parameters_csv_file": table,
    }
    exec(lens_cell, names)
    keyframes = own / "_detail/cam_00"
    with h5py.File(keyframes / "camera_keyframe_positions.hdf5") as one:
        positions = one["dataset"][:]
    with h5py.File(keyframes / "camera_keyframe_orientations.hdf5") as one:
        turns = one["dataset"][:]
    for number in range(PICTURES):
        names |= {"R_world_from_cam": np.matrix(turns[number]),
                  "camera_position_world": positions[number]}  # fmt: skip
        exec(rays_cell, names)
        order = truth.rows * truth.width + truth.columns
        origins, directions = (
            names[f"ray_{key}_world"][order] for key in ("positions", "directions")
        )
        file = own / "images/scene_cam_00_geometry_hdf5" / f"frame.{number:04d}.depth_meters.hdf5"
        with h5py.File(file) as one:
            distance = one["dataset"][:][truth.rows, truth.columns]
        meant = np.linalg.norm(truth.places(number) - positions[number], axis=1)
        apart = np.abs(distance - meant).max()
        yield truth.missed(number, origins, directions), 1000.0 * float(apart)


def by_nerfstudio(parser: Any, truth: Truth, middle_px: float) -> Iterator[tuple[float, float]]:
    """Cast rays of one of nerfstudio's parsers, in which a pixel's middle has that coordinate."""
    import cv2
    import torch

    read = parser.get_dataparser_outputs("train")
    depths = read.metadata["depth_filenames"]
    for number in range(PICTURES):
        coords = np.stack([truth.rows, truth.columns], axis=1) + middle_px
        made = read.cameras.generate_rays(
            camera_indices=torch.full((len(coords), 1), number),
            coords=torch.tensor(coords, dtype=torch.float32),
        )
        steps = cv2.imread(str(depths[number]), cv2.IMREAD_UNCHANGED)
        depth = np.asarray(steps, np.float64) * read.metadata["depth_unit_scale_factor"]
        apart = np.abs(depth[truth.rows, truth.columns] - truth.depth(number)).max()
        off = truth.missed(number, made.origins.numpy(), made.directions.numpy())
        yield off, 1000.0 * float(apart)


def judge(folder: Path, sources: Path) -> None:
    """Print a row for each reader."""
    from nerfstudio.data.dataparsers.nerfstudio_dataparser import NerfstudioDataParserConfig
    from nerfstudio.data.dataparsers.scannet_dataparser import ScanNetDataParserConfig

    truth = Truth(folder)
    plain = {"center_method": "none", "auto_scale_poses": False, "load_3D_points": False}

    def scannet(*_: Any) -> Iterator[tuple[float, float]]:
        asked = {**plain, "train_split_fraction": 1.0, "data": folder / "scannet"}
        # ScanNet counts from the first pixel's middle, and its parser leaves that as it is.
        return by_nerfstudio(ScanNetDataParserConfig(**asked).setup(), truth, 0.0)

    def nerfstudio(*_: Any) -> Iterator[tuple[float, float]]:
        asked = {**plain, "orientation_method": "none", "eval_mode": "all"}
        asked["data"] = folder / "nerfstudio"
        return by_nerfstudio(NerfstudioDataParserConfig(**asked).setup(), truth, 0.5)

    readers: dict[str, Callable[..., Iterator[tuple[float, float]]]] = {
        "nerfstudio|nerfstudio": nerfstudio,
        "scannet|nerfstudio's parser of ScanNet": scannet,
        "3dgs|3DGS's loader and matrices": by_gaussians,
        "instant-ngp|torch-ngp": by_instant_ngp,
        "replica|NICE-SLAM": by_nice_slam,
        "hypersim|Hypersim's notebook on rays": by_hypersim,
    }
    print("|format|reader|missed by [px]|depth off [mm]|\n|---|---|---|---|")
    for name, reader in readers.items():
        found = list(reader(folder, sources, truth))
        off, apart = (max(one[k] for one in found) for k in range(2))
        print(f"|{name}|{off:.1e}|{apart:.2f}|")


def _module(path: Path) -> Any:
    """Import a file of a repository."""
    made = types.ModuleType(path.stem)
    exec(compile(path.read_text(), str(path), "exec"), made.__dict__)
    return made


def _parts(path: Path, names: tuple[str, ...]) -> Any:
    """Import some functions of a file whose other parts need a GPU."""
    import ast

    import torch
    from packaging import version

    tree = ast.parse(path.read_text())
    kept: list[ast.stmt] = [
        one for one in tree.body if isinstance(one, ast.FunctionDef) and one.name in names
    ]
    made = types.ModuleType(path.stem)
    made.__dict__.update(torch=torch, np=np, pver=version)
    exec(compile(ast.Module(kept, []), str(path), "exec"), made.__dict__)
    return made


if __name__ == "__main__":
    if sys.argv[1] == "write":
        write(Path(sys.argv[2]))
    else:
        judge(Path(sys.argv[2]), Path(sys.argv[3]))
