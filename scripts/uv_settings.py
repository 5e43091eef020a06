"""Prints pip's settings as lines for a shell that set them for uv, so that both ask the same index.

eval "$(.venv/bin/python scripts/uv_settings.py)"
"""

import ast
import shlex
import subprocess
import sys

# How uv calls what pip calls so; of what may be given several times, by what they are divided.
NAMES = {
    "cert": ("SSL_CERT_FILE", None),
    "extra-index-url": ("UV_INDEX", " "),
    "find-links": ("UV_FIND_LINKS", ","),
    "index-url": ("UV_DEFAULT_INDEX", None),
    "no-index": ("UV_NO_INDEX", None),
    "proxy": ("HTTPS_PROXY", None),
    "trusted-host": ("UV_INSECURE_HOST", " "),
}
RANKS = ("global", "user", "site", "install", ":env:")

listed = subprocess.run(
    [sys.executable, "-m", "pip", "config", "list"], capture_output=True, text=True, check=False
).stdout
found: dict[str, tuple[int, str]] = {}
for line in listed.splitlines():
    key, _, written = line.partition("=")
    section, _, name = key.rpartition(".")
    if name in NAMES and section in RANKS:
        found[name] = max(found.get(name, (-1, "")), (RANKS.index(section), written))
for name, (_, written) in found.items():
    variable, divider = NAMES[name]
    try:
        value = str(ast.literal_eval(written))
    except (SyntaxError, ValueError):
        value = written
    value = value if divider is None else divider.join(value.split())
    print(f"export {variable}={shlex.quote(value)}")
# As pip: the best version that any index has.
print("export UV_INDEX_STRATEGY=unsafe-best-match")
