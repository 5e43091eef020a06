"""Streams of frames, extra views, pictures and boxes of an Agent; simulators that come again."""

from __future__ import annotations

import gc
import os
import signal
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from sailenv_ros import Agent
from sailenv_ros.errors import (
    DeadlineExceeded,
    InvalidRequest,
    SimulationClosed,
    SimulatorLost,
    UnknownName,
)
from tests.ros.conftest import LOCKSTEP, SMALL
from tests.support.sim_node_process import NodeProcess
from tests.support.waiting import until

pytestmark = pytest.mark.ros

NAMESPACE = "/streamed"


def test_a_stream_gives_each_frame_of_its_rate(agent: Agent) -> None:
    """60 Hz is a frame every 4 steps: stamps and dt say so, and no number is left out."""
    stamps, numbers = [], []
    for frame in agent.frames(60.0):
        stamps.append(frame["stamp_ns"])
        numbers.append(frame["sequence"])
        if len(stamps) == 6:
            break
        agent.step(4)
    assert stamps == [round(count * 1e9 / 60 - 0.4) for count in range(6)]
    assert numbers == list(range(1, 7))


def test_an_agent_that_nobody_refers_to_gives_its_place_back(keeper: Agent) -> None:
    """A notebook's cell that runs again and again locks nobody out: the most are 16."""
    for number in range(20):
        agent = Agent(**SMALL, namespace="/streamed")
        assert agent.get_frame()["sequence"] == 1
        seen = iter(agent.frames(60.0))
        next(seen)
        name = agent.id
        agent.itself = agent  # type: ignore[attr-defined]  # as a cell's leftovers may do
        del agent, seen
        gc.collect()
        until(
            lambda name=name: name not in {one.name for one in keeper.info.agents},  # type: ignore[misc]
            f"agent number {number} to be gone",
        )


def test_a_slow_reader_gets_the_newest(agent: Agent) -> None:
    """Frames that were passed over show as gaps in the numbers; the newest is what comes."""
    stream = agent.frames(240.0)
    first = next(stream)
    agent.step(40)
    latest = first
    while latest["sequence"] < first["sequence"] + 40:
        latest = next(stream)
    assert latest["stamp_ns"] - first["stamp_ns"] == pytest.approx(40e9 / 240, abs=1)
    stream.close()


def test_a_frame_knows_its_ids_while_others_spawn_and_despawn(agent: Agent, keeper: Agent) -> None:
    """Another client puts a cube before the camera and away again, as fast as it can."""
    agent.set_follow(False)
    agent.set_position((0.0, 0.0, 20.0), teleport=True)
    agent.set_rotation((0.0, 0.0, 0.0), teleport=True)
    enough = threading.Event()

    def come_and_go() -> None:
        while not enough.is_set():
            id_ = keeper.spawn_object("Cube", (2.0, 0.0, 20.0), object_name="visitor")
            keeper.despawn_object(id_)

    with ThreadPoolExecutor(1) as pool:
        other = pool.submit(come_and_go)
        try:
            frames = [agent.get_frame() for _ in range(50)]
            frames.append(next(agent.frames(30.0)))
        finally:
            enough.set()
        other.result(20.0)
    ids = [{*np.unique(frame["instance"]).tolist()} - {0} for frame in frames]
    unknown = [seen - frame["instances"].keys() for seen, frame in zip(ids, frames, strict=True)]
    assert not any(unknown)
    # What is in the middle of the picture is there if, and only if, the frame knows of it.
    knows = ["visitor" in [o.name for o in f["instances"].values()] for f in frames]
    assert knows == [bool(frame["instance"][60, 80]) for frame in frames]
    assert {True, False} == {*knows}


def test_a_stream_ends_with_its_iteration(agent: Agent, keeper: Agent) -> None:
    """While it runs the agent has its rate; afterwards frames are made on request alone."""
    stream = agent.frames(30.0)
    next(stream)
    assert [s.rate_hz for s in keeper.info.agents if s.name == agent.id] == [30.0]
    stream.close()
    until(lambda: [s.rate_hz for s in keeper.info.agents if s.name == agent.id] == [0.0], "the end")
    number = agent.get_frame()["sequence"]
    agent.step(48)
    assert agent.get_frame()["sequence"] == number + 1


def test_requests_work_within_a_stream(agent: Agent) -> None:
    """get_frame and set_position beside a stream: numbers and times never go back."""
    numbers = []
    for frame in agent.frames(30.0):
        numbers.append(frame["sequence"])
        agent.set_position((0.0, 0.0, 1.0 + 0.01 * len(numbers)))
        numbers.append(agent.get_frame()["sequence"])
        agent.step(8)
        if len(numbers) > 8:
            break
    assert numbers == sorted(set(numbers))


