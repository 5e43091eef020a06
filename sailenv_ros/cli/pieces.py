"""`sailenv assets show`: families of pieces, pieces of many seeds, single objects, on a sheet."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from sailenv_content.families.making import make_piece
from sailenv_content.families.names import MAX_SEED, PieceName
from sailenv_content.families.registry import family_named, family_names
from sailenv_ros.assets.asset_library import AssetLibrary
from sailenv_ros.assets.sources import installed_sources
from sailenv_ros.errors import UnknownName
from sailenv_ros.types.model import Asset
from sailenv_ros.types.validation import checked_integer

__all__ = ["add_show", "run_show"]

COLUMNS, TILE_PX, AZIMUTH_DEG = 6, 240, 32.0
MOST_PIECES = 1000


def add_show(actions: Any) -> None:
    """Add the action to those of `sailenv assets`."""
    show: argparse.ArgumentParser = actions.add_parser(
        "show", help="list families of pieces that seeds draw, or make and picture some, or objects"
    )
    show.add_argument(
        "names", nargs="*", metavar="FAMILY[~STYLE]", help="or an object (default: list them)"
    )
    show.add_argument(
        "--seeds", nargs=2, type=int, default=(0, 5), metavar=("FIRST", "LAST"), help="(0 5)"
    )
    show.add_argument("--sheet", type=Path, metavar="FILE", help="picture them: .jpg, .png")


def run_show(args: argparse.Namespace) -> int:
    """List the families, or make pieces; print a line for each."""
    if not args.names:
        for name in family_names():
            print(f"{name:<14} {', '.join(family_named(name).styles)}")
        return 0
    first = checked_integer("--seeds", args.seeds[0], 0, MAX_SEED)
    last = checked_integer("--seeds", args.seeds[1], first, first + MOST_PIECES - 1)
    library = AssetLibrary(installed_sources())
    known = set(family_names())
    single = [n for n in args.names if n.partition("~")[0] not in known and library.has(n)]
    styles = [style for name in args.names if name not in single for style in _styles(name)]
    assets = []
    for name in single:
        assets.append(library.get(name))
        print(_line(assets[-1]))
    for family, style in styles:
        for seed in range(first, last + 1):
            piece = make_piece(family_named(family), PieceName(family, style, seed))
            assets.append(piece.asset)
            print(_line(piece.asset) + (f", drawn {piece.draws} times" if piece.draws > 1 else ""))
    if args.sheet is not None:
        from sailenv_ros.frame.pictures.contact_sheet import save_contact_sheet
        from sailenv_ros.simulation.models.preview_renderer import PreviewRenderer

        with PreviewRenderer() as previews:
            pictures = {
                asset.name: previews.thumbnail(
                    asset, width=TILE_PX, height=TILE_PX * 5 // 6, azimuth_deg=AZIMUTH_DEG
                )
                for asset in assets
            }
        print(save_contact_sheet(args.sheet, pictures, columns=COLUMNS))
    return 0


def _line(asset: Asset) -> str:
    low, high = asset.model.bounds()
    size = " × ".join(f"{100 * side:.0f}" for side in high - low)
    count = len(asset.moving) + (0 if asset.rig is None else len(asset.rig.names))
    joints = f", {count} joints" if count else ""
    return f"{asset.name:<24} {size:>15} cm {asset.mass_kg:6.1f} kg{joints}"


def _styles(name: str) -> Iterator[tuple[str, str]]:
    """Yield families and styles of a name; see `run_show`."""
    family, mark, style = name.partition("~")
    if family not in family_names():
        raise UnknownName("family of pieces", family, family_names())
    known = family_named(family).styles
    if mark and style not in known:
        raise UnknownName(f"style of {family!r}", style, known)
    yield from ((family, one) for one in ([style] if mark else known))
