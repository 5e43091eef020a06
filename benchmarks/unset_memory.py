"""Frames do not depend on memory that nobody has written to.

    python -m benchmarks.unset_memory

The native library is built twice: variables that its source leaves unset are filled with zeros by
the one, and with a pattern by the other. Every view of some rooms must have equal bytes. A
sanitizer does not see such variables, and equal runs in one process often find the same there.
`scripts/sanitize` runs this.
"""

from __future__ import annotations

import hashlib
import json
import math
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from sailenv_ros import Simulation, look_at
from sailenv_ros.native.compile import LIBRARY_NAME, compile_library
from sailenv_ros.native.library import LIBRARY_VARIABLE, load_library
from sailenv_ros.simulation.finished_light import bake_missing
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.types.views import RENDERED_VIEWS
from tests.packaging.project import ROOT

FILLS = ("zero", "pattern")
ROOMS = ("room_01", "room_02", "room_03", "generated:kitchen:5", "generated:bathroom:6")
VIEWS_OF_ROOM = 8


def main() -> int:
    """Return 0 if all frames are equal."""
    if sys.argv[1:] == ["--frames"]:
        print(json.dumps(_digests()))
        return 0
    sets = load_library().instruction_sets[-1:]
    made = []
    with tempfile.TemporaryDirectory(prefix="sailenv-unset-") as name:
        for fill in FILLS:
            library = Path(name) / fill / LIBRARY_NAME
            compile_library(library, sets=sets, extra_flags=[f"-ftrivial-auto-var-init={fill}"])
            made.append(_digests_of(library))
    zeros, pattern = made
    differ = [frame for frame, digest in zeros.items() if pattern[frame] != digest]
    print(f"{len(differ)} of {len(zeros)} views depend on unset memory", *differ)
    return int(bool(differ))


def _digests_of(library: Path) -> dict[str, str]:
    done = subprocess.run(
        [sys.executable, "-m", "benchmarks.unset_memory", "--frames"],
        env={**os.environ, LIBRARY_VARIABLE: str(library)},
        cwd=ROOT,
        stdout=subprocess.PIPE,
        text=True,
        timeout=1800,
        check=True,
    )
    found: dict[str, str] = json.loads(done.stdout)
    return found


def _digests() -> dict[str, str]:
    """Return the SHA-256 of each view of each frame."""
    found = {}
    for room in ROOMS:
        world = SceneLibrary().build(room)
        bake_missing(world)  # nothing is mirrored by rays in plain light
        world.close()
        with Simulation(
            room, width=320, height=240, views=RENDERED_VIEWS, mode="lockstep", light="baked"
        ) as simulation:
            for number in range(VIEWS_OF_ROOM):
                turn = 0.8 * number
                eye = (math.cos(1.3 * number), math.sin(1.7 * number), 0.9 + 0.1 * number)
                ahead = (eye[0] + math.cos(turn), eye[1] + math.sin(turn), eye[2] - 0.3)
                simulation.set_pose(look_at(eye, ahead))
                simulation.step(4)
                frame = simulation.capture(RENDERED_VIEWS)
                for view in RENDERED_VIEWS:
                    digest = hashlib.sha256(frame[view].tobytes()).hexdigest()
                    found[f"{room}/{number}/{view}"] = digest
    return found


if __name__ == "__main__":
    sys.exit(main())
