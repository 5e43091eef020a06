"""Scenes and assets → files of other programs: the steps that all formats have in common."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.scene_export.contents import ExportedScene
from sailenv_ros.scene_export.formats import ASSET_FORMATS, SCENE_FORMATS, Writer
from sailenv_ros.scene_export.gathering import agents_in, exported_asset, exported_world
from sailenv_ros.scene_export.saving import require_free, save
from sailenv_ros.simulation import Simulation
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.types.rigid_body import STEPS_PER_SECOND
from sailenv_ros.types.validation import checked_number

__all__ = ["ExportReport", "export_asset", "export_scene"]

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

    if isinstance(scene, Simulation):
        if steps:
            raise InvalidRequest("at_s", at_s, "0 for a Simulation: it is written as it is now")
        running = scene
        return _export(lambda: _present(running), path, SCENE_FORMATS, overwrite=overwrite)
    described = scene

    def gathered() -> ExportedScene:
        library = SceneLibrary(allow_modules=allow_modules, baked_light=False)
        with closing(library.build(described)) as world:
            world.step(steps)
            agents = agents_in(world, library.agents_of(world.scene))
            return exported_world(world, agents)

    return _export(gathered, path, SCENE_FORMATS, overwrite=overwrite)


def _present(simulation: Simulation) -> ExportedScene:
    return simulation.read(lambda core: exported_world(core.world, core.agents))


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
        losses=written.losses,
    )
