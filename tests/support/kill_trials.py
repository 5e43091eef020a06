"""Works that are killed on the way: begun in a folder of their own, killed, looked at, done again.

What they leave is compared with an undisturbed run: whatever has a final name is whole, no process
and no segment is left, and the next run ends with the same bytes.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml
from mcap.reader import make_reader

from sailenv_content.standard.fetch import fetched
from sailenv_ros.light.bake.light_files import DIGEST_BYTES, MAGIC
from sailenv_ros.system.files import UNFINISHED
from sailenv_ros.system.user_folders import cache_folder
from tests.support.waiting import until

__all__ = [
    "WORKS",
    "Digests",
    "Work",
    "WorkProcess",
    "files_whole",
    "prepared",
    "run_to_its_end",
]

ROOT = Path(__file__).resolve().parents[2]

Digests = Mapping[str, str]
"""Digests of files by their final names."""

OF_A_RUN = ("seconds", "machine", "machines", "made")
"""Keys of JSON that tell of a run and not of what it made."""

DRAFT = ".draft"
"""End of the names of rough light, which is there until the light is."""

NOTE = ".known"
"""End of the name of what tells the light of a scene file; its name depends on the file's place."""

SEGMENTS = Path("/dev/shm")

GONE_S = 60.0
"""Time in which workers end: one that starts looks for its parent after its imports [s]."""

RECIPE: Mapping[str, Any] = {
    "version": 1,
    "seed": 5,
    "scenes": [{"scene": "optical"}],
    "clips": {"train": 6, "val": 2},
    "clip": {"frames": 4, "rate": 30.0, "per_scene": 2},
    "cameras": [
        {"type": "orbit", "name": "around", "object": "red cube", "width": 96, "height": 64}
    ],
    "views": ["rgb", "depth", "instance", "flow"],
    "formats": ["coco", "webdataset", "mcap"],
    "shard": {"clips": 1},
}  # fmt: skip

ROOM = """version: 1
room: {size: [3, 2.5, 2.4], openings: [{type: window, wall: east}]}
objects:
  - {name: box, asset: cube, position: [0.5, 0.2, 0.5]}
"""

_SHORT_PARTS = """
import sys
from sailenv_ros.cli.main import main
from sailenv_ros.dataset.streams import making

making.PART_FRAMES = 20
sys.exit(main(sys.argv[1:]))
"""
"""A stream's parts of 500 frames would take most of the time."""

FURNITURE = ("apple_01", "book_01", "cup_01")
SKIES = "blender-data"

SAILENV = (sys.executable, "-m", "sailenv_ros.cli.main")


@dataclass(frozen=True, slots=True, kw_only=True)
class Work:
    """A work that can be begun in a folder, as often as one likes.

    Attributes
    ----------
    command : callable
        From the folder to the words of the command.
    made : str
        Name in the folder of what is made.
    prepare : callable
        Makes the folder ready, once.
    """

    command: Callable[[Path], Sequence[str]]
    made: str
    prepare: Callable[[Path], object] = lambda folder: None


_FEW_SKIES = f"""
import sys
from pathlib import Path
from sailenv_content.standard import pack_build
from sailenv_ros.cli.furniture import build_furniture

if __name__ == "__main__":
    fetched = pack_build.fetched
    few = Path(sys.argv[1])
    pack_build.fetched = lambda name, **how: few if name == {SKIES!r} else fetched(name, **how)
    build_furniture(names={FURNITURE}, jobs=2)
"""
"""All skies would take most of the time."""


def _linked_sources(folder: Path) -> None:
    """Have the build find what was downloaded before, and one sky; nothing is changed there."""
    (folder / "cache").mkdir()
    (folder / "cache" / "sources").symlink_to(cache_folder() / "sources")
    (folder / "skies").mkdir()
    shutil.copy(fetched(SKIES) / "night.exr", folder / "skies")


WORKS: Mapping[str, Work] = {
    "stream": Work(
        command=lambda folder: (
            sys.executable, "-c", _SHORT_PARTS, "stream", "solid", "--frames", "100",
            "--views", "instance", "--quiet", "-o", str(folder / "made"),
        ),
        made="made",
    ),
    "dataset": Work(
        command=lambda folder: (
            *SAILENV, "dataset", "make", str(folder / "recipe.yaml"), "--workers", "2",
            "-o", str(folder / "made"),
        ),
        made="made",
        prepare=lambda folder: (folder / "recipe.yaml").write_text(yaml.safe_dump(dict(RECIPE))),
    ),
    "bake": Work(
        command=lambda folder: (*SAILENV, "scene", "bake", str(folder / "room.yaml")),
        made="cache/light",
        prepare=lambda folder: (folder / "room.yaml").write_text(ROOM),
    ),
    "furniture": Work(
        command=lambda folder: (sys.executable, "-c", _FEW_SKIES, str(folder / "skies")),
        made="cache/packs",
        prepare=_linked_sources,
    ),
}  # fmt: skip


