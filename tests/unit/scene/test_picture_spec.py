"""An agent's picture in a scene file: to the settings that the renderer takes."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any

import pytest
from pydantic import ValidationError

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.scene import SceneSpec
from sailenv_ros.scene.serialisation import agent_entry
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.picture_settings import LIMITS, PictureSettings


def settings_of(**picture: Any) -> PictureSettings:
    agent = {"name": "eye", "picture": picture} if picture else {"name": "eye"}
    scene = SceneSpec.model_validate({"version": 1, "agents": [agent]})
    return scene.agents[0].to_agent_spec().picture


def test_what_is_left_out_is_as_everywhere() -> None:
    assert settings_of() == PictureSettings()
    assert settings_of(exposure=1) == PictureSettings(exposure=1.0)


def test_every_setting_can_be_written() -> None:
    """A file can say all that the data type holds, with lengths named without their unit."""
    given = PictureSettings(
        exposure=-1.5,
        tone_curve="linear",
        occlusion_strength=0.2,
        occlusion_radius_m=0.7,
        smooth_edges=False,
        supersampling=3,
        bloom=0.1,
        full_well=9000.0,
        read_noise=2.5,
    )
    written = {f.name.removesuffix("_m"): getattr(given, f.name) for f in fields(PictureSettings)}
    assert settings_of(**written) == given
    # And what is written of an agent reads back as it was, without what is as everywhere.
    entry = agent_entry(AgentSpec(name="eye", picture=given), None)
    assert settings_of(**entry["picture"]) == given
    assert "picture" not in agent_entry(AgentSpec(name="eye"), None)


@pytest.mark.parametrize("name", LIMITS)
def test_limits_are_those_of_the_settings(name: str) -> None:
    """What the data type would refuse is refused in the file already."""
    low, high = LIMITS[name].least, LIMITS[name].most
    assert low is not None
    assert high is not None
    key = name.removesuffix("_m")
    for accepted in (low, high):
        assert getattr(settings_of(**{key: accepted}), name) == accepted
    for refused in (low - 0.01, high * 1.01):
        with pytest.raises(ValidationError, match=key):
            settings_of(**{key: refused})


@pytest.mark.parametrize("refused", [0, 5, 1.5, True])
def test_supersampling_is_a_small_whole_number(refused: object) -> None:
    assert settings_of(supersampling=4).supersampling == 4
    with pytest.raises(ValidationError, match=r"supersampling[\s\S]*an integer from 1 to 4"):
        settings_of(supersampling=refused)


@pytest.mark.parametrize(("size", "times"), [((1366, 100), 3), ((100, 4096), 2)])
def test_a_picture_of_too_many_samples_is_refused_in_the_file(
    size: tuple[int, int], times: int
) -> None:
    """With its place, where the data type would refuse it as well; one less is accepted."""

    def agent(number: int) -> AgentSpec:
        entry = {"name": "eye", "width": size[0], "height": size[1]}
        entry["picture"] = {"supersampling": number}
        scene = SceneSpec.model_validate({"version": 1, "agents": [entry]})
        return scene.agents[0].to_agent_spec()

    assert agent(times - 1).picture.supersampling == times - 1
    with pytest.raises(ValidationError, match=f"at most {times - 1} with a"):
        agent(times)
    with pytest.raises(InvalidRequest, match=f"supersampling must be at most {times - 1} for"):
        replace(agent(times - 1), picture=PictureSettings(supersampling=times))
