"""Prints what the package needs, and extras of it: one requirement a line, for pip to install.

python scripts/requirements.py assets,bake
"""

import sys
from pathlib import Path
from unittest import mock

import setuptools

setup_file = Path(__file__).resolve().parents[1] / "setup.py"
with mock.patch.object(setuptools, "setup") as called:
    exec(
        compile(setup_file.read_text(encoding="utf-8"), setup_file, "exec"),
        {"__file__": str(setup_file)},
    )
described = called.call_args.kwargs
needed = list(described["install_requires"])
for extra in filter(None, sys.argv[1].split(",")):
    needed += described["extras_require"][extra]
print(*dict.fromkeys(needed), sep="\n")
