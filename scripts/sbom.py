"""Prints what this Python has installed as a bill of materials: CycloneDX 1.6, JSON.

    python scripts/sbom.py > sbom.json

Nothing in it depends on when it is made: the same environment gives the same bytes.
"""

import json
import re
import sys
from importlib.metadata import Distribution, distributions
from pathlib import Path

HASHES = Path(__file__).resolve().parents[1] / "constraints-hashes.txt"


def plain(name: str) -> str:
    """Return a name as indexes write it."""
    return re.sub(r"[-_.]+", "-", name).lower()


def locked() -> dict[str, list[str]]:
    """Return the SHA-256 of the files of each ``name==version`` on PyPI."""
    found: dict[str, list[str]] = {}
    for entry in HASHES.read_text(encoding="utf-8").split("\n"):
        if pin := re.match(r"([\w.-]+)==([^ ;]+)", entry):
            hashes = found.setdefault(f"{plain(pin[1])}=={pin[2]}", [])
        elif digest := re.search(r"--hash=sha256:([0-9a-f]{64})", entry):
            hashes.append(digest[1])
    return found


def component(package: Distribution, hashes: dict[str, list[str]]) -> dict[str, object]:
    """Return the entry of one package."""
    name, about = plain(package.metadata["Name"]), package.metadata
    told = [
        line.rpartition(" :: ")[2]
        for line in about.get_all("Classifier", [])
        if line.startswith("License ::")
    ]
    licence = about["License-Expression"] or about["License"] or ""
    licence = licence if licence and "\n" not in licence else " AND ".join(told)
    entry: dict[str, object] = {"type": "library", "bom-ref": f"{name}@{package.version}"}
    entry |= {"name": name, "version": package.version}
    if licence:
        entry["licenses"] = [{"license": {"name": licence}}]
    # What is not among the pins was built here, or is a part of another package.
    if digests := hashes.get(f"{name}=={package.version}"):
        files = f"https://pypi.org/project/{name}/{package.version}/#files"
        listed = [{"alg": "SHA-256", "content": digest} for digest in sorted(digests)]
        entry["purl"] = f"pkg:pypi/{name}@{package.version}"
        entry["externalReferences"] = [{"type": "distribution", "url": files, "hashes": listed}]
    return entry


def main() -> None:
    """Print the document."""
    hashes = locked()
    packages = {plain(one.metadata["Name"]): one for one in distributions()}
    own = packages.pop("sailenv-ros")
    document = {
        "bomFormat": "CycloneDX",
        "specVersion": "1.6",
        "version": 1,
        "metadata": {"component": {**component(own, {}), "type": "application"}},
        "components": [component(packages[name], hashes) for name in sorted(packages)],
    }
    json.dump(document, sys.stdout, indent=1)
    print()


if __name__ == "__main__":
    main()