class WorkProcess:
    """A command in a session of its own; a context manager that leaves nothing of it.

    Parameters
    ----------
    work : Work
    folder : Path
        All that it writes is in there, temporary files too.
    """

    def __init__(self, work: Work, folder: Path) -> None:
        self._segments: set[Path] = set()
        # Some libraries share theirs with all processes, for ever.
        self._of_others = set(SEGMENTS.iterdir())
        self.temporary = folder / "temporary"
        self.temporary.mkdir(exist_ok=True)
        environment = {
            **os.environ,
            "SAILENV_CACHE": str(folder / "cache"),
            "TMPDIR": str(self.temporary),
            "PYTHONPATH": f"{ROOT}{os.pathsep}{os.environ.get('PYTHONPATH', '')}",
        }
        self._log = (folder / "log").open("w+")
        self._process = subprocess.Popen(
            list(work.command(folder)),
            env=environment,
            stdout=self._log,
            stderr=self._log,
            start_new_session=True,
        )

    @property
    def pid(self) -> int:
        return self._process.pid

    @property
    def ended(self) -> bool:
        return self._process.poll() is not None

    def wait(self, timeout_s: float) -> None:
        """Wait for the end, which must be a good one."""
        status = self._process.wait(timeout_s)
        self._log.seek(0)
        assert status == 0, f"status {status}: {self._log.read()}"

    def kill(self) -> None:
        """End the process by SIGKILL, and await all that it began to be gone as well."""
        self._segments |= set(self._mapped())
        self._process.kill()
        self._process.wait()
        until(lambda: not self.children(), "what a killed process began to be gone", GONE_S)

    def children(self) -> list[int]:
        """Processes of its session that run."""
        return [pid for pid, session in _sessions() if session == self.pid]

    def lasting(self) -> list[str]:
        """Return what a killed process left forever: sockets with a name, and segments."""
        sockets = [path for path in self.temporary.rglob("*") if path.is_socket()]
        return sorted(map(str, [*sockets, *filter(Path.exists, self._segments - self._of_others)]))

    def _mapped(self) -> Iterable[Path]:
        for pid in self.children():
            try:
                maps = Path(f"/proc/{pid}/maps").read_text()
            except OSError:  # gone meanwhile
                continue
            yield from (Path(found) for found in re.findall(r"/dev/shm/\S+", maps))

    def __enter__(self) -> WorkProcess:
        return self

    def __exit__(self, *exc: object) -> None:
        if not self.ended:
            self._process.kill()
            self._process.wait()
        for pid in self.children():
            os.kill(pid, signal.SIGKILL)
        self._log.close()


def run_to_its_end(work: Work, folder: Path, timeout_s: float = 600.0) -> Digests:
    """Do a work, or what is left of it; return what it made.

    Nothing may be left beside it: no draft, and no temporary file of this run or one before.
    """
    with WorkProcess(work, folder) as process:
        process.wait(timeout_s)
        until(lambda: not process.children(), "what a process began to be gone", GONE_S)
        left = [*process.temporary.rglob("*"), *_drafts(folder / work.made)]
        assert not left, f"left behind: {left}"
    return files_whole(work, folder)


def files_whole(work: Work, folder: Path) -> Digests:
    """Return the digests of all that has a final name; ValueError if a file is not whole."""
    digests = {}
    for path in _files(folder, work.made):
        name = str(path.relative_to(folder)).replace(UNFINISHED, "")
        if path.suffix == NOTE:
            name = NOTE
        if path.suffix == DRAFT:
            _digest(path)
        else:
            digests[name] = _digest(path)
    return digests


def prepared(work: Work, folder: Path) -> Path:
    """Make a new folder for a work ready; return it."""
    folder.mkdir(parents=True)
    work.prepare(folder)
    return folder


def _files(folder: Path, made: str) -> Iterable[Path]:
    # A stream grows in a folder beside its place, in which all but drafts is final.
    for place in (folder / made, folder / f"{made}{UNFINISHED}"):
        for path in sorted(place.rglob("*")):
            inside = path.relative_to(place)
            draft = any(part.endswith(UNFINISHED) for part in inside.parts)
            if path.is_file() and not draft and not path.name.endswith(".lock"):
                yield path


def _drafts(place: Path) -> list[Path]:
    beside = place.with_name(f"{place.name}{UNFINISHED}")
    drafts = [path for path in place.rglob("*") if path.name.endswith((UNFINISHED, DRAFT))]
    return drafts + ([beside] if beside.exists() else [])


def _digest(path: Path) -> str:
    """Return a digest of what a file tells of the work, not of the run."""
    data = path.read_bytes()
    if path.suffix == ".mcap":
        digest = hashlib.sha256()
        with path.open("rb") as file:
            for _, channel, message in make_reader(file).iter_messages(log_time_order=False):
                # It says how long rendering took.
                if not channel.topic.endswith("frame_info"):
                    digest.update(f"{channel.topic} {message.log_time} ".encode())
                    digest.update(message.data)
        return digest.hexdigest()
    if path.suffix == ".json":
        return hashlib.sha256(json.dumps(_of_the_work(json.loads(data))).encode()).hexdigest()
    if path.suffix in (".light", DRAFT):
        begin = len(MAGIC) + DIGEST_BYTES
        found = hashlib.blake2b(data[begin:], digest_size=DIGEST_BYTES).digest()
        if data[:begin] != MAGIC + found:
            raise ValueError(f"{path} is not whole")
    return hashlib.sha256(data).hexdigest()


def _of_the_work(value: Any) -> Any:
    if isinstance(value, dict):
        return {name: _of_the_work(one) for name, one in value.items() if name not in OF_A_RUN}
    return [_of_the_work(one) for one in value] if isinstance(value, list) else value


def _sessions() -> Iterable[tuple[int, int]]:
    """Yield each process that runs, and its session."""
    for entry in Path("/proc").iterdir():
        if not entry.name.isdigit():
            continue
        try:
            fields = (entry / "stat").read_text().rpartition(")")[2].split()
        except OSError:  # gone meanwhile
            continue
        if fields[0] != "Z":
            yield int(entry.name), int(fields[3])
