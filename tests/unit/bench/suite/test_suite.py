"""`sailenv bench all`: parts in processes of their own, records that are kept, one table."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from sailenv_bench.experiments.results import load_result
from sailenv_bench.suite import parts as parts_module
from sailenv_bench.suite.measurement import Measurement, from_plain, median_s, plain
from sailenv_bench.suite.page import figures_page, shown
from sailenv_bench.suite.parts import PARTS, Part, load_part, parts_named
from sailenv_bench.suite.running import Record, kept_records, measure_part, run_parts
from sailenv_ros.cli.main import command_parser, main
from sailenv_ros.errors import InvalidState, UnknownName
from tests.support.waiting import until
from tests.unit.bench.experiments.samples import TOLD

FAST, SLOW = (Part(name=name, title=f"Part {name}", module=f"trivial.{name}") for name in "ab")
ROW = Measurement(name="one | two", value=2.0, unit="ms", other="other", other_value=8.0)


def record_of(part: Part, quick: bool) -> Record:
    """A record as a measured part leaves it."""
    return {"name": part.name, "measurements": [plain(ROW)], "seconds": 30.0, "load": [0.1, 0.2]}


def refuse(part: Part, quick: bool) -> Record:
    """A record as a failed part leaves it."""
    return {"name": part.name, "failed": "no such thing", "seconds": 0.1, "load": [0.1, 0.2]}


@pytest.fixture
def trivial(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A package ``trivial`` whose modules are parts."""
    folder = tmp_path / "trivial"
    folder.mkdir()
    (folder / "__init__.py").touch()
    (folder / "a.py").write_text(
        "from sailenv_bench.suite.measurement import Measurement\n"
        "def measurements(quick):\n"
        "    yield Measurement(name='x', value=1.0 if quick else 2.0, unit='s')\n"
    )
    (folder / "b.py").write_text("def measurements(quick):\n    raise ValueError('it is broken')\n")
    path = os.pathsep.join([str(tmp_path), os.environ.get("PYTHONPATH", "")])
    monkeypatch.setenv("PYTHONPATH", path)
    return folder


def test_a_ratio_is_the_value_by_the_other() -> None:
    """And survives JSON; without another value there is none."""
    assert ROW.ratio == 0.25
    assert from_plain(plain(ROW)) == ROW
    assert plain(ROW)["ratio"] == 0.25
    assert Measurement(name="x", value=1.0, unit="s").ratio is None


def test_the_median_is_that_of_the_calls() -> None:
    """By the clock that is given: 1, 5 and 2 s."""
    ticks = iter([0.0, 1.0, 10.0, 15.0, 20.0, 22.0])
    assert median_s(lambda: None, 3, lambda: next(ticks)) == 2.0


@pytest.mark.parametrize(
    ("value", "text"),
    [(None, ""), (0.0, "0.000"), (1.7e-8, "1.7e-08"), (0.1234, "0.123"), (1.234, "1.23"),
     (12.34, "12.3"), (123.4, "123"), (2157.0, "2157")],
)  # fmt: skip
def test_numbers_have_three_digits(value: float | None, text: str) -> None:
    """Those that count."""
    assert shown(value) == text


def test_parts_are_chosen_by_name() -> None:
    """In the order of the table; all without names; an unknown one is refused by name."""
    first, second = PARTS[0].name, PARTS[1].name
    assert [part.name for part in parts_named([second, first])] == [first, second]
    assert parts_named([]) == PARTS
    with pytest.raises(UnknownName, match=f"did you mean '{first}'"):
        parts_named([first + "s"])
    assert len({part.name for part in PARTS}) == len(PARTS)


def test_a_file_of_the_repository_is_needed(tmp_path: Path) -> None:
    """One sentence says so where the package was installed without it."""
    part = next(part for part in PARTS if "." not in part.module)
    with pytest.raises(InvalidState, match=f"only from a checkout.*benchmarks/{part.module}"):
        load_part(part, tmp_path)


@pytest.mark.parametrize("part", [part for part in PARTS if "." in part.module], ids=str)
def test_parts_of_the_package_can_be_loaded(part: Part) -> None:
    """Each has the function that the process calls."""
    assert callable(load_part(part))


