"""Compare the renderer's pictures with those of a path tracer: same scene, same cameras.

    python -m benchmarks.reference.compare [--scenes NAME ...] [--views NAME ...] [--chosen N]
        [--samples N] [--size W H] [--supersampling N] [--renderer native|opengl]
        [--moves N [--anew]] [--trace-only | --no-trace | --last] [--output FOLDER]

Prints a table of SSIM, PSNR and FLIP per camera, and how near objects that can move come in their
mean colours; writes it as JSON, all pictures, and a sheet (ours, reference, their difference) per
scene to the folder. Traced pictures are kept in the cache. Scenes that are not in `views.yaml`,
such as ``generated:kitchen:70017``, are seen by cameras that their name chooses.
With ``--moves`` rooms whose furniture has been moved (`moved.py`) are compared, too: the place that
was left and the new one, in light that was baked before and refined after the move.
"""

from __future__ import annotations

import argparse
import itertools
import json
import sys
import tempfile
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from numpy.typing import NDArray
from PIL import Image

from benchmarks.reference.curve import matched_stops, picture_of
from benchmarks.reference.moved import moved_room
from benchmarks.reference.objects import NEAR_DELTA_E, lines_on_objects, movable_ids, share_near
from benchmarks.reference.parts import Parts
from benchmarks.reference.regions import REGIONS, regions_of
from benchmarks.reference.regions import VIEWS as SHOWN_BY
from benchmarks.reference.scene_export import scene_of, sensor, without_outside
from benchmarks.reference.tracing import HOME, ToolMissing, Traced, run_tool, traced_views
from sailenv_ros.frame.pictures.contact_sheet import save_contact_sheet
from sailenv_ros.light.relight.baked_scene import BakedScene
from sailenv_ros.light.relight.object_lights import with_object_light
from sailenv_ros.render.contract import RenderBackend, RenderRequest
from sailenv_ros.render.cpu.renderer import NativeRenderer
from sailenv_ros.render.gl.renderer import Renderer
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.system.threads import thread_count
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.geometry import look_at
from sailenv_ros.types.picture_settings import PictureSettings
from sailenv_ros.types.snapshot import WorldSnapshot
from tests.support.plausible_views import plausible_views

RENDERERS: dict[str, Callable[[], RenderBackend]] = {"native": NativeRenderer, "opengl": Renderer}

VIEWS = Path(__file__).with_name("views.yaml")

MEANS = ("ssim", "psnr_db", "flip", "stops", "ssim_halves", "flip_halves")

Picture = NDArray[np.uint8]
Row = dict[str, Any]


def main() -> int:
    """Trace, render, measure, show; 0 if every view was compared."""
    arguments = _arguments()
    picture = PictureSettings(supersampling=arguments.supersampling)
    listed = yaml.safe_load(VIEWS.read_text(encoding="utf-8"))
    rows: list[Row] = []
    wanted = 0
    try:
        own = [scene for scene in listed if not scene.endswith(".yaml")]
        for scene in own if arguments.scenes is None else arguments.scenes:
            snapshot = _snapshot(scene)
            views = _cameras(listed.get(scene), snapshot, arguments, picture)
            wanted += len(views) + 2 * arguments.moves
            rows += _compared(_file_name(scene), snapshot, views, arguments)
            for number in range(arguments.moves):
                moved, move = moved_room(scene, snapshot, number, anew=arguments.anew)
                width, height = arguments.size
                sized = replace(move.cameras[0].intrinsics, width=width, height=height)
                seen = {
                    place: replace(camera, intrinsics=sized, picture=picture)
                    for place, camera in zip(("left", "taken"), move.cameras, strict=True)
                }
                rows += _compared(f"{scene}_moved_{number}", moved, seen, arguments)
    except ToolMissing as problem:
        print(problem, file=sys.stderr)
        return 1
    if not arguments.trace_only:
        _show(rows, arguments.output)
    return 0 if arguments.trace_only or len(rows) == wanted else 1


def _file_name(scene: str) -> str:
    """Return a scene's name, or that of its file, as part of a file's name."""
    return Path(scene).stem.replace(":", "_")


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument(
        "--scenes", nargs="+", default=None, help="names or files; the package's rooms"
    )
    parser.add_argument("--views", nargs="+", default=None, help="names of cameras; all of them")
    parser.add_argument(
        "--chosen", type=int, default=3, metavar="N", help="cameras of scenes not in views.yaml"
    )
    parser.add_argument("--samples", type=int, default=256, help="per pixel of the reference")
    parser.add_argument("--size", type=int, nargs=2, default=(320, 240), metavar=("W", "H"))
    parser.add_argument(
        "--moves", type=int, default=0, metavar="N", help="rooms after so many moves, too"
    )
    parser.add_argument("--anew", action="store_true", help="bake the light of these anew")
    parser.add_argument(
        "--supersampling", type=int, default=1, metavar="N", help="of ours; 1: as by default"
    )
    parser.add_argument("--renderer", choices=RENDERERS, default="native", help="that draws ours")
    parser.add_argument("--output", type=Path, default=Path("build/reference"), metavar="FOLDER")
    either = parser.add_mutually_exclusive_group()
    either.add_argument("--trace-only", action="store_true", help="do not render ours")
    either.add_argument("--no-trace", action="store_true", help="take what the cache has")
    either.add_argument(
        "--last", action="store_true", help="take the last traced, though the scene has changed"
    )
    return parser.parse_args()


