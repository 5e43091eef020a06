"""Which renderer draws: names that are accepted, and what is taken where OpenGL fails."""

from __future__ import annotations

import logging

import pytest

from sailenv_ros.errors import ContextError, UnknownName
from sailenv_ros.render import selection
from sailenv_ros.render.contract import BACKEND_NAMES
from sailenv_ros.render.cpu.renderer import NativeRenderer
from sailenv_ros.render.gl import renderer
from sailenv_ros.render.selection import make_backend


def test_a_renderer_that_is_gone_is_refused_with_those_that_are_there() -> None:
    """TinyRenderer is one: the sentence lists what is accepted."""
    assert BACKEND_NAMES == ("auto", "native", "gl")
    with pytest.raises(UnknownName, match=r"renderer .*auto, native, gl"):
        make_backend("tiny", None)  # type: ignore[arg-type]


def test_where_opengl_fails_the_native_renderer_draws(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    """On its own a warning says why; where OpenGL was asked for, the failure is an error."""

    def refuse(**_: object) -> None:
        raise ContextError(["device 0: no driver"])

    monkeypatch.setattr(selection, "graphics_hardware", lambda: 0)
    monkeypatch.setattr(renderer, "Renderer", refuse)
    with caplog.at_level(logging.WARNING):
        made = make_backend("auto", None)
    assert isinstance(made, NativeRenderer)
    made.close()
    assert "no driver" in caplog.text
    with pytest.raises(ContextError, match="no driver"):
        make_backend("gl", None)
