"""Imports a model in a process of its own: bytes or a file in, an `Asset` out.

Reading an untrusted model takes memory, time and Python's lock, and native code looks at every byte
of it. The child has limits of memory, processor time and file size and a low priority; the
simulation continues meanwhile, and whatever becomes of the child is a sentence.
"""

from __future__ import annotations

import contextlib
import json
import os
import resource
import signal
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sailenv_ros.errors import AssetError, InvalidRequest, SailenvError
from sailenv_ros.simulation.models.asset_file import read_asset, write_asset
from sailenv_ros.simulation.models.uploads import asset_from_upload, checked_upload
from sailenv_ros.system.files import storage_errors
from sailenv_ros.system.parent import end_with_parent
from sailenv_ros.types.model import Asset

__all__ = [
    "FILE_LIMITS",
    "UPLOAD_LIMITS",
    "ImportLimits",
    "import_file_apart",
    "import_upload_apart",
]

NICENESS = 10

_DATA, _ANSWER, _ASSET = "data", "answer.json", "asset"


@dataclass(frozen=True, slots=True, kw_only=True)
class ImportLimits:
    """Limits of an import.

    Attributes
    ----------
    memory_bytes : int
        Address space of the process [B].
    time_s : float
        Until it is ended, its start included [s].
    file_bytes : int
        Of any one file that it writes [B].
    """

    memory_bytes: int = 4 * 2**30
    time_s: float = 90.0
    file_bytes: int = 2**30


UPLOAD_LIMITS = ImportLimits()
FILE_LIMITS = ImportLimits(memory_bytes=8 * 2**30, time_s=900.0)


def import_upload_apart(
    data: bytes, *, name: str, filename: str, limits: ImportLimits = UPLOAD_LIMITS, **settings: Any
) -> Asset:
    """Import uploaded bytes in a process of its own.

    See `uploads.asset_from_upload` for the arguments.

    Raises
    ------
    InvalidRequest, AssetError
        As `asset_from_upload`, and if the import passes a limit or its process dies.
    """
    checked_upload(data, name=name, filename=filename)
    with (
        storage_errors(f"the model {filename!r}", Path(tempfile.gettempdir())),
        tempfile.TemporaryDirectory(prefix="sailenv-import-") as place,
    ):
        folder = Path(place)
        (folder / _DATA).write_bytes(data)
        return _answer(
            folder, "upload", filename, {"name": name, "filename": filename, **settings}, limits
        )


def import_file_apart(path: Path, *, limits: ImportLimits = FILE_LIMITS, **settings: Any) -> Asset:
    """Import a file in a process of its own; see `assets.importing.import_asset`.

    Raises
    ------
    InvalidRequest, AssetError
        As `import_asset`, and if the import passes a limit or its process dies.
    """
    with tempfile.TemporaryDirectory(prefix="sailenv-import-") as name:
        return _answer(Path(name), "file", path.name, {"path": str(path), **settings}, limits)


def _answer(
    folder: Path, kind: str, shown: str, settings: Mapping[str, Any], limits: ImportLimits
) -> Asset:
    """Have the child import and read what it wrote."""
    task = {
        "kind": kind,
        "settings": dict(settings),
        "memory_bytes": limits.memory_bytes,
        "time_s": limits.time_s,
        "file_bytes": limits.file_bytes,
        "parent": os.getpid(),
    }
    status = _run(folder, json.dumps(task), limits.time_s)
    if status is None:
        raise AssetError(shown, f"importing it took longer than {limits.time_s:g} s, the limit")
    try:
        answer = json.loads((folder / _ANSWER).read_bytes()[:100_000])
        refused = answer.get("refused")
    except (OSError, ValueError, AttributeError):
        raise AssetError(shown, _death(status, limits)) from None
    if refused is None:
        return read_asset(folder / _ASSET)
    if refused["kind"] == "InvalidRequest":
        raise InvalidRequest(*(str(refused[key]) for key in ("what", "got", "accepted")))
    raise AssetError(str(refused["asset"]), str(refused["why"]))


