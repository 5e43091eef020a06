"""Pictures of an exported room by other programs, beside ours: docs/images/export.jpg.

    python3.11 -m venv judges/bpy && judges/bpy/bin/pip install bpy==4.5.15
    python3.11 -m venv judges/mujoco && judges/mujoco/bin/pip install mujoco
    apt install libosmesa6
    python -m benchmarks.foreign_pictures write FOLDER --judges judges
    python -m benchmarks.foreign_pictures views FOLDER
    opensplat FOLDER/views -n 3000 --val --val-image 000000.png --val-render FOLDER/seen
    python -m benchmarks.foreign_pictures sheet FOLDER [-o PICTURE] [--splats FOLDER/seen]

`write` exports `room_01` as MJCF and as USD with lamps and with baked light, and has Cycles trace
the former, show the latter, and MuJoCo draw. Radiance is developed as ours is, at the exposure at
which it is most like our picture; that and the PSNR are printed. `views` exports pictures for
https://github.com/pierotofy/OpenSplat, which trains Gaussians on processors too; the first one is
ours, is held back, and what it draws there lies in the folder `--splats`. So few steps want
`--resolution-schedule 600 --reset-alpha-every 100`, too.
"""

from __future__ import annotations

import argparse
import os
import subprocess
from pathlib import Path

import cv2
import numpy as np
from PIL import Image, ImageDraw, ImageFont

from benchmarks.reference.curve import matched_stops, picture_of
from sailenv_ros import AgentSpec, CameraIntrinsics, Simulation, export_scene, look_at
from sailenv_ros.dataset.formats import DatasetWriter

SIZE = (480, 360)
EYE, TARGET = (2.1, -1.25, 1.55), (-1.2, 0.95, 0.85)
VIEWS = 90
LENS = CameraIntrinsics(width=SIZE[0], height=SIZE[1], vertical_fov_deg=62.0)
TILES = {
    "ours": "sailenv_ros",
    "lamps": "Cycles traces the lamps of .usda",
    "lit": "Cycles shows the baked light of .usda",
    "mujoco": "MuJoCo draws .xml",
    "points": "Gaussians at our points, nerfstudio",
    "splats": "Gaussians after {steps} steps",
}


def write(folder: Path, judges: Path) -> None:
    """Export, and have each program draw."""
    folder.mkdir(parents=True, exist_ok=True)
    spec = AgentSpec(name="eye", intrinsics=LENS, following=False)
    with Simulation("room_01", mode="lockstep", light="baked", agent=spec) as simulation:
        simulation.set_pose(look_at(EYE, TARGET))
        np.save(folder / "ours.npy", simulation.capture.within(300.0)()["rgb"])
        export_scene(simulation, folder / "lit.usda", light="baked", overwrite=True)
        for name in ("lamps.usda", "room.xml"):
            export_scene(simulation, folder / name, overwrite=True)
        around = simulation.read(lambda core: core.world.contents.environment)
    assert around.sky is not None
    sky = np.asarray(around.sky.radiance[..., ::-1], np.float32)
    cv2.imwrite(str(folder / "sky.hdr"), sky)
    size = [str(side) for side in SIZE]
    script = str(Path(__file__).with_name("blender_picture.py"))
    for name, samples in (("lit", "8"), ("lamps", "48")):
        command: list[str | Path] = [
            judges / "bpy/bin/python",
            script,
            folder / f"{name}.usda",
            "eye",
            *size,
        ]
        command += [samples, folder / "sky.hdr", folder / f"{name}.npy"]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    script = str(Path(__file__).with_name("mujoco_picture.py"))
    command = [judges / "mujoco/bin/python", script, folder / "room.xml", "eye", *size]
    plain = {**os.environ, "MUJOCO_GL": "osmesa", "PYTHONPATH": ""}
    subprocess.run([*command, folder / "mujoco.npy"], env=plain, check=True)


