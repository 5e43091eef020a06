"""The geometry of a recorded scene: its scene file and catalogue once more, by a `SceneInfo`.

Messages and recordings have the skeletons of people, not their vertices: these are made again.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from sailenv_ros.errors import InvalidState, UnknownName
from sailenv_ros.frame.frame import Frame
from sailenv_ros.rays.scene_geometry import SceneGeometry
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.types.deformation import Deformation
from sailenv_ros.types.labels import PART_MARK, Instance
from sailenv_ros.types.model import Model
from sailenv_ros.types.scene_info import SceneInfo
from sailenv_ros.world.skin import skin_over_skeleton

__all__ = ["recorded_geometry", "with_skin"]


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


def with_skin(frame: Frame, library: SceneLibrary | None = None) -> Frame:
    """Return a frame from messages or a recording with the vertices of its people.

    With them motion and tracks follow skin. A frame that has them, or no people, is returned as
    it is.

    Parameters
    ----------
    frame : Frame
    library : SceneLibrary or None
        Where people come from; None means what is installed.

    Raises
    ------
    InvalidState
        If the scene of the frame's instant is not known.
    UnknownName, AssetError, InvalidRequest
        If someone cannot be made here, or has other joints than in the frame.
    """
    states = frame.states
    if states is None or states.deformations or not states.skeletons:
        return frame
    if frame.info is None:
        raise InvalidState("a frame of a scene that is not known has no skin")
    library = library or SceneLibrary()
    instances = {one.id: one for one in frame.info.instances}
    shapes: dict[int, Deformation] = {}
    for id_, skeleton in states.skeletons.items():
        asset = library.peek_asset(instances[id_].asset)
        row = states.row(id_)
        scale = float(states.scales[row, 0])
        whole = skin_over_skeleton(asset, skeleton, states.matrices[row], scale)
        shapes[id_] = whole.only(asset.meshes_of(None))
        numbers = _parts_of(instances[id_], frame.info.instances)
        for part in asset.parts:
            shapes[numbers[part.name]] = whole.only(asset.meshes_of(part))
    return replace(frame, states=replace(states, deformations=shapes))


def _parts_of(whole: Instance, instances: Sequence[Instance]) -> dict[str, int]:
    """Return the ids of an object's parts by their names in its asset."""
    mark = whole.name + PART_MARK
    return {
        one.name.removeprefix(mark): one.id
        for one in instances
        if one.is_part and one.name.startswith(mark)
    }