@pytest.mark.parametrize("part", [part for part in PARTS if "." not in part.module], ids=str)
def test_parts_of_the_repository_are_there(part: Part) -> None:
    """Each file has the function that the process calls."""
    source = Path(__file__).parents[4] / part.source
    assert "\ndef measurements(quick: bool) -> Iterator[Measurement]:" in source.read_text()


def test_a_part_is_measured_in_a_process(trivial: Path) -> None:
    """Its rows come back, with time and load."""
    for quick, value in ((True, 1.0), (False, 2.0)):
        record = measure_part(FAST, quick)
        (row,) = map(from_plain, record["measurements"])
        assert (row.name, row.value, row.unit) == ("x", value, "s")
        assert record["name"] == "a"
        assert record["seconds"] > 0.0
        assert len(record["load"]) == 2


def test_a_failure_is_told_by_its_last_line(trivial: Path) -> None:
    """Of an exception, of a module that is not there, of a process that was killed."""
    assert measure_part(SLOW, quick=True)["failed"] == "ValueError: it is broken"
    missing = Part(name="c", title="c", module="trivial.c")
    assert "trivial.c" in measure_part(missing, quick=True)["failed"]
    (trivial / "a.py").write_text("import os\nos.kill(os.getpid(), 9)\n")
    assert measure_part(FAST, quick=True)["failed"] == "it ended with status -9"


