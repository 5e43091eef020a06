"""The simulation's thread: requests from anywhere, streams, the wall clock, an orderly end."""

from __future__ import annotations

import gc
import threading
from collections.abc import Callable, Iterator

import pytest

import sailenv_ros.simulation.simulation as module
from sailenv_ros.errors import (
    DeadlineExceeded,
    InvalidRequest,
    InvalidState,
    PhysicsError,
    SimulationClosed,
    UnknownName,
)
from sailenv_ros.simulation import Simulation
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.scene_info import SceneInfo
from sailenv_ros.types.snapshot import SceneContents
from tests.support.blank_renderer import BlankRenderer

SMALL = CameraIntrinsics(width=16, height=12)
EYE = AgentSpec(name="eye", intrinsics=SMALL, rate_hz=60.0)


@pytest.fixture
def start(monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[..., Simulation]]:
    """Start simulations whose renderer draws nothing; ends them all."""
    monkeypatch.setattr(module, "make_backend", lambda *_: BlankRenderer())
    started: list[Simulation] = []

    def begin(**kwargs: object) -> Simulation:
        started.append(Simulation("optical", **kwargs))  # type: ignore[arg-type]  # settings of a test
        return started[-1]

    yield begin
    for simulation in started:
        simulation.close()


def test_each_scene_is_preloaded_once_and_what_fails_there_is_told(
    start: Callable[..., Simulation], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Before its first picture; ground truth alone needs nothing."""
    renderer = BlankRenderer()
    monkeypatch.setattr(module, "make_backend", lambda *_: renderer)
    simulation = start(mode="lockstep", agent=EYE)
    simulation.capture("depth")
    assert not renderer.preloaded
    for _ in range(2):
        simulation.capture("rgb")
    assert len(renderer.preloaded) == 1
    simulation.change_scene("solid_benchmark")
    simulation.capture("rgb", agent="eye")
    assert len(renderer.preloaded) == 2

    def fails(contents: SceneContents) -> None:
        raise InvalidState(f"no room for {len(contents.instances)} instances")

    renderer.preload = fails  # type: ignore[method-assign]
    simulation.change_scene("optical")
    with pytest.raises(InvalidState, match="no room for"):
        simulation.capture("rgb", agent="eye")


def test_simulated_time_follows_the_wall_clock(start: Callable[..., Simulation]) -> None:
    """In real time frames come by themselves, with stamps on the rate's grid and growing."""
    simulation = start()
    simulation.register_agent(EYE)
    with simulation.stream("eye", ["depth"]) as stream:
        stamps = [stream.get(5.0).stamp_ns for _ in range(6)]
    assert stamps == sorted(set(stamps))
    assert all(stamp * 240 // 1_000_000_000 % 4 in (0, 3) for stamp in stamps)


def test_a_paused_simulation_stands_still_and_goes_on(start: Callable[..., Simulation]) -> None:
    """pause holds time, step moves it by hand, resume lets it run."""
    simulation = start()
    simulation.pause()
    simulation.pause()
    here = simulation.step(1)
    assert simulation.step(24) - here == pytest.approx(100_000_000, abs=1)
    assert simulation.info.paused
    told = threading.Event()
    simulation.on_step(lambda now: told.set() if now > here + 200_000_000 else None)
    simulation.resume()
    assert told.wait(5.0)


def test_a_lockstep_simulation_moves_by_step_alone(start: Callable[..., Simulation]) -> None:
    """Nothing happens between requests, and captures repeat themselves."""
    simulation = start(mode="lockstep")
    simulation.register_agent(EYE)
    first = simulation.capture(["depth"], agent="eye")
    assert simulation.capture(["depth"], agent="eye").stamp_ns == first.stamp_ns == 0
    assert simulation.step(240) == 1_000_000_000


def test_requests_from_many_threads_are_all_answered(start: Callable[..., Simulation]) -> None:
    """Eight threads with an agent each; every one gets its own frames."""
    simulation = start()
    wrong: list[str] = []

    def client(number: int) -> None:
        name = f"agent_{number}"
        simulation.register_agent(AgentSpec(name=name, intrinsics=SMALL))
        for sequence in range(1, 21):
            frame = simulation.capture(["depth"], agent=name)
            if (frame.agent, frame.sequence) != (name, sequence):
                wrong.append(f"{name}: {frame.agent} {frame.sequence}")
        simulation.delete_agent(name)

    threads = [threading.Thread(target=client, args=(number,)) for number in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(30.0)
    assert not wrong
    assert simulation.info.agents == ()


def test_a_slow_consumer_loses_frames_and_knows_it(start: Callable[..., Simulation]) -> None:
    """The newest wins; what was replaced is counted."""
    simulation = start(mode="lockstep")
    simulation.register_agent(EYE)
    with simulation.stream("eye", ["depth"]) as stream:
        simulation.step(40)
        newest = stream.get(5.0)
        assert newest.stamp_ns == 40 * 1_000_000_000 // 240
        assert stream.dropped == newest.sequence - 1 > 5
        with pytest.raises(
            DeadlineExceeded,
            match=r"timed out after 0\.01 s while waiting for a frame of agent 'eye'",
        ):
            stream.get(0.01)


def test_a_stream_ends_with_its_agent(start: Callable[..., Simulation]) -> None:
    """Whoever waits for a frame of a deleted agent is told, not left waiting."""
    simulation = start(mode="lockstep")
    simulation.register_agent(EYE)
    stream = simulation.stream("eye", [])
    simulation.delete_agent("eye")
    with pytest.raises(SimulationClosed, match="agent 'eye' was deleted"):
        stream.get(5.0)
    stream.close()


def test_listeners_hear_of_changes_until_they_leave(start: Callable[..., Simulation]) -> None:
    """Called at once, at every change, and no more after leaving."""
    simulation = start(mode="lockstep")
    told: list[SceneInfo] = []
    leave = simulation.on_info(told.append)
    simulation.register_agent(EYE)
    simulation.change_scene("solid_benchmark")
    assert [info.scene for info in told] == ["optical", "optical", "solid_benchmark"]
    leave()
    simulation.reset()
    assert len(told) == 3
    assert simulation.info.epoch == 3


def test_requests_have_names_and_errors_reach_the_asker(start: Callable[..., Simulation]) -> None:
    """A future raises what the operation raised; unknown arguments are refused at once."""
    simulation = start(mode="lockstep")
    future = simulation.change_scene.submit("nowhere")
    with pytest.raises(UnknownName, match="scene must be one of"):
        future.result(5.0)
    with pytest.raises(TypeError, match="unexpected keyword argument 'speed'"):
        simulation.step.submit(2, speed=3)  # type: ignore[call-arg]  # on purpose
    assert simulation.step.submit(2).result(5.0) == 8_333_333


def test_a_request_that_takes_too_long_names_itself(start: Callable[..., Simulation]) -> None:
    """The deadline passes while the loop is busy with another's request."""
    simulation = start(mode="lockstep")
    busy = simulation.step.submit(100_000)
    with pytest.raises(
        DeadlineExceeded, match=r"timed out after 0\.01 s while waiting for the operation 'pause'"
    ):
        simulation.pause.within(0.01)()
    simulation.close()
    assert busy.done()


def test_what_cannot_start_leaves_nothing(start: Callable[..., Simulation]) -> None:
    """Wrong settings and scenes raise in the constructor; no thread stays behind."""
    before = threading.active_count()
    with pytest.raises(UnknownName, match="scene must be one of"):
        Simulation("nowhere")
    with pytest.raises(UnknownName, match="mode must be one of: realtime, lockstep"):
        start(mode="fast")
    with pytest.raises(InvalidRequest, match="real_time_factor must be a number from"):
        start(real_time_factor=0.0)
    gc.collect()
    assert threading.active_count() == before


def test_closing_ends_everything_once(start: Callable[..., Simulation]) -> None:
    """Streams end, later requests are refused, a second close is harmless."""
    simulation = start()
    simulation.register_agent(EYE)
    stream = simulation.stream("eye", ["depth"])
    simulation.close()
    simulation.close()
    assert simulation.closed
    with pytest.raises(SimulationClosed, match="the simulation has ended: it was closed"):
        simulation.step()
    stream.close()


def test_a_fault_of_the_engine_ends_it_with_the_reason(
    start: Callable[..., Simulation],
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
) -> None:
    """If physics fails in the loop, whoever asks next learns why."""
    simulation = start()

    def fail(*_: object, **__: object) -> None:
        raise PhysicsError("the world came apart")

    simulation.register_agent(EYE)
    stream = simulation.stream("eye", ["depth"])
    monkeypatch.setattr("sailenv_ros.world.world.World.step", fail)

    def drain() -> None:
        for _ in range(100):
            stream.get(5.0)

    with pytest.raises(SimulationClosed, match="the world came apart"):
        drain()
    with pytest.raises(SimulationClosed, match="the world came apart"):
        simulation.get_agent_pose(agent="eye")
    assert "the simulation ends because of an internal error" in caplog.text
