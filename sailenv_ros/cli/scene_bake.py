"""`sailenv scene bake`: compute the light of rooms beforehand, with a progress bar.

`sailenv setup` uses it too.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeElapsedColumn

from sailenv_ros.cli.arguments import add_allow_modules
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.light.bake.fingerprint import fingerprint
from sailenv_ros.light.bake.light_files import (
    baked_file,
    is_baked,
    load_baked,
    remember,
    store_baked,
    store_draft,
)
from sailenv_ros.light.bake.pipeline import bake
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.types.baked_light import BakedLight
from sailenv_ros.types.snapshot import WorldSnapshot

__all__ = ["add_arguments", "bake_scenes", "ensure_baked", "rooms"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the action's arguments to its parser."""
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help="names or files")
    parser.add_argument("--all", action="store_true", help="every scene with a room")
    parser.add_argument("--force", action="store_true", help="bake anew what is there already")
    add_allow_modules(parser)


def bake_scenes(args: argparse.Namespace) -> int:
    """Bake what was asked for; 0 if all is baked at its end.

    Raises
    ------
    InvalidRequest
        If neither scenes nor `--all` are given.
    """
    library = SceneLibrary(allow_modules=args.allow_modules)
    scenes = [*args.scenes, *(rooms(library) if args.all else ())]
    if not scenes:
        raise InvalidRequest("what to bake", "nothing", "names or files of scenes, or --all")
    for scene in scenes:
        print(f"{scene}: {_bake_one(library, scene, force=args.force)}", flush=True)
    return 0


def ensure_baked(
    scene: str,
    scene_paths: Sequence[Path] = (),
    *,
    allow_modules: bool,
    drafted: Callable[[], None] = lambda: None,
) -> bool:
    """Bake a scene's light unless it is baked or has no room; return whether it was baked now.

    Parameters
    ----------
    drafted : callable
        Called whenever light is there that is right, but rougher than the final one.
    """
    library = SceneLibrary(scene_paths, allow_modules=allow_modules)
    if is_baked(library.stamp(scene)) or library.load(scene).room is None:
        return False
    _bake_one(library, scene, force=False, drafted=drafted)
    return True


def rooms(library: SceneLibrary) -> list[str]:
    """Return the names of the scenes that have a room, whose light can be baked."""
    return [name for name in library.scene_names if library.load(name).room is not None]


def _bake_one(
    library: SceneLibrary,
    scene: str,
    *,
    force: bool,
    drafted: Callable[[], None] = lambda: None,
) -> str:
    """Bake a scene and say what was done."""
    if library.load(scene).room is None:
        return "it has no room; its light is worked out from frame to frame"
    snapshot = library.snapshot(scene)
    name = fingerprint(snapshot)
    if not force and load_baked(name) is not None:
        said = f"baked already ({baked_file(name)})"
    else:

        def keep(draft: BakedLight) -> None:
            if load_baked(name) is None:  # with --force the light that is there is better
                store_draft(draft)
                drafted()

        path = store_baked(_with_a_bar(snapshot, scene, keep))
        said = f"baked ({path}, {path.stat().st_size / 1e6:.0f} MB)"
    remember(library.stamp(scene), name)
    return said


def _with_a_bar(
    snapshot: WorldSnapshot, scene: str, preview: Callable[[BakedLight], None]
) -> BakedLight:
    console = Console(stderr=True)
    columns = (
        TextColumn("{task.description:<32}"), BarColumn(), TaskProgressColumn(), TimeElapsedColumn()
    )  # fmt: skip
    with Progress(*columns, console=console, transient=not console.is_terminal) as bar:
        task = bar.add_task(f"light of {scene}", total=1.0)

        quarters = 0

        def report_stage(stage: str, share: float) -> None:
            nonlocal quarters
            bar.update(task, description=f"light of {scene}: {stage}", completed=share)
            if not console.is_terminal and int(4 * share) > quarters:
                quarters = int(4 * share)
                print(f"light of {scene}: {25 * quarters} %", file=sys.stderr, flush=True)

        baked = bake(snapshot, report=report_stage, preview=preview)
        bar.update(task, description=f"light of {scene}", completed=1.0)
    return baked
