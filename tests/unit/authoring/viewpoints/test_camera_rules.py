"""Camera poses by rules: what each rule says of a pose is so, by the views from there."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import ArrayLike

from sailenv_ros import Simulation
from sailenv_ros.authoring.viewpoints import CameraView, camera_rules
from sailenv_ros.errors import InvalidEntry, InvalidRequest, UnknownName
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.geometry import Pose

YARD = """
version: 1
objects:
  - {name: floor, asset: cube, scale: [6, 6, 0.1], position: [0, 0, -0.05], category: floor, static: true}
  - {name: north, asset: cube, scale: [6, 0.1, 2.5], position: [0, 3, 1.25], category: wall, static: true}
  - {name: south, asset: cube, scale: [6, 0.1, 2.5], position: [0, -3, 1.25], category: wall, static: true}
  - {name: east, asset: cube, scale: [0.1, 6, 2.5], position: [3, 0, 1.25], category: wall, static: true}
  - {name: west, asset: cube, scale: [0.1, 6, 2.5], position: [-3, 0, 1.25], category: wall, static: true}
  - {name: table, asset: cube, scale: [1, 1, 0.8], position: [-1, 1, 0.4], category: desk, static: true}
  - {name: vase, asset: cylinder, scale: 0.3, position: [-1, 1, 0.95], category: vase, static: true}
  - {name: ball, asset: sphere, scale: 0.5, position: [1.5, -1.5, 0.25], static: true}
  - {name: box, asset: cube, scale: 0.6, position: [1.8, 1.7, 0.3], static: true}
