"""What a scene draws at random: distributions, seeds, faults with their places; no physics."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sailenv_ros.errors import SceneError
from sailenv_ros.scene.field_types import Number
from sailenv_ros.scene.loader import load_scene
from sailenv_ros.scene.randomise.distributions import DISTRIBUTIONS
from sailenv_ros.scene.randomise.drawn import Draw, Drawn
from sailenv_ros.scene.randomise.random_values import merged, sampled
from sailenv_ros.scene.randomise.randomisation import RandomTargets
from sailenv_ros.scene.spec import SceneSpec
from sailenv_ros.simulation.scenes import SceneLibrary

SCENES = Path(__file__).parents[3] / "scenes"
TARGETS = RandomTargets(
    objects=("box 1", "box 2", "lid"),
    surfaces=("floor",),
    agents=("eye",),
    lights={"sun": (0.0, 0.0, 3.0)},
)
NUMBER = Drawn(float)
POINT = Drawn(tuple[float, float, float])


def draw(distribution: str, given: Any, kind: Drawn = NUMBER) -> Draw:
    return kind.check({distribution: given})


def many(drawn: Draw, count: int = 4000) -> np.ndarray:
    generator = np.random.default_rng(3)
    return np.array([drawn.sample(generator) for _ in range(count)])


def things(*entries: dict[str, Any]) -> Any:
    base = {
        "version": 1,
        "objects": [{"name": name, "asset": "cube"} for name in TARGETS.objects],
        "lights": [{"name": "sun", "type": "point"}],
        "room": {"size": [3, 3, 3]},
    }
    return SceneSpec.model_validate({**base, "randomise": entries}).randomise


class TestDistributions:
    def test_uniform_is_flat_between_its_ends(self) -> None:
        values = many(draw("uniform", [-1.0, 3.0]))
        assert -1.0 <= values.min() < values.max() <= 3.0
        np.testing.assert_allclose(np.histogram(values, 4)[0] / 1000.0, 1.0, atol=0.1)

    def test_log_uniform_has_as_many_in_each_octave(self) -> None:
        values = many(draw("log_uniform", [0.25, 4.0]))
        assert 0.25 <= values.min() < values.max() <= 4.0
        shares = np.histogram(np.log2(values), [-2, -1, 0, 1, 2])[0] / 1000.0
        np.testing.assert_allclose(shares, 1.0, atol=0.1)

    def test_normal_has_its_moments(self) -> None:
        values = many(draw("normal", [2.0, 0.5]))
        assert abs(values.mean() - 2.0) < 0.03
        assert abs(values.std() - 0.5) < 0.03

    def test_normal_gives_nothing_that_is_refused(self) -> None:
        positive = Drawn(Annotated[float, Number(least=0.0, most=1.0)])
        values = many(draw("normal", [0.1, 0.5], positive))
        assert values.min() >= 0.0
        assert values.max() <= 1.0

    def test_choice_goes_by_its_weights(self) -> None:
        words = Drawn(str)
        values = many(draw("choice", {"of": ["a", "b", "c"], "weights": [1, 0, 3]}, words))
        assert set(values) == {"a", "c"}
        assert abs((values == "c").mean() - 0.75) < 0.03
        equal = many(draw("choice", ["a", "b"], words))
        assert abs((equal == "a").mean() - 0.5) < 0.03

    def test_numbers_of_a_vector_are_drawn_one_by_one(self) -> None:
        values = many(draw("uniform", [[0, 0, 0], [1, 2, 0]], POINT))
        np.testing.assert_allclose(values.max(axis=0), [1, 2, 0], atol=0.01)
        assert abs(np.corrcoef(values[:, 0], values[:, 1])[0, 1]) < 0.05

    def test_whole_numbers_have_both_ends(self) -> None:
        whole = Drawn(Annotated[int, Number(least=0, most=9, whole=True)])
        values = many(draw("uniform", [1, 3], whole), 300)
        assert set(values.tolist()) == {1, 2, 3}

    @given(st.floats(-1e6, 1e6), st.floats(0, 1e6), st.integers(0, 2**32))
    def test_what_is_drawn_lies_within(self, low: float, width: float, seed: int) -> None:
        value = draw("uniform", [low, low + width]).sample(np.random.default_rng(seed))
        assert low <= value <= low + width


class TestSeeds:
    ENTRIES = (
        {"name": "a", "type": "object", "of": "box*", "turn": {"uniform": [0, 90]}},
        {"name": "b", "type": "light", "of": "sun", "intensity": {"log_uniform": [1, 4]}},
        {"name": "c", "type": "environment", "exposure": {"normal": [0, 1]}},
    )

    def values(self, *entries: dict[str, Any], seed: int = 1, index: int = 0) -> Any:
        return sampled(things(*entries), TARGETS, seed=seed, index=index)

    def test_same_seed_and_index_give_the_same(self) -> None:
        assert self.values(*self.ENTRIES) == self.values(*self.ENTRIES)
        assert self.values(*self.ENTRIES) != self.values(*self.ENTRIES, seed=2)
        assert self.values(*self.ENTRIES) != self.values(*self.ENTRIES, index=1)

    def test_values_do_not_depend_on_other_entries_or_their_order(self) -> None:
        whole = self.values(*self.ENTRIES)
        assert self.values(*self.ENTRIES[::-1]) == whole
        for entry in self.ENTRIES:
            for key, value in self.values(entry).items():
                assert whole[key] == value

    def test_each_object_and_key_has_values_of_its_own(self) -> None:
        drawn = self.values(
            {
                "name": "a",
                "type": "object",
                "of": "box*",
                "turn": {"uniform": [0, 1]},
                "scale": {"uniform": [0.5, 1]},
            }
        )["objects"]
        assert set(drawn) == {"box 1", "box 2"}
        numbers = [number for keys in drawn.values() for number in keys.values()]
        assert len(set(numbers)) == 4

    def test_frames_depend_on_their_instant(self) -> None:
        entry = {**self.ENTRIES[1], "every": "frame"}
        assert self.values(entry) == {}
        at = [
            sampled(things(entry), TARGETS, seed=1, index=0, every="frame", step=step)
            for step in (0, 0, 8)
        ]
        assert at[0] == at[1] != at[2]

    def test_values_are_what_json_holds(self) -> None:
        spec = load_scene(SCENES / "random_shapes.yaml")
        targets = RandomTargets(
            objects=tuple(entry.name for entry in spec.objects),
            agents=("eye",),
            lights={light.name: (0.0, 0.0, 0.0) for light in spec.lights},
        )
        for every in ("epoch", "frame"):
            values = sampled(spec.randomise, targets, seed=5, index=2, every=every, step=3)  # type: ignore[arg-type]
            assert values
            assert json.loads(json.dumps(values)) == values

    def test_later_entries_win(self) -> None:
        assert merged({"a": {"b": 1, "c": 2}}, {"a": {"b": 3}}) == {"a": {"b": 3, "c": 2}}
        assert merged({"added": [1]}, {"added": [2]}) == {"added": [1, 2]}


def test_file_is_written_as_it_was_read() -> None:
    spec = load_scene(SCENES / "random_shapes.yaml")
    dumped = spec.model_dump(mode="json", exclude_unset=True)
    assert SceneSpec.model_validate(dumped) == spec


def test_faults_are_told_all_at_once_with_their_places(tmp_path: Path) -> None:
    (tmp_path / "bad.yaml").write_text(
        """version: 1
