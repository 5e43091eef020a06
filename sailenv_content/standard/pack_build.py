"""Building the standard pack: recipe and fetched sources in, a pack in the user's cache out.

Idempotent: a pack that was built from the same recipe, code and sources is left as it is. What is
damaged or missing of it is made, and the rest of it kept. Some objects can be built before others:
the pack names those that are missing then.
"""

from __future__ import annotations

import hashlib
import multiprocessing
import os
import shutil
import tempfile
from collections.abc import Callable, Collection, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from functools import lru_cache
from importlib import metadata
from pathlib import Path

from sailenv_content.standard.catalogues import LICENCES, Catalogues
from sailenv_content.standard.fetch import fetched
from sailenv_content.standard.prepare import prepare
from sailenv_ros.assets import meshes as asset_meshes
from sailenv_ros.assets.checksums import file_checksum
from sailenv_ros.assets.folders import cache_folder, standard_pack_folder
from sailenv_ros.assets.pack import (
    PACK_FILE,
    AssetPack,
    PackContent,
    PackEntry,
)
from sailenv_ros.assets.pack_writer import packed, write_content
from sailenv_ros.assets.recipe import Recipe, recipe_files, standard_recipe
from sailenv_ros.assets.skies import SKIES, bake_sky
from sailenv_ros.errors import AssetError, UnknownName
from sailenv_ros.extras import need
from sailenv_ros.system.files import (
    UNFINISHED,
    file_lock,
    make_folder,
    remove_unfinished,
    replaced_folder,
    storage_errors,
)
from sailenv_ros.system.parent import end_with_parent

__all__ = ["CREDITS", "build_standard_pack", "damaged_files", "is_current", "licence_files"]

CREDITS = "credits"

Progress = Callable[[str, int, int], None]
"""Called with what was done, how many are done, and of how many."""

_TOOLS = (
    "glb",
    "gltf_description",
    "gltf_emission",
    "hulls",
    "meshes",
    "model_files",
    "obj_polygons",
    "recipe",
    "finishes",
    "simplification",
    "skies",
    "solids",
)
"""Modules beside this folder whose code shapes the result."""

_OPTIONAL = ("coacd", "OpenEXR")
_PURPOSE = "building the furniture pack"

_LIBRARIES = ("trimesh", "coacd", "mapbox_earcut", "numpy")


BUILD_S = 3600.0
"""Time that another process may take to build the pack [s]."""


def is_current(folder: Path | None = None, *, names: Collection[str] | None = None) -> bool:
    """Return whether the pack is undamaged and was made as it would be made now.

    Parameters
    ----------
    folder : Path or None
        None means the standard pack's.
    names : collection of str or None
        Objects that have to be in it; None means all.
    """
    folder = standard_pack_folder() if folder is None else folder
    if not _is_of_now(folder) or damaged_files(folder):
        return False
    pack = AssetPack(folder)
    return not pack.content.missing if names is None else set(names) <= set(pack.entries)


def damaged_files(folder: Path | None = None) -> Mapping[str, str]:
    """Return what is wrong with the pack's files, in words, by their paths in its folder.

    Nothing is wrong where there is no pack.
    """
    folder = standard_pack_folder() if folder is None else folder
    if not (folder / PACK_FILE).exists():
        return {}
    try:
        return AssetPack(folder).problems()
    except AssetError as problem:
        return {PACK_FILE: problem.why}


def _is_of_now(folder: Path) -> bool:
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
    names: Collection[str] | None = None,
) -> Path:
    """Build the pack, unless it is there and whole; return its folder.

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
    names : collection of str or None
        Objects to build now, besides those that are there; the others are missing until the next
        call. None means all.

    Raises
    ------
    UnknownName
        If the pack has no object of a name.
    AssetError
        If the sources are not to be had, or an object cannot be made. Nothing is changed then.
    MissingPackage
        If a package that building needs is not installed.
    StorageError
        If it cannot be written. Nothing is changed then.
    DeadlineExceeded
        If another process kept building it.
    """
    for package in _OPTIONAL:
        need(package, _PURPOSE)  # now, and not after minutes of work
    assets = standard_recipe().assets
    for name in names or ():
        if name not in assets:
            raise UnknownName("object of the standard pack", name, assets)
    folder = standard_pack_folder()
    if is_current(folder, names=names) and not force:
        return folder

    def tell() -> None:
        say("waiting for another process that builds the pack")

    with (
        storage_errors("the pack of furniture", folder),
        file_lock(
            cache_folder() / ".standard_pack.lock",
            "the pack of furniture",
            timeout_s=BUILD_S,
            waiting=tell,
        ),
    ):
        # Another process may have built it meanwhile.
        if force or not is_current(folder, names=names):
            _build(folder, progress=progress, say=say, jobs=jobs, force=force, names=names)
    return folder