"""  # noqa: E501 - one object a line


@pytest.fixture(scope="module")
def simulation(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Simulation]:
    path = tmp_path_factory.mktemp("yard") / "yard.yaml"
    path.write_text(YARD, encoding="utf-8")
    eye = AgentSpec(
        name="eye",
        intrinsics=CameraIntrinsics(width=64, height=48),
        following=False,
        rate_hz=0.0,
    )
    with Simulation(path, mode="lockstep", agent=eye) as simulation:
        yield simulation


def views_from(simulation: Simulation, view: CameraView) -> dict[str, np.ndarray]:
    simulation.set_pose(view.pose, teleport=True)
    return dict(simulation.capture(["instance", "depth"]).views)


def id_of(simulation: Simulation, name: str) -> int:
    return next(i.id for i in simulation.info.instances if i.name == name)


def test_objects_are_large_enough_and_little_hidden(simulation: Simulation) -> None:
    """Each has its turn; cover and visible share, counted; azimuths apart."""
    found = simulation.sample_cameras("object_view", 8, cover=(0.03, 0.5), visible=0.8)
    assert len(found) == 8
    ids = [id_of(simulation, name) for name in ("table", "vase", "ball", "box")]
    assert [view.target_id for view in found] == ids * 2
    for view in found:
        share = float((views_from(simulation, view)["instance"] == view.target_id).mean())
        assert 0.03 <= share <= 0.5
        masks = simulation.get_amodal_masks()
        row = masks.ids.tolist().index(view.target_id)
        assert share * 64 * 48 >= 0.8 * masks.whole_pixels[row]
        assert max(abs(v) for v in view.pose.position_m[:2]) < 2.95  # in no wall
    for first, second in zip(found[:4], found[4:], strict=True):
        at = next(i for i in simulation.info.instances if i.id == first.target_id)
        x, y, _ = simulation.get_object(at.id).pose.position_m
        turns = [
            math.atan2(v.pose.position_m[1] - y, v.pose.position_m[0] - x) for v in (first, second)
        ]
        assert abs(math.remainder(turns[0] - turns[1], math.tau)) >= math.radians(19.9)


def test_objects_are_not_looked_at_from_outside(tmp_path: Path) -> None:
    """Through a wall of glass they would be seen well; without a ceiling there is no outside."""
    ball = "{name: ball, asset: sphere, scale: 0.4, position: [0.7, 0, 0.6], static: true}"
    ceiling = (
        "{name: ceiling, asset: cube, scale: [2, 2, 0.1], rotation: [0, 0, 30], "
        "position: [0, 0, 4], category: ceiling, static: true}"
    )
    outside = {}
    for name, objects in (("pavilion", f"[{ceiling}, {ball}]"), ("space", f"[{ball}]")):
        path = tmp_path / f"{name}.yaml"
        path.write_text(f"version: 1\nobjects: {objects}\n", encoding="utf-8")
        with Simulation(path, mode="lockstep", agent=AgentSpec(name="eye")) as simulation:
            views = simulation.sample_cameras("object_view", 8, objects=("ball",), apart_deg=5.0)
        assert len(views) == 8
        places = np.array([view.pose.position_m[:2] for view in views])
        turn = math.radians(30.0)
        own = places @ np.array(
            [[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]]
        )
        outside[name] = int((np.abs(own) > 1.0).any(axis=1).sum())
    assert outside["pavilion"] == 0
    assert outside["space"] > 0


def test_objects_can_be_chosen(simulation: Simulation) -> None:
    """By name and by category."""
    ball, vase = (id_of(simulation, name) for name in ("ball", "vase"))
    named = simulation.sample_cameras("object_view", 2, objects=["ball"])
    assert {view.target_id for view in named} == {ball}
    both = simulation.sample_cameras("object_view", 2, objects=["ball"], categories=["vase"])
    assert {view.target_id for view in both} == {ball, vase}


def test_free_views_keep_height_pitch_and_distance(simulation: Simulation) -> None:
    """Free places, nothing too near in the picture, objects in view, no two alike."""
    settings = {
        "height_m": (1.0, 1.4),
        "pitch_deg": (5.0, 20.0),
        "clearance_m": 0.3,
        "nearest_m": 0.6,
        "objects": 2,
        "cover": 0.01,
    }
    found = simulation.sample_cameras("free_view", 6, **settings)
    assert len(found) == 6
    space = simulation.free_space(1.7, 0.3)
    objects = {id_of(simulation, name) for name in ("table", "vase", "ball", "box")}
    for view in found:
        roll, pitch, _ = view.pose.rpy_deg
        assert roll == pytest.approx(0.0, abs=1e-9)
        assert 5.0 <= pitch <= 20.0
        assert 1.0 <= view.pose.position_m[2] <= 1.4
        assert space.is_free(view.pose.position_m)
        shown = views_from(simulation, view)
        assert shown["depth"].min() >= 0.6
        ids, pixels = np.unique(shown["instance"], return_counts=True)
        seen = {int(i) for i, count in zip(ids, pixels, strict=True) if count >= 0.01 * 64 * 48}
        assert len(seen & objects) >= 2
    for number, first in enumerate(found):
        for second in found[:number]:
            away = math.dist(first.pose.position_m, second.pose.position_m)
            cosine = first.pose.matrix()[:3, 0] @ second.pose.matrix()[:3, 0]
            assert away >= 0.5 or cosine <= math.cos(math.radians(40.0)) + 1e-9


def test_free_views_beside_others_cost_no_pose(
    simulation: Simulation, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where all looks are like the one that is chosen, the others are told by numbers alone."""
    made: list[Pose] = []
    original = Pose.from_rpy_deg

    def counted(position_m: ArrayLike, rpy_deg: ArrayLike) -> Pose:
        made.append(original(position_m, rpy_deg))
        return made[-1]

    monkeypatch.setattr(Pose, "from_rpy_deg", counted)
    alike = {"apart_m": 100.0, "apart_deg": 180.0, "objects": 0, "nearest_m": 0.0}
    found = simulation.sample_cameras("free_view", 5, attempts=40, **alike)
    assert len(found) == 1
    assert made == [found[0].pose]


def test_few_views_show_everything(simulation: Simulation) -> None:
    """Three views from free space show each object at least to the share that counts."""
    found = simulation.sample_cameras("coverage", 3, visible=0.6, clearance_m=0.2)
    shown: set[int] = set()
    for view in found:
        seen = views_from(simulation, view)["instance"]
        masks = simulation.get_amodal_masks()
        for id_, whole in zip(masks.ids.tolist(), masks.whole_pixels.tolist(), strict=True):
            if whole and (seen == id_).sum() >= 0.6 * whole:
                shown.add(id_)
    assert {id_of(simulation, name) for name in ("table", "vase", "ball", "box")} <= shown


