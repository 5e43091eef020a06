"""COLMAP reads our models, and finds the same room with our poses and its own features.

    python benchmarks/judge_reconstruction.py write FOLDER
    python benchmarks/judge_reconstruction.py judge FOLDER
    python benchmarks/judge_reconstruction.py tracks FOLDER
    python benchmarks/judge_reconstruction.py rays FOLDER

`write` exports forty pictures of `room_01` from an ellipse within it, by each of three lenses. Then
`judge`, in an environment with pycolmap and without this project, prints for each: points, mean
length of their tracks, the greatest distance between an observation and COLMAP's projection of its
point [px]; and for points that COLMAP triangulates of SIFT features with our poses and lens: how
many, their mean reprojection error [px], the median distance to the nearest of our points [mm].
`tracks` gives COLMAP our observations in place of its features, and prints how far what it
triangulates of them is from our points [mm]. `rays`, where nerfstudio is, reads the same by its
data parser and prints by how much, at most, its rays miss the points that they should meet [px].
"""

from __future__ import annotations

import sqlite3
import sys
from pathlib import Path
from typing import Any

import numpy as np

PICTURES = 40
VIEWS = "rgb", "depth", "instance", "range"
LENSES: dict[str, dict[str, Any]] = {
    "pinhole": {},
    "plumb_bob": {
        "distortion_model": "plumb_bob",
        "distortion": (-0.2, 0.05, 0.001, -0.001, 0.01),
        "fx_px": 450.0,
        "fy_px": 451.0,
    },
    "equidistant": {
        "distortion_model": "equidistant",
        "distortion": (0.01, -0.003, 0.001, 0.0),
        "fx_px": 250.0,
        "fy_px": 251.0,
        "max_angle_deg": 80.0,
    },
}


def write(folder: Path) -> None:
    """Export pictures by each lens."""
    from sailenv_ros import AgentSpec, CameraIntrinsics, Simulation, look_at
    from sailenv_ros.dataset.formats import DatasetWriter

    for name, law in LENSES.items():
        lens = CameraIntrinsics(width=640, height=480, **law)
        spec = AgentSpec(name="eye", intrinsics=lens, views=VIEWS, following=False)
        with (
            Simulation("room_01", mode="lockstep", agent=spec) as simulation,
            DatasetWriter(folder / name, ["colmap", "nerfstudio"]) as writer,
        ):
            for turn in np.linspace(0.0, 2.0 * np.pi, PICTURES, endpoint=False):
                c, s = float(np.cos(turn)), float(np.sin(turn))
                simulation.set_pose(look_at((1.3 * c, 1.1 * s, 1.5), (-0.6 * c, -0.6 * s, 0.8)))
                simulation.step(8)
                writer.add(simulation.capture())
            writer.finish()


def judge(folder: Path) -> None:
    """Print a row for each model."""
    import pycolmap

    pycolmap.logging.minloglevel = 3
    print("|lens|points|track|off [px]|triangulated|their error [px]|to ours [mm]|")
    print(7 * "|---" + "|")
    for own in sorted(path.parent for path in folder.glob("*/colmap/sparse")):
        model = pycolmap.Reconstruction(own / "sparse" / "0")
        off = max(_off(model, image) for image in model.images.values())
        found = _triangulated(pycolmap, own, model)
        ours = np.array([point.xyz for point in model.points3D.values()])
        theirs = np.array([point.xyz for point in found.points3D.values()])
        near = [1e3 * np.sqrt(((ours - place) ** 2).sum(axis=1).min()) for place in theirs]
        print(
            f"|{own.parent.name}|{len(ours)}|{model.compute_mean_track_length():.1f}|{off:.1e}"
            f"|{len(theirs)}|{found.compute_mean_reprojection_error():.2f}|{np.median(near):.0f}|"
        )


def _off(model: Any, image: Any) -> float:
    """Return how far an image's observations are from where COLMAP projects their points [px]."""
    seen = [point for point in image.points2D if point.has_point3D()]
    pose = image.cam_from_world()
    places = np.array([model.points3D[point.point3D_id].xyz for point in seen])
    local = places @ pose.rotation.matrix().T + pose.translation
    camera = model.cameras[image.camera_id]
    pixels = np.array([camera.img_from_cam(point) for point in local])
    told = np.array([point.xy for point in seen])
    return float(np.linalg.norm(pixels - told, axis=1).max())


def _triangulated(pycolmap: Any, folder: Path, model: Any) -> Any:
    """Return the points that COLMAP finds with our poses; its data base numbers the pictures."""
    base, bare, found = folder / "features.db", folder / "bare", folder / "triangulated"
    base.unlink(missing_ok=True)
    (camera,) = model.cameras.values()
    options = pycolmap.ImageReaderOptions()
    options.camera_model = camera.model.name
    options.camera_params = camera.params_to_string()
    mode = pycolmap.CameraMode.SINGLE
    pycolmap.extract_features(base, folder / "images", camera_mode=mode, reader_options=options)
    pycolmap.match_sequential(base)
    with sqlite3.connect(base) as connection:
        number = dict(connection.execute("select name, image_id from images").fetchall())
    bare.mkdir(exist_ok=True)
    found.mkdir(exist_ok=True)
    text = (folder / "sparse" / "0" / "images.txt").read_text().splitlines()[::2]
    poses = [line.split() for line in text]
    lines = [" ".join([str(number[words[-1]]), *words[1:]]) + "\n\n" for words in poses]
    (bare / "images.txt").write_text("".join(lines))
    (bare / "points3D.txt").write_text("")
    (bare / "cameras.txt").write_bytes((folder / "sparse" / "0" / "cameras.txt").read_bytes())
    return pycolmap.triangulate_points(
        pycolmap.Reconstruction(bare), base, folder / "images", found, clear_points=True
    )