def _build(
    folder: Path,
    *,
    progress: Progress,
    say: Callable[[str], None],
    jobs: int | None,
    force: bool,
    names: Collection[str] | None,
) -> None:
    recipe = standard_recipe()
    kept = {} if force else _intact_entries(folder)
    for file, problem in damaged_files(folder).items():
        say(f"{file} {problem} and is made anew")
    furniture = fetched("sweethome3d-furniture", say=say, check=True)
    skies = fetched("blender-data", say=say, check=True)
    make_folder(folder.parent)
    remove_unfinished(folder.parent)  # what a killed build left
    with replaced_folder(folder) as scratch:
        for entry in kept.values():
            shutil.copyfile(folder / entry.file, scratch / entry.file)
        wanted = [
            name for name in recipe.assets if name not in kept and (names is None or name in names)
        ]
        entries = {**kept, **_objects(wanted, furniture, scratch, progress, jobs)}
        _keep_skies(skies, scratch)
        _keep_credits(furniture, recipe, scratch)
        content = PackContent(
            version=1,
            title=recipe.title,
            fingerprint=_fingerprint(),
            assets=tuple(entries[name] for name in recipe.assets if name in entries),
            files=_other_files(scratch),
            missing=tuple(name for name in recipe.assets if name not in entries),
        )
        write_content(scratch, content)


def _intact_entries(folder: Path) -> dict[str, PackEntry]:
    """Return the entries whose files need not be made anew, by name."""
    if not _is_of_now(folder):
        return {}
    pack = AssetPack(folder)
    damaged = pack.problems()
    return {
        name: entry
        for name, entry in pack.entries.items()
        if entry.sha256 and entry.file not in damaged
    }


def _other_files(scratch: Path) -> dict[str, str]:
    """Return the checksums of all but the models, by their paths in the folder."""
    return {
        str(path.relative_to(scratch)): file_checksum(path)
        for folder in (SKIES, CREDITS)
        for path in sorted((scratch / folder).rglob("*"))
        if path.is_file()
    }


def _objects(
    wanted: Sequence[str], furniture: Path, scratch: Path, progress: Progress, jobs: int | None
) -> Mapping[str, PackEntry]:
    """Make objects; return their entries by name."""
    entries: dict[str, PackEntry] = {}
    if not wanted:
        return entries
    # Spawned, because forking a process with threads of GL or DDS may hang.
    context = multiprocessing.get_context("spawn")
    workers = min(jobs or os.cpu_count() or 1, len(wanted))
    with (
        tempfile.TemporaryDirectory(dir=scratch.parent, prefix=".work.", suffix=UNFINISHED) as work,
        ProcessPoolExecutor(
            workers, mp_context=context, initializer=_begin_worker, initargs=(os.getpid(), work)
        ) as pool,
    ):
        waiting = {pool.submit(_make, name, furniture, scratch): name for name in wanted}
        try:
            for done in as_completed(waiting):
                entries[waiting[done]] = done.result()
                progress(waiting[done], len(entries), len(wanted))
        except BaseException:
            pool.shutdown(wait=True, cancel_futures=True)
            raise
    return entries


def _begin_worker(parent: int, work: str) -> None:
    """Leave nothing behind, whatever ends the build: no process and no temporary file."""
    end_with_parent(parent)
    tempfile.tempdir = work


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
        labelled=made.labelled,
        author=made.author,
        licence=made.licence,
        source=made.source,
    )


def _keep_skies(skies: Path, scratch: Path) -> None:
    (scratch / SKIES).mkdir()
    for sky in sorted(skies.glob("*.exr")):
        bake_sky(sky, scratch / SKIES / f"{sky.stem}.npy")
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
    digest = hashlib.sha256()
    for recipe in recipe_files():
        digest.update(recipe.read_bytes())
    content = Path(__file__).parents[1]
    own = sorted(p for room in ("procedural", "standard") for p in (content / room).rglob("*.py"))
    assets = Path(asset_meshes.__file__).parent
    for source in (*own, *(assets / f"{name}.py" for name in _TOOLS)):
        digest.update(source.read_bytes())
    for library in _LIBRARIES:
        if library in _OPTIONAL:
            need(library, _PURPOSE)
        digest.update(f"{library} {metadata.version(library)}".encode())
    return digest.hexdigest()[:16]


def licence_files(folder: Path) -> tuple[Path, ...]:
    """Return the licence and credits files that a pack keeps."""
    return tuple(sorted(path for path in (folder / CREDITS).rglob("*") if path.is_file()))
