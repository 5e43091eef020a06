"""The geometry of a recorded scene: its scene file and catalogue once more, by a `SceneInfo`."""

from __future__ import annotations

from sailenv_ros.errors import UnknownName
from sailenv_ros.rays.scene_geometry import SceneGeometry
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.types.labels import PART_MARK
from sailenv_ros.types.model import Model
from sailenv_ros.types.scene_info import SceneInfo

__all__ = ["recorded_geometry"]


def recorded_geometry(info: SceneInfo, library: SceneLibrary | None = None) -> SceneGeometry:
    """Return the geometry of a scene as it was when that was told of it.

    What the scene's file names is built as it is now; what was spawned besides is taken from the
    catalogue by its name there.

    Parameters
    ----------
    info : SceneInfo
        `Frame.info` of a recorded frame.
    library : SceneLibrary or None
        Where scenes and assets come from; None means what is installed.

    Raises
    ------
    UnknownName
        If there is no such scene, or an asset is not in the catalogue: of models that were
        uploaded to a simulator, `SceneGeometry` takes the geometry of that simulation.
    SceneError, AssetError
        If the scene cannot be built.
    """
    library = library or SceneLibrary()
    world = library.build(info.scene)
    try:
        own = {drawn.instance.name: drawn for drawn in world.contents.instances}
        bodies = {body.placement.name: body.placement.asset for body in world.bodies}
    finally:
        world.close()
    # Before parts were told apart, recordings knew whole objects alone.
    divided = {instance.parent for instance in info.instances if instance.is_part}
    models: dict[int, Model] = {}
    for instance in info.instances:
        drawn = own.get(instance.name)
        if drawn is not None and drawn.instance.asset == instance.asset:
            whole = not instance.is_part and instance.id not in divided
            models[instance.id] = bodies[instance.name].model if whole else drawn.model
        elif instance.asset.partition(PART_MARK)[0] in library.knowledge.assets:
            if instance.is_part or instance.id in divided:
                models[instance.id] = library.assets.drawn_model(instance.asset)
            else:
                models[instance.id] = library.peek_asset(instance.asset).model
        else:
            raise UnknownName("asset", instance.asset, library.spawnables)
    return SceneGeometry(models)