def tracks(folder: Path) -> None:
    """Print a row for each model: points that COLMAP triangulates of our observations."""
    import pycolmap

    pycolmap.logging.minloglevel = 3
    print("|lens|points|triangulated|off [mm]|median|99 %|most|error [px]|\n" + "|---" * 8 + "|")
    for own in sorted(path.parent for path in folder.glob("*/colmap/sparse")):
        model = pycolmap.Reconstruction(own / "sparse" / "0")
        ours = {
            (id_, number): model.points3D[point.point3D_id]
            for id_, image in model.images.items()
            for number, point in enumerate(image.points2D)
            if point.has_point3D()
        }
        base, found = own / "tracks.db", own / "of_tracks"
        base.unlink(missing_ok=True)
        found.mkdir(exist_ok=True)
        _keep_tracks(pycolmap, base, model)
        made = pycolmap.triangulate_points(
            pycolmap.Reconstruction(own / "sparse" / "0"), base, own / "images", found
        )
        off = np.array(
            [
                1e3 * np.linalg.norm(point.xyz - ours[one.image_id, one.point2D_idx].xyz)
                for point in made.points3D.values()
                for one in point.track.elements[:1]
            ]
        )
        print(
            f"|{own.parent.name}|{len(model.points3D)}|{len(off)}|{off.mean():.3f}"
            f"|{np.median(off):.3f}|{np.percentile(off, 99):.3f}|{off.max():.3f}"
            f"|{made.compute_mean_reprojection_error():.1e}|"
        )


def _keep_tracks(pycolmap: Any, file: Path, model: Any) -> None:
    """Write a data base of our observations, and which of two pictures see the same point."""
    seen = {}
    with pycolmap.Database.open(file) as base:
        for camera in model.cameras.values():
            base.write_camera(camera, use_camera_id=True)
        for rig in model.rigs.values():
            base.write_rig(rig, use_rig_id=True)
        for frame in model.frames.values():
            base.write_frame(frame, use_frame_id=True)
        for id_, image in sorted(model.images.items()):
            base.write_image(image, use_image_id=True)
            base.write_keypoints(id_, np.array([one.xy for one in image.points2D], np.float32))
            seen[id_] = {one.point3D_id: n for n, one in enumerate(image.points2D)}
        for first in seen:
            for second in seen:
                both = sorted(seen[first].keys() & seen[second].keys())
                if first < second and both:
                    geometry = pycolmap.TwoViewGeometry()
                    geometry.config = pycolmap.TwoViewGeometryConfiguration.CALIBRATED
                    geometry.inlier_matches = np.array(
                        [[seen[first][one], seen[second][one]] for one in both], np.uint32
                    )
                    base.write_matches(first, second, geometry.inlier_matches)
                    base.write_two_view_geometry(first, second, geometry)


def rays(folder: Path) -> None:
    """Print a row for each model, of every eighth picture."""
    import torch
    from nerfstudio.data.dataparsers.nerfstudio_dataparser import NerfstudioDataParserConfig

    print("|lens|pictures|rays miss by [px]|\n|---|---|---|")
    for own in sorted(path.parent for path in folder.glob("*/nerfstudio")):
        parser = NerfstudioDataParserConfig(
            data=own / "nerfstudio",
            orientation_method="none",
            center_method="none",
            auto_scale_poses=False,
            eval_mode="all",
            load_3D_points=False,
        ).setup()
        cameras = parser.get_dataparser_outputs("train").cameras
        model = own / "colmap" / "sparse" / "0"
        words = [line.split() for line in (model / "points3D.txt").read_text().splitlines()]
        places = {int(point[0]): [float(word) for word in point[1:4]] for point in words}
        seen = (model / "images.txt").read_text().splitlines()[1::2]
        worst = 0.0
        for number in range(0, len(seen), 8):
            observed = np.array(seen[number].split(), np.float64).reshape(-1, 3)
            made = cameras.generate_rays(
                camera_indices=torch.full((len(observed), 1), number),
                coords=torch.tensor(observed[:, [1, 0]], dtype=torch.float32),
            )
            there = np.array([places[int(point)] for point in observed[:, 2]])
            meant = there - made.origins.numpy()
            meant /= np.linalg.norm(meant, axis=1, keepdims=True)
            looks = made.directions.numpy().astype(np.float64)
            looks /= np.linalg.norm(looks, axis=1, keepdims=True)
            off = np.linalg.norm(np.cross(looks, meant), axis=1) * float(cameras.fx[0])
            worst = max(worst, float(off.max()))
        print(f"|{own.name}|{len(seen)}|{worst:.1e}|")


if __name__ == "__main__":
    {"write": write, "judge": judge, "tracks": tracks, "rays": rays}[sys.argv[1]](Path(sys.argv[2]))
