"""Draws a contact sheet of generated rooms: python scripts/picture_rooms.py FILE [--bake|--draft].

Each room is seen by its agent `view`, whose place the generator has chosen by the camera rule
`room_view`. Told is which chairs and couches stand in more than one of the rooms.
"""

from __future__ import annotations

import argparse
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sailenv_ros import Simulation
from sailenv_ros.cli.scene_bake import ensure_baked
from sailenv_ros.frame.pictures.contact_sheet import save_picture
from sailenv_ros.simulation.scenes import SceneLibrary

KINDS = ("living_room", "kitchen", "bedroom", "office", "bathroom", "apartment")
SEEDS = (350001, 350002, 350003, 350004)
"""One row each."""

TILE_PX = (352, 264)
"""Width and height of a picture."""

SEATS = ("chair", "couch")
"""Categories of which no two rooms should have the same piece."""


def main() -> None:
    """Draw the sheet."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("output", type=Path)
    parser.add_argument("--bake", action="store_true", help="bake the rooms' light first")
    parser.add_argument("--draft", action="store_true", help="bake no more than a draft of it")
    parser.add_argument("--kinds", nargs="+", default=KINDS)
    parser.add_argument("--seeds", type=int, nargs="+", default=SEEDS)
    args = parser.parse_args()
    rows = []
    library = SceneLibrary()
    seats: dict[str, dict[str, set[str]]] = {category: {} for category in SEATS}
    for seed in args.seeds:
        tiles = []
        for kind in args.kinds:
            scene = f"generated:{kind}:{seed}"
            if args.bake:
                ensure_baked(scene, allow_modules=False)
            elif args.draft:
                with suppress(_EnoughError):
                    ensure_baked(scene, allow_modules=False, drafted=_end)
            tiles.append(_picture(scene))
            for entry in library.load(scene).objects:
                category = library.assets.get(entry.asset).category
                if category in seats:
                    seats[category].setdefault(entry.asset, set()).add(scene)
            print(scene, flush=True)
        rows.append(np.hstack(tiles))
    print(save_picture(args.output, np.vstack(rows)))
    for category, found in seats.items():
        again = [name for name, rooms in found.items() if len(rooms) > 1]
        print(f"{len(found)} {category}: in more than one room {', '.join(again) or 'none'}")


class _EnoughError(Exception):
    """Ends a bake when its draft is there."""


def _end() -> None:
    raise _EnoughError


def _picture(scene: str) -> NDArray[np.uint8]:
    with Simulation(scene=scene, mode="lockstep") as simulation:
        lens = next(agent.intrinsics for agent in simulation.info.agents if agent.name == "view")
        width, height = TILE_PX
        simulation.set_intrinsics(replace(lens, width=width, height=height), agent="view")
        picture: NDArray[np.uint8] = simulation.capture(("rgb",), agent="view").views["rgb"]
        return picture.copy()


if __name__ == "__main__":
    main()
