"""Contact of people who lie on beds and couches, by rays of its own at each vertex of their skin.

    python benchmarks/lying.py [--people 7]

Prints for each piece how deep skin is in it at most, lying and on the way there, and how far the
head, the hips and the heels hover.
"""

from __future__ import annotations

import argparse
import contextlib

import numpy as np

from sailenv_content.people.fetch_bodies import fetch_bodies
from sailenv_content.people.looks import people
from sailenv_ros.assets.asset_library import AssetLibrary
from sailenv_ros.assets.categories import load_categories
from sailenv_ros.assets.sources import installed_sources
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.model import Model
from sailenv_ros.world.height_fields import heights_at
from sailenv_ros.world.mover import Mover
from sailenv_ros.world.person_body import PersonBody
from sailenv_ros.world.placement import Placement
from sailenv_ros.world.skin import contact_skin
from sailenv_ros.world.world import World

PIECES = (
    *("bed_01", "bed_02", "bed~slatted:1", "bed~panelled:2", "bed~upholstered:3", "bed~iron:4"),
    *("bed~platform:5", "bed~drawers:6", "couch_02", "couch_03"),
)
SHANK = ("lowerleg01", "foot", "toe1-1")
RESTING = (
    ("head", "neck02", "neck03"),
    ("root", "spine05", "spine04", "upperleg01.L", "upperleg01.R"),
    ("foot.L", "lowerleg01.L"),
)
STOCK = AssetLibrary(installed_sources())
CATEGORIES = load_categories()


def world_with(piece: str, who: str) -> World:
    """Return a world of a floor, a piece, and a person beside it."""

    def placed(name: str, asset: str, x: float, y: float, *, static: bool = False) -> Placement:
        found = STOCK.get(asset)
        category = CATEGORIES.named(found.category).id
        pose = Pose((x, y, 0.0))
        return Placement(name=name, asset=found, category_id=category, pose=pose, static=static)

    return World(
        scene="lying",
        placements=[
            placed("ground", "plane", 0.0, 0.0, static=True),
            placed("piece", piece, 0.0, 0.0, static=True),
            placed("person", who, 2.2, 1.0),
        ],
        movers=[Mover(name="mover", start=Pose(), track=None, controller="rigidbody")],
        categories=CATEGORIES,
    )


def depths(body: PersonBody, model: Model) -> tuple[np.ndarray, np.ndarray]:
    """Return (V,) depths of skin and clothes below what a ray from above meets [m], and joints."""
    skin = contact_skin(body.placement.asset)
    matrix = body.world_from_body()
    places = skin.places(body.walker.posture) @ matrix[:3, :3].T + matrix[:3, 3]
    tops = heights_at(model, (1.0, 1.0, 1.0), places[:, :2])
    return np.where(tops < 0.0, -np.inf, tops - places[:, 2]), skin.joints


def main() -> None:
    """Print the figures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--people", type=int, default=7)
    count = parser.parse_args().people
    fetch_bodies()
    names = list(people())[:: max(1, 28 // count)]
    worst = 0.0
    for piece in PIECES:
        model = STOCK.get(piece).model
        lying, way, hovers, refused = 0.0, 0.0, 0.0, []
        for who in names:
            with contextlib.closing(world_with(piece, who)) as world:
                body = next(b for b in world.bodies if isinstance(b, PersonBody))
                rig = body.placement.asset.rig
                assert rig is not None
                world.step(1)
                if not body.walker.lie_on("piece"):
                    refused.append(who)
                    continue
                while body.walker.activity in ("walking", "lying down"):
                    world.step(24)
                    if body.walker.activity == "lying down":
                        found, joints = depths(body, model)
                        hanging = [
                            rig.joint_of[f"{bone}.{side}"] for bone in SHANK for side in "LR"
                        ]
                        way = max(way, float(found[~np.isin(joints, hanging)].max()))
                found, joints = depths(body, model)
                lying = max(lying, float(found.max()))
                for part in RESTING:
                    chosen = np.isin(joints, [rig.joint_of[joint] for joint in part])
                    hovers = max(hovers, -float(found[chosen].max()))
        worst = max(worst, lying)
        print(
            f"{piece}: at most {1e3 * lying:.0f} mm deep, {1e3 * way:.0f} mm on the way; "
            f"head, hips and heels at most {1e3 * hovers:.0f} mm above; "
            f"no room for {', '.join(refused) or 'nobody'}"
        )
    print(f"lying: at most {1e3 * worst:.0f} mm deep")


if __name__ == "__main__":
    main()
