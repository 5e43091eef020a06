"""Prints what the package needs, and extras of it: one requirement a line, for pip to install.

    python scripts/requirements.py assets,bake

In the place of sailenv-msgs, which no index has, stands what it needs itself.
"""

import sys
from pathlib import Path
from unittest import mock

import setuptools

try:
    import tomllib
except ModuleNotFoundError:  # Python 3.10
    from pip._vendor import tomli as tomllib

root = Path(__file__).resolve().parents[1]
program = compile((root / "setup.py").read_text(encoding="utf-8"), root / "setup.py", "exec")
with mock.patch.object(setuptools, "setup") as called:
    exec(program, {"__file__": str(root / "setup.py")})
described = called.call_args.kwargs
needed = list(described["install_requires"])
for extra in filter(None, sys.argv[1].split(",")):
    needed += described["extras_require"][extra]
messages = tomllib.loads((root / "sailenv_msgs" / "pyproject.toml").read_text(encoding="utf-8"))
if messages["project"]["name"] in needed:
    needed.remove(messages["project"]["name"])
    needed += messages["project"]["dependencies"]
print(*dict.fromkeys(needed), sep="\n")
