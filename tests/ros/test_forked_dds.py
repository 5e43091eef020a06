"""Processes that are forked after DDS was used have GUIDs and locks of their own all the same."""

from __future__ import annotations

import subprocess
import sys

FORKS = """
import ctypes, os, signal, warnings
import rclpy
from rclpy.context import Context
from rclpy.node import Node
from std_msgs.msg import Empty
from sailenv_ros.system.inherited_dds import LIBRARY, renew_inherited_dds

warnings.simplefilter("ignore", DeprecationWarning)  # Python 3.12 on forks beside threads

def join(process):
    before = renew_inherited_dds()
    context = Context()
    rclpy.init(args=[], context=context)
    # Each under a name of its own, as they hear one another.
    node = Node(process, context=context, use_global_arguments=False, enable_rosout=False)
    node.create_publisher(Empty, "~/said", 1)
    [publisher] = node.get_publishers_info_by_topic(f"/{process}/said")
    own_id = list((os.getpid() & 0xFFFF).to_bytes(2, "little"))
    print(process, before, renew_inherited_dds(), publisher.endpoint_gid[4:6] == own_id, flush=True)
    return node, context

def leave(node, context):
    node.destroy_node()
    context.shutdown()

def fork(process, then=lambda: None):
    child = os.fork()
    if child:
        assert os.waitpid(child, 0)[1] == 0
    else:
        signal.alarm(20)
        joined = join(process)
        then()
        leave(*joined)
        os._exit(0)

joined = join("parent")
fast_dds = ctypes.CDLL(LIBRARY)
mutex = ctypes.c_uint64.in_dll(
    fast_dds, "_ZZN8eprosima7fastdds4rtps17SharedSegmentBase4mtx_EvE4mtx_"
)
# As if a thread that has it had been interrupted by the forks.
assert fast_dds.pthread_mutex_lock(ctypes.byref(mutex)) == 0
fork("child", lambda: fork("grandchild"))
fork("sibling")
assert fast_dds.pthread_mutex_unlock(ctypes.byref(mutex)) == 0
leave(*joined)
leave(*join("parent_again"))
"""


def test_every_fork_makes_its_own() -> None:
    """It renews what it inherited, once; else GUIDs tell of the parent, and the lock blocks."""
    ran = subprocess.run(
        [sys.executable, "-c", FORKS], capture_output=True, text=True, timeout=60, check=False
    )
    assert ran.stdout.splitlines() == [
        "parent False False True",
        "child True False True",
        "grandchild True False True",
        "sibling True False True",
        "parent_again False False True",
    ], ran.stderr
