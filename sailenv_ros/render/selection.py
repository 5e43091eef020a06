"""Selection of the renderer: OpenGL on graphics hardware, or the native library."""

from __future__ import annotations

import logging
from pathlib import Path

from sailenv_ros.errors import ContextError, UnknownName
from sailenv_ros.render.contract import BACKEND_NAMES, BackendName, RenderBackend

__all__ = ["graphics_hardware", "make_backend"]

_log = logging.getLogger(__name__)

_DEVICE_FILES = ("dri/renderD*", "nvidia*", "dxg", "mali*", "kgsl*")
"""Device files of drivers of graphics hardware in /dev; without any there is no such hardware."""


def make_backend(backend: BackendName, device: int | None) -> RenderBackend:
    """Make a renderer in the calling thread, which alone may use it.

    Parameters
    ----------
    backend : {'auto', 'native', 'gl'}
        ``auto`` takes OpenGL on graphics hardware, or on the device that is asked for; else, and
        where OpenGL fails there, the native renderer. A warning tells of the failure.
    device : int or None
        Number of the EGL device.

    Raises
    ------
    ContextError
        If OpenGL was asked for and there is no context.
    NativeLibraryError
        If there is no native library.
    UnknownName
        If there is no back end of that name.
    """
    if backend not in BACKEND_NAMES:
        raise UnknownName("renderer", backend, BACKEND_NAMES)
    if backend == "auto" and device is None:
        device = graphics_hardware()
    if backend == "gl" or (backend == "auto" and device is not None):
        try:
            # Imported here: the native renderer works where moderngl cannot even be imported.
            from sailenv_ros.render.gl.renderer import Renderer

            return Renderer(device=device)
        except (ContextError, ImportError) as problem:
            if backend == "gl":
                raise
            _log.warning("drawing with the native renderer instead of OpenGL: %s", problem)
    from sailenv_ros.render.cpu.renderer import NativeRenderer

    return NativeRenderer()


def graphics_hardware() -> int | None:
    """Return EGL's number of the first device with graphics hardware; None if there is none."""
    if not any(found for pattern in _DEVICE_FILES for found in Path("/dev").glob(pattern)):
        # Asking EGL takes a tenth of a second, and longer where its drivers are not well.
        return None
    try:
        from sailenv_ros.render.gl.context import probe_devices
    except ImportError:
        return None
    reports = probe_devices()
    return next((r.index for r in reports if not r.refused and not r.software), None)
