"""The standard interfaces where an older version of their package is installed."""

from __future__ import annotations

import logging
import sys
from typing import Any

import pytest

from sailenv_ros.ros.nodes.simulation_interfaces import standard_interfaces

pytestmark = pytest.mark.ros


def test_an_older_version_is_a_warning_and_no_reason_not_to_start(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    """Some types are missing there; the simulator has all its other services."""
    nothing: Any = None
    module = "sailenv_ros.ros.nodes.simulation_interfaces.server"
    monkeypatch.setitem(sys.modules, module, nothing)
    with caplog.at_level(logging.WARNING):
        assert standard_interfaces(nothing, nothing, nothing) is None
    assert "need version 1.5.1 or later" in caplog.text
