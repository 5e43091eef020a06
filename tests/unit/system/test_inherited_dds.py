"""Without Fast DDS there is nothing to renew; tests/ros has what forks do."""

from __future__ import annotations

import pytest

from sailenv_ros.system.inherited_dds import renew_inherited_dds


def test_a_library_that_is_not_loaded_is_left_so(caplog: pytest.LogCaptureFixture) -> None:
    """Nobody has used it, so nothing was inherited."""
    assert not renew_inherited_dds("libfastrtps.so.0.0")
    assert not caplog.records


def test_another_build_is_told(caplog: pytest.LogCaptureFixture) -> None:
    """Where the variables cannot be found, none is written, and the log says so."""
    assert not renew_inherited_dds("libc.so.6")
    [record] = caplog.records
    assert record.getMessage().startswith("agents of forked processes may not find a simulator: ")
