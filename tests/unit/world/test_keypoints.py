"""Named points of assets: from the pack's file to the objects of a world."""

from __future__ import annotations

from pathlib import Path

from sailenv_ros.assets.categories import load_categories
from sailenv_ros.assets.pack import AssetPack, PackContent
from sailenv_ros.assets.pack_writer import packed, write_content
from sailenv_ros.assets.primitives import Primitives
from sailenv_ros.types.geometry import Pose
from sailenv_ros.world.mover import Mover
from sailenv_ros.world.placement import Placement
from sailenv_ros.world.world import World


def test_keypoints_of_a_pack_are_those_of_its_objects(tmp_path: Path) -> None:
    """In the asset's own frame, times the object's scale."""
    (tmp_path / "pack").mkdir()
    cube = Primitives().load("cube")
    entry = packed(
        tmp_path / "pack", "marked", cube.model.parts, (), display_name="Marked", category="cube",
        mass=1.0, collision="box",
    )  # fmt: skip
    marked = entry.model_copy(update={"keypoints": {"tip": (0.5, 0.0, 0.25)}})
    write_content(tmp_path / "pack", PackContent(version=1, assets=(marked,)))
    asset = AssetPack(tmp_path / "pack").load("marked")
    assert asset.keypoints == (("tip", (0.5, 0.0, 0.25)),)
    placements = [
        Placement(name=name, asset=asset, category_id=1, pose=Pose(), scale=scale, static=True)
        for name, scale in (("one", (1.0, 1.0, 1.0)), ("two", (2.0, 1.0, 4.0)))
    ]
    world = World(
        scene="marked", epoch=1, placements=placements,
        movers=[Mover(name="mover", start=Pose(), track=None, controller="rigidbody")],
        categories=load_categories(),
    )  # fmt: skip
    one, two = (drawn.instance for drawn in world.contents.instances)
    assert one.keypoints[0].position_m == (0.5, 0.0, 0.25)
    assert two.keypoints[0].position_m == (1.0, 0.0, 1.0)
    assert two.low_m == (-1.0, -0.5, -2.0)
    world.close()
