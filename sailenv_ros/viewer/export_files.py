"""The present scene as a file to download: one that other programs open."""

from __future__ import annotations

import asyncio
import io
import tempfile
import zipfile
from pathlib import Path

from aiohttp import web

from sailenv_ros.errors import SailenvError
from sailenv_ros.scene_export import SCENE_FORMATS, export_scene
from sailenv_ros.simulation import Simulation
from sailenv_ros.viewer.access_control import AccessControl

__all__ = ["ExportFiles"]


class ExportFiles:
    """Answers requests for ``/export/FORMAT``, with ``?light=baked`` in baked light, one at a time.

    Parameters
    ----------
    simulation : Simulation
    access : AccessControl
    deadline_s : float
        Of one answer [s].
    """

    def __init__(self, simulation: Simulation, access: AccessControl, deadline_s: float) -> None:
        self._simulation, self._access, self._deadline_s = simulation, access, deadline_s
        self._one_at_a_time = asyncio.Lock()

    async def answer(self, request: web.Request) -> web.StreamResponse:
        """Return the scene as it is now, as a file of that format."""
        reason = self._access.refusal_of_token(request.query.get("token", ""))
        if reason:
            return web.Response(status=403, text=f"{reason}\n")
        suffix = f".{request.match_info['format']}"
        if suffix not in SCENE_FORMATS:
            accepted = ", ".join(name[1:] for name in SCENE_FORMATS)
            return web.Response(status=404, text=f"a scene is exported as one of: {accepted}\n")
        if self._one_at_a_time.locked():
            return web.Response(status=503, text="another export is being written\n")
        async with self._one_at_a_time:
            try:
                light = request.query.get("light", "lamps")
                making = asyncio.to_thread(exported_file, self._simulation, suffix, light)
                name, data = await asyncio.wait_for(making, self._deadline_s)
            except (SailenvError, asyncio.TimeoutError) as problem:
                text = str(problem) or f"no export within {self._deadline_s:g} s"
                return web.Response(status=500, text=f"{text}\n")
        kept = "".join(letter if letter.isalnum() or letter in "._-" else "_" for letter in name)
        return web.Response(
            body=data,
            content_type="application/octet-stream",
            headers={"Content-Disposition": f'attachment; filename="{kept}"'},
        )


def exported_file(simulation: Simulation, suffix: str, light: str = "lamps") -> tuple[str, bytes]:
    """Return a file's name and bytes; a ZIP archive where the format needs a folder beside it.

    Parameters
    ----------
    simulation : Simulation
    suffix : str
        One of `SCENE_FORMATS`.
    light : str
        As `export_scene` takes it.

    Raises
    ------
    InvalidRequest
        If the format, or the light as it is now, cannot be had.
    """
    stem = Path(simulation.info.scene.replace(":", "_")).stem
    with tempfile.TemporaryDirectory(prefix="sailenv-export-") as folder:
        path = Path(folder) / f"{stem}{suffix}"
        report = export_scene(simulation, path, light=light)  # type: ignore[arg-type]  # it checks
        if report.folder is None:
            return report.file.name, report.file.read_bytes()
        archive = io.BytesIO()
        with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as file:
            for path in (report.file, *sorted(report.folder.rglob("*"))):
                file.write(path, path.relative_to(folder))
        return f"{stem}_{suffix[1:]}.zip", archive.getvalue()
