"""Ctrl-C while a program of this package still imports what it needs: it ends without a word.

A traceback out of an import tells nobody anything, and libraries that are interrupted
there say that they are broken. So the system ends the process, until it can end by itself.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType

__all__ = ["catch_interrupts", "end_at_interrupts", "held_interrupts"]

_PROGRAMS = ("sailenv", "sim_node", "recorder", "player")


def end_at_interrupts() -> None:
    """Leave SIGINT to the operating system if this process runs a program of this package.

    A program that imports the package keeps the handler that it has, and so does a
    process that was told to ignore SIGINT.
    """
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler and _is_our_program():
        signal.signal(signal.SIGINT, signal.SIG_DFL)


def catch_interrupts() -> None:
    """Have SIGINT raise `KeyboardInterrupt` again, after `end_at_interrupts`."""
    if signal.getsignal(signal.SIGINT) is signal.SIG_DFL and _is_our_program():
        signal.signal(signal.SIGINT, signal.default_int_handler)


@contextmanager
def held_interrupts() -> Iterator[Callable[[], None]]:
    """Hold Ctrl-C back; yield a function that raises `KeyboardInterrupt` if it was pressed.

    Python raises it anywhere: after a lock is taken and before its owner can release it, or in a
    callback, where it is lost. Who waits for other processes calls the function where it does no
    harm. In other threads than the main one, or beside another handler, nothing is held back.
    """
    ours = (
        threading.current_thread() is threading.main_thread()
        and signal.getsignal(signal.SIGINT) is signal.default_int_handler
    )
    pressed = False

    # No lock: a second Ctrl-C may interrupt this.
    def hold(number: int, frame: FrameType | None) -> None:
        nonlocal pressed
        pressed = True

    def raise_held() -> None:
        if pressed:
            raise KeyboardInterrupt

    if ours:
        signal.signal(signal.SIGINT, hold)
    try:
        yield raise_held
    finally:
        if ours:
            signal.signal(signal.SIGINT, signal.default_int_handler)


def _is_our_program() -> bool:
    # What Python was begun with: it changes sys.argv while it looks for the module of "-m".
    words = sys.orig_argv[1:]
    if "-m" in words[:-1]:
        return words[words.index("-m") + 1].startswith("sailenv_ros.")
    folder, name = os.path.split(sys.argv[0] if sys.argv else "")
    return name in _PROGRAMS and os.path.samefile(folder or ".", os.path.dirname(sys.executable))
