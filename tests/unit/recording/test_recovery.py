"""After a crash: every complete chunk comes back, whatever the moment and wherever it was cut."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
import yaml
from mcap.reader import make_reader
from mcap.writer import Writer
from rosbags.rosbag2 import Reader

from sailenv_ros.cli.main import main
from sailenv_ros.errors import RecordingError
from sailenv_ros.recording.bag_recovery import is_whole, recover
from sailenv_ros.recording.mcap.recovery import recover_file
from sailenv_ros.recording.reader import RecordingReader
from sailenv_ros.recording.topics import RecordedTopic, RecordingOptions
from sailenv_ros.recording.writer import RecordingWriter
from tests.support.recordings import write_noise
from tests.support.waiting import until

pytestmark = pytest.mark.ros

NOTE = RecordedTopic(name="/note", type="std_msgs/msg/String", schema="string data\n")


def numbers(path: Path) -> list[int]:
    """Return the numbers of all messages, read by the format's own library."""
    with path.open("rb") as stream:
        return [m.log_time for _, _, m in make_reader(stream, validate_crcs=True).iter_messages()]


def small_bag(folder: Path) -> None:
    """Write nine messages, three in a chunk."""
    options = RecordingOptions(compression="zstd")
    with RecordingWriter(folder, options) as writer:
        writer.add_topic(NOTE)
        for number in range(9):
            writer.write("/note", (b"\0\1\0\0\4\0\0\0", b"%03d\0" % number), number)
            if number % 3 == 2:
                writer.flush()


@pytest.mark.slow
def test_a_file_cut_at_any_byte_gives_all_complete_chunks(memory_folder: Path) -> None:
    """As after a power loss: for every length of a file, every chunk that is in it comes back."""
    small_bag(memory_folder / "bag")
    whole = (memory_folder / "bag/bag_0.mcap").read_bytes()
    chunk_ends = []
    with (memory_folder / "bag/bag_0.mcap").open("rb") as stream:
        for count, chunk in enumerate(make_reader(stream).get_summary().chunk_indexes, start=1):
            chunk_ends.append((chunk.chunk_start_offset + chunk.chunk_length, 3 * count))
    assert len(chunk_ends) == 3
    cut, out = memory_folder / "cut.mcap", memory_folder / "out.mcap"
    found, known = list[int](), b""
    for size in range(8, len(whole)):
        cut.write_bytes(whole[:size])
        with pytest.raises(RecordingError, match="sailenv bag recover"):
            RecordingReader(cut)
        done = recover_file(cut, out)
        expected = max((count for end, count in chunk_ends if end <= size), default=0)
        assert done.messages == expected
        made = out.read_bytes()
        if made != known:  # the same bytes are read in the same way
            assert is_whole(out)
            found, known = numbers(out), made
        assert found == list(range(expected)), size
        out.unlink()


def test_a_file_with_a_hole_gives_the_chunks_around_it(tmp_path: Path) -> None:
    """Zeros where a chunk's data was cost that chunk alone."""
    small_bag(tmp_path / "bag")
    path = tmp_path / "bag/bag_0.mcap"
    with path.open("rb") as stream:
        second = make_reader(stream).get_summary().chunk_indexes[1]
    data = bytearray(path.read_bytes())
    end = second.chunk_start_offset + second.chunk_length
    data[end - 20 : end] = bytes(20)
    path.write_bytes(data)
    (done,) = recover(path)
    assert (done.messages, done.lost_chunks) == (6, 1)
    assert numbers(path) == [0, 1, 2, 6, 7, 8]
    assert done.kept is not None
    assert done.kept.read_bytes() == data


CHILD = """
import sys
from pathlib import Path
sys.path.insert(0, sys.argv[2])
from sailenv_ros.recording.lockstep import FrameRecorder
from sailenv_ros.recording.topics import RecordingOptions
from sailenv_ros.recording.writer import RecordingWriter
from tests.support.recordings import noise_frame, noise_info
writer = RecordingWriter(Path(sys.argv[1]), RecordingOptions(chunk_bytes=5000))
recorder = FrameRecorder(writer)
recorder.write_info(noise_info())
number = 0
while True:
    number += 1
    recorder.write_frame(noise_frame(number), 10.0)
    writer.flush()
    print(number, flush=True)
"""


