"""Which renderer draws: OpenGL where there is a context to be had, else the software fallback."""

from __future__ import annotations

import logging

from sailenv_ros.errors import ContextError, UnknownName
from sailenv_ros.render.backend import BackendName, RenderBackend

__all__ = ["make_backend"]

_log = logging.getLogger(__name__)


def make_backend(backend: BackendName, device: int | None) -> RenderBackend:
    """Make a renderer in the calling thread, which alone may use it.

    Parameters
    ----------
    backend : {'auto', 'gl', 'tiny'}
        ``auto`` takes OpenGL and falls back to ``tiny`` with a warning that says why.
    device : int or None
        Number of the EGL device.

    Raises
    ------
    ContextError
        If OpenGL was asked for and there is no context.
    UnknownName
        If there is no back end of that name.
    """
    if backend not in ("auto", "gl", "tiny"):
        raise UnknownName("renderer", backend, ("auto", "gl", "tiny"))
    if backend != "tiny":
        try:
            # Imported here, so that the fallback works where moderngl cannot even be imported.
            from sailenv_ros.render.renderer import Renderer

            return Renderer(device=device)
        except (ContextError, ImportError) as problem:
            if backend == "gl":
                raise
            _log.warning("falling back to the slow software renderer: %s", problem)
    from sailenv_ros.simulation.tiny_renderer import TinyRenderer

    return TinyRenderer()
