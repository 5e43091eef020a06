"""`sailenv scene generate`: a furnished room from a seed, as a scene file."""

from __future__ import annotations

import argparse
from pathlib import Path

from sailenv_content.generation.generator import Generator
from sailenv_ros.authoring.room_rules.names import MAX_SEED, drawn_kind
from sailenv_ros.authoring.room_rules.rule_files import read_rules
from sailenv_ros.errors import InvalidRequest, SceneError
from sailenv_ros.scene.scene_catalogue import SUFFIXES
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.system.files import write_file
from sailenv_ros.system.resources import resource_path
from sailenv_ros.types.validation import checked_integer

__all__ = ["add_arguments", "generate"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what the action takes."""
    parser.add_argument("--seed", type=int, metavar="N", help="the same makes the same file")
    parser.add_argument("--kind", metavar="KIND", help="of room; drawn by the seed if left out")
    parser.add_argument("-o", "--output", type=Path, metavar="FILE", help="a YAML file")
    parser.add_argument(
        "--overwrite", action="store_true", help="replace a file that exists already"
    )
    parser.add_argument(
        "--rules",
        type=Path,
        metavar="FOLDER",
        help="kinds of rooms and their libraries, instead of the package's own (config/rooms)",
    )
    parser.add_argument("--kinds", action="store_true", help="check the rules, list the kinds")


def generate(args: argparse.Namespace) -> int:
    """Make a room and write its file; 0 if all is well.

    Raises
    ------
    InvalidRequest
        If an argument is missing or cannot be taken, or the file exists.
    """
    known = SceneLibrary().knowledge
    folder = args.rules or resource_path("config", "rooms")
    try:
        rules = read_rules(
            folder,
            assets=known.assets,
            categories=known.categories,
            surfaces=known.surfaces,
            skies=known.skies or None,
        )
    except SceneError as problem:
        print(problem)
        return 1
    if args.kinds:
        for name in sorted(rules.kinds):
            print(f"{name:<{max(map(len, rules.kinds))}}  {rules.kinds[name].title}")
        return 0
    if args.seed is None or args.output is None:
        missing = "--seed" if args.seed is None else "--output"
        raise InvalidRequest(missing, None, "given, unless --kinds is")
    seed = checked_integer("--seed", args.seed, 0, MAX_SEED)
    if args.output.suffix not in SUFFIXES:
        accepted = f"a name that ends in {SUFFIXES[0]}"
        raise InvalidRequest("--output", str(args.output), accepted)
    if args.output.exists() and not args.overwrite:
        raise InvalidRequest("--output", str(args.output), "a new file, or give --overwrite")
    kind = drawn_kind(seed, rules) if args.kind is None else args.kind
    made = Generator(rules=rules).generate(kind, seed)
    try:
        write_file(args.output, made.text.encode(), overwrite=args.overwrite)
    except OSError as problem:
        accepted = f"one that can be written ({problem.strerror})"
        raise InvalidRequest("--output", str(args.output), accepted) from None
    print(
        f"{args.output}: {made.spec.title} ({len(made.spec.objects)} objects)\n"
        f"Look at it: sailenv scene render {args.output} -o {args.output.stem}.png"
    )
    return 0
