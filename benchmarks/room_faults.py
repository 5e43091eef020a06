"""Count faults of baked light in plausible views of scenes: dashes at edges, bright spots.

    python -m benchmarks.room_faults room_01 generated:living_room:2 [--views 20] [--output DIR]

Views are 1024×768, chosen by a seed (`tests/support/plausible_views.py`); what counts as a fault
stands in `tests/support/light_faults.py`. Looked at are walls, floors and ceilings. With `--output`
each view is written there with its faults marked: dashes red, spots in a blue frame.
"""

from __future__ import annotations

import argparse
import itertools
from pathlib import Path

import cv2
import numpy as np

from sailenv_ros.render.contract import RenderRequest
from sailenv_ros.render.cpu.renderer import NativeRenderer
from tests.support.light_faults import BLOCK_PX, bright_spots, dashes, surfaces_of
from tests.support.plausible_views import plausible_views, room_at_rest

STRUCTURE = ("wall", "floor", "ceiling")
VIEWS = ("rgb", "instance", "normals", "albedo")


def counted(name: str, views: int, output: Path | None) -> list[tuple[int, int]]:
    """Return how many pixels of dashes and how many squares of spots each view has."""
    room = room_at_rest(name)
    categories = [drawn.instance.category for drawn in room.contents.instances]
    structure = room.contents.instance_ids[np.isin(categories, STRUCTURE)]
    renderer = NativeRenderer()
    found: list[tuple[int, int]] = []
    try:
        cameras = plausible_views(room, renderer, f"spots{name}", width=1024, height=768)
        for number, camera in enumerate(itertools.islice(cameras, views)):
            seen = renderer.render(RenderRequest(room, camera, VIEWS)).views
            plain = np.isin(seen["instance"], structure)
            surfaces = surfaces_of(seen["instance"], seen["normals"], plain)
            lines = dashes(seen["rgb"], seen["albedo"], surfaces)
            spots = bright_spots(seen["rgb"], seen["albedo"], surfaces)
            found.append((len(lines), len(spots)))
            if output is not None:
                picture = np.ascontiguousarray(seen["rgb"][..., ::-1])
                picture[tuple(lines.T)] = 0, 0, 255
                for v, u in (spots * BLOCK_PX).tolist():
                    corner = u + BLOCK_PX, v + BLOCK_PX
                    cv2.rectangle(picture, (u, v), corner, (255, 0, 0), 1)
                cv2.imwrite(str(output / f"{name.replace(':', '_')}_{number:02}.png"), picture)
    finally:
        renderer.close()
    return found


def main() -> None:
    """Count and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenes", nargs="+")
    parser.add_argument("--views", type=int, default=20)
    parser.add_argument("--output", type=Path)
    args = parser.parse_args()
    if args.output is not None:
        args.output.mkdir(parents=True, exist_ok=True)
    for name in args.scenes:
        found = counted(name, args.views, args.output)
        dark, bright = (sum(column) for column in zip(*found, strict=True))
        faulty, worst = sum(map(any, found)), max(dashes for dashes, _ in found)
        print(
            f"{name}: dashes {dark} px, at most {worst} in a view; spots {bright} squares; "
            f"in {faulty} of {len(found)} views"
        )


if __name__ == "__main__":
    main()
