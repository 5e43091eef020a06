"""A small dark floor with its baked light, and things that can move on it."""

from __future__ import annotations

from dataclasses import replace

from sailenv_ros.light.bake.pipeline import bake
from sailenv_ros.light.relight.baked_scene import BakedScene
from sailenv_ros.light.relight.baked_scene_store import BakedSceneStore
from sailenv_ros.light.relight.movable_objects import MovableObjects
from sailenv_ros.light.relight.object_light import PlacedObject
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.lights import Environment, Light
from sailenv_ros.types.model import Model
from sailenv_ros.types.snapshot import WorldSnapshot
from tests.support.bake_scenes import COARSE, DARK, ground
from tests.support.tiny_scenes import Thing, box_mesh, model_of, snapshot_of

BLACK = (0.0, 0.0, 0.0, 1.0)
FLOOR = ground(2.0, base_colour=BLACK)
BOX = model_of(box_mesh(0.2), base_colour=BLACK)
WHITE_SKY = Environment(background="colour", background_colour=(0.8, 0.8, 0.8))
LAMP = Light(name="lamp", type="point", position_m=(0.0, 0.0, 2.0))
IN_THE_AIR = Pose((0.0, 0.0, 1.0))


def room(
    *things: tuple[Model, Pose],
    environment: Environment = DARK,
    lights: tuple[Light, ...] = (),
    floor: Model = FLOOR,
) -> WorldSnapshot:
    """A small floor, dark by itself, that stands still, with its light, and what can move."""
    every = [Thing(floor), *(Thing(model, pose) for model, pose in things)]
    snapshot = snapshot_of(every, environment=environment, lights=lights)
    contents = snapshot.contents
    first, *others = contents.instances
    still = replace(first, instance=replace(first.instance, static=True))
    snapshot = replace(snapshot, contents=replace(contents, instances=(still, *others)))
    light = bake(snapshot, settings=COARSE)
    return replace(snapshot, contents=replace(snapshot.contents, baked=light))


def scene_of(snapshot: WorldSnapshot) -> BakedScene:
    assert snapshot.contents.baked is not None
    return BakedScene(snapshot.contents.baked, snapshot.contents, 1)


def scene_on_disk(snapshot: WorldSnapshot) -> BakedScene:
    """A scene of light that is kept on disk, with nothing found in it yet."""
    scene = BakedSceneStore().scene_of(snapshot.contents, 1)
    scene.baked = replace(scene.baked, checksum="of its file")
    return scene


def moved(snapshot: WorldSnapshot, row: int, x: float) -> WorldSnapshot:
    """A thing at another place."""
    poses = snapshot.world_from_body.copy()
    poses[row, 0, 3] = x
    return replace(snapshot, world_from_body=poses)


def movable_objects(snapshot: WorldSnapshot) -> list[PlacedObject]:
    """The objects of a snapshot that can move."""
    found = MovableObjects()
    found.follow(snapshot)
    return found.things
