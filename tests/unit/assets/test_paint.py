"""Paint changes what is asked for and nothing else; equal paint gives the same object."""

from __future__ import annotations

import gc
import weakref

import numpy as np

from sailenv_ros.assets import AssetLibrary, painted
from sailenv_ros.types.model import Material, Mesh, Model, ModelPart

RED = (1.0, 0.0, 0.0)


def _model(**material: object) -> Model:
    mesh = Mesh(
        positions=np.eye(3, dtype=np.float32),
        normals=np.eye(3, dtype=np.float32),
        uvs=np.zeros((3, 2), dtype=np.float32),
        triangles=np.array([[0, 1, 2]], dtype=np.uint32),
    )
    return Model(
        name="model",
        parts=(ModelPart(mesh=mesh, material=Material(**material)),),  # type: ignore[arg-type]
    )


def test_without_paint_the_model_is_the_same_object() -> None:
    model = AssetLibrary().get("cube").model
    assert painted(model) is model


def test_equal_paint_gives_the_same_object_and_other_paint_another() -> None:
    model = AssetLibrary().get("cube").model
    red = painted(model, colour=RED)
    assert painted(model, colour=(1.0, 0.0, 0.0)) is red
    assert painted(model, colour=(0.9, 0.0, 0.0)) is not red
    assert painted(model, colour=RED, roughness=0.1) is not red
    assert painted(AssetLibrary().get("cube").model, colour=RED) is not red


def test_the_mesh_is_shared() -> None:
    model = AssetLibrary().get("cube").model
    assert painted(model, colour=RED).parts[0].mesh is model.parts[0].mesh


def test_only_what_is_asked_for_changes() -> None:
    model = _model(base_colour=(0.1, 0.2, 0.3, 0.4), metallic=0.5, roughness=0.7)
    (part,) = painted(model, colour=RED).parts
    assert part.material.base_colour == (1.0, 0.0, 0.0, 0.4)
    assert (part.material.metallic, part.material.roughness) == (0.5, 0.7)
    (part,) = painted(model, metallic=1.0).parts
    assert part.material.base_colour == (0.1, 0.2, 0.3, 0.4)
    assert (part.material.metallic, part.material.roughness) == (1.0, 0.7)


def test_a_colour_replaces_the_texture_but_keeps_what_it_cuts_out() -> None:
    texture = np.arange(16, dtype=np.uint8).reshape(2, 2, 4)
    opaque = painted(_model(base_colour_texture=texture), colour=RED)
    assert opaque.parts[0].material.base_colour_texture is None
    cut = painted(_model(base_colour_texture=texture, alpha="mask"), colour=RED)
    outline = cut.parts[0].material.base_colour_texture
    assert outline is not None
    assert (outline[..., :3] == 255).all()
    np.testing.assert_array_equal(outline[..., 3], texture[..., 3])


def test_metalness_and_roughness_replace_their_texture() -> None:
    texture = np.zeros((2, 2, 4), dtype=np.uint8)
    model = painted(_model(metallic_roughness_texture=texture), roughness=0.2)
    assert model.parts[0].material.metallic_roughness_texture is None


def test_painted_models_do_not_keep_a_model_alive() -> None:
    model = _model()
    painted(model, colour=RED)
    gone = weakref.ref(model)
    del model
    gc.collect()
    assert gone() is None
