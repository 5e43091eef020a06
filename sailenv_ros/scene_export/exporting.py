"""Scenes and assets → files of other programs: the steps that all formats have in common."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal, TypeAlias, get_args

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.frame.frame import Frame
from sailenv_ros.scene_export.contents import ExportedScene
from sailenv_ros.scene_export.formats import ASSET_FORMATS, SCENE_FORMATS, Writer
from sailenv_ros.scene_export.gathering import (
    agents_in,
    exported_asset,
    exported_world,
    with_motion,
)
from sailenv_ros.scene_export.losses import RICH, motion_losses
from sailenv_ros.scene_export.motion import Moment, motion_of
from sailenv_ros.scene_export.saving import require_free, save
from sailenv_ros.simulation import Simulation
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.types.geometry import BODY_FROM_OPTICAL, Pose, invert
from sailenv_ros.types.rigid_body import STEPS_PER_SECOND
from sailenv_ros.types.validation import checked_number

__all__ = ["ExportReport", "export_asset", "export_scene"]

_Light: TypeAlias = Literal["lamps", "baked"]

LONGEST_S = 3600.0
"""Latest moment of a scene that is exported [s]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ExportReport:
    """Summary of an export.

    Attributes
    ----------
    file : Path
    folder : Path or None
        Of meshes and pictures beside it; None where the file holds all.
    objects, instances, triangles : int
        Bodies; instances, which labelled parts are too; triangles, shared ones once.
    size_bytes : int
        Of all files.
    losses : tuple of str
        What the format cannot hold, in a sentence each.
    """

    file: Path
    folder: Path | None
    objects: int
    instances: int
    triangles: int
    size_bytes: int
    losses: tuple[str, ...]


def export_scene(
    scene: str | Path | Simulation,
    path: str | Path,
    *,
    at_s: float = 0.0,
    duration_s: float = 0.0,
    rate_hz: float = 24.0,
    frames: Sequence[Frame] = (),
    light: _Light = "lamps",
    overwrite: bool = False,
    allow_modules: bool = False,
) -> ExportReport:
    """Write a scene as a file of another program; the name's end says of which.

    Parameters
    ----------
    scene : str, Path or Simulation
        Name of a scene, a scene file, or ``generated:KIND:SEED``; or one that is simulated, as it
        is now.
    path : str or Path
        Ends in one of `SCENE_FORMATS`. Meshes and pictures of some formats lie in a folder beside
        it, which is called like it.
    at_s : float
        Simulated time of the moment that is written, at most 3600 [s]; 0 for a Simulation.
    duration_s : float
        For so long its motion is written, too [s]; 0 for none, and for a Simulation.
    rate_hz : float
        Samples of the motion a second, at most 240.
    frames : sequence of Frame
        Motion that was captured or recorded of the scene, instead: a sample for each frame.
    light : {'lamps', 'baked'}
        ``baked``, of ``.glb`` and USD: a light map with shadows and bounced light; USD keeps the
        lights for what has none. A room whose light is not baked yet is baked first.
    overwrite : bool
        True replaces both.
    allow_modules : bool
        True runs code of Python modules that a scene file names.

    Raises
    ------
    InvalidRequest, UnknownName
        If the format, the scene or the place cannot be accepted.
    SceneError, AssetError
        If the scene cannot be built.
    StorageError
        If something cannot be written. In every case nothing is left behind.
    """
    path = Path(path)
    steps = round(checked_number("at_s", at_s, 0.0, LONGEST_S, unit="s") * STEPS_PER_SECOND)

    duration = checked_number("duration_s", duration_s, 0.0, LONGEST_S, unit="s")
    rate = checked_number("rate_hz", rate_hz, 0.1, STEPS_PER_SECOND, unit="Hz")
    if duration and frames:
        raise InvalidRequest("duration_s", duration_s, "0 where frames tell the motion")
    if light not in get_args(_Light):
        raise InvalidRequest("light", light, f"one of: {', '.join(get_args(_Light))}")
    if light == "baked" and path.suffix.lower() not in RICH:
        raise InvalidRequest("light", light, f"lamps, as {', '.join(RICH)} alone hold light maps")
    if isinstance(scene, Simulation):
        if steps or duration:
            what, value = ("at_s", at_s) if steps else ("duration_s", duration_s)
            raise InvalidRequest(what, value, "0 for a Simulation: it is written as it is now")
        running = scene
        return _export(
            lambda: _moved(_present(running, light), frames, rate),
            path,
            SCENE_FORMATS,
            overwrite=overwrite,
        )
    described = scene

    def gathered() -> ExportedScene:
        baked = light == "baked"
        library = SceneLibrary(allow_modules=allow_modules, baked_light=baked)
        with closing(library.build(described)) as world:
            if baked:
                # It takes long to import, and who starts a simulator does not need it.
                from sailenv_ros.simulation.finished_light import bake_missing

                bake_missing(world)
            world.step(steps)
            agents = agents_in(world, library.agents_of(world.scene))
            scene = exported_world(world, agents, light=light)
            if duration:
                return with_motion(scene, world, agents, duration, rate)
            return _moved(scene, frames, rate)

    return _export(gathered, path, SCENE_FORMATS, overwrite=overwrite)