lights: [{name: sun, type: directional}]
objects: [{name: box, asset: cube}]
randomise:
  - {name: a, type: light, of: moon, intensity: 1}
  - {name: a, type: light, of: sun, intensity: {uniform: [3, -1]}}
  - {name: c, type: light, of: sun, intensity: {uniform: [3, 1]}}
  - {name: d, type: light, of: sun, intensity: {gauss: [3, 1]}}
  - {name: e, type: object, of: box, every: frame, turn: 3}
  - {name: f, type: object, of: box, asset: {choice: [cube, cuube]}}
  - {name: g, type: material, of: "b?x", material: {choice: [marzipan]}}
  - {name: h, type: wish, of: box}
  - {name: i, type: distractors, assets: [cuube], count: 3, within: [[1, 0, 0], [0, 1, 1]]}
  - {name: j, type: camera, look_at: [0, 0, 0]}
  - {name: k, type: light, of: sun, colour: {log_uniform: [[0, 1, 1], [1, 1, 1]]}}
  - {name: l, type: environment, sky_map: {choice: [moonshine]}}
  - {name: m, type: environment, exposure: {normal: [0, -1]}}
  - {name: n, type: environment, exposure: {choice: {of: [0, 1], weights: [1]}}}
  - {name: o, type: environment, exposure: {choice: []}}