def test_pictures_of_the_room_show_much_and_nothing_large_in_front(simulation: Simulation) -> None:
    """The first is worth more than most views from free space; the second shows the rest."""
    first, second = simulation.sample_cameras("room_view", 2, attempts=80, objects=1)
    plain = simulation.sample_cameras("free_view", 8, objects=0, nearest_m=0.0)

    def shown(view: CameraView) -> tuple[int, float]:
        seen = views_from(simulation, view)
        objects = {id_of(simulation, name) for name in ("table", "vase", "ball", "box")}
        near = float((np.nan_to_num(seen["depth"], nan=0.0) < 1.1).mean())
        return len(objects & set(np.unique(seen["instance"]).tolist())), near

    others = sorted(shown(view)[0] for view in plain)
    assert shown(first)[0] >= others[len(others) // 2]
    assert shown(first)[1] < 0.1
    assert views_from(simulation, first)["depth"].min() >= 0.5
    assert first.pose != second.pose


@pytest.mark.parametrize("rule", sorted(camera_rules()))
def test_poses_come_from_name_and_seed(simulation: Simulation, rule: str) -> None:
    """The same again for the same, whatever was asked between; others for others."""
    first = simulation.sample_cameras(rule, 2, name="a", seed=5)
    other = simulation.sample_cameras(rule, 2, name="b", seed=5)
    assert simulation.sample_cameras(rule, 2, name="a", seed=5) == first
    assert other != first
    assert simulation.sample_cameras(rule, 2, name="a", seed=6) != first


def test_nobody_sees_that_cameras_were_sampled(simulation: Simulation) -> None:
    """The frames of an agent are as if nothing had been drawn between them."""
    simulation.reset()
    plain = [simulation.capture(["flow", "depth"]) for _ in range(2)]
    simulation.reset()
    first = simulation.capture(["flow", "depth"])
    simulation.sample_cameras("free_view", 2)
    second = simulation.capture(["flow", "depth"])
    for one, two in zip(plain, (first, second), strict=True):
        assert one["depth"].tobytes() == two["depth"].tobytes()
        assert one["flow"].tobytes() == two["flow"].tobytes()


def test_what_cannot_be_asked_for_is_refused(simulation: Simulation) -> None:
    """Each in a sentence that says what is accepted."""
    with pytest.raises(UnknownName, match="object_view"):
        simulation.sample_cameras("object_vew")
    with pytest.raises(InvalidEntry, match="is not a setting of free_view; its settings are"):
        simulation.sample_cameras("free_view", heigth_m=(1, 2))
    with pytest.raises(InvalidEntry, match="visible"):
        simulation.sample_cameras("object_view", visible=2.0)
    with pytest.raises(UnknownName, match="ball"):
        simulation.sample_cameras("object_view", objects=["bal"])
    with pytest.raises(InvalidRequest, match="height_m"):
        simulation.sample_cameras("free_view", height_m=(2.0, 1.0))
    with pytest.raises(InvalidRequest, match="count"):
        simulation.sample_cameras("free_view", 0)


def test_a_rule_that_cannot_be_met_ends(simulation: Simulation) -> None:
    """With fewer views, and not with a search without end."""
    assert simulation.sample_cameras("free_view", 2, nearest_m=50.0, attempts=20) == ()
    assert simulation.sample_cameras("coverage", 2, clearance_m=5.0) == ()


def test_the_page_has_every_setting() -> None:
    """Names, defaults and meanings of `docs/space.md` are those of the rules."""
    page = (Path(__file__).parents[4] / "docs" / "space.md").read_text(encoding="utf-8")
    for rule in camera_rules().values():
        for name, field in rule.settings.model_fields.items():
            rows = [
                row
                for row in page.splitlines()
                if f"`{rule.type}`" in row.partition(f"|`{name}`|")[0] and f"|`{name}`|" in row
            ]
            assert len(rows) == 1, (rule.type, name)
            assert str(field.description) in rows[0]
            assert _shown(field.default) in rows[0]


def _shown(value: object) -> str:
    if isinstance(value, tuple):
        return " … ".join(f"{number:g}" for number in value) or "none"
    return f"{value:g}"
