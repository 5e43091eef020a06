"""Every class of error in a scene file is told in one plain sentence, with its place."""

from __future__ import annotations

from pathlib import Path

import pytest

from sailenv_ros.errors import SceneError
from tests.unit.scene.reading import diagnostics, read

HEAD = "version: 1\nobjects:\n"

VALUES = {
    "not a number": (
        "  - {name: a, asset: cube, mass: heavy}",
        "3:34: objects[0].mass: must be a number above 0 and at most 1000000 [kg], got 'heavy'",
    ),
    "mass 0": (
        "  - {name: a, asset: cube, mass: 0}",
        "3:34: objects[0].mass: must be a number above 0 [kg], got 0 "
        "(static: true is for what never moves)",
    ),
    "negative mass": (
        "  - {name: a, asset: cube, mass: -1.0}",
        "3:34: objects[0].mass: must be a number above 0 [kg], got -1.0 "
        "(static: true is for what never moves)",
    ),
    "true is no number": (
        "  - {name: a, asset: cube, friction: true}",
        "3:38: objects[0].friction: must be a number from 0 to 10, got true",
    ),
    "NaN inside a vector": (
        "  - {name: a, asset: cube, position: [0, .nan, 1]}",
        "3:42: objects[0].position[1]: must be a number from -10000 to 10000 [m], got nan",
    ),
    "infinity": (
        "  - {name: a, asset: cube, position: [0, 0, -.inf]}",
        "3:45: objects[0].position[2]: must be a number from -10000 to 10000 [m], got -inf",
    ),
    "a number beyond floats": (
        f"  - {{name: a, asset: cube, scale: {'9' * 400}}}",
        "3:35: objects[0].scale: must be a number from 0.001 to 1000, got " + "9" * 57 + "...",
    ),
    "scale 0": (
        "  - {name: a, asset: cube, scale: 0}",
        "3:35: objects[0].scale: must be a number from 0.001 to 1000, got 0",
    ),
    "too few numbers": (
        "  - {name: a, asset: cube, position: [0, 1]}",
        "3:38: objects[0].position: must be three numbers [x, y, z] in [m], got [0, 1]",
    ),
    "a word for a vector": (
        "  - {name: a, asset: cube, rotation: left}",
        "3:38: objects[0].rotation: must be three numbers [roll, pitch, yaw] in [deg], got 'left'",
    ),
    "quaternion that is not of unit length": (
        "  - {name: a, asset: cube, orientation: [0, 0, 0, 2]}",
        "3:41: objects[0].orientation: must be a quaternion [x, y, z, w] of unit length, "
        "got [0, 0, 0, 2] of length 2",
    ),
    "two rotations": (
        "  - {name: a, asset: cube, rotation: [0, 0, 0], orientation: [0, 0, 0, 1]}",
        "3:62: objects[0].orientation: cannot stand beside rotation; "
        "give one of: rotation, orientation",
    ),
    "yes is a text": (
        "  - {name: a, asset: cube, static: yes}",
        "3:36: objects[0].static: must be true or false, got 'yes'",
    ),
    "colour": (
        "  - {name: a, asset: cube, colour: '#ff00'}",
        "3:36: objects[0].colour: must be a colour such as '#ff8800' (quoted, sRGB) or [r, g, b] "
        "of linear numbers from 0 to 1, got '#ff00'",
    ),
    "colour of too large numbers": (
        "  - {name: a, asset: cube, colour: [255, 0, 0]}",
        "3:36: objects[0].colour: must be a colour such as '#ff8800' (quoted, sRGB) or [r, g, b] "
        "of linear numbers from 0 to 1, got [255, 0, 0]",
    ),
    "name": (
        "  - {name: 'a/b', asset: cube}",
        "3:12: objects[0].name: must be a name of letters, digits, spaces, '_', '-' or '.', "
        "at most 63 characters, got 'a/b'",
    ),
    "missing key": (
        "  - {name: a}",
        "3:5: objects[0].asset: is missing (name in the catalogue, e.g. cube or Chair 01)",
    ),
    "unknown key with a near one": (
        "  - {name: a, asset: cube, friktion: 1}",
        "3:28: objects[0].friktion: is not a key that is known here; did you mean 'friction'?",
    ),
    "an object that is no mapping": (
        "  - cube",
        "3:5: objects[0]: must be a mapping (key: value), got 'cube'",
    ),
    "behaviour on a static object": (
        "  - {name: a, asset: cube, static: true, behaviours: [{type: spin}]}",
        "3:54: objects[0].behaviours: cannot be given to an object that never moves; "
        "leave behaviours out, or static: true out",
    ),
    "velocity of a static object": (
        "  - {name: a, asset: cube, static: true, velocity: [1, 0, 0]}",
        "3:52: objects[0].velocity: cannot be given to an object that never moves; "
        "leave velocity out, or static: true out",
    ),
    "unknown asset": (
        "  - {name: a, asset: Chair 02}",
        "3:22: objects[0].asset: there is no asset 'Chair 02'; did you mean 'Chair 01'?",
    ),
    "unknown category": (
        "  - {name: a, asset: cube, category: table}",
        "3:38: objects[0].category: there is no category 'table'; known: cube, chair, dining table",
    ),
    "the background is no category of objects": (
        "  - {name: a, asset: cube, category: background}",
        "3:38: objects[0].category: there is no category 'background'; "
        "known: cube, chair, dining table",
    ),
    "unknown behaviour": (
        "  - {name: a, asset: cube, behaviours: [{type: jump}]}",
        "3:48: objects[0].behaviours[0].type: must be one of: spin",
    ),
    "behaviour without a type": (
        "  - {name: a, asset: cube, behaviours: [{rate: 3}]}",
        "3:41: objects[0].behaviours[0].type: is missing "
        "(name of the behaviour, e.g. rotate_rigidbody)",
    ),
    "parameter of a behaviour": (
        "  - {name: a, asset: cube, behaviours: [{type: spin, rate: fast}]}",
        "3:60: objects[0].behaviours[0].rate: must be an integer",
    ),
    "two objects of one name": (
        "  - {name: a, asset: cube}\n  - {name: a, asset: cube}",
        "4:12: objects[1].name: must be unique among objects, but objects[0] has 'a' too",
    ),
    "soft close without limits": (
        "  - {name: a, asset: cube, joint: {type: slide, soft_close: {within: 0.1, speed: 1}}}",
        "3:61: objects[0].joint.soft_close: needs limits, at one of which the joint is shut",
    ),
    "soft close of no width": (
        "  - {name: a, asset: cube, joint: {type: slide, limits: [0, 1], soft_close: "
        "{within: 0, speed: 1}}}",
        "3:86: objects[0].joint.soft_close.within: must be a number from 0.0001 to 10000, got 0",
    ),
    "soft close without a speed": (
        "  - {name: a, asset: cube, joint: {type: slide, limits: [0, 1], soft_close: "
        "{within: 0.1}}}",
        "3:77: objects[0].joint.soft_close.speed: is missing (at the end at most, and with which "
        "it shuts by itself [rad/s] or [m/s])",
    ),
    "detents nowhere": (
        "  - {name: a, asset: cube, joint: {type: hinge, detents: {strength: 1}}}",
        "3:58: objects[0].joint.detents.every: is needed, or at: where a joint has its detents",
    ),
    "detents by two keys": (
        "  - {name: a, asset: cube, joint: {type: hinge, detents: {strength: 1, every: 1, "
        "at: [0, 1]}}}",
        "3:86: objects[0].joint.detents.at: cannot stand beside every; give one of: every, at",
    ),
    "a single detent without reach": (
        "  - {name: a, asset: cube, joint: {type: hinge, detents: {strength: 1, at: [0]}}}",
        "3:58: objects[0].joint.detents.within: is needed beside a single detent",
    ),
    "a detent beyond the limits": (
        "  - {name: a, asset: cube, joint: {type: hinge, limits: [0, 1], detents: {strength: 1, "
        "at: [0, 2]}}}",
        "3:96: objects[0].joint.detents.at[1]: must be within the limits, from 0 to 1, got 2",
    ),
    "detents of which none is within the limits": (
        "  - {name: a, asset: cube, joint: {type: hinge, limits: [0.1, 1], detents: "
        "{strength: 1, every: 2}}}",
        "3:97: objects[0].joint.detents.every: has no multiple within the limits, from 0.1 to 1",
    ),
    "detents of what is fixed": (
        "  - {name: a, asset: cube, joint: {type: fixed, detents: {strength: 1, every: 1}}}",
        "3:58: objects[0].joint.detents: means something only for a hinge or a slide",
    ),
}


