"""A disk that fails on demand, and one that loses power: every call of Python's to a folder.

`FaultyDisk` stands between Python and the operating system while it is entered. It counts each
open, write, truncation, fsync, rename, link, removal, new folder and memory map below its folder;
the call of a given number fails. What was done is kept as a log, from which `after_power_loss`
makes every state in which a disk may be found that lost power in between.
"""

from __future__ import annotations

import builtins
import errno
import io
import mmap
import os
import shutil
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

from sailenv_ros.system import files

Kind = Literal["full", "broken", "short"]

ERRNO = {"full": errno.ENOSPC, "broken": errno.EIO, "short": errno.ENOSPC}


@dataclass
class Step:
    """One thing that was done: to a file's bytes, to a folder's names, or to the disk itself."""

    what: Literal[
        "create", "write", "cut", "sync", "syncfs", "rename", "link", "unlink", "mkdir", "rmdir"
    ]
    path: str
    other: str = ""
    offset: int = 0
    data: bytes = b""


@dataclass
class FaultyDisk:
    """Counts and logs; fails the call number `fail_at` (from 1), 0 for none."""

    root: Path
    fail_at: int = 0
    kind: Kind = "full"
    calls: int = 0
    log: list[Step] = field(default_factory=list)
    failed: str = ""

    def __post_init__(self) -> None:
        self._real: dict[tuple[Any, str], Any] = {}
        self._paths: dict[int, str] = {}
        self._full = False

    # -- counting --------------------------------------------------------------------------

    def check(self, what: str, path: object) -> None:
        """Count a call; raise if it is the one that fails."""
        self.calls += 1
        if self.calls == self.fail_at or (self._full and what == "write"):
            self.failed = self.failed or f"{what} {path}"
            self._full = self._full or (what == "write" and self.kind != "broken")
            number = ERRNO[self.kind]
            raise OSError(number, os.strerror(number), str(path))

    def short(self, what: str) -> bool:
        """Return whether a write takes a part alone; those after it then find the disk full."""
        if self.kind != "short" or what != "write" or self.calls + 1 != self.fail_at:
            return False
        self.calls += 1
        self.failed, self._full = "write", True
        return True

    def watched(self, path: object) -> bool:
        """Return whether a path, or an open file's number, is below the folder."""
        if isinstance(path, int):
            return path in self._paths
        try:
            text = os.path.abspath(os.fsdecode(path))  # type: ignore[arg-type]
        except TypeError:
            return False
        return text == str(self.root) or text.startswith(f"{self.root}/")

    def name(self, path: Any) -> str:
        """Return a path relative to the folder."""
        if isinstance(path, int):
            return self._paths[path]
        return os.path.relpath(os.path.abspath(os.fsdecode(path)), self.root)

    # -- what is put in Python's place -----------------------------------------------------

    def __enter__(self) -> FaultyDisk:
        for name in ("open", "close", "fsync", "rename", "replace", "link", "unlink", "mkdir"):
            self._put(os, name, getattr(self, f"_{name}"))
        self._put(os, "remove", self._unlink)
        self._put(os, "rmdir", self._rmdir)
        self._put(io, "open", self._open_file)
        self._put(builtins, "open", self._open_file)
        disk = self

        class FileIO(_FileIO):
            def __init__(self, file: Any, mode: str = "r", *args: Any, **more: Any) -> None:
                super().__init__(disk, file, mode, *args, **more)

        self._put(io, "FileIO", FileIO)
        self._put(mmap, "mmap", self._mmap)
        self._put(files, "_renameat2", self._renameat2)
        self._put(files, "_syncfs", self._syncfs)
        self._put(shutil, "_USE_CP_SENDFILE", False)
        return self

    def __exit__(self, *exc: object) -> None:
        for (owner, name), real in self._real.items():
            setattr(owner, name, real)
        self._real.clear()

    def _put(self, owner: Any, name: str, ours: Any) -> None:
        self._real[owner, name] = getattr(owner, name)
        setattr(owner, name, ours)

    def real(self, owner: Any, name: str) -> Any:
        return self._real[owner, name]

    def _open(self, path: Any, flags: int, mode: int = 0o777, *, dir_fd: int | None = None) -> int:
        if dir_fd is not None or not self.watched(path):
            return int(self.real(os, "open")(path, flags, mode, dir_fd=dir_fd))
        if flags & os.O_DIRECTORY or not os.path.isdir(path):  # else it is about to be removed
            self.check("open", path)
        new = bool(flags & os.O_CREAT) and not os.path.exists(path)
        fd = int(self.real(os, "open")(path, flags, mode))
        self._paths[fd] = self.name(path)
        if new:
            self.log.append(Step("create", self.name(path)))
        return fd

    def _close(self, fd: int) -> None:
        self._paths.pop(fd, None)
        self.real(os, "close")(fd)

    def _fsync(self, fd: Any) -> None:
        number = fd if isinstance(fd, int) else fd.fileno()
        if number not in self._paths:
            self.real(os, "fsync")(fd)
            return
        self.check("fsync", self._paths[number])
        self.log.append(Step("sync", self._paths[number]))

    def _rename(self, old: Any, new: Any, **more: Any) -> None:
        self._named("rename", "rename", old, new, **more)

    def _replace(self, old: Any, new: Any, **more: Any) -> None:
        self._named("replace", "rename", old, new, **more)

    def _link(self, old: Any, new: Any, **more: Any) -> None:
        self._named("link", "link", old, new, **more)

    def _named(self, call: str, what: Any, old: Any, new: Any, **more: Any) -> None:
        if self.watched(new):
            self.check(call, new)
        self.real(os, call)(old, new, **more)
        if self.watched(new):
            self.log.append(Step(what, self.name(old), self.name(new)))

    def _unlink(self, path: Any, *, dir_fd: int | None = None) -> None:
        # Removing a draft is the last thing that is tried: it does not fail here.
        self.real(os, "unlink")(path, dir_fd=dir_fd)
        if dir_fd is None and self.watched(path):
            self.log.append(Step("unlink", self.name(path)))

    def _mkdir(self, path: Any, mode: int = 0o777, **more: Any) -> None:
        if self.watched(path):
            self.check("mkdir", path)
        self.real(os, "mkdir")(path, mode, **more)
        if self.watched(path):
            self.log.append(Step("mkdir", self.name(path)))

    def _rmdir(self, path: Any, *, dir_fd: int | None = None) -> None:
        self.real(os, "rmdir")(path, dir_fd=dir_fd)

    def _renameat2(self, old: Path, new: Path, flags: int) -> bool:
        if self.watched(new):
            self.check("rename", new)
        done = bool(self.real(files, "_renameat2")(old, new, flags))
        if done and self.watched(new):
            self.log.append(Step("rename", self.name(old), self.name(new)))
        return done

    def _syncfs(self, fd: int) -> None:
        if fd in self._paths:
            self.check("syncfs", self._paths[fd])
            self.log.append(Step("syncfs", self._paths[fd]))
        self.real(files, "_syncfs")(fd)

    def _mmap(self, fd: int, *args: Any, **more: Any) -> Any:
        if fd in self._paths:
            self.check("mmap", self._paths[fd])
        return self.real(mmap, "mmap")(fd, *args, **more)

    def _open_file(
        self, file: Any, mode: str = "r", buffering: int = -1, encoding: str | None = None,
        errors: str | None = None, newline: str | None = None, closefd: bool = True,
        opener: Callable[[str, int], int] | None = None,
    ) -> Any:  # fmt: skip
        if not self.watched(file):
            return self.real(io, "open")(
                file, mode, buffering, encoding, errors, newline, closefd, opener
            )
        raw = _FileIO(self, file, mode.replace("b", "").replace("t", ""), closefd)
        if buffering == 0:
            return raw
        if "+" in mode:
            buffered: Any = io.BufferedRandom(raw)
        else:
            buffered = (io.BufferedReader if "r" in mode else io.BufferedWriter)(raw)
        if "b" in mode:
            return buffered
        text = io.TextIOWrapper(buffered, encoding or "utf-8", errors, newline)
        text.mode = mode  # type: ignore[misc]  # as open() does
        return text


