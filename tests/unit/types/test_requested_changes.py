"""What operations change by keywords: each key is one of the data that it changes."""

from __future__ import annotations

import inspect
from dataclasses import fields
from typing import Any

import pytest

from sailenv_ros.scene.requested_changes import EnvironmentChanges, MaterialChanges, ObjectChanges
from sailenv_ros.scene.spec import EnvironmentSpec, ObjectSpec
from sailenv_ros.scene.spec_materials import MaterialSpec
from sailenv_ros.simulation.operations import Operations
from sailenv_ros.types.lights import Light, LightAttributes, LightChanges
from sailenv_ros.types.picture_settings import PictureChanges, PictureSettings


def test_lights_and_pictures_have_a_key_for_each_field() -> None:
    """In the order of the data class; the name of a light stays."""
    light = [field.name for field in fields(Light)]
    assert set(LightChanges.__annotations__) == {*light} - {"name"}
    assert list(LightAttributes.__annotations__) == [n for n in light if n not in ("name", "type")]
    assert list(PictureChanges.__annotations__) == [field.name for field in fields(PictureSettings)]


def test_keys_of_scene_files_are_those_of_their_models() -> None:
    """Nothing of the environment is left out, and nothing is asked for that no file can say."""
    assert list(EnvironmentChanges.__annotations__) == list(EnvironmentSpec.model_fields)
    assert {*MaterialChanges.__annotations__} == {*MaterialSpec.model_fields} - {"part"}
    assert {*ObjectChanges.__annotations__} <= {*ObjectSpec.model_fields}


@pytest.mark.parametrize(
    ("operation", "keys"),
    [
        (Operations.set_light, LightChanges),
        (Operations.add_light, LightAttributes),
        (Operations.set_picture, PictureChanges),
        (Operations.change_object, ObjectChanges),
        (Operations.set_material, MaterialChanges),
        (Operations.set_environment, EnvironmentChanges),
    ],
)
def test_help_shows_the_keys(operation: Any, keys: Any) -> None:
    """The signature that people see names each keyword; the one that binds takes any of them."""
    shown = inspect.signature(operation).parameters
    assert {*operation.keywords} == {*keys.__annotations__} <= shown.keys()
    assert all(shown[key].kind is inspect.Parameter.KEYWORD_ONLY for key in operation.keywords)
    last = list(operation.signature.parameters.values())[-1]
    assert last.kind is inspect.Parameter.VAR_KEYWORD
