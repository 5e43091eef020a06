"""`sailenv setup`: build the furniture and bake the light of the rooms, once on each machine.

Says on standard output what is ready, one line each, and on standard error how far it is.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Collection
from pathlib import Path
from typing import Any

from sailenv_content.people.fetch_bodies import body_data, fetch_bodies
from sailenv_content.standard.pack_build import is_current
from sailenv_ros.assets.recipe import standard_recipe
from sailenv_ros.cli.arguments import add_allow_modules
from sailenv_ros.cli.furniture import build_furniture
from sailenv_ros.cli.scene_bake import ensure_baked, rooms
from sailenv_ros.errors import AssetError, StorageError
from sailenv_ros.scene.loader import load_scene
from sailenv_ros.simulation.background_build import READY
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.system.parent import end_with_parent
from sailenv_ros.types.light_choice import STEADY_LIGHTS

__all__ = ["add_parser", "run"]


def add_parser(subparsers: Any) -> None:
    """Add the command to those of `sailenv`."""
    parser: argparse.ArgumentParser = subparsers.add_parser(
        "setup", help="build the furniture and bake the light of the rooms, once on each machine"
    )
    parser.set_defaults(run=run)
    parser.add_argument(
        "--scene", metavar="SCENE", help="what this scene needs first (with --only: nothing else)"
    )
    parser.add_argument("--only", action="store_true", help="what --scene needs and nothing else")
    parser.add_argument(
        "--light",
        choices=STEADY_LIGHTS,
        default="baked",
        help="plain: bake none (default: %(default)s)",
    )
    parser.add_argument(
        "--no-light", action="store_const", const="plain", dest="light", help="as --light plain"
    )
    parser.add_argument("--jobs", type=int, metavar="N", help="processes (default: one a core)")
    parser.add_argument(
        "--scenes", type=Path, action="append", default=[], metavar="DIR", help="more scenes"
    )
    # Of a simulator that builds in the background: ends with it.
    parser.add_argument("--parent", type=int, help=argparse.SUPPRESS)
    add_allow_modules(parser)


def run(args: argparse.Namespace) -> int:
    """Build and bake what is not there yet; 0 if all is there at its end."""
    if args.parent is not None:
        end_with_parent(args.parent)
    if args.scene is not None:
        _furniture(_names_of(args.scene, args.scenes), args.jobs, f"furniture of {args.scene}")
        if args.light == "baked":
            _light(args.scene, args)
    if args.only:
        return 0
    _furniture(None, args.jobs, "furniture")
    _people()
    if args.light == "baked":
        for scene in rooms(SceneLibrary(args.scenes, allow_modules=args.allow_modules)):
            _light(scene, args)
    return 0


def _people() -> None:
    """Fetch what people are made from; rooms without people need it not."""
    if body_data() is not None:
        return
    try:
        fetch_bodies()
        print(f"{READY}people", flush=True)
    except (AssetError, StorageError) as problem:
        print(f"NOTE: there will be no people: {problem}", file=sys.stderr)


def _names_of(scene: str, scene_paths: list[Path]) -> Collection[str]:
    """Return the objects of the standard pack that a scene names."""
    library = SceneLibrary(scene_paths)
    named = {library.canonical_asset(e.asset) for e in load_scene(library.path(scene)).objects}
    return named & standard_recipe().assets.keys()


def _furniture(names: Collection[str] | None, jobs: int | None, what: str) -> None:
    if (names is None or names) and not is_current(names=names):
        build_furniture(names=names, jobs=jobs)
        print(f"{READY}{what}", flush=True)


def _light(scene: str, args: argparse.Namespace) -> None:
    def drafted() -> None:
        print(f"{READY}light of {scene}, rough as yet", flush=True)

    modules = args.allow_modules
    if ensure_baked(scene, args.scenes, allow_modules=modules, drafted=drafted):
        print(f"{READY}light of {scene}", flush=True)