def _cameras(
    listed: Mapping[str, Mapping[str, Any]] | None,
    snapshot: WorldSnapshot,
    arguments: argparse.Namespace,
    picture: PictureSettings,
) -> dict[str, Camera]:
    """Return the cameras of a scene by name: those listed, or some that are chosen."""
    width, height = arguments.size
    if listed is None:
        chosen = _chosen_cameras(snapshot, width, height, arguments.chosen)
        cameras = {
            f"view_{number}": replace(camera, picture=picture)
            for number, camera in enumerate(chosen)
        }
    else:
        cameras = {name: _camera(view, (width, height), picture) for name, view in listed.items()}
    names = cameras if arguments.views is None else arguments.views
    return {name: camera for name, camera in cameras.items() if name in names}


def _chosen_cameras(snapshot: WorldSnapshot, width: int, height: int, count: int) -> list[Camera]:
    renderer = NativeRenderer()
    try:
        name = f"reference{snapshot.contents.scene}"
        cameras = plausible_views(snapshot, renderer, name, width=width, height=height)
        return list(itertools.islice(cameras, count))
    finally:
        renderer.close()


def _camera(
    view: Mapping[str, Any], size: tuple[int, int], picture: PictureSettings | None
) -> Camera:
    intrinsics = CameraIntrinsics(
        width=size[0], height=size[1], vertical_fov_deg=float(view["fov"])
    )
    pose = look_at(view["position"], view["look_at"])
    return Camera(intrinsics=intrinsics, pose=pose, picture=picture or PictureSettings())


def _snapshot(scene: str) -> WorldSnapshot:
    world = SceneLibrary().build(scene)
    try:
        # The traced sky is as bright as it is.
        environment = replace(world.contents.environment, sky_blend=False)
        world.set_environment(environment)
        return _with_light_on_objects(without_outside(world.snapshot()))
    finally:
        world.close()


def _with_light_on_objects(snapshot: WorldSnapshot) -> WorldSnapshot:
    """Return what the simulation shows: with the light on what can move, where there is a bake."""
    if snapshot.contents.baked is None:
        return snapshot
    threads = thread_count()
    scene = BakedScene(snapshot.contents.baked, snapshot.contents, threads)
    return with_object_light(snapshot, scene, threads)


def _compared(
    scene: str,
    snapshot: WorldSnapshot,
    cameras: Mapping[str, Camera],
    arguments: argparse.Namespace,
) -> list[Row]:
    references = traced_views(
        scene,
        scene_of(snapshot, Parts(HOME / "parts")),
        {name: sensor(camera) for name, camera in cameras.items()},
        arguments.samples,
        may_trace=not (arguments.no_trace or arguments.last),
        or_last=arguments.last,
    )
    for name in cameras.keys() - references.keys():
        print(f"{scene}/{name}: no traced picture of this scene in the cache", file=sys.stderr)
    if arguments.trace_only or not references:
        return []
    drawn = {name: cameras[name] for name in references}
    ours = _rendered(snapshot, drawn, RENDERERS[arguments.renderer])
    stops = snapshot.contents.environment.exposure
    rows = _measured(scene, ours, movable_ids(snapshot), references, stops, arguments.output)
    names = {drawn.instance.id: drawn.instance.name for drawn in snapshot.contents.instances}
    for row in rows:
        for thing in row["objects"]:
            thing["name"] = names[thing["id"]]
    return rows


def _rendered(
    snapshot: WorldSnapshot, cameras: Mapping[str, Camera], make: Callable[[], RenderBackend]
) -> dict[str, dict[str, NDArray[Any]]]:
    renderer = make()
    wanted = ("rgb", *SHOWN_BY)
    try:
        made = {
            name: renderer.render(RenderRequest(snapshot, camera, wanted)).views
            for name, camera in cameras.items()
        }
        return {
            name: {view: array.copy() for view, array in views.items()}
            for name, views in made.items()
        }
    finally:
        renderer.close()


