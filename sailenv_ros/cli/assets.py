"""`sailenv assets`: build the standard pack, check, list and picture what there is, add to it."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from rich.console import Console

from sailenv_content.animals.looks import OWN_LICENCE, animals
from sailenv_content.people.fetch_bodies import (
    BODIES_COMMAND,
    LICENCE,
    SOURCE,
    body_data,
    body_folder,
    fetch_bodies,
)
from sailenv_content.people.looks import people
from sailenv_content.standard.fetch import SOURCES, kept_folder
from sailenv_content.standard.pack_build import is_current, licence_files
from sailenv_ros.assets.asset_library import AssetLibrary
from sailenv_ros.assets.checksums import damaged_by_manifest
from sailenv_ros.assets.folders import own_pack_folder, pack_folders, standard_pack_folder
from sailenv_ros.assets.motions import add_motion, read_clip
from sailenv_ros.assets.own_pack import add_to_own_pack
from sailenv_ros.assets.pack import BUILD_COMMAND, PACK_FILE, AssetPack
from sailenv_ros.assets.sources import installed_packs, installed_sources
from sailenv_ros.cli.furniture import build_furniture, object_progress
from sailenv_ros.cli.pieces import add_show, run_show
from sailenv_ros.cli.scene_export import add_asset_arguments, export_one_asset
from sailenv_ros.errors import AssetError, UnknownName
from sailenv_ros.light.bake.light_files import damaged_light
from sailenv_ros.simulation.models.import_process import import_file_apart
from sailenv_ros.simulation.models.thumbnails import is_whole_png, thumbnail_folder
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.system.array_cache import damaged_arrays
from sailenv_ros.types.humanoid import humanoid_of
from sailenv_ros.types.validation import checked_integer

__all__ = ["add_parser", "run"]


COLUMNS, TILE_PX, AZIMUTH_DEG = 10, 192, 32.0
"""Layout of a contact sheet, and the azimuth of its views, unless given: columns, px, deg."""


def add_parser(subparsers: Any) -> None:
    """Add the command to those of `sailenv`."""
    parser: argparse.ArgumentParser = subparsers.add_parser(
        "assets", help="build the furniture, list and picture objects, add one's own"
    )
    parser.set_defaults(run=run)
    actions = parser.add_subparsers(dest="action", required=True, metavar="ACTION")
    build = actions.add_parser("build", help="fetch and make the standard pack of furniture")
    build.add_argument("--force", action="store_true", help="make it anew though it is there")
    build.add_argument("--jobs", type=int, metavar="N", help="processes (default: one a core)")
    actions.add_parser("people", help="fetch the data that people are made from")
    actions.add_parser("verify", help="check every file of packs, sources, baked light and caches")
    listed = actions.add_parser(
        "list", help="list every object, with its category, size and licence"
    )
    listed.add_argument(
        "--sheet", type=Path, metavar="FILE", help="picture them all, too: .jpg, .png"
    )
    listed.set_defaults(names=(), columns=COLUMNS, tile=TILE_PX, azimuth=AZIMUTH_DEG)
    credit = actions.add_parser("credits", help="print authors, licences and sources")
    credit.add_argument("--full", action="store_true", help="the licence texts too")
    sheet = actions.add_parser("sheet", help="picture objects on a contact sheet")
    sheet.add_argument("names", nargs="*", metavar="NAME", help="objects (default: all)")
    sheet.add_argument(
        "-o", "--output", type=Path, required=True, metavar="FILE", help=".jpg, .png"
    )
    sheet.add_argument("--columns", type=int, default=COLUMNS, metavar="N")
    sheet.add_argument("--tile", type=int, default=TILE_PX, metavar="PX", help="width of a picture")
    sheet.add_argument(
        "--azimuth", type=float, default=AZIMUTH_DEG, metavar="DEG", help="of the camera"
    )
    add_show(actions)
    add_asset_arguments(
        actions.add_parser("export", help="write an object as a file of another program")
    )
    add = actions.add_parser("add", help="put a model of yours into your own pack")
    add.add_argument("model", type=Path, metavar="FILE", help=".glb, .gltf, .obj or .zip")
    add.add_argument("--category", required=True, help="what it is, e.g. chair")
    add.add_argument("--name", help="catalogue name (default: the file's)")
    add.add_argument("--display-name", help="for people (default: made from the name)")
    add.add_argument("--height", type=float, metavar="M", help="scale it to this height")
    add.add_argument("--mass", type=float, metavar="KG", help="(default: by its size)")
    add.add_argument("--author", default="", help="for the credits")
    add.add_argument("--licence", default="", help="for the credits")
    motion = actions.add_parser("add-motion", help="keep a BVH file of yours for people to play")
    motion.add_argument("file", type=Path, metavar="FILE", help=".bvh")
    motion.add_argument("--name", default="", help="(default: the file's)")


def run(args: argparse.Namespace) -> int:
    """Do what was asked; 0 if all is well."""
    return {
        "build": _build,
        "people": _people,
        "list": _list,
        "credits": _credits,
        "sheet": _sheet,
        "show": run_show,
        "add": _add,
        "add-motion": _add_motion,
        "export": export_one_asset,
        "verify": _verify,
    }[args.action](args)


def _build(args: argparse.Namespace) -> int:
    folder = standard_pack_folder()
    if is_current(folder) and not args.force:
        print(f"{folder}: up to date ({len(AssetPack(folder).entries)} objects)")
        return 0
    build_furniture(jobs=args.jobs, force=args.force)
    print(f"{folder}: {len(AssetPack(folder).entries)} objects")
    return 0


def _people(args: argparse.Namespace) -> int:
    fetch_bodies(say=print, check=True)
    print(f"{body_folder()}: {len(people())} people")
    return 0


def _list(args: argparse.Namespace) -> int:
    for pack in installed_packs():
        print(f"{pack.folder}  {pack.content.title}".rstrip())
        for name, entry in sorted(pack.entries.items()):
            size = " × ".join(f"{100 * s:.0f}" for s in entry.size)
            print(f"  {name:<20} {entry.category:<16} {size:>18} cm  {entry.licence}")
    if not any(pack.folder == standard_pack_folder() for pack in installed_packs()):
        print("The furniture has not been built yet: sailenv assets build")
    if body_data() is None:
        print(f"The data of people has not been fetched yet: {BODIES_COMMAND}")
    else:
        print(f"{body_folder()}  {SOURCE}")
        for name, look in people().items():
            print(f"  {name:<20} {'person':<16} {look.title:<21} {LICENCE}")
    print("cats and dogs, which rules make  (sailenv_ros)")
    for name, animal in animals().items():
        print(f"  {name:<20} {animal.kind:<16} {animal.title:<21} {OWN_LICENCE}")
    if args.sheet is not None:
        args.output = args.sheet
        return _sheet(args)
    return 0


def _verify(_: argparse.Namespace) -> int:
    """Print every damaged file and what makes it again; 1 if there is one."""
    kinds = (_pack_problems, _source_problems, _light_problems, _array_problems, _picture_problems)
    problems = [problem for kind in kinds for problem in kind()]
    for file, problem, remedy in problems:
        print(f"{file}: {problem}; {remedy}")
    if not problems:
        print("packs, sources, baked light and caches: all files are whole")
    return 1 if problems else 0


Problems = Iterator[tuple[Path, str, str]]
"""A file, what is wrong with it, and what is to be done."""


def _pack_problems() -> Problems:
    for folder in (standard_pack_folder(), *pack_folders()):
        if not (folder / PACK_FILE).is_file():
            continue
        remedy = BUILD_COMMAND if folder == standard_pack_folder() else "add or install it anew"
        try:
            problems = AssetPack(folder).problems()
        except AssetError as problem:
            yield folder / PACK_FILE, problem.why, remedy
        else:
            for file, what in problems.items():
                yield folder / file, what, remedy


def _source_problems() -> Problems:
    for package in SOURCES:
        folder = kept_folder(package)
        for file, what in damaged_by_manifest(folder).items():
            yield folder / file, what, f"{BUILD_COMMAND} --force downloads {package} anew"


def _light_problems() -> Problems:
    for path, what in damaged_light().items():
        yield path, what, "sailenv scene bake SCENE bakes it anew"


def _array_problems() -> Problems:
    for path, what in damaged_arrays().items():
        yield path, what, "it is made anew when it is asked for"


def _picture_problems() -> Problems:
    for path in sorted(thumbnail_folder().glob("*.png")):
        if not is_whole_png(path.read_bytes()):
            yield path, "is damaged (its checksum is wrong)", "it is made anew when it is asked for"


def _credits(args: argparse.Namespace) -> int:
    for pack in installed_packs():
        print(f"# {pack.content.title or pack.folder}\n")
        for name, entry in sorted(pack.entries.items()):
            print(f"{entry.display_name} ({name}): {entry.author}, {entry.licence}, {entry.source}")
        files = licence_files(pack.folder)
        if files and not args.full:
            print(f"\n{len(files)} licence texts and credits files lie in {files[0].parents[1]}")
        for file in files if args.full else ():
            print(f"\n## {file.relative_to(pack.folder)}\n")
            print(file.read_text(encoding="utf-8", errors="replace").strip())
        print()
    return 0


def _sheet(args: argparse.Namespace) -> int:
    # Imported here: all other actions do without OpenGL.
    from sailenv_ros.frame.pictures.contact_sheet import save_contact_sheet
    from sailenv_ros.simulation.models.preview_renderer import PreviewRenderer

    columns = checked_integer("--columns", args.columns, 1, 1000)
    tile_px = checked_integer("--tile", args.tile, 16, 2048, unit="px")
    library = AssetLibrary(installed_sources())
    names = [library.canonical(n) for n in args.names] or [
        name for pack in installed_packs() for name in sorted(pack.entries)
    ]
    console = Console(stderr=True)
    pictures = {}
    with PreviewRenderer() as previews, object_progress(console) as bar:
        for name in bar.track(names, description="pictures"):
            asset = library.get(name)
            pictures[asset.display_name] = previews.thumbnail(
                asset, width=tile_px, height=tile_px * 3 // 4, azimuth_deg=args.azimuth
            )
    print(save_contact_sheet(args.output, pictures, columns=columns))
    return 0


def _add(args: argparse.Namespace) -> int:
    categories = SceneLibrary().categories
    if args.category not in {category.name for category in categories.values()}:
        raise UnknownName("category", args.category, (c.name for c in categories.values()))
    name = args.name or "".join(
        c if c.isascii() and c.isalnum() else "_" for c in args.model.stem.lower()
    ).strip("_")
    asset = import_file_apart(
        args.model.absolute(),
        name=name,
        display_name=args.display_name,
        category=args.category,
        height_m=args.height,
        mass_kg=args.mass,
    )
    entry = add_to_own_pack(asset, author=args.author, licence=args.licence, source=args.model.name)
    preview = _preview(asset)
    size = " × ".join(f"{s:.3g}" for s in entry.size)
    print(
        f"{entry.name}: {entry.category}, {size} m, {entry.mass:.3g} kg, "
        f"{entry.triangles} triangles, {len(asset.collision)} collision pieces\n"
        f"in {own_pack_folder()}, pictured in {preview.name}"
    )
    return 0


def _add_motion(args: argparse.Namespace) -> int:
    humanoid_of(read_clip(args.file))
    name, clip = add_motion(args.file, args.name)
    print(
        f"{name}: {len(clip.roots)} frames in {clip.duration_s:.2f} s, "
        f"{len(clip.joint_names)} joints; for the behaviour play_clip"
    )
    return 0


def _preview(asset: Any) -> Path:
    from sailenv_ros.frame.pictures.contact_sheet import save_contact_sheet
    from sailenv_ros.simulation.models.preview_renderer import PreviewRenderer

    with PreviewRenderer() as previews:
        pictures = {
            side: previews.thumbnail(asset, width=400, height=300, azimuth_deg=azimuth)
            for side, azimuth in (("front", 25.0), ("back", 205.0))
        }
    return save_contact_sheet(own_pack_folder() / f"{asset.name}.png", pictures, columns=2)
