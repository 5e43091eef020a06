"""What rays meet of a scene: sides, holes, glass, scale, whichever instance is nearer."""

from __future__ import annotations

import numpy as np

from sailenv_ros.frame.motion import SceneGeometry
from sailenv_ros.types.instance_states import InstanceStates
from tests.support.tiny_scenes import box_mesh, model_of, wall_mesh

FORWARD = np.array([[1.0, 0.0, 0.0]])
ORIGIN = np.zeros((1, 3))


def states_at(*places: tuple[float, float, float], scales: object = None) -> InstanceStates:
    count = len(places)
    return InstanceStates(
        ids=np.arange(1, count + 1, dtype=np.uint16),
        positions=np.array(places),
        orientations=np.tile([0.0, 0.0, 0.0, 1.0], (count, 1)),
        linear_velocities=np.zeros((count, 3)),
        angular_velocities=np.zeros((count, 3)),
        scales=scales,  # type: ignore[arg-type]
    )


def look(geometry: SceneGeometry, states: InstanceStates, origin: object = ORIGIN) -> tuple:
    hits = geometry.cast(states, np.asarray(origin, np.float64).reshape(-1, 3), FORWARD)
    return int(hits.instance[0]), float(hits.distance[0])


def test_the_nearer_instance_is_met_wherever_it_is() -> None:
    """One model, two instances, which change places; scale counts; nothing is nothing."""
    box = model_of(box_mesh(1.0))
    geometry = SceneGeometry({1: box, 2: box})
    assert look(geometry, states_at((3, 0, 0), (5, 0, 0))) == (1, 2.5)
    assert look(geometry, states_at((6, 0, 0), (5, 0, 0))) == (2, 4.5)
    scales = np.array([[4.0, 1.0, 1.0], [1.0, 1.0, 1.0]])
    assert look(geometry, states_at((6, 0, 0), (5, 0, 0), scales=scales)) == (1, 4.0)
    assert look(geometry, states_at((-6, 0, 0), (5, 3, 0))) == (0, np.inf)


def test_backs_are_met_where_they_are_drawn() -> None:
    """A wall from behind is not there, unless it is two-sided."""
    states = states_at((2, 0, 0), scales=np.array([[3.0, 1.0, 0.5]]))
    for both in (False, True):
        geometry = SceneGeometry({1: model_of(wall_mesh(), double_sided=both)})
        assert look(geometry, states)[0] == 1
        hits = geometry.cast(states, np.array([(4.0, 0.0, 0.0)]), -FORWARD)
        assert hits.instance[0] == int(both)


def test_glass_and_holes_are_passed() -> None:
    """What is transparent is not there; of a mask the texel at the place decides, each time."""
    texture = np.full((2, 2, 4), 255, np.uint8)
    texture[:, 0, 3] = 0  # the left half is open
    half = model_of(wall_mesh(), alpha="mask", base_colour_texture=texture)
    glass = model_of(wall_mesh(), alpha="blend")
    box = model_of(box_mesh(1.0))
    geometry = SceneGeometry({1: glass, 2: half, 3: half, 4: box})
    states = states_at((1, 0, 0), (2, 0, 0), (3, 0, 0), (5, 0, 0))
    # Seen along x, y is to the left.
    assert look(geometry, states, (0.0, 0.25, 0.0)) == (4, 4.5)
    assert look(geometry, states, (0.0, -0.25, 0.0)) == (2, 2.0)
    shifted = states_at((1, 0, 0), (2, -0.5, 0), (3, 0.5, 0), (5, 0, 0))
    assert look(geometry, shifted, (0.0, 0.1, 0.0)) == (3, 3.0)