def _run(folder: Path, task: str, time_s: float) -> int | None:
    """Run the child; return its status, None if it took too long."""
    package_parent = str(Path(__file__).resolve().parents[3])
    path = os.environ.get("PYTHONPATH", "")
    process = subprocess.Popen(
        [sys.executable, "-m", __name__, str(folder)],
        env={
            **os.environ,
            "PYTHONPATH": os.pathsep.join([package_parent, *([path] if path else [])]),
            "PYTHONSAFEPATH": "1",  # not a package of this name that lies in the current folder
            "TMPDIR": str(folder),  # goes with the folder, however the child ends
            "OMP_NUM_THREADS": "1",
            "OPENBLAS_NUM_THREADS": "1",
        },
        cwd=folder,
        stdin=subprocess.PIPE,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        # A Ctrl-C at the terminal is for the parent, which then ends this.
        start_new_session=True,
    )
    try:
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.communicate(task.encode(), time_s)
            return process.returncode
        return None
    finally:
        process.kill()
        process.wait()


def _death(status: int, limits: ImportLimits) -> str:
    if status in (-signal.SIGXCPU, -signal.SIGKILL):
        return f"importing it took more processor time than {limits.time_s:g} s, the limit"
    memory = f"{limits.memory_bytes / 2**30:g} GiB"
    how = f"signal {-status}" if status < 0 else f"status {status}"
    return f"the process that imported it ended with {how}; it may need more than {memory} memory"


# -- the child -----------------------------------------------------------------------------


def _serve(folder: Path) -> None:
    task = json.loads(sys.stdin.buffer.read())
    end_with_parent(task["parent"])
    _load_libraries()
    _limit(task)
    answer: dict[str, Any] = {"refused": None}
    try:
        write_asset(folder / _ASSET, _imported(folder, task["kind"], task["settings"]))
    except AssetError as problem:
        answer = {"refused": {"kind": "AssetError", "asset": problem.asset, "why": problem.why}}
    except InvalidRequest as problem:
        told = {"what": problem.what, "got": str(problem.got)[:200], "accepted": problem.accepted}
        answer = {"refused": {"kind": "InvalidRequest", **told}}
    except (MemoryError, RecursionError):
        answer = _refused(folder, "it is too large or nested too deep")
    except (OSError, SailenvError) as problem:
        answer = _refused(folder, f"it cannot be imported ({problem})")
    (folder / _ANSWER).write_text(json.dumps(answer), encoding="utf-8")


def _refused(folder: Path, why: str) -> dict[str, Any]:
    (folder / _ASSET).unlink(missing_ok=True)
    return {"refused": {"kind": "AssetError", "asset": "model", "why": why}}


def _imported(folder: Path, kind: str, settings: Mapping[str, Any]) -> Asset:
    if kind == "upload":
        return asset_from_upload((folder / _DATA).read_bytes(), **settings)
    from sailenv_ros.assets.importing import import_asset

    path = Path(settings["path"])
    return import_asset(path, **{k: v for k, v in settings.items() if k != "path"})


def _load_libraries() -> None:
    """Load what reads models before memory is limited.

    OpenBLAS never stops asking for its buffer where it cannot have one as it is loaded.
    """
    import scipy.linalg  # noqa: F401  # loaded for its library
    import trimesh  # noqa: F401


def _limit(task: Mapping[str, Any]) -> None:
    os.nice(NICENESS)
    seconds = max(1, int(task["time_s"]))
    for kind, most in (
        (resource.RLIMIT_AS, int(task["memory_bytes"])),
        (resource.RLIMIT_CPU, seconds),
        (resource.RLIMIT_FSIZE, int(task["file_bytes"])),
        (resource.RLIMIT_CORE, 0),
    ):
        hard = resource.getrlimit(kind)[1]
        resource.setrlimit(kind, (most if hard < 0 else min(most, hard),) * 2)


if __name__ == "__main__":
    _serve(Path(sys.argv[1]))
