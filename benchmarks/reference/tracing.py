"""Traced pictures by what they depend on: kept in the cache, traced where they are missing.

A scene of `export` and its cameras in, linear radiance out. Mitsuba runs in a process and an
environment of its own (`trace.py`, made by `setup`).
"""

from __future__ import annotations

import hashlib
import json
import subprocess
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.system.user_folders import cache_folder

__all__ = ["HOME", "ToolMissing", "Traced", "missing_views", "run_tool", "traced_views"]

HERE = Path(__file__).resolve().parent
HOME = cache_folder() / "reference"

METHOD = 3
"""Of `trace.py`: another number makes all traced pictures stale."""

_ENVIRONMENT_S = 7200.0

Dict = dict[str, Any]


class ToolMissing(Exception):
    """The tracer's environment has not been made."""


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Traced:
    """Result of the path tracer.

    Attributes
    ----------
    radiance, raw : (H, W, 3) float32
        Linear, denoised and not.
    halves : (2, H, W, 3) float32
        Of either half of the samples by itself, denoised.
    noise, noise_denoised : float
        Median over the pixels of the estimated relative error of either.
    seconds : float
        What it took [s].
    """

    radiance: NDArray[np.float32]
    raw: NDArray[np.float32]
    halves: NDArray[np.float32]
    noise: float
    noise_denoised: float
    seconds: float


def traced_views(
    name: str,
    scene: Dict,
    sensors: Mapping[str, Dict],
    samples: int,
    *,
    may_trace: bool = True,
    or_last: bool = False,
) -> dict[str, Traced]:
    """Return the traced pictures of a scene by the names of its cameras.

    Parameters
    ----------
    name : str
        Of the scene, for file names.
    scene : dict
        See `export.scene_of`; its parts lie in ``HOME / "parts"``.
    sensors : mapping of str to dict
        See `export.sensor`.
    samples : int
        Per pixel.
    may_trace : bool
        False takes what is there.
    or_last : bool
        True takes, of what is missing, the last one of that scene's and camera's name and size:
        the scene has been changed since.

    Raises
    ------
    ToolMissing
        If something is to be traced, and `setup` has not been run.
    CalledProcessError
        If tracing failed.
    """
    files = {view: _file(name, view, scene, sensors[view], samples) for view in sensors}
    missing = missing_views(files)
    for view in missing if or_last else ():
        files[view] = _last(name, view, sensors[view]["film"]) or files[view]
    missing = missing_views(files)
    if missing and may_trace:
        _trace(name, scene, {view: (sensors[view], files[view]) for view in missing}, samples)
    return {view: _read(file) for view, file in files.items() if file.exists()}


def missing_views(files: Mapping[str, Path]) -> list[str]:
    """Return which views have no file yet."""
    return [view for view, file in files.items() if not file.exists()]


def run_tool(script: str, *arguments: str | Path, capture: bool = False) -> str:
    """Run a script of this folder in the tracer's environment; return what it printed if captured.

    Raises
    ------
    ToolMissing
        If there is no such environment.
    CalledProcessError
        If it failed.
    """
    python = HOME / "venv" / "bin" / "python"
    if not python.exists():
        raise ToolMissing(f"there is no {python}; make it with {HERE / 'setup'}")
    command = ["nice", "-n", "10", str(python), str(HERE / script), *map(str, arguments)]
    done = subprocess.run(
        command,
        check=True,
        text=True,
        timeout=_ENVIRONMENT_S,
        stdout=subprocess.PIPE if capture else None,
    )
    return done.stdout or ""


def _file(name: str, view: str, scene: Dict, sensor: Dict, samples: int) -> Path:
    # Names of parts are hashes of their content, so this text says all that the light depends on.
    text = json.dumps([METHOD, scene, sensor, samples], sort_keys=True)
    digest = hashlib.sha256(text.encode()).hexdigest()[:16]
    return HOME / "traces" / f"{name}-{view}-{digest}.npz"


def _last(name: str, view: str, film: Dict) -> Path | None:
    """Find the file that was written last for a camera's name and size."""
    found = sorted((HOME / "traces").glob(f"{name}-{view}-*.npz"), key=lambda f: f.stat().st_mtime)
    size = (film["height"], film["width"], 3)
    return next((file for file in reversed(found) if _is_of(file, size)), None)


def _is_of(file: Path, size: tuple[int, int, int]) -> bool:
    """Tell if a file is of a size, and not of before halves were kept."""
    with np.load(file) as stored:
        return "halves" in stored and stored["radiance"].shape == size


def _trace(name: str, scene: Dict, views: Mapping[str, tuple[Dict, Path]], samples: int) -> None:
    (HOME / "traces").mkdir(parents=True, exist_ok=True)
    listed: Sequence[Dict] = [
        {"name": view, "sensor": sensor, "output": str(file)}
        for view, (sensor, file) in views.items()
    ]
    job = {
        "name": name,
        "scene": scene,
        "parts": str(HOME / "parts"),
        "samples": samples,
        "views": listed,
    }
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "job.json"
        file.write_text(json.dumps(job), encoding="utf-8")
        run_tool("trace.py", file)


def _read(file: Path) -> Traced:
    with np.load(file) as stored:
        return Traced(
            radiance=stored["radiance"],
            raw=stored["raw"],
            halves=stored["halves"],
            noise=float(stored["noise"]),
            noise_denoised=float(stored["noise_denoised"]),
            seconds=float(stored["seconds"]),
        )