def views(folder: Path) -> None:
    """Export pictures from all around, and the points that they see."""
    lens = CameraIntrinsics(width=320, height=240, vertical_fov_deg=62.0)
    kept = ("rgb", "depth", "instance", "range")
    spec = AgentSpec(name="eye", intrinsics=lens, views=kept, following=False)
    turns = np.linspace(0.0, 2.0 * np.pi, VIEWS, endpoint=False)
    with (
        Simulation("room_01", mode="lockstep", light="baked", agent=spec) as simulation,
        DatasetWriter(folder / "views", ["nerfstudio"]) as writer,
    ):
        for number in range(-1, VIEWS):
            c, s = float(np.cos(turns[number])), float(np.sin(turns[number]))
            height = (1.1, 1.55, 1.9)[number % 3]
            eye = (1.9 * c, 1.3 * s, height)
            far = (-0.9 * c, -0.9 * s, (0.4, 1.0, 1.7)[number // 3 % 3])  # the ceiling, too
            pose = look_at(EYE, TARGET) if number < 0 else look_at(eye, far)
            simulation.set_pose(pose)
            simulation.step(1)
            writer.add(simulation.capture.within(300.0)())
        writer.finish()


def sheet(folder: Path, output: Path, splats: Path | None) -> None:
    """Lay the pictures out, two in a row."""
    ours = np.load(folder / "ours.npy")
    pictures = {"ours": ours, "mujoco": np.load(folder / "mujoco.npy")}
    for name in ("lit", "lamps"):
        radiance = np.load(folder / f"{name}.npy")
        stops = matched_stops(radiance, ours)
        pictures[name] = picture_of(radiance, stops)
        error = np.square(pictures[name].astype(float) - ours).mean()
        print(f"{name}: {stops:+.2f} stops, PSNR {10.0 * np.log10(255.0**2 / error):.1f} dB")
    drawn = sorted(splats.glob("*.png"), key=lambda path: int(path.stem)) if splats else []
    for name, file in zip(
        ("points", "splats"), (drawn[0], drawn[-1]) if drawn else (), strict=False
    ):
        with Image.open(file) as picture:
            pictures[name] = np.asarray(picture.convert("RGB").resize(SIZE))
    if drawn:
        with Image.open(drawn[-1]) as last, Image.open(folder / "views/images/000000.png") as meant:
            pair = [np.asarray(one.convert("RGB"), float) for one in (last, meant)]
        error = np.square(pair[0] - pair[1]).mean()
        print(f"splats: {drawn[-1].stem} steps, PSNR {10.0 * np.log10(255.0**2 / error):.1f} dB")
    shown = [name for name in TILES if name in pictures]
    rows = -(-len(shown) // 2)
    made = Image.new("RGB", (2 * SIZE[0], rows * SIZE[1]), "white")
    font = ImageFont.load_default(15)
    for place, name in enumerate(shown):
        tile = Image.fromarray(pictures[name])
        pen = ImageDraw.Draw(tile)
        words = TILES[name].format(steps=drawn[-1].stem if drawn else "")
        left, top, right, bottom = pen.textbbox((8, 6), words, font=font)
        pen.rectangle((left - 4, top - 3, right + 4, bottom + 3), fill="black")
        pen.text((8, 6), words, fill="white", font=font)
        made.paste(tile, (place % 2 * SIZE[0], place // 2 * SIZE[1]))
    made.save(output, quality=72, optimize=True)


def main() -> None:
    """Read the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("what", choices=("write", "views", "sheet"))
    parser.add_argument("folder", type=Path)
    parser.add_argument("--judges", type=Path, default=Path("judges"), help="see above")
    parser.add_argument("-o", "--output", type=Path, default=Path("docs/images/export.jpg"))
    parser.add_argument("--splats", type=Path)
    args = parser.parse_args()
    if args.what == "write":
        write(args.folder, args.judges.absolute())
    elif args.what == "views":
        views(args.folder)
    else:
        sheet(args.folder, args.output, args.splats)


if __name__ == "__main__":
    main()
