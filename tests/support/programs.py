"""Programs of their own: what a fresh process prints."""

from __future__ import annotations

import subprocess
import sys


def run(code: str, *arguments: str) -> str:
    """Run a program of its own; return what it prints."""
    result = subprocess.run(
        [sys.executable, "-c", code, *arguments], capture_output=True, text=True, check=True
    )
    return result.stdout.strip()