@pytest.mark.parametrize(("text", "expected"), VALUES.values(), ids=VALUES)
def test_a_fault_of_an_object_names_its_place_and_what_is_accepted(
    tmp_path: Path, text: str, expected: str
) -> None:
    assert diagnostics(tmp_path, HEAD + text + "\n") == [expected]


ENTRIES = {
    "unknown key at the top": (
        "version: 1\nobject: []\n",
        "2:1: object: is not a key that is known here; did you mean 'objects'?",
    ),
    "no version": ("title: x\n", "1:1: version: is missing (of this format; 1)"),
    "version of another format": ("version: 2\n", "1:10: version: must be 1, got 2"),
    "another name than the file's": (
        "version: 1\nname: hall\n",
        "2:7: name: must be the file's name, 'room', or be left out; got 'hall'",
    ),
    "a list is expected": (
        "version: 1\nobjects: {a: 1}\n",
        "2:10: objects: must be a list (each entry begins with -), got a mapping with a",
    ),
    "an empty list is written []": (
        "version: 1\nobjects:\n",
        "2:9: objects: must be a list (each entry begins with -), got nothing",
    ),
    "a mapping is expected": (
        "version: 1\nenvironment: 3\n",
        "2:14: environment: must be a mapping (key: value), got 3",
    ),
    "choice": (
        "version: 1\nenvironment: {background: color}\n",
        "2:27: environment.background: must be one of: sky, colour (did you mean 'colour'?), "
        "got 'color'",
    ),
    "text": ("version: 1\ntitle: 3\n", "2:8: title: must be a text, got 3"),
    "long text": (
        f"version: 1\ntitle: {'x' * 201}\n",
        f"2:8: title: must be a text of at most 200 characters, got '{'x' * 56}...",
    ),
    "unquoted hash": (
        "version: 1\nenvironment:\n  sky_zenith: #ff0000\n",
        "3:14: environment.sky_zenith: must be a colour such as '#ff8800' (quoted, sRGB) or "
        "[r, g, b] of linear numbers from 0 to 1000000, got nothing; "
        "an unquoted # begins a comment in YAML",
    ),
    "kind of light": (
        "version: 1\nlights: [{type: pint, name: a}]\n",
        "2:17: lights[0].type: must be one of: directional, point, spot, area "
        "(did you mean 'point'?), got 'pint'",
    ),
    "light without a kind": (
        "version: 1\nlights: [{name: a}]\n",
        "2:10: lights[0].type: is missing; it says which kind this is",
    ),
    "key of another kind of light": (
        "version: 1\nlights: [{type: point, name: a, width: 2}]\n",
        "2:33: lights[0].width: is not a key that is known here; known: name, colour, intensity, "
        "indirect_multiplier, type, position, range",
    ),
    "a key called like the light's kind": (
        "version: 1\nlights: [{type: point, name: a, point: 2}]\n",
        "2:33: lights[0].point: is not a key that is known here; did you mean 'position'?",
    ),
    "direction without a length": (
        "version: 1\nlights: [{type: directional, name: a, direction: [0, 0, 0.0]}]\n",
        "2:50: lights[0].direction: must be three numbers [x, y, z], not all 0",
    ),
    "cones that do not nest": (
        "version: 1\nlights: [{type: spot, name: a, inner_cone: 50}]\n",
        "2:44: lights[0].inner_cone: is refused: inner_cone must be at most outer_cone, "
        "got 50 and 35",
    ),
    "two lights of one name": (
        "version: 1\nlights: [{type: point, name: a}, {type: area, name: a}]\n",
        "2:53: lights[1].name: must be unique among lights, but lights[0] has 'a' too",
    ),
    "mover and movers": (
        "version: 1\nmover: {}\nmovers: [{}]\n",
        "3:9: movers: cannot stand beside mover; give one of: mover, movers",
    ),
    "looking at where one is": (
        "version: 1\nmover: {waypoints: [{position: [1, 2, 3], look_at: [1, 2, 3]}]}\n",
        "2:52: mover.waypoints[0].look_at: must be a point away from position, got [1, 2, 3]",
    ),
    "time that stands still": (
        "version: 1\nmover: {total_time: 0}\n",
        "2:21: mover.total_time: must be a number above 0 [s], got 0",
    ),
    "size of a picture": (
        "version: 1\nagents: [{name: a, width: 100000}]\n",
        "2:27: agents[0].width: must be an integer from 8 to 4096 [px], got 100000",
    ),
    "size that is no integer": (
        "version: 1\nagents: [{name: a, width: 64.5}]\n",
        "2:27: agents[0].width: must be an integer from 8 to 4096 [px], got 64.5",
    ),
    "agent's name": (
        "version: 1\nagents: [{name: Eye}]\n",
        "2:17: agents[0].name: must be a lower-case letter, then lower-case letters, digits or "
        "underscores, at most 63, got 'Eye'",
    ),
    "view": (
        "version: 1\nagents: [{name: a, views: [rgb, dept]}]\n",
        "2:33: agents[0].views[1]: must be one of: rgb, depth, category, instance, flow, "
        "flow_valid, occlusion, range, lens_valid, normals, albedo, uv, metallic_roughness, "
        "measured_depth, raw, object_coords (did you mean 'depth'?), got 'dept'",
    ),
    "view named twice": (
        "version: 1\nagents: [{name: a, views: [rgb, rgb]}]\n",
        "2:33: agents[0].views[1]: names 'rgb' a second time",
    ),
    "no view": (
        "version: 1\nagents: [{name: a, views: []}]\n",
        "2:27: agents[0].views: must be a list of at least 1 entry, got 0",
    ),
    "near beyond far": (
        "version: 1\nagents: [{name: a, near: 0.5, far: 0.2}]\n",
        "2:26: agents[0].near: is refused: near must be less than far, got 0.5 and 0.2",
    ),
    "an axis beside the picture": (
        "version: 1\nagents: [{name: a, width: 100, cx_offset: -50.5}]\n",
        "2:43: agents[0].cx_offset: is refused: it must be within half of width, 50, got -50.5",
    ),
    "an angle of view that a pin-hole has not": (
        "version: 1\nagents: [{name: a, vertical_fov: 175}]\n",
        "2:34: agents[0].vertical_fov: must be a number from 1 to 170 [deg], got 175",
    ),
    "an unknown model of lenses": (
        "version: 1\nagents: [{name: a, distortion_model: plumbbob}]\n",
        "2:38: agents[0].distortion_model: must be one of: pinhole, plumb_bob, "
        "rational_polynomial, equidistant, double_sphere, mei, equirectangular, orthographic (did "
        "you mean 'plumb_bob'?), got 'plumbbob'",
    ),
    "too few coefficients": (
        "version: 1\nagents:\n- name: a\n  distortion_model: plumb_bob\n  distortion: [0.1, 0.2]\n",
        "5:15: agents[0].distortion: must be 4 or 5 finite numbers, the coefficients k1 k2 p1 p2 "
        "k3 of plumb_bob, got [0.1, 0.2]",
    ),
    "no coefficients at all": (
        "version: 1\nagents: [{name: a, distortion_model: equidistant}]\n",
        "2:38: agents[0].distortion_model: does not fit: distortion must be 4 finite numbers, the "
        "coefficients k1 k2 k3 k4 of equidistant, got []",
    ),
    "one focal length": (
        "version: 1\nagents: [{name: a, fx: 300}]\n",
        "2:24: agents[0].fx: does not fit: fy must be above 0 [px] where the other focal length "
        "is; or both 0, got 0.0",
    ),
    "parallel rays without a scale": (
        "version: 1\nagents: [{name: a, distortion_model: orthographic}]\n",
        "2:38: agents[0].distortion_model: does not fit: fx must be above 0 [px/m], since all rays "
        "are parallel, got 0.0",
    ),
    "a depth sensor of parallel rays": (
        "version: 1\nagents:\n- {name: a, distortion_model: orthographic, fx: 9, fy: 9,\n"
        "   picture: {depth_sensor: kinect_v1}}\n",
        "4:28: agents[0].picture.depth_sensor: is refused: it must be 'ideal' where rays are "
        "parallel, since depth sensors look from one point, got 'kinect_v1'",
    ),
    "a lens that folds in the picture": (
        "version: 1\nagents:\n- {name: a, distortion_model: plumb_bob, fx: 200, fy: 200,\n"
        "   distortion: [-0.5, 0, 0, 0]}\n",
        "4:16: agents[0].distortion: must be coefficients that do not fold within the picture, or "
        "max_angle must be less than 39.2315 [deg], where these fold, got [-0.5, 0, 0, 0]",
    ),
    "an image circle beyond the model's": (
        "version: 1\nagents: [{name: a, max_angle: 95}]\n",
        "2:31: agents[0].max_angle: must be at most 89.5 [deg], where the law of pinhole ends, got "
        "95",
    ),
    "an agent turned nowhere": (
        "version: 1\nagents: [{name: a, rotation: [0, 0, 9]}]\n",
        "2:30: agents[0].rotation: needs a position beside it",
    ),
    "an agent's mover": (
        "version: 1\nmovers: [{name: left}, {name: right}]\nagents: [{name: a, mover: rihgt}]\n",
        "3:27: agents[0].mover: the scene has no mover 'rihgt'; did you mean 'right'?",
    ),
    "an id of the fixed table": (
        "version: 1\ncategories: [{name: rocket, id: 3}]\n",
        "2:33: categories[0].id: must be an integer from 200 to 65535, got 3",
    ),
    "a name of the fixed table": (
        "version: 1\ncategories: [{name: chair, id: 200}]\n",
        "2:21: categories[0].name: 'chair' is in the fixed table already; use another",
    ),
    "an id twice": (
        "version: 1\ncategories: [{name: a, id: 200}, {name: b, id: 200}]\n",
        "2:48: categories[1].id: must be unique among categories, but categories[0] has 200 too",
    ),
}


