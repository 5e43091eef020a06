"""Results as files: one JSON for each experiment in a folder, with what it must be read with.

A dict in, a file out, and back. Knows no experiment and no plot.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.system.files import make_folder, storage_errors, write_file

__all__ = ["EXPERIMENTS", "load_result", "save_result"]

EXPERIMENTS = ("flow_speed", "flow_accuracy", "detection", "throughput", "streams", "endless")
"""Names of the experiments, in the report's order."""

VERSION = 1


def save_result(
    folder: Path, experiment: str, provenance: Mapping[str, Any], data: Mapping[str, Any]
) -> Path:
    """Write a result as ``<experiment>.json``; numbers that are not finite become null.

    Returns
    -------
    path : Path

    Raises
    ------
    StorageError
        If it cannot be written.
    """
    path = folder / f"{experiment}.json"
    result = {
        "version": VERSION,
        "experiment": experiment,
        "provenance": dict(provenance),
        "data": data,
    }
    text = json.dumps(_plain(result), indent=1, ensure_ascii=False, allow_nan=False)
    with storage_errors("the result", path):
        make_folder(folder)
        write_file(path, (text + "\n").encode())
    return path


def load_result(folder: Path, experiment: str) -> dict[str, Any] | None:
    """Read a result; None if there is none.

    Raises
    ------
    InvalidRequest
        If the file is not a result of this version.
    """
    path = folder / f"{experiment}.json"
    if not path.exists():
        return None
    try:
        result = json.loads(path.read_text(encoding="utf-8"))
        version = result["version"]
    except (OSError, ValueError, KeyError, TypeError) as problem:
        raise InvalidRequest(str(path), str(problem), "a result that `sailenv` wrote") from None
    if version != VERSION or result.get("experiment") != experiment:
        raise InvalidRequest(
            str(path), f"version {version}", f"a result of {experiment}, version {VERSION}"
        )
    return dict(result)


def _plain(value: Any) -> Any:
    """Turn NumPy's numbers and tuples into JSON's."""
    if isinstance(value, Mapping):
        return {str(key): _plain(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(entry) for entry in value]
    if hasattr(value, "tolist"):
        return _plain(value.tolist())
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