def test_a_killed_recorder_leaves_every_frame_that_it_had_written(tmp_path: Path) -> None:
    """After kill -9 at any instant all chunks that were written are restored."""
    bag = tmp_path / "bag"
    wanted = 19
    root = Path(__file__).parents[3]
    child = subprocess.Popen(
        [sys.executable, "-c", CHILD, str(bag), str(root)], stdout=subprocess.PIPE, text=True
    )
    assert child.stdout is not None
    lines: list[str] = []
    until(
        lambda: lines.append(child.stdout.readline()) or len(lines) >= wanted,  # type: ignore[union-attr, func-returns-value]  # a stream by now
        "frames of the child",
        60.0,
    )
    os.kill(child.pid, signal.SIGKILL)
    rest = child.stdout.read()
    child.wait(10.0)
    child.stdout.close()
    said = len([*lines, *rest.splitlines()])
    with pytest.raises(RecordingError, match="sailenv bag recover"):
        RecordingReader(bag)
    (done,) = recover(bag)
    with RecordingReader(bag) as reader:
        rgb = [m.sequence for _, m in reader.messages(["/sailenv/eye/rgb"])]
        infos = [m.sequence for _, m in reader.messages(["/sailenv/eye/frame_info"])]
    assert rgb == list(range(1, len(rgb) + 1))
    assert len(rgb) >= said - 1  # a line can be cut off
    assert len(infos) >= said - 1
    assert done.messages >= 8 * (said - 1)
    with Reader(bag) as other:
        assert sum(1 for _ in other.messages()) == done.messages


def test_the_command_mends_a_bag(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """`sailenv bag recover` restores under the own name and keeps what was damaged."""
    bag = tmp_path / "bag"
    write_noise(bag, 6, RecordingOptions(chunk_bytes=4000))
    path = bag / "bag_0.mcap"
    assert main(["bag", "recover", str(bag)]) == 0
    assert "nothing to restore" in capsys.readouterr().out
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) * 2 // 3])
    (bag / "metadata.yaml").unlink()
    assert main(["bag", "info", str(bag)]) == 2
    assert "sailenv bag recover" in capsys.readouterr().err
    assert main(["bag", "recover", str(bag), "-o", str(tmp_path / "no/where")]) == 2
    assert main(["bag", "recover", str(path), "-o", str(tmp_path / "copy.mcap")]) == 0
    assert is_whole(tmp_path / "copy.mcap")
    assert not is_whole(path)
    assert main(["bag", "recover", str(path)]) == 0
    assert "restored" in capsys.readouterr().out
    assert (bag / "bag_0.mcap.damaged").read_bytes() == whole[: len(whole) * 2 // 3]
    assert main(["bag", "info", str(bag)]) == 0
    assert "/sailenv/eye/rgb" in capsys.readouterr().out
    bag_information = yaml.safe_load((bag / "metadata.yaml").read_text())
    count = bag_information["rosbag2_bagfile_information"]["message_count"]
    with Reader(bag) as reader:
        assert reader.message_count == count == sum(1 for _ in reader.messages()) > 8


def test_what_another_program_left_is_mended_too(tmp_path: Path) -> None:
    """Unchunked messages and definitions within chunks are restored as well."""
    for chunked in (True, False):
        path = tmp_path / f"other_{chunked}.mcap"
        with path.open("wb") as stream:
            writer = Writer(stream, chunk_size=50, use_chunking=chunked)
            writer.start(profile="ros2", library="another")
            schema = writer.register_schema("std_msgs/msg/String", "ros2msg", b"string data\n")
            channel = writer.register_channel("/chat", "cdr", schema)
            for number in range(10):
                writer.add_message(channel, number, bytes(40), number)
            # Not finished.
        recover(path)
        assert numbers(path) == list(range(10))


def test_what_is_no_recording_is_left_alone(tmp_path: Path) -> None:
    """A text is no MCAP file: nothing is written, nothing renamed."""
    path = tmp_path / "text.mcap"
    path.write_text("something else entirely")
    with pytest.raises(RecordingError, match="no MCAP file; there is nothing"):
        recover(path)
    assert [file.name for file in tmp_path.iterdir()] == ["text.mcap"]
    with pytest.raises(RecordingError, match="is not there"):
        recover(tmp_path / "nothing.mcap")


def test_a_full_disk_while_mending_leaves_the_damaged_file(tmp_path: Path) -> None:
    """The damaged file keeps its name until the restored one is complete."""
    from tests.support.recordings import file_size_limit

    small_bag(tmp_path / "bag")
    path = tmp_path / "bag/bag_0.mcap"
    cut = path.read_bytes()[:-10]
    path.write_bytes(cut)
    with file_size_limit(200), pytest.raises(RecordingError, match="disk is full"):
        recover(path)
    assert path.read_bytes() == cut
    assert sorted(file.name for file in path.parent.iterdir()) == ["bag_0.mcap", "metadata.yaml"]