@pytest.mark.parametrize(("text", "expected"), ENTRIES.values(), ids=ENTRIES)
def test_a_fault_elsewhere_names_its_place_and_what_is_accepted(
    tmp_path: Path, text: str, expected: str
) -> None:
    assert diagnostics(tmp_path, text) == [expected]


def test_all_faults_are_told_at_once_in_the_order_of_the_file(tmp_path: Path) -> None:
    text = """\
version: 1
titel: many errors
objects:
  - name: a
    mass: -2
    mass: 3
    asset: cub
  - {name: a, asset: cube, static: true, behaviours: [{type: fly}]}
lights:
  - {type: directional, name: sun, intensity: .nan}
"""
    told = diagnostics(tmp_path, text)
    places = [tuple(int(part) for part in line.split(":")[:2]) for line in told]
    assert places == sorted(places)
    assert [line.split(": ")[1] for line in told] == [
        "titel",
        "objects[0].mass",
        "the key 'mass' stands in line 5 already",
        "objects[0].asset",
        "objects[1].name",
        "objects[1].behaviours",
        "objects[1].behaviours[0].type",
        "lights[0].intensity",
    ]


def test_a_category_that_the_scene_adds_may_be_used(tmp_path: Path) -> None:
    text = (
        HEAD
        + "  - {name: a, asset: cube, category: rocket}\ncategories: [{name: rocket, id: 201}]\n"
    )
    assert read(tmp_path, text).objects[0].category == "rocket"


def test_names_are_left_alone_without_knowledge(tmp_path: Path) -> None:
    spec = read(tmp_path, HEAD + "  - {name: a, asset: anything}\n", knowledge=None)
    assert spec.objects[0].asset == "anything"


def test_a_very_long_list_of_faults_is_cut_and_says_so(tmp_path: Path) -> None:
    told = diagnostics(tmp_path, HEAD + "  - {name: a b, asset: cube, mass: 0}\n" * 80)
    assert len(told) == 101
    # 80 masses and 79 repeated names, of which 100 are told.
    assert told[-1].endswith("and 59 more errors")


def test_a_file_that_is_not_there(tmp_path: Path) -> None:
    from sailenv_ros.scene import load_scene

    with pytest.raises(SceneError, match=r"none\.yaml: cannot be read: No such file"):
        load_scene(tmp_path / "none.yaml")
    with pytest.raises(SceneError, match="cannot be read: Is a directory"):
        load_scene(tmp_path)
