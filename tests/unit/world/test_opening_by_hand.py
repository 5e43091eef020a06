"""People who open drawers and doors: the joint gets to its end, and the hand goes along."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from sailenv_ros.scene.spec_joints import JointSpec
from sailenv_ros.types.geometry import Pose
from sailenv_ros.world.jointed_bodies import JointedBody
from sailenv_ros.world.placement import JointPlacement, Placement
from tests.support.blocks import Block, furniture
from tests.support.peopled_worlds import CATEGORIES, one, person, placed, world_of

DRAWER: Block = ((0.4, 0.5, 0.18), (0.0, 0.0, 0.0))
DOOR: Block = ((0.03, 0.5, 0.8), (0.0, 0.25, 0.0))


def on_joint(block: Block, place: tuple[float, float, float], **joint: Any) -> Placement:
    asset = furniture("part", "cabinet", [block])
    return Placement(
        name="part",
        asset=asset,
        category_id=CATEGORIES.named(asset.category).id,
        pose=Pose(place),
        mass_kg=2.0,
        joint=JointPlacement(
            spec=JointSpec(**joint), parent="cabinet", parent_from_rest=Pose(place)
        ),
    )


def cabinet() -> Placement:
    asset = furniture("cabinet", "cabinet", [((0.45, 0.6, 1.2), (-0.25, 0.0, 0.0))])
    return placed("cabinet", asset, 0.0, 0.0, static=True)


@pytest.mark.parametrize(
    ("part", "end"),
    [
        (on_joint(DRAWER, (-0.2, 0.0, 0.8), type="slide", axis=(1, 0, 0), limits=(0, 0.3)), 0.3),
        (
            on_joint(DOOR, (0.0, -0.25, 0.3), type="hinge", axis=(0, 0, -1), limits=(0, 1.6)),
            1.6,
        ),
    ],
    ids=["drawer", "door"],
)
def test_one_opens_by_hand_and_closes(part: Placement, end: float) -> None:
    world = world_of(person("anna", 1.4, 0.4), cabinet(), part)
    anna = one(world, "anna")
    moving = world.body(world.find("part"))
    assert isinstance(moving, JointedBody)
    world.step(4)
    for goal in (end, 0.0):
        assert anna.walker.open("part"), anna.walker.problem
        farthest, seen = 0.0, []
        for _ in range(800):
            world.step(8)
            seen.append(anna.walker.activity)
            _, speed = moving.joint_state()
            if abs(speed) > 0.05:
                names, joints = anna.skeleton().joint_names, anna.skeleton().joints
                wrists = joints[[names.index(f"wrist.{side}") for side in "LR"]]
                handle = anna.walker._does._handle  # type: ignore[union-attr]
                matrix = moving.world_from_body()
                held = matrix[:3, :3] @ handle + matrix[:3, 3]
                nearer = float(np.linalg.norm(wrists - held, axis=1).min())
                farthest = max(farthest, nearer)
            if seen[-1] == "standing":
                break
        assert seen[-2] == "reaching"
        assert moving.joint_state()[0] == pytest.approx(goal, abs=0.45 * end if goal else 0.01)
        assert 0.05 < farthest < 0.3  # a hand's length
    world.close()


def test_what_is_no_door_or_out_of_reach_is_refused() -> None:
    high = on_joint(DRAWER, (-0.2, 0.0, 2.2), type="slide", axis=(1, 0, 0), limits=(0, 0.3))
    world = world_of(person("anna", 1.4, 0.4), cabinet(), high)
    anna = one(world, "anna")
    world.step(4)
    for name in ("cabinet", "anna", "nothing"):
        assert not anna.walker.open(name)
    if anna.walker.open("part"):
        for _ in range(400):
            world.step(8)
            if anna.walker.activity == "standing":
                break
    part = world.body(world.find("part"))
    assert isinstance(part, JointedBody)
    assert part.joint_state()[0] == pytest.approx(0.0, abs=1e-6)
    world.close()
