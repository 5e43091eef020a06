"""Keeping freed memory: the same big arrays are not faulted in again and again."""

from __future__ import annotations

import gc
import inspect
import resource
import subprocess
import sys
import weakref

import numpy as np
import pytest

from sailenv_ros.assets.rooms.pieces import Box, boxes_mesh
from sailenv_ros.frame.lens_rays import ray_lengths
from sailenv_ros.system.memory import cached_for_scenes, forget_scenes
from sailenv_ros.types.camera import CameraIntrinsics
from tests.support import allocator
from tests.support.programs import run

COUNT_FAULTS = """
import resource, sys
import numpy as np
from sailenv_ros.system.memory import keep_freed_memory
def faults():
    return resource.getrusage(resource.RUSAGE_SELF).ru_minflt
def make():
    return [np.full(1_100_000 + 1000 * n, 7, np.uint8) for n in range(10)]
if sys.argv[1] == "keep":
    assert keep_freed_memory()
elif sys.argv[1] == "many scenes":
    assert keep_freed_memory(many_scenes=True)
for _ in range(3):
    make()
before = faults()
for _ in range(10):
    make()
print(faults() - before)
"""


def faults(how: str) -> int:
    """Count the page faults of making big arrays, in a process of its own."""
    return int(run(COUNT_FAULTS, how))


def test_kept_memory_is_not_faulted_in_again() -> None:
    """Arrays of ten megabytes, made anew ten times, cost next to no page faults if they are."""
    assert faults("keep") < 100
    assert faults("many scenes") > 10_000
    assert faults("as it is") > 10_000


@pytest.mark.parametrize("node", ["sim_node", "recorder", "player", "streamer"])
def test_a_node_with_too_few_addresses_says_so(node: str) -> None:
    """Its libraries ended in "Segmentation fault" as they were loaded."""
    few = 700 * 2**20
    done = subprocess.run(
        [sys.executable, "-m", f"sailenv_ros.ros.nodes.{node}"],
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (few, few)),
        capture_output=True,
        text=True,
        timeout=60.0,
    )
    sentence = "this process may have 700 MiB of addresses (ulimit -v), and a node needs 1400 MiB"
    assert (done.returncode, done.stdout) == (1, "")
    assert done.stderr == f"sailenv_ros: {sentence} to start\n"


def test_what_is_told_of_a_memory_error_names_the_limit() -> None:
    """If there is one."""
    program = (
        "import resource; from sailenv_ros.system.memory import no_memory; print(no_memory());"
        "resource.setrlimit(resource.RLIMIT_AS, (2**30, 2**30)); print(no_memory())"
    )
    told = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True).stdout
    sentence = "there is not enough memory for this"
    assert told.splitlines() == [sentence, f"{sentence}: 1024 MiB are allowed (ulimit -v)"]


_FREED = """
import numpy as np
from pathlib import Path
from sailenv_ros.system.memory import give_back_freed_memory, keep_freed_memory

def resident_mib():
    return int(Path("/proc/self/statm").read_text().split()[1]) * 4 // 1024

keep_freed_memory()
blocks = [np.ones(12_000) for _ in range(3000)]
pinned = blocks[::100]  # so that the heap cannot simply end sooner
del blocks
kept = resident_mib()
give_back_freed_memory()
print(kept - resident_mib())
"""


def test_freed_memory_is_given_back() -> None:
    """Of 275 MiB that were freed among blocks in use, nearly all."""
    done = subprocess.run(
        [sys.executable, "-c", _FREED], capture_output=True, text=True, timeout=60, check=True
    )
    assert int(done.stdout) > 200


# The package may be an installed one, beside which no `tests` stand: the program brings its own.
_BLOCKS = f"""{inspect.getsource(allocator)}
import sys
import numpy as np
from sailenv_ros.system.memory import give_back_freed_memory, keep_freed_memory
np.ones(4 << 20, np.uint8)  # glibc takes blocks of this size from its heap from now on
if sys.argv[1] == "kept":
    keep_freed_memory()
if sys.argv[1] != "as it is":
    give_back_freed_memory()
before = allocations().hblks
block = np.ones(2 << 20, np.uint8)
print(allocations().hblks - before)
"""


@pytest.mark.parametrize(("how", "of_its_own"), [("as it is", 0), ("kept", 0), ("given back", 1)])
def test_once_memory_was_given_back_large_blocks_go_back_at_once(how: str, of_its_own: int) -> None:
    """Unless the process has said how it keeps memory: scenes come and go from then on."""
    assert int(run(_BLOCKS, how)) == of_its_own


_HEAPS = """
import ctypes, sys, tempfile, threading
from sailenv_ros.system.memory import share_freed_memory
if sys.argv[1] == "shared":
    assert share_freed_memory()
libc = ctypes.CDLL(None)
libc.malloc.restype = ctypes.c_void_p
libc.fdopen.restype = ctypes.c_void_p
together = threading.Barrier(9)
def work():
    libc.malloc(2000)
    together.wait(30.0)  # each has its heap while the others have theirs
for _ in range(8):
    threading.Thread(target=work).start()
together.wait(30.0)
with tempfile.NamedTemporaryFile() as told:
    file = ctypes.c_void_p(libc.fdopen(told.fileno(), b"w"))
    libc.malloc_info(0, file)
    libc.fflush(file)
    print(open(told.name).read().count("<heap "))
"""


def test_threads_share_what_they_free() -> None:
    """Else each keeps what its largest work took: 40 MiB in a node whose agents come and go."""
    assert int(run(_HEAPS, "shared")) == 1
    assert int(run(_HEAPS, "as it is")) > 4


def test_what_was_cached_for_scenes_is_dropped_with_them() -> None:
    made = []

    @cached_for_scenes(2)
    def picture(edge: int) -> np.ndarray:
        made.append(edge)
        return np.ones((edge, edge))

    first = picture(2)
    assert picture(2) is first
    forget_scenes()
    assert picture(2) is not first
    assert made == [2, 2]
    for edge in (3, 4, 2):
        picture(edge)
    assert made == [2, 2, 3, 4, 2]
    forget_scenes()
    assert picture.cache_info().currsize == 0


def test_what_depends_on_a_camera_is_cached_for_scenes() -> None:
    """In a stream that drifts they would have another one in each room."""
    lens = CameraIntrinsics(width=16, height=16)
    ray_lengths(lens)
    assert ray_lengths.cache_info().currsize > 0
    forget_scenes()
    assert ray_lengths.cache_info().currsize == 0


def test_walls_and_windows_are_kept_no_longer_than_their_scene() -> None:
    frame = [Box(low=(0.0, 0.0, 0.0), high=(1.0, 0.1, 0.1))]
    mesh = weakref.ref(boxes_mesh(frame, chamfer_m=0.01).positions)
    assert mesh() is boxes_mesh(frame, chamfer_m=0.01).positions
    forget_scenes()
    gc.collect()
    assert mesh() is None