def test_a_part_that_takes_too_long_is_ended(
    trivial: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With all processes that it started."""
    pid = trivial / "pid"
    (trivial / "a.py").write_text(
        "import subprocess, sys, time\n"
        "child = subprocess.Popen([sys.executable, '-c', 'import time; time.sleep(600)'])\n"
        f"open({str(pid)!r}, 'w').write(f'{{child.pid}}.')\n"
        "time.sleep(600)\n"
    )

    class LateEnough(subprocess.Popen[bytes]):
        """Lets the timeout pass when the child is there."""

        def wait(self, timeout: float | None = None) -> int:
            if timeout == 4.0:
                until(lambda: pid.exists() and pid.read_text().endswith("."), "the child", 60.0)
                raise subprocess.TimeoutExpired("a", timeout)
            return super().wait(timeout)

    monkeypatch.setattr("sailenv_bench.suite.running.subprocess.Popen", LateEnough)
    record = measure_part(FAST, quick=True, timeout_s=4.0)
    assert record["failed"] == "it did not end within 4 s"
    child = int(pid.read_text()[:-1])
    until(lambda: not _runs(child), "the child to end")


def _runs(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def test_finished_parts_are_kept_and_failed_ones_are_not(tmp_path: Path) -> None:
    """A second run measures what failed, and nothing else."""
    measured: list[str] = []

    def measure(part: Part, quick: bool) -> Record:
        measured.append(part.name)
        return refuse(part, quick) if measured == ["a", "b"] else record_of(part, quick)

    for _ in range(2):
        records = run_parts([FAST, SLOW], tmp_path, TOLD, quick=True, measure=measure)
    assert measured == ["a", "b", "b"]
    assert [record["name"] for record in records] == ["a", "b"]
    result = load_result(tmp_path, "figures")
    assert result is not None
    assert all("measurements" in record for record in result["data"]["parts"])
    assert "machine" not in result["provenance"]


def test_after_ctrl_c_the_next_run_goes_on(tmp_path: Path) -> None:
    """Whatever was finished before it is on the disk."""

    def interrupted(part: Part, quick: bool) -> Record:
        if part is SLOW:
            raise KeyboardInterrupt
        return record_of(part, quick)

    with pytest.raises(KeyboardInterrupt):
        run_parts([FAST, SLOW], tmp_path, TOLD, quick=True, measure=interrupted)
    assert set(kept_records(tmp_path, TOLD, quick=True)) == {"a"}


@pytest.mark.parametrize(
    "other",
    [{"commit": "abd"}, {"cpu": "A slow CPU"}, {"cpus": 1}, {"versions": {"numpy": "3"}}],
    ids=str,
)
def test_records_of_another_state_are_not_kept(tmp_path: Path, other: dict[str, Any]) -> None:
    """Another commit, machine or version, other extent, or a commit with changes."""
    run_parts([FAST], tmp_path, TOLD, quick=True, measure=record_of)
    assert kept_records(tmp_path, TOLD, quick=True)
    assert not kept_records(tmp_path, {**TOLD, **other}, quick=True)
    assert not kept_records(tmp_path, TOLD, quick=False)
    changed = {**TOLD, "commit": "abc+"}
    run_parts([FAST], tmp_path, changed, quick=True, measure=record_of)
    assert not kept_records(tmp_path, changed, quick=True)


def test_the_page_is_one_table(tmp_path: Path) -> None:
    """Every row has five cells; machine, commit, load, a failure and a rough run are told."""
    named = {part.name: part for part in PARTS}
    first, second = list(named)[:2]
    records = [record_of(named[first], True), refuse(named[second], True)]
    page = figures_page(TOLD, {"quick": True, "parts": records, "load_end": [9.0, 8.0, 7.0]})
    rows = [line for line in page.splitlines() if line.startswith("|")]
    assert {len(re.findall(r"(?<!\\)\|", row)) for row in rows} == {6}
    assert r"|one \| two|**0.25**|2.00 ms|other|8.00|" in rows
    assert "|failed: no such thing|||||" in rows
    for told in (TOLD["cpu"], TOLD["commit"], "0.1, 0.2, 0.3", "9.0, 8.0, 7.0", "numpy 2", "rough"):
        assert told in page
    whole = figures_page(TOLD, {"quick": False, "parts": records[:1], "load_end": [0.0]})
    assert "rough" not in whole


def test_the_command_writes_both_files_and_tells_a_failure(
    trivial: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """The status is 1, and the other part is there all the same."""
    monkeypatch.setattr(parts_module, "PARTS", (SLOW, FAST))
    monkeypatch.setattr("sailenv_bench.suite.page.PARTS", (SLOW, FAST))
    output = tmp_path / "out"
    assert main(["bench", "all", "--quick", "-o", str(output)]) == 1
    told = capsys.readouterr()
    assert "1 of 2: b FAILED: ValueError: it is broken" in told.err
    assert "2 of 2: a done" in told.err
    assert sorted(path.name for path in output.iterdir()) == ["figures.json", "figures.md"]
    assert "|x||1.00 s|||" in (output / "figures.md").read_text()
    assert main(["bench", "all", "--quick", "-o", str(output), "--part", "a", "--again"]) == 0
    assert main(["bench", "all", "--quick", "-o", str(output), "--part", "c"]) == 2


def test_ctrl_c_ends_the_command_and_its_part(trivial: Path, tmp_path: Path) -> None:
    """With status 130 and nothing left running."""
    (trivial / "a.py").write_text(
        f"import os, time\nopen({str(trivial / 'pid')!r}, 'w').write(f'{{os.getpid()}}.')\n"
        "time.sleep(600)\n"
    )
    code = (
        "import sys\nfrom sailenv_bench.suite import parts\n"
        "parts.PARTS = (parts.Part(name='a', title='a', module='trivial.a'),)\n"
        "from sailenv_ros.cli.main import main\nsys.exit(main(sys.argv[1:]))"
    )
    words = [sys.executable, "-c", code, "bench", "all", "-o", str(tmp_path / "out")]
    running = subprocess.Popen(
        words,
        stderr=subprocess.PIPE,
        text=True,
        # A shell has its background jobs ignore Ctrl-C, and these tests may be one.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    pid = trivial / "pid"
    until(lambda: pid.exists() and pid.read_text().endswith("."), "the part to begin", 60.0)
    running.send_signal(signal.SIGINT)
    _, errors = running.communicate(timeout=60)
    assert running.returncode == 130, errors
    assert "Traceback" not in errors
    assert not _runs(int(pid.read_text()[:-1]))


def test_options_are_read() -> None:
    """Their defaults are a whole run into the folder of results."""
    args = command_parser(["bench"]).parse_args(["bench", "all"])
    assert (args.quick, args.part, args.again, str(args.output)) == (
        False, [], False, "sailenv_results",
    )  # fmt: skip
    words = ["bench", "all", "--quick", "--again", "--part", "frames", "agent", "-o", "docs"]
    args = command_parser(["bench"]).parse_args(words)
    assert (args.quick, args.part, args.again, str(args.output)) == (
        True, ["frames", "agent"], True, "docs",
    )  # fmt: skip