""",
        encoding="utf-8",
    )
    with pytest.raises(SceneError) as caught:
        SceneLibrary([tmp_path]).load("bad")
    found = {(one.line, one.field): one.message for one in caught.value.diagnostics}
    places = {
        (5, "randomise[0].of"),
        (6, "randomise[1].name"),
        (6, "randomise[1].intensity"),
        (7, "randomise[2].intensity"),
        (8, "randomise[3].intensity"),
        (9, "randomise[4].every"),
        (10, "randomise[5].asset"),
        (11, "randomise[6].material"),
        (12, "randomise[7].type"),
        (13, "randomise[8].assets[0]"),
        (13, "randomise[8].within"),
        (14, "randomise[9].look_at"),
        (15, "randomise[10].colour"),
        (16, "randomise[11].sky_map"),
        (17, "randomise[12].exposure"),
        (18, "randomise[13].exposure"),
        (19, "randomise[14].exposure"),
    }
    assert places == set(found)
    assert "did you mean 'cube'" in found[10, "randomise[5].asset"]
    for name in DISTRIBUTIONS:
        assert name in found[8, "randomise[3].intensity"]


class TestRelative:
    """`times` and `add` change the scene's own value; the record tells by how much."""

    TARGETS = RandomTargets(
        objects=("box 1",),
        lights={"sun": (0.0, 0.0, 3.0)},
        agents=("eye",),
        own={
            "environment": {"exposure": 0.7, "ambient": (0.1, 0.2, 0.4), "sky_share": 0.9},
            "lights": {"sun": {"intensity": 3.0, "colour": (1.0, 0.5, 0.25)}},
            "objects": {"box 1": {"scale": (1.0, 2.0, 3.0)}},
            "agents": {"eye": {"exposure": -0.5}},
        },
    )

    def values(self, *entries: dict[str, Any], seed: int = 1) -> Any:
        return sampled(things(*entries), self.TARGETS, seed=seed, index=0)

    def test_the_own_value_is_changed_and_the_amount_recorded(self) -> None:
        drawn = self.values(
            {"name": "a", "type": "environment", "exposure": {"add": {"uniform": [-0.5, 0.5]}},
             "ambient": {"times": {"uniform": [0.5, 2]}}},
            {"name": "b", "type": "light", "of": "sun", "intensity": {"times": 2},
             "colour": {"times": [1, 2, 4]}},
            {"name": "c", "type": "object", "of": "box 1", "scale": {"times": 0.5}},
            {"name": "d", "type": "camera", "exposure": {"add": 1}},
        )  # fmt: skip
        stops = drawn["relative"]["environment"]["exposure"]["add"]
        assert -0.5 <= stops <= 0.5
        assert drawn["environment"]["exposure"] == 0.7 + stops
        factor = drawn["relative"]["environment"]["ambient"]["times"]
        assert drawn["environment"]["ambient"] == [0.1 * factor, 0.2 * factor, 0.4 * factor]
        assert drawn["lights"]["sun"] == {"intensity": 6.0, "colour": [1.0, 1.0, 1.0]}
        assert drawn["relative"]["lights"]["sun"] == {
            "intensity": {"times": 2.0},
            "colour": {"times": [1.0, 2.0, 4.0]},
        }
        assert drawn["objects"]["box 1"]["scale"] == [0.5, 1.0, 1.5]
        assert drawn["agents"]["eye"]["exposure"] == 0.5
        assert json.loads(json.dumps(drawn)) == drawn

    def test_what_the_key_refuses_is_drawn_again(self) -> None:
        entry = {"name": "a", "type": "environment", "sky_share": {"add": {"uniform": [-1, 1]}}}
        shares = [self.values(entry, seed=s)["environment"]["sky_share"] for s in range(40)]
        assert 0.0 <= min(shares) < 0.3
        assert 0.7 < max(shares) <= 1.0
        never = self.values({"name": "a", "type": "environment", "sky_share": {"add": 5}})
        assert never["environment"]["sky_share"] == 0.9
        assert never["relative"]["environment"]["sky_share"] == {"add": 0.0}

    def test_a_later_absolute_value_has_no_amount(self) -> None:
        drawn = self.values(
            {"name": "a", "type": "environment", "exposure": {"add": 1}},
            {"name": "b", "type": "environment", "exposure": 2},
        )
        assert drawn == {"environment": {"exposure": 2.0}}

    @pytest.mark.parametrize(
        ("entry", "told"),
        [
            ({"exposure": {"add": [1, 2, 3]}}, "must be a number"),
            ({"exposure": {"times": {"uniform": [2, 1]}}}, "must give uniform"),
            ({"ambient": {"times": [1, 2]}}, "one number or three"),
            ({"ambient": {"times": {"uniform": [1, [1, 2, 3]]}}}, "must give uniform"),
            ({"sky_map": {"times": 2}}, "got 'times'"),
        ],
    )
    def test_amounts_that_are_none_are_refused(self, entry: dict[str, Any], told: str) -> None:
        with pytest.raises(ValueError, match=told):
            things({"name": "a", "type": "environment", **entry})

    def test_it_is_written_as_it_was_read(self) -> None:
        spread = {"times": {"normal": [1, 0.1]}}
        entry = {"name": "a", "type": "light", "of": "sun", "intensity": spread}
        (thing,) = things(entry)
        assert thing.model_dump(mode="json", exclude_defaults=True) == entry