class _FileIO(io.FileIO):
    """A file below the folder: each write is counted, and logged with its place."""

    def __init__(
        self, disk: FaultyDisk, file: Any, mode: str, closefd: bool = True, opener: Any = None
    ) -> None:
        self._disk = disk
        self._path = ""
        mine = disk.watched(file)
        if mine and not isinstance(file, int):
            disk.check("open", file)
        new = mine and not isinstance(file, int) and mode[0] in "wx" and not os.path.exists(file)
        super().__init__(file, mode, closefd)
        if mine:
            self._path = disk.name(file)
            disk._paths[self.fileno()] = self._path
            if new:
                disk.log.append(Step("create", self._path))
            elif mode[0] == "w" and not isinstance(file, int):
                disk.log.append(Step("cut", self._path))

    def write(self, data: Any, /) -> int:
        if not self._path:
            return int(super().write(data) or 0)
        view = memoryview(data).cast("B")
        if self._disk.short("write") and len(view) > 1:
            view = view[: len(view) // 2]
        else:
            self._disk.check("write", self._path)
        at = self.tell()
        count = int(super().write(view) or 0)
        self._disk.log.append(Step("write", self._path, offset=at, data=bytes(view[:count])))
        return count

    def truncate(self, size: int | None = None, /) -> int:
        # Cutting back after a failure is what makes a file whole again: it does not fail here.
        result = super().truncate(size)
        if self._path:
            self._disk.log.append(Step("cut", self._path, offset=result))
        return result

    def close(self) -> None:
        if not self.closed and self._path:
            self._disk._paths.pop(self.fileno(), None)
        super().close()


# -- power loss ----------------------------------------------------------------------------


@dataclass
class _Inode:
    now: bytearray
    durable: bytes = b""


def after_power_loss(start: Path, log: list[Step], target: Path) -> Iterator[tuple[int, str, Path]]:
    """Yield each state a disk may be in: how much of the log was done, which state, its folder.

    Bytes that were not synced may be lost or there; so may the names of a folder that was not
    synced. `start` is the folder as it was before, all of it on the disk.
    """
    for done in range(len(log) + 1):
        for variant in ("nothing unsynced", "names alone", "bytes alone", "everything"):
            shutil.rmtree(target, ignore_errors=True)
            _materialise(start, log[:done], variant, target)
            yield done, variant, target


def _materialise(start: Path, log: list[Step], variant: str, target: Path) -> None:
    folders = {"."}
    now: dict[str, _Inode] = {}
    for path in sorted(start.rglob("*")):
        name = str(path.relative_to(start))
        if path.is_dir():
            folders.add(name)
        else:
            now[name] = _Inode(bytearray(path.read_bytes()), path.read_bytes())
    durable = dict(now)
    for step in log:
        _apply(step, now, durable, folders)
    names = now if variant in ("names alone", "everything") else durable
    target.mkdir()
    for folder in sorted(folders - {"."}):
        (target / folder).mkdir(parents=True, exist_ok=True)
    for name, inode in names.items():
        content = bytes(inode.now) if variant in ("bytes alone", "everything") else inode.durable
        (target / name).parent.mkdir(parents=True, exist_ok=True)
        (target / name).write_bytes(content)


def _apply(
    step: Step, now: dict[str, _Inode], durable: dict[str, _Inode], folders: set[str]
) -> None:
    if step.what == "create":
        now[step.path] = _Inode(bytearray())
    elif step.what == "write":
        content = now[step.path].now
        content.extend(bytes(max(0, step.offset - len(content))))
        content[step.offset : step.offset + len(step.data)] = step.data
    elif step.what == "cut":
        del now[step.path].now[step.offset :]
    elif step.what == "mkdir":
        folders.add(step.path)
    elif step.what == "rename":
        now[step.other] = now.pop(step.path)
    elif step.what == "link":
        now[step.other] = now[step.path]
    elif step.what == "unlink":
        now.pop(step.path, None)
    elif step.what == "syncfs":
        for inode in now.values():
            inode.durable = bytes(inode.now)
        durable.clear()
        durable.update(now)
    elif step.what == "sync" and step.path in folders:
        for names in (durable, now):
            inside = [n for n in names if (os.path.dirname(n) or ".") == step.path]
            if names is durable:
                for name in inside:
                    del durable[name]
            else:
                durable.update({name: now[name] for name in inside})
    elif step.what == "sync":
        now[step.path].durable = bytes(now[step.path].now)
