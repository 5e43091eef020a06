"""Commands print in every locale."""

from __future__ import annotations

import io
import os
import subprocess
import sys

import pytest

from sailenv_ros.cli.printing import make_printable


@pytest.mark.parametrize(
    ("encoding", "printed"),
    [
        ("ascii", b"3 x 4 m2, cafe, -> ?, \xc3..."),
        ("latin-1", b"3 \xd7 4 m\xb2, caf\xe9, -> ?, \xc3..."),
        ("utf-8", "3 × 4 m², café, → 木, ".encode() + b"\xc3" + "…".encode()),
    ],
)
def test_what_an_encoding_lacks_is_printed_as_the_nearest(encoding: str, printed: bytes) -> None:
    """Names of files keep their bytes."""
    stream = io.TextIOWrapper(data := io.BytesIO(), encoding=encoding)
    make_printable(stream)
    stream.write("3 × 4 m², café, → 木, \udcc3…")
    stream.flush()
    assert data.getvalue() == printed


def test_help_in_a_locale_without_unicode() -> None:
    """An ellipsis in it ended in a traceback."""
    plain = {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0", "PYTHONIOENCODING": ""}
    done = subprocess.run(
        [sys.executable, "-m", "sailenv_ros.cli.main", "dataset", "make", "--help"],
        env={**os.environ, **plain, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
        capture_output=True,
        timeout=60.0,
    )
    assert (done.returncode, done.stderr) == (0, b"")
    assert b"(s3://...)" in done.stdout