@pytest.mark.parametrize("rate", [0.0, -1.0, float("nan"), "fast", True])
def test_a_stream_needs_a_rate(agent: Agent, rate: object) -> None:
    """Zero, negative and other values are refused in one sentence."""
    with pytest.raises(InvalidRequest, match="rate_hz must be a number above 0"):
        next(agent.frames(rate))  # type: ignore[arg-type]  # on purpose


def test_a_rate_too_high_is_refused(agent: Agent) -> None:
    """More than a frame at each step there is not."""
    with pytest.raises(InvalidRequest, match="above 0 and at most 240"):
        next(agent.frames(1000.0))


def test_a_stream_while_time_stands_still_says_so(agent: Agent) -> None:
    """The first frame is made at once, the next one never; the deadline's error names why."""
    stream = agent.frames(30.0, timeout_s=0.3)
    next(stream)
    with pytest.raises(DeadlineExceeded, match="simulated time stands still"):
        next(stream)


def test_more_views_come_on_request(agent: Agent) -> None:
    """They are in that frame and not in the next; unknown ones are refused."""
    frame = agent.get_frame(["normals", "occlusion"])
    assert frame["normals"].shape == (120, 160, 3)
    assert frame["occlusion"].dtype == np.bool_
    assert set(agent.get_frame()["sizes"]) == {"main", "depth", "category", "object", "flow"}
    with pytest.raises(UnknownName, match="view must be one of"):
        agent.get_frame(["heat"])


def test_boxes_hold_what_is_seen(agent: Agent) -> None:
    """Ids are those of `instances`, pixels are counted, and each box is as tight as can be."""
    frame = agent.get_frame()
    boxes = agent.boxes(frame)
    assert set(boxes.ids.tolist()) == set(np.unique(frame["instance"]).tolist()) - {0}
    assert int(boxes.pixels.sum()) == int((frame["instance"] > 0).sum())
    for id_, (left, top, right, bottom), pixels in boxes:
        assert id_ in agent.instances
        inside = frame["instance"][top : bottom + 1, left : right + 1] == id_
        assert int(inside.sum()) == pixels
        assert inside[0].any()
        assert inside[-1].any()
        assert inside[:, 0].any()
        assert inside[:, -1].any()
    with pytest.raises(UnknownName, match="instance"):
        agent.boxes({"main": frame["main"]})


def test_pictures_are_bgr(agent: Agent, tmp_path: Path) -> None:
    """Flow to the right is red, categories have their colours, the sheet is written."""
    flow = np.zeros((4, 4, 2), np.float32)
    flow[..., 0] = 5.0
    assert agent.draw_flow_map(flow)[0, 0].tolist() == [0, 0, 255]
    frame = agent.get_frame()
    coloured = agent.colour_categories(frame["category"])
    row, column = np.argwhere(frame["category"] > 0)[0]
    number = int(frame["category"][row, column])
    assert tuple(coloured[row, column][::-1].tolist()) == agent.category_colours[number]
    assert agent.save_contact_sheet(tmp_path / "sheet.png", frame).stat().st_size > 5000


# -- simulators that come again ------------------------------------------------------------


def test_an_agent_rejoins_a_simulator_that_was_started_anew() -> None:
    """The same Agent has frames again, also where the new simulator came before it noticed."""
    with NodeProcess("/again", mode="lockstep", agent__name="") as first:
        agent = Agent(**SMALL, namespace="/again", timeout_s=5.0)
        agent.get_frame()
        first.signal(signal.SIGKILL)
        first.status()
        with NodeProcess("/again", mode="lockstep", agent__name=""):
            with pytest.raises(SimulatorLost):
                agent.get_frame()
            agent.rejoin()
            assert agent.simulator_pid is None
            assert agent.get_frame()["sequence"] == 1
            agent.rejoin()  # nothing was lost: it begins anew all the same
            assert agent.get_frame()["sequence"] == 1
            agent.close()
    with pytest.raises(SimulationClosed):
        agent.rejoin()


def test_an_agent_that_lost_its_own_simulator_starts_another() -> None:
    """Where none runs any more, rejoining starts one with the same parameters."""
    with Agent(**SMALL, namespace="/restarted", simulator=LOCKSTEP) as agent:
        lost = agent.simulator_pid
        assert lost is not None
        os.kill(lost, signal.SIGKILL)
        with pytest.raises(SimulatorLost):
            agent.get_frame()
        agent.rejoin()
        assert agent.simulator_pid not in (None, lost)
        assert agent.get_frame()["scene"] == "optical"
