"""Changing what is done to an agent's picture, over DDS: it is in what is seen from then on."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sailenv_msgs.msg as msgs
from sailenv_msgs.srv import GetPicture, RegisterAgent, SetPicture
from sailenv_msgs_py.changes import changes_to_msg
from sailenv_msgs_py.picture_msgs import picture_from_msg
from sailenv_ros import Agent, Simulation
from sailenv_ros.errors import InvalidRequest, SimulationClosed, UnknownName
from sailenv_ros.recording.lockstep import record_lockstep
from sailenv_ros.recording.writer import RecordingWriter
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.picture_settings import NAMES, PictureSettings
from sailenv_ros.types.views import RENDERED_VIEWS as VIEWS
from tests.support.ros_probe import Probe

pytestmark = [pytest.mark.ros, pytest.mark.gl]

NAMESPACE = "/developed"
BRIGHT = PictureSettings(exposure=1.0)
SMALL = {"width": 96, "height": 72}

OTHERS: dict[str, Any] = {
    "exposure": -1.0,
    "auto_exposure_s": 0.25,
    "tone_curve": "linear",
    "occlusion_strength": 0.0,
    "occlusion_radius_m": 2.0,
    "smooth_edges": False,
    "supersampling": 2,
    "bloom": 0.5,
    "full_well": 300.0,
    "read_noise": 40.0,
    "depth_sensor": "kinect_v1",
    "exposure_time_ms": 5.0,
    "exposure_samples": 3,
    "row_time_us": 100.0,
    "read_out": "up",
    "gain": 1.0,
    "vignetting": 0.8,
    "lateral_colour": 0.01,
    "dirt": 0.6,
    "white_balance": -40.0,
    "jpeg_quality": 40,
}
"""Of each setting another value than the usual one."""

SHUTTER = ("exposure_time_ms", "exposure_samples", "row_time_us", "read_out")
"""Settings on which the instants of frames depend."""

TRUTH = ("depth_m", "category", "instance", "flow", "flow_valid", "occlusion", "normals")
"""Arrays of a frame that no picture's settings may touch."""


@pytest.fixture
def agent(keeper: Agent) -> Iterator[Agent]:
    """An agent in the scene as it begins, a step after its first frame: there is flow."""
    keeper.reset()
    with Agent(**SMALL, namespace=NAMESPACE) as agent:
        agent.get_frame()
        agent.step(8)
        yield agent


@pytest.fixture(scope="module")
def probe(keeper: Agent) -> Iterator[Probe]:
    """A participant without the facade."""
    with Probe(NAMESPACE) as probe:
        yield probe


def truth(frame: dict[str, Any]) -> dict[str, bytes]:
    """Return the bytes of what must not depend on a picture's settings."""
    return {name: frame[name].tobytes() for name in TRUTH}


def test_the_next_frame_is_brighter_and_its_truth_the_same(agent: Agent) -> None:
    """A stop more light, in the frame that is asked for next; all else is equal, byte for byte."""
    before = agent.get_frame(VIEWS)
    changed = agent.set_picture(exposure=1.0)
    after = agent.get_frame(VIEWS)
    assert changed == agent.picture == BRIGHT
    assert after["stamp_ns"] == before["stamp_ns"]
    assert after["main"].mean() > 1.2 * before["main"].mean()
    assert truth(after) == truth(before)
    agent.set_picture(PictureSettings())
    again = agent.get_frame(VIEWS)
    assert again["main"].tobytes() == before["main"].tobytes()


def test_every_setting_is_seen(agent: Agent) -> None:
    """Each by itself changes what is measured at one instant, and of its truth not a byte."""
    needs = {"read_noise": {"full_well": 300.0}}
    assert tuple(OTHERS) == NAMES
    for name, value in OTHERS.items():
        usual = agent.set_picture(PictureSettings(), **needs.get(name, {}))
        before = agent.get_frame(VIEWS)
        assert agent.set_picture(**{name: value}) == replace(usual, **{name: value})
        if name in SHUTTER:
            continue
        after = agent.get_frame(VIEWS)
        seen = "measured_depth" if name == "depth_sensor" else "main"
        assert after[seen].tobytes() != before[seen].tobytes(), name
        assert truth(after) == truth(before), name


def test_a_frame_belongs_to_the_middle_of_its_shutter(agent: Agent) -> None:
    """Eight steps later, less half of 71 rows of 0.1 ms and 5 ms of exposure."""
    before = agent.get_frame(VIEWS)
    agent.set_picture(row_time_us=100.0, exposure_time_ms=5.0)
    agent.step(8)
    after = agent.get_frame(VIEWS)
    later_ns = after["stamp_ns"] - before["stamp_ns"]
    assert abs(later_ns - (8 * 1e9 / 240 - 0.5 * (71 * 1e5 + 5e6))) <= 2.0


def test_poses_of_rows_and_the_exposure_arrive(agent: Agent) -> None:
    """Rows 0.1 ms apart about the frame's own; the told stops by hand give the same picture."""
    agent.set_picture(row_time_us=100.0, auto_exposure_s=0.5)
    agent.step(8)
    frame = agent.get_frame(VIEWS)
    rows = frame["row_poses"]
    assert np.diff(rows.times_ns).tolist() == [100_000] * 71
    assert abs(rows.times_ns[35:37].mean() - frame["stamp_ns"]) <= 1.0
    middle = rows.world_from_camera[35:37].mean(axis=0)
    np.testing.assert_allclose(middle, frame["world_from_camera"], atol=1e-7)
    assert (rows.world_from_camera[0] != rows.world_from_camera[71]).any()
    agent.set_picture(auto_exposure_s=0.0, exposure=frame["exposure"])
    by_hand = agent.get_frame(VIEWS)
    assert by_hand["stamp_ns"] == frame["stamp_ns"]
    assert by_hand["main"].tobytes() == frame["main"].tobytes()
    assert by_hand["exposure"] == frame["exposure"] != 0.0


