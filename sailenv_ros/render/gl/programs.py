"""GLSL programs: sources with includes and switches, compiled once per context."""

from __future__ import annotations

import re
from functools import cache
from importlib import resources
from typing import Any

import moderngl

from sailenv_ros.errors import RenderError
from sailenv_ros.native.lens import LENS
from sailenv_ros.types.camera import CameraIntrinsics

__all__ = ["ProgramCache", "set_lens", "set_uniform", "shader_source"]

_INCLUDE = re.compile(r'^#include "([\w.]+)"$', re.MULTILINE)

_FOR_CPP = re.compile(
    r"^#ifdef __cplusplus\n.*?^(?:#else\n(.*?)^)?#endif\n", re.MULTILINE | re.DOTALL
)


@cache
def _read(name: str) -> str:
    """Return a shader, or a header that kernels share with shaders, with all that it includes."""
    native = name.endswith(".h")
    package = "sailenv_ros.native" if native else "sailenv_ros.render.gl"
    folder = resources.files(package) / ("src/kernels" if native else "shaders")
    text = (folder / name).read_text(encoding="utf-8")
    text = _FOR_CPP.sub(lambda match: match[1] or "", text)
    return _INCLUDE.sub(lambda match: _read(match[1]), text)


def shader_source(name: str, switches: tuple[tuple[str, int], ...] = ()) -> str:
    """Return a shader's text with its includes, the version line and the switches defined."""
    defines = "".join(f"#define {key} {value}\n" for key, value in switches)
    return f"#version 430\n{defines}{_read(name)}"


class ProgramCache:
    """Compiles each combination of shaders and switches at most once."""

    def __init__(self, context: moderngl.Context) -> None:
        self._context = context
        self._programs: dict[Any, moderngl.Program] = {}

    def get(self, vertex: str, fragment: str, **switches: int) -> moderngl.Program:
        """Return the program of two shader files.

        Raises
        ------
        RenderError
            If the driver does not accept it; carries the driver's words.
        """
        ordered = tuple(sorted(switches.items()))
        key = (vertex, fragment, ordered)
        if key not in self._programs:
            try:
                self._programs[key] = self._context.program(
                    vertex_shader=shader_source(vertex, ordered),
                    fragment_shader=shader_source(fragment, ordered),
                )
            except moderngl.Error as problem:
                raise RenderError(
                    f"the shaders {vertex} and {fragment} do not compile: {problem}"
                ) from None
        return self._programs[key]

    def close(self) -> None:
        """Free all programs."""
        for program in self._programs.values():
            program.release()
        self._programs.clear()


def set_uniform(program: moderngl.Program, name: str, value: Any) -> None:
    """Set a uniform if the compiler kept it: unused ones vanish from a program."""
    member = program.get(name, None)
    if isinstance(member, moderngl.Uniform):
        member.value = value


def set_lens(program: moderngl.Program, intrinsics: CameraIntrinsics) -> None:
    """Set the numbers of `Lens` (src/kernels/lens.h) that a program reads."""
    assert LENS.names is not None
    for name, number in zip(LENS.names, intrinsics.lens_record[0].item(), strict=True):
        set_uniform(program, f"lens.{name}", number)
