"""Ctrl-C while a program imports: no traceback. Programs of others keep their own handlers."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

INTERRUPTED = "import os, signal, time\nos.kill(os.getpid(), signal.SIGINT)\ntime.sleep(60.0)\n"


@pytest.mark.parametrize(
    ("library", "words"),
    [
        ("numpy", ["sailenv_ros.cli.main", "scene", "list"]),
        ("rclpy", ["sailenv_ros.ros.nodes.sim_node"]),
        ("rclpy", ["sailenv_ros.ros.nodes.recorder"]),
    ],
)
def test_ctrl_c_within_an_import_ends_without_a_word(
    tmp_path: Path, library: str, words: list[str]
) -> None:
    """The library that is imported just then is one that is interrupted for certain."""
    (tmp_path / f"{library}.py").write_text(INTERRUPTED)
    done = subprocess.run(
        [sys.executable, "-m", *words],
        env={**os.environ, "PYTHONPATH": os.pathsep.join([str(tmp_path), *filter(None, sys.path)])},
        capture_output=True,
        text=True,
        timeout=60.0,
    )
    assert (done.returncode, done.stdout, done.stderr) == (-signal.SIGINT, "", "")


@pytest.mark.parametrize("handler", ["default_int_handler", "SIG_IGN", "SIG_DFL"])
def test_programs_of_others_keep_their_handler(handler: str) -> None:
    """Importing the package changes nothing there."""
    program = (
        f"import signal; signal.signal(signal.SIGINT, signal.{handler});"
        f"import sailenv_ros.cli.main; sailenv_ros.cli.main.catch_interrupts();"
        f"assert signal.getsignal(signal.SIGINT) == signal.{handler}"
    )
    subprocess.run([sys.executable, "-c", program], check=True, timeout=60.0)
