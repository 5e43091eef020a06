"""`sailenv scene import`: a scene of another program becomes a scene file and a pack."""

from __future__ import annotations

import argparse
from pathlib import Path

from sailenv_content.scene_import.importers import IMPORTED_SUFFIXES, import_scene
from sailenv_ros.assets.folders import own_pack_folder, pack_folders

__all__ = ["add_arguments", "import_file"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument(
        "file", type=Path, metavar="FILE", help=f"one of: {', '.join(IMPORTED_SUFFIXES)}"
    )
    parser.add_argument(
        "-o", "--output", type=Path, required=True, metavar="SCENE.yaml", help="the scene file"
    )
    parser.add_argument(
        "--pack",
        type=Path,
        metavar="FOLDER",
        help="where its models go (default: a pack named after the scene, among your own)",
    )
    parser.add_argument("--overwrite", action="store_true", help="replace the scene and its pack")
    parser.add_argument(
        "--own-models",
        action="store_true",
        help="take every model from the file, also where the standard pack has it",
    )


def import_file(args: argparse.Namespace) -> int:
    """Import a file; report what came of it."""
    pack = args.pack or own_pack_folder().with_name(args.output.stem)
    report = import_scene(
        args.file, args.output, pack, overwrite=args.overwrite, own_models=args.own_models
    )
    print(
        f"{report.file}: {report.objects} objects, {report.ours} of them of the standard pack, "
        f"{report.lights} lights; {report.models} models in {report.pack_folder}"
    )
    for note in report.notes:
        print(f"note: {note}")
    if pack.resolve() not in {folder.resolve() for folder in pack_folders()}:
        print(f"Before you use it: export SAILENV_PACKS={pack.resolve()}")
    print(f"Look at it: sailenv scene render {report.file} -o {report.file.stem}.png")
    return 0