def _measured(
    scene: str,
    ours: Mapping[str, Mapping[str, NDArray[Any]]],
    movable: NDArray[np.int64],
    references: Mapping[str, Traced],
    stops: float,
    output: Path,
) -> list[Row]:
    """Measure every pair at the scene's exposure and at the one that fits best; save pictures."""
    pairs: dict[str, Picture] = {}
    tiles: dict[str, Picture] = {}
    rows: list[Row] = []
    for name, traced in references.items():
        drawn, ids = ours[name]["rgb"], ours[name]["instance"]
        best = matched_stops(traced.radiance, drawn)
        matched = picture_of(traced.radiance, best)
        for kind, picture in (("matched", matched), ("plain", picture_of(traced.radiance, stops))):
            pairs[f"ours_{name}.{kind}"], pairs[f"reference_{name}.{kind}"] = drawn, picture
        pairs[f"regions_{name}.matched"] = regions_of(ours[name])
        pairs[f"objects_{name}.matched"] = np.where(np.isin(ids, movable), ids, 0)
        halves = [picture_of(half, best) for half in traced.halves]
        pairs[f"ours_{name}.halves"], pairs[f"reference_{name}.halves"] = halves
        rows.append({"scene": scene, "view": name, "stops": best - stops, "noise": traced.noise})
        rows[-1]["noise_denoised"] = traced.noise_denoised
        difference = np.abs(drawn.astype(int) - matched.astype(int))
        tiles[f"{name}: ours"] = drawn
        tiles[f"{name}: reference {best - stops:+.1f} stops"] = matched
        tiles[name] = np.minimum(2 * difference, 255).astype(np.uint8)
        _save(output / f"{scene}_{name}_ours.png", drawn)
        _save(output / f"{scene}_{name}_reference.png", matched)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "pairs.npz"
        np.savez(file, **pairs)  # type: ignore[arg-type]
        figures = json.loads(run_tool("measure.py", file, capture=True))
    for row in rows:
        row.update(figures[f"{row['view']}.matched"])
        plain = figures[f"{row['view']}.plain"]
        row.update({f"{key}_unmatched": value for key, value in plain.items()})
        for key in ("ssim", "flip"):
            row[f"{key}_halves"] = figures[f"{row['view']}.halves"][key]
    save_contact_sheet(output / f"{scene}.png", _labelled(tiles, rows), columns=3)
    return rows


def _labelled(tiles: Mapping[str, Picture], rows: list[Row]) -> dict[str, Picture]:
    """Put the figures on the tiles of the difference, which is shown twice as bright."""
    text = {
        row["view"]: f"SSIM {row['ssim']:.3f} PSNR {row['psnr_db']:.1f} FLIP {row['flip']:.2f}"
        for row in rows
    }
    # Labels must differ: spaces at their ends do not show.
    return {
        text.get(label, label) + " " * number: tile
        for number, (label, tile) in enumerate(tiles.items())
    }


def _save(file: Path, picture: Picture) -> None:
    file.parent.mkdir(parents=True, exist_ok=True)
    Image.fromarray(picture).save(file)


def _show(rows: list[Row], output: Path) -> None:
    print(
        f"{'':22}{'SSIM':>8}{'PSNR':>8}{'FLIP':>8}{'stops':>8}{'halves: SSIM FLIP':>18}"
        f"{'things':>8}"
        "   as it is: SSIM PSNR"
    )
    for row in rows:
        print(
            f"{row['scene'] + '/' + row['view']:22}{row['ssim']:8.3f}{row['psnr_db']:8.1f}"
            f"{row['flip']:8.3f}{row['stops']:+8.2f}{row['ssim_halves']:12.3f}"
            f"{row['flip_halves']:6.3f}"
            f"{share_near(row['objects'], NEAR_DELTA_E):8.0%}"
            f"{row['ssim_unmatched']:18.3f}{row['psnr_db_unmatched']:5.1f}"
        )
    if rows:
        mean = {key: float(np.mean([r[key] for r in rows])) for key in MEANS}
        lowest = min(row["ssim"] for row in rows)
        print(
            f"{'mean':22}{mean['ssim']:8.3f}{mean['psnr_db']:8.1f}{mean['flip']:8.3f}"
            f"{mean['stops']:+8.2f}{mean['ssim_halves']:12.3f}{mean['flip_halves']:6.3f}"
        )
        print(f"{'lowest SSIM':22}{lowest:8.3f}")
        for label, key in (("1 - SSIM", "lost"), ("FLIP", "flip_lost")):
            lost = np.mean([row[key] for row in rows], axis=0)
            parts = (f"{name} {part:.3f}" for name, part in zip(REGIONS, lost, strict=True))
            print(f"of {label}: {', '.join(parts)}")
        for line in lines_on_objects(rows):
            print(line)
    output.mkdir(parents=True, exist_ok=True)
    file = output / "comparison.json"
    file.write_text(json.dumps(rows, indent=1), encoding="utf-8")
    print(f"written to {output}")


if __name__ == "__main__":
    sys.exit(main())