def test_streamed_frames_show_it(agent: Agent) -> None:
    """A stream that runs meanwhile goes on, brighter; a reset keeps the settings."""
    stream = agent.frames(30.0)
    dark = next(stream)["main"].mean()
    agent.set_picture(exposure=2.0)
    agent.step(8)
    assert next(stream)["main"].mean() > 1.2 * dark
    stream.close()
    agent.reset()
    assert agent.picture.exposure == 2.0


def test_an_agent_begins_with_its_picture(keeper: Agent) -> None:
    """As it was constructed; another agent's stays what it was."""
    with Agent(**SMALL, namespace=NAMESPACE, picture=BRIGHT) as bright:
        assert bright.picture == BRIGHT
        bright.set_picture(bloom=0.25)
        announced = {spec.name: spec.picture for spec in keeper.info.agents}
        assert keeper.picture == announced[keeper.id] == PictureSettings()
        assert bright.picture == PictureSettings(exposure=1.0, bloom=0.25)
        assert bright.set_picture() == bright.picture
        bright.delete()
        with pytest.raises(SimulationClosed, match="register it first"):
            bright.set_picture(exposure=0.0)
    with pytest.raises(InvalidRequest, match="object of PictureSettings"):
        Agent(**SMALL, namespace=NAMESPACE, picture={"exposure": 1.0})  # type: ignore[arg-type]  # on purpose


def test_wrong_settings_are_refused_before_they_are_sent(agent: Agent) -> None:
    """In the words of the noun, and nothing is changed."""
    with pytest.raises(InvalidRequest, match="bloom must be a number from 0 to 1"):
        agent.set_picture(exposure=1.0, bloom=3.0)
    with pytest.raises(UnknownName, match="did you mean 'exposure'"):
        agent.set_picture(exposur=1.0)
    with pytest.raises(InvalidRequest, match="settings must be"):
        agent.set_picture({"exposure": 1.0})  # type: ignore[arg-type]  # on purpose
    assert agent.picture == PictureSettings()


def test_the_services_take_the_fields_that_are_named(agent: Agent, probe: Probe) -> None:
    """None named changes none; the answer, and that of `get_picture`, is how it is then."""
    changes = {"exposure": 1.0, "tone_curve": "linear"}
    request = SetPicture.Request(changes=changes_to_msg(changes))
    answer = probe.done(SetPicture, f"{agent.id}/set_picture", request)
    assert picture_from_msg(answer.picture) == PictureSettings(exposure=1.0, tone_curve="linear")
    probe.done(SetPicture, f"{agent.id}/set_picture", SetPicture.Request())
    assert probe.done(GetPicture, f"{agent.id}/get_picture").picture == answer.picture
    assert agent.picture == PictureSettings(exposure=1.0, tone_curve="linear")


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"exposure": 99.0}, "exposure must be a number from -16 to 16 [stops]"),
        ({"exposure": 1.0, "bloom": float("nan")}, "bloom must be"),
        ({"exposure": 1.0, "tone_curve": "log"}, "filmic, linear"),
        ({"exposure": 1.0, "blom": 0.0}, "did you mean 'bloom'"),
        ({"exposure": 1.0, "agent": "eye"}, "changes must be names of what can be changed"),
    ],
)
def test_a_refused_request_changes_nothing(
    agent: Agent, probe: Probe, changes: dict[str, Any], sentence: str
) -> None:
    """One wrong field among good ones refuses all of them, in one sentence."""
    request = SetPicture.Request(changes=changes_to_msg(changes))
    answer = probe.call(SetPicture, f"{agent.id}/set_picture", request)
    assert not answer.success
    assert sentence in answer.message
    assert "\n" not in answer.message
    assert agent.picture == PictureSettings()


def test_a_registration_with_a_wrong_picture_is_refused(agent: Agent, probe: Probe) -> None:
    """The settings are looked at as the rest of an agent is."""
    wrong = msgs.AgentInfo(name="wrong", picture=msgs.PictureSettings(read_noise=-1.0))
    answer = probe.call(RegisterAgent, "register_agent", RegisterAgent.Request(agent=wrong))
    assert not answer.success
    assert "read_noise must be" in answer.message


def test_a_recording_shows_the_change(tmp_path: Path) -> None:
    """Frames after it are brighter than without it, of one truth, and the agent is told anew."""

    def record(folder: Path, exposure: float) -> list[dict[str, Any]]:
        lens = CameraIntrinsics(width=64, height=48)
        with (
            Simulation("optical", mode="lockstep") as running,
            RecordingWriter(folder) as writer,
        ):
            running.register_agent(AgentSpec(name="eye", intrinsics=lens, views=tuple(VIEWS)))

            def change(count: int) -> None:
                if count == 2:
                    running.set_picture(exposure=exposure, agent="eye")

            record_lockstep(running, writer, frames=5, on_frame=change)
        with Agent.from_recording(folder) as read:
            frames = list(read)
            (spec,) = read._info.agents  # type: ignore[union-attr]  # there are frames
            assert spec.picture == PictureSettings(exposure=exposure)
        return frames

    plain, changed = record(tmp_path / "plain", 0.0), record(tmp_path / "changed", 1.0)
    assert len(plain) == len(changed) == 5
    for number, (one, other) in enumerate(zip(plain, changed, strict=True)):
        assert truth(one) == truth(other)
        brighter = other["main"].mean() > 1.2 * one["main"].mean()
        # The third was asked for before the second was written.
        assert brighter if number >= 3 else one["main"].tobytes() == other["main"].tobytes()
