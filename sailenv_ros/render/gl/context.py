"""OpenGL contexts without a window: which EGL devices there are, and one context on one of them.

A context belongs to the thread that makes it. Devices are EGL's own, in EGL's order; no
particular vendor's driver is needed.
"""

from __future__ import annotations

import logging
import os
from dataclasses import dataclass
from typing import Any

import moderngl

from sailenv_ros.errors import ContextError, InvalidRequest

__all__ = ["DeviceReport", "create_context", "is_software", "probe_devices"]

_log = logging.getLogger(__name__)

REQUIRED_GL = 430
"""OpenGL 4.3: what the shaders are written in."""

MAX_DEVICES = 16

_LLVMPIPE_OPTIONS = {"GALLIVM_PERF": "no_aos_sampling"}
"""Set before Mesa's software rasteriser starts, where the user has not: without it byte textures
are interpolated in whole numbers, and rounded down each time. Pictures are up to 2 of 255 darker
then, and not those of graphics hardware; exact interpolation costs nothing that can be measured."""

_SOFTWARE = ("llvmpipe", "softpipe", "swrast", "swiftshader")


@dataclass(frozen=True, slots=True, kw_only=True)
class DeviceReport:
    """Result of trying one EGL device.

    Attributes
    ----------
    index : int
        EGL's number of the device.
    renderer, version : str
        What OpenGL calls itself there; empty where there is no context.
    refused : str
        Why there is none; empty where there is one.
    """

    index: int
    renderer: str = ""
    version: str = ""
    refused: str = ""

    @property
    def software(self) -> bool:
        """True if no graphics hardware is behind it."""
        return is_software(self.renderer)

    def __str__(self) -> str:
        if self.refused:
            return f"EGL device {self.index}: {self.refused}"
        return f"EGL device {self.index}: {self.renderer}, OpenGL {self.version}"


def is_software(renderer: str) -> bool:
    """Return whether a renderer runs on the CPU, by OpenGL's name for it."""
    return any(word in renderer.lower() for word in _SOFTWARE)


def probe_devices() -> tuple[DeviceReport, ...]:
    """Try every EGL device in turn; contexts are released again.

    A driver may hang or crash: who must not, calls this in a process of its own.
    """
    reports = []
    for index in range(MAX_DEVICES):
        try:
            context = _open(index)
        except ContextError as refusal:
            reason = refusal.attempts[0]
            if index and "found" in reason and "devices" in reason:
                break
            reports.append(DeviceReport(index=index, refused=reason))
            if "libEGL" in reason:
                break
        else:
            reports.append(_report(index, context))
            context.release()
    return tuple(reports)


def create_context(device: int | None = None) -> tuple[moderngl.Context, DeviceReport]:
    """Make a context in the calling thread, which alone may use it.

    Parameters
    ----------
    device : int or None
        EGL's number of the device. None takes the first one with graphics hardware, and the
        first of all where there is none, with a warning.

    Raises
    ------
    ContextError
        If there is none; names every device tried and why it was refused.
    """
    if device is not None:
        if isinstance(device, bool) or not isinstance(device, int) or not 0 <= device < MAX_DEVICES:
            raise InvalidRequest("render_device", device, f"a number from 0 to {MAX_DEVICES - 1}")
        context = _open(device)
        return context, _report(device, context)
    reports = probe_devices()
    usable = [report for report in reports if not report.refused]
    if not usable:
        raise ContextError(str(report) for report in reports)
    best = min(usable, key=lambda report: (report.software, report.index))
    for report in reports:
        if report.refused:
            _log.info("not used: %s", report)
    if best.software:
        _log.warning(
            "rendering in SOFTWARE on the CPU (%s): no graphics hardware found", best.renderer
        )
    return _open(best.index), best


def _open(index: int) -> moderngl.Context:
    for name, value in _LLVMPIPE_OPTIONS.items():
        os.environ.setdefault(name, value)
    try:
        settings: dict[str, Any] = {"backend": "egl", "device_index": index}
        return moderngl.create_context(REQUIRED_GL, True, **settings)
    except Exception as problem:
        raise ContextError([str(problem) or type(problem).__name__]) from None


def _report(index: int, context: moderngl.Context) -> DeviceReport:
    info = context.info
    return DeviceReport(
        index=index, renderer=info["GL_RENDERER"], version=info["GL_VERSION"].split(" ")[0]
    )