def _moved(scene: ExportedScene, frames: Sequence[Frame], rate_hz: float) -> ExportedScene:
    """Return a scene with the motion of frames, if there are any."""
    if not frames:
        return scene
    moments: list[Moment] = []
    epochs: set[tuple[str, int]] = set()
    for frame in frames:
        epochs.add((frame.scene, frame.epoch))
        if len(epochs) > 1:
            raise InvalidRequest("frames", "of several scenes or epochs", "of one scene and epoch")
        if frame.states is None:
            raise InvalidRequest("frames", "without states", "with the states of instances")
        pose = Pose.from_matrix(frame.camera.world_from_camera @ invert(BODY_FROM_OPTICAL))
        moments.append(
            Moment(time_s=1e-9 * frame.stamp_ns, states=frame.states, cameras={frame.agent: pose})
        )
    ids = [body.instance.id for body in scene.bodies]
    return replace(scene, motion=motion_of(moments, ids, rate_hz))


def _present(simulation: Simulation, light: _Light) -> ExportedScene:
    return simulation.read(lambda core: exported_world(core.world, core.agents, light=light))


def export_asset(asset: str, path: str | Path, *, overwrite: bool = False) -> ExportReport:
    """Write an object of the catalogue as a file of another program, with what opens of it.

    Parameters
    ----------
    asset : str
        Its name, e.g. ``chair_01`` or ``wardrobe~hinged:7``.
    path : str or Path
        Ends in one of `ASSET_FORMATS`; see `export_scene`.
    overwrite : bool

    Raises
    ------
    InvalidRequest, UnknownName, AssetError, StorageError
        As of `export_scene`.
    """

    def gathered() -> ExportedScene:
        library = SceneLibrary(baked_light=False)
        return exported_asset(library.peek_asset(asset), library.categories)

    return _export(gathered, Path(path), ASSET_FORMATS, overwrite=overwrite)


def _export(
    gathered: Callable[[], ExportedScene],
    path: Path,
    formats: Mapping[str, Writer],
    *,
    overwrite: bool,
) -> ExportReport:
    writer = formats.get(path.suffix.lower())
    if writer is None:
        accepted = f"one that ends in one of: {', '.join(formats)}"
        if path.suffix.lower() in ASSET_FORMATS:
            accepted += f"; {path.suffix.lower()} holds one object, see `sailenv assets export`"
        raise InvalidRequest("name of the file", path.name, accepted)
    if not path.absolute().parent.is_dir():
        raise InvalidRequest("folder of the file", str(path.parent), "one that exists")
    beside = path.with_name(f"{path.stem}_{path.suffix[1:].lower()}")
    require_free(path, beside, overwrite=overwrite)
    scene = gathered()
    written = writer(scene, beside.name)
    save(written, path, beside)
    meshes = {id(part.mesh): len(part.mesh.triangles) for part in scene.parts}
    return ExportReport(
        file=path,
        folder=beside if written.beside else None,
        objects=len(scene.bodies),
        instances=sum(len(body.pieces) for body in scene.bodies),
        triangles=sum(meshes.values()),
        size_bytes=len(written.data) + sum(map(len, written.beside.values())),
        losses=(*written.losses, *motion_losses(scene, path.suffix.lower())),
    )
