"""Building the standard pack: recipe and fetched sources in, a pack in the user's cache out.

Idempotent: a pack that was built from the same recipe, code and sources is left as it is.
"""

from __future__ import annotations

import hashlib
import multiprocessing
import os
import shutil
from collections.abc import Callable, Mapping
from concurrent.futures import ProcessPoolExecutor, as_completed
from functools import lru_cache
from importlib import metadata
from pathlib import Path

from sailenv_ros.assets.pack import AssetPack, PackContent, PackEntry
from sailenv_ros.assets.pack_writer import packed, replaced_folder, write_content
from sailenv_ros.assets.places import standard_pack_folder
from sailenv_ros.assets.standard.catalogues import LICENCES, Catalogues
from sailenv_ros.assets.standard.fetch import fetched
from sailenv_ros.assets.standard.prepare import prepare
from sailenv_ros.assets.standard.recipe import Recipe, standard_recipe
from sailenv_ros.errors import AssetError
from sailenv_ros.resources import resource_path

__all__ = ["CREDITS", "SKIES", "build_standard_pack", "is_current"]

CREDITS = "credits"
SKIES = "skies"

Progress = Callable[[str, int, int], None]
"""Called with what was done, how many are done, and of how many."""

_TOOLS = ("glb", "hulls", "meshes", "model_files", "obj_polygons", "solids")
"""Modules beside this folder whose code shapes the result."""

_LIBRARIES = ("trimesh", "meshoptimizer", "coacd", "mapbox_earcut", "numpy")


def is_current(folder: Path | None = None) -> bool:
    """Tell if the pack is there and was made as it would be made now."""
    folder = standard_pack_folder() if folder is None else folder
    try:
        return AssetPack(folder).content.fingerprint == _fingerprint()
    except AssetError:
        return False


def build_standard_pack(
    *,
    progress: Progress = lambda *_: None,
    say: Callable[[str], None] = lambda _: None,
    jobs: int | None = None,
    force: bool = False,
) -> Path:
    """Build the pack, unless it is there; give its folder.

    Parameters
    ----------
    progress : callable
        ``progress(name, done, of)`` after each object.
    say : callable
        Is told what is downloaded.
    jobs : int or None
        Processes at work; None takes one for each core.
    force : bool
        Build it even if it is there.

    Raises
    ------
    AssetError
        If the sources are not to be had, or an object cannot be made. Nothing is changed then.
    """
    folder = standard_pack_folder()
    if is_current(folder) and not force:
        return folder
    recipe = standard_recipe()
    furniture = fetched("sweethome3d-furniture", say=say)
    skies = fetched("blender-data", say=say)
    with replaced_folder(folder) as scratch:
        entries = _objects(recipe, furniture, scratch, progress, jobs)
        _keep_skies(skies, scratch)
        _keep_credits(furniture, recipe, scratch)
        content = PackContent(
            version=1,
            title=recipe.title,
            fingerprint=_fingerprint(),
            assets=tuple(entries[name] for name in recipe.assets),
        )
        write_content(scratch, content)
    return folder


def _objects(
    recipe: Recipe, furniture: Path, scratch: Path, progress: Progress, jobs: int | None
) -> Mapping[str, PackEntry]:
    entries: dict[str, PackEntry] = {}
    # Spawned, because forking a process with threads of GL or DDS may hang.
    context = multiprocessing.get_context("spawn")
    workers = jobs or os.cpu_count() or 1
    with ProcessPoolExecutor(workers, mp_context=context) as pool:
        waiting = {pool.submit(_make, name, furniture, scratch): name for name in recipe.assets}
        try:
            for done in as_completed(waiting):
                entries[waiting[done]] = done.result()
                progress(waiting[done], len(entries), len(waiting))
        except BaseException:
            pool.shutdown(wait=True, cancel_futures=True)
            raise
    return entries


@lru_cache(maxsize=1)
def _catalogues(furniture: Path) -> Catalogues:
    return Catalogues(furniture)


def _make(name: str, furniture: Path, scratch: Path) -> PackEntry:
    """Make one object, in a process of its own."""
    recipe = standard_recipe()
    entry = recipe.assets[name]
    made = prepare(name, entry, _catalogues(furniture))
    hulled = entry.collision in ("pieces", "hull", "convex", "base")
    return packed(
        scratch,
        name,
        made.parts,
        made.hulls,
        display_name=recipe.display_name(name),
        category=entry.category,
        mass=entry.mass,
        collision="hulls" if hulled else entry.collision,
        tags=(*entry.tags, made.title.lower()),
        author=made.author,
        licence=made.licence,
        source=made.source,
    )


def _keep_skies(skies: Path, scratch: Path) -> None:
    (scratch / SKIES).mkdir()
    for sky in sorted(skies.glob("*.exr")):
        shutil.copyfile(sky, scratch / SKIES / sky.name)
    notice = scratch / CREDITS / "blender-data"
    notice.mkdir(parents=True)
    for text in sorted(skies.glob("*.txt")):
        shutil.copyfile(text, notice / text.name)


def _keep_credits(furniture: Path, recipe: Recipe, scratch: Path) -> None:
    """Keep every licence text and credits file of what was used."""
    catalogues = _catalogues(furniture)
    for library, text in catalogues.credits():
        place = scratch / CREDITS / library
        place.mkdir(parents=True)
        (place / "LICENSE.TXT").write_text(text, encoding="utf-8")
    for entry in recipe.assets.values():
        if entry.source.partition("/")[0] in LICENCES:
            listed = catalogues.entry(entry.source)
            for name, data in catalogues.notices(listed):
                place = scratch / CREDITS / listed.library / f"{listed.model}-{name}"
                place.write_bytes(data)


@lru_cache(maxsize=1)
def _fingerprint() -> str:
    """Hash all that the pack depends on: recipe, our code, the libraries' versions."""
    digest = hashlib.sha256(resource_path("config", "standard_pack.yaml").read_bytes())
    own = Path(__file__).parent
    for source in (*sorted(own.rglob("*.py")), *(own.parent / f"{name}.py" for name in _TOOLS)):
        digest.update(source.read_bytes())
    for library in _LIBRARIES:
        digest.update(f"{library} {metadata.version(library)}".encode())
    return digest.hexdigest()[:16]


def licence_files(folder: Path) -> tuple[Path, ...]:
    """Give the licence and credits files that a pack keeps."""
    return tuple(sorted(path for path in (folder / CREDITS).rglob("*") if path.is_file()))
