"""A simulation works in the process that made it; elsewhere it refuses at once and says so."""

from __future__ import annotations

import copy
import multiprocessing
import os
import pickle
import threading
import warnings
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from typing import Any

import pytest

from sailenv_ros.errors import SimulationClosed, WrongProcess
from sailenv_ros.simulation import Simulation
from sailenv_ros.system.own_process import OwnProcess
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics

EYE = AgentSpec(name="eye", intrinsics=CameraIntrinsics(width=16, height=12), rate_hz=30.0)

FORKING = multiprocessing.get_context("fork")


@pytest.fixture(scope="module")
def simulation() -> Iterator[Simulation]:
    """Return a simulation that runs and has rendered."""
    with Simulation("optical", backend="native", agent=EYE) as running:
        running.capture()
        yield running


def in_a_fork(work: Callable[[], Any]) -> Any:
    """Return what a function returns in a fork of this process, or the error that it raises."""
    receiver, sender = FORKING.Pipe(duplex=False)

    def run() -> None:
        try:
            sender.send(work())
        except Exception as error:
            sender.send(error)

    process = FORKING.Process(target=run)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # Python 3.12 on forks beside threads
        process.start()
    try:
        assert receiver.poll(60), "the fork says nothing"
        return receiver.recv()
    finally:
        process.join(10)
        process.kill()
        process.join()


USES: dict[str, Callable[[Simulation], Any]] = {
    "an operation": lambda simulation: simulation.capture(["depth"]),
    "a future": lambda simulation: simulation.get_gravity.submit().result(30),
    "background work": lambda simulation: simulation.get_thumbnail_png.submit("cube").result(30),
    "a stream": lambda simulation: simulation.stream("eye", ["depth"]),
    "frames": lambda simulation: next(simulation.frames()),
    "a new light": lambda simulation: simulation.refresh().result(30),
}


@pytest.mark.parametrize("use", USES)
def test_a_fork_is_refused_at_once(simulation: Simulation, use: str) -> None:
    """Its thread is not there: whoever waited for it waited until the deadline."""
    error = in_a_fork(lambda: USES[use](simulation))
    assert isinstance(error, WrongProcess), error
    assert isinstance(error, SimulationClosed)
    assert str(error) == (
        f"this Simulation works in the process that made it alone ({os.getpid()}) and cannot be "
        "copied, sent to another one or inherited by a fork: make it in the worker"
    )


def test_an_inherited_stream_and_an_inherited_frame_refuse_too(simulation: Simulation) -> None:
    """The stream's frames came by a thread, and amodal masks are drawn by it."""
    frame = simulation.capture()
    with simulation.stream("eye", ["depth"]) as stream:
        told = in_a_fork(lambda: stream.get(30.0))
        assert isinstance(told, WrongProcess)
        assert str(told).startswith("this FrameStream works in the process")
        assert stream.get(30.0)["depth"].shape == (12, 16)
    assert isinstance(in_a_fork(lambda: frame.amodal), WrongProcess)
    assert frame.amodal.height == 12


def test_closing_it_in_a_fork_leaves_the_parents_alone(simulation: Simulation) -> None:
    """A lock that is held as the process is forked is held in the fork for ever."""
    with simulation._loop._wake:
        assert in_a_fork(lambda: (simulation.close(), simulation.closed)) == (None, False)
    assert simulation.capture()["depth"].shape == (12, 16)


def test_the_worker_makes_its_own(simulation: Simulation) -> None:
    """Which has the same frames."""

    def work() -> bytes:
        with Simulation("optical", mode="lockstep", backend="native", agent=EYE) as own:
            return own.capture(["depth"])["depth"].tobytes()

    assert in_a_fork(work) == work()


@pytest.mark.parametrize("copied", [pickle.dumps, copy.copy, copy.deepcopy])
def test_it_cannot_be_copied_or_sent(
    simulation: Simulation, copied: Callable[[Any], object]
) -> None:
    """In the same words as in a fork."""
    with pytest.raises(WrongProcess, match=r"this Simulation works.*make it in the worker"):
        copied(simulation)


def test_a_thread_is_the_same_process() -> None:
    found: Future[bool] = Future()
    process = OwnProcess("Simulation")
    thread = threading.Thread(target=lambda: found.set_result(process.is_inherited))
    thread.start()
    assert found.result(10) is False
    thread.join()
    process.require()
