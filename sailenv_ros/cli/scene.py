"""`sailenv scene`: check, list, render, bake, import, export, begin scenes; their JSON Schema."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from sailenv_ros.behaviours import behaviour_kinds
from sailenv_ros.cli import (
    scene_bake,
    scene_export,
    scene_generate,
    scene_import,
    scene_lens,
    scene_render,
)
from sailenv_ros.cli.arguments import add_allow_modules
from sailenv_ros.errors import AssetError, InvalidRequest, SceneError, UnknownName
from sailenv_ros.scene.loader import load_scene
from sailenv_ros.scene.reference import write_reference
from sailenv_ros.scene.scene_catalogue import SUFFIXES, SceneCatalogue
from sailenv_ros.scene.schema import (
    SCHEMA_FILE,
    is_stale,
    scene_schema,
    schema_text,
    write_schema,
)
from sailenv_ros.scene.spec import SceneSpec
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.system.files import write_file
from sailenv_ros.system.resources import resource_path
from sailenv_ros.world.physics_check import obstructions, overlaps, shifts

__all__ = ["add_parser", "run"]


def add_parser(subparsers: Any) -> None:
    """Add the command to those of `sailenv`."""
    parser: argparse.ArgumentParser = subparsers.add_parser(
        "scene", help="check, render, bake, import, export and begin scenes"
    )
    parser.set_defaults(run=run)
    actions = parser.add_subparsers(dest="action", required=True, metavar="ACTION")
    check = actions.add_parser("check", help="report every error of scene files, with its place")
    check.add_argument("scenes", nargs="+", metavar="FILE", help="a YAML file, or a scene's name")
    check.add_argument(
        "--physics",
        action="store_true",
        help="build it too: what overlaps, what does not stay in place, what is in the mover's way",
    )
    add_allow_modules(check)
    actions.add_parser("list", help="list the scenes that come with the package")
    scene_render.add_arguments(
        actions.add_parser("render", help="render a scene from a viewpoint into a picture file")
    )
    scene_bake.add_arguments(
        actions.add_parser("bake", help="work out the light of rooms beforehand")
    )
    scene_import.add_arguments(
        actions.add_parser("import", help="make a scene of a file of another program")
    )
    scene_export.add_arguments(
        actions.add_parser("export", help="write a scene as a file of another program")
    )
    scene_generate.add_arguments(
        actions.add_parser("generate", help="make a furnished room from a seed")
    )
    scene_lens.add_arguments(
        actions.add_parser("lens", help="print the keys of a camera that a calibration is of")
    )
    new = actions.add_parser("new", help="write a commented scene to begin with")
    new.add_argument("file", type=Path, metavar="FILE", help="where to; must not exist")
    schema = actions.add_parser("schema", help="write the JSON Schema that editors complete by")
    schema.add_argument(
        "--check", action="store_true", help="only tell if the file is not up to date"
    )
    schema.add_argument(
        "--output",
        type=Path,
        metavar="FILE",
        help=f"where to, - for standard output (default: {SCHEMA_FILE} beside the scenes)",
    )


def run(args: argparse.Namespace) -> int:
    """Do what was asked; 0 if all is well, 1 if there are errors."""
    if args.action == "check":
        return _check(args.scenes, physics=args.physics, allow_modules=args.allow_modules)
    if args.action == "list":
        return _list()
    if args.action == "render":
        return scene_render.render_scene(args)
    if args.action == "bake":
        return scene_bake.bake_scenes(args)
    if args.action == "import":
        return scene_import.import_file(args)
    if args.action == "export":
        return scene_export.export_one_scene(args)
    if args.action == "generate":
        return scene_generate.generate(args)
    if args.action == "lens":
        return scene_lens.show_lens(args)
    if args.action == "new":
        return _new(args.file)
    return _schema(args.output, check=args.check)


def _new(file: Path) -> int:
    if file.suffix not in SUFFIXES:
        raise InvalidRequest("name of the scene file", file.name, f"one that ends in {SUFFIXES[0]}")
    try:
        content = resource_path("config", "new_scene.yaml").read_bytes()
        write_file(file, content, overwrite=False)
    except FileExistsError:
        raise InvalidRequest("scene file", str(file), "one that does not exist yet") from None
    except OSError as problem:
        raise InvalidRequest(
            "scene file", str(file), f"one that can be written ({problem.strerror})"
        ) from None
    print(f"{file}\nLook at it: sailenv scene render {file} -o {file.stem}.png")
    return 0


def _check(scenes: list[str], *, physics: bool, allow_modules: bool) -> int:
    """Check files; code that they name runs only where they are built and that is allowed."""
    library, status = SceneLibrary(allow_modules=allow_modules), 0
    for scene in scenes:
        try:
            counts = _counts(_load(library, scene))
            diagnostics = list(_physics_diagnostics(library, scene)) if physics else []
            for diagnostic in diagnostics:
                print(f"{scene}: {diagnostic}")
            status = 1 if diagnostics else status
            if not diagnostics:
                print(f"{scene}: ok ({counts})")
        except (SceneError, AssetError, UnknownName) as problem:
            print(problem)
            status = 1
    return status


def _physics_diagnostics(library: SceneLibrary, scene: str) -> Iterator[str]:
    world = library.build(scene)
    try:
        for overlap in overlaps(world):
            depth_mm = 1000.0 * overlap.depth_m
            yield f"{overlap.first!r} and {overlap.second!r} overlap by {depth_mm:.0f} mm"
        for way in obstructions(world):
            clearance_cm = 100.0 * way.clearance_m
            yield (
                f"the mover {way.mover!r} passes {way.name!r} at {clearance_cm:.0f} cm "
                f"({way.time_s:g} s on its way)"
            )
        for shift in shifts(world):
            yield (
                f"{shift.name!r} does not stay in place: after 2 s it has moved by "
                f"{100.0 * shift.distance_m:.0f} cm and turned by {shift.angle_deg:.0f} deg"
            )
    finally:
        world.close()


def _load(library: SceneLibrary, scene: str) -> SceneSpec:
    """Load a file, also one that is not there: then its own error is the clearest."""
    if Path(scene).suffix in SUFFIXES:
        return load_scene(Path(scene), knowledge=library.knowledge)
    return library.load(scene)


def _counts(spec: SceneSpec) -> str:
    counts = {
        "object": len(spec.objects),
        "light": len(spec.lights),
        "mover": len(spec.all_movers),
        "agent": len(spec.agents),
    }
    counted = [f"{count} {noun}{'' if count == 1 else 's'}" for noun, count in counts.items()]
    of_modules = {b.type for entry in spec.objects for b in entry.behaviours if ":" in b.type}
    return ", ".join([*counted, *(f"names the code of {type_!r}" for type_ in sorted(of_modules))])


def _list() -> int:
    library, status = SceneLibrary(), 0
    width = max(map(len, library.scene_names), default=0)
    for name in library.scene_names:
        try:
            print(f"{name:<{width}}  {library.load(name).title}".rstrip())
        except (SceneError, AssetError):
            print(f"{name:<{width}}  (has errors: see sailenv scene check {name})")
            status = 1
    return status


def _schema(output: Path | None, *, check: bool) -> int:
    behaviours = {name: kind.parameters for name, kind in behaviour_kinds().items()}
    path = SceneCatalogue().folders[-1] / SCHEMA_FILE if output is None else output
    if check:
        stale = is_stale(path, behaviours)
        print(f"{path}: {'stale; run sailenv scene schema' if stale else 'up to date'}")
        return int(stale)
    if str(path) == "-":
        sys.stdout.write(schema_text(behaviours))
        return 0
    try:
        write_schema(path, behaviours)
    except OSError as problem:
        print(f"{path}: cannot be written: {problem.strerror}")
        return 1
    print(path)
    docs = path.parents[1] / "docs"
    if output is None and docs.is_dir():  # a checkout; an installed package has no docs
        write_reference(docs, scene_schema(behaviours))
        print(docs)
    return 0
