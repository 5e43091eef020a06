"""Renews the state of Fast DDS that a forked process must not keep: its identity and held locks.

Fast DDS makes some things once in a process. The first eight bytes of every GUID are one of them:
vendor, host, process id, a random number. A process that is forked later inherits these, and the
count of participants that the last four bytes come from. So the first participants of all such
processes have one GUID, and one that hears two of them takes them for one: of two agents that exist
at the same time, at least one never finds its simulator.

The keepers of shared memory are others. Their locks may be held, in the moment of the fork, by
threads that exist in the parent alone: then the first message from shared memory blocks for good.
That is not rare, because glibc's `fork` has the allocator's locks all the while: a thread that
allocates or frees meanwhile waits, with what else it holds.

One lock cannot be reached from here: that of glibc's `sem_open`, which Fast DDS calls when it opens
a port of a new participant. A process forked in that moment blocks as its context is made.

Knows nothing of ROS.
"""

from __future__ import annotations

import ctypes
import logging
import os

__all__ = ["renew_inherited_dds"]

_log = logging.getLogger(__name__)

LIBRARY = "libfastrtps.so.2.14"
"""Fast DDS of ROS 2 Jazzy, as the loader names it."""

_SCOPE = "ZN8eprosima7fastdds4rtps"
"""Variables of functions are named by the Itanium C++ ABI, as GCC and Clang do on Linux."""

_IDENTITY = f"{_SCOPE}9GuidUtils8instanceEvE9singleton"

_MADE_ONCE = (
    _IDENTITY,
    f"{_SCOPE}7UUIDGen8instanceEvE18singleton_uuid_gen",
    f"{_SCOPE}15SharedMemGlobal4Port9WatchTask3getEvE19watch_task_instance",
    f"{_SCOPE}16SharedMemManager14SegmentWrapper9WatchTask3getEvE19watch_task_instance",
    f"{_SCOPE}17SharedMemWatchdog3getEvE18watch_dog_instance",
)
"""Singletons that their first user creates; a guard variable tells whether each exists."""

_MUTEX = f"_Z{_SCOPE}17SharedSegmentBase4mtx_EvE4mtx_"

_MUTEX_BYTES = 40
"""Size of a ``pthread_mutex_t`` on x86-64, all zeros when free; larger ones end in padding [B]."""


def renew_inherited_dds(library: str = LIBRARY) -> bool:
    """Have Fast DDS make again what another process made, if this is a fork of it.

    To be called before a ROS context is made. Contexts that were inherited have lost their threads
    and do not work, before it and after it.

    Parameters
    ----------
    library : str
        Fast DDS, as the loader names it.

    Returns
    -------
    renewed : bool
        False if nothing has been made yet, or by this process itself.
    """
    try:
        fast_dds = ctypes.CDLL(library, mode=os.RTLD_NOLOAD | os.RTLD_NOW)
    except OSError:
        return False  # nobody has used it yet, or another middleware is used
    try:
        identity = (ctypes.c_uint8 * 12).in_dll(fast_dds, f"_Z{_IDENTITY}")
        guards = [ctypes.c_uint64.in_dll(fast_dds, f"_ZGV{name}") for name in _MADE_ONCE]
        mutex = (ctypes.c_uint8 * _MUTEX_BYTES).in_dll(fast_dds, _MUTEX)
    except ValueError as missing:
        _log.warning("agents of forked processes may not find a simulator: %s", missing)
        return False
    # Fast DDS writes the lower half of the process id there.
    process_id = int.from_bytes(bytes(identity[4:6]), "little")
    if not guards[0].value or process_id == os.getpid() & 0xFFFF:
        return False
    for guard in guards:
        guard.value = 0
    ctypes.memset(mutex, 0, _MUTEX_BYTES)
    return True
