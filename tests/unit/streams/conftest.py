"""A room that is built in an instant, and a course through it."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

import sailenv_ros.streams as streams
from sailenv_ros.streams import Course, Stream

ROOM = """
version: 1
room:
  size: [4, 3, 2.4]
  openings: [{wall: north, type: window, at: 0, width: 1, height: 1, sill: 1}]
lights:
  - {name: window light, type: area, position: [0, 1.4, 1.5], direction: [0, -1, -0.2], width: 1,
     height: 1, intensity: 2}
  - {name: lamp, type: point, position: [0.5, 0, 2], intensity: 1}
objects:
  - {name: ball, asset: sphere, category: cup, scale: 0.2, position: [0.6, 0.4, 0.2], mass: 0.3}
  - {name: cube, asset: cube, category: laptop, scale: 0.3, position: [-0.5, 0.6, 0.15],
     static: true}
  - name: flap
    asset: cube
    category: box
    scale: [0.5, 0.04, 0.5]
    position: [1.2, -0.6, 0.6]
    joint: {type: hinge, axis: [0, 0, 1], origin: [-0.25, 0, 0], limits: [0, 90]}
mover:
  waypoints:
    - {position: [-1.4, -1, 1.3], look_at: [0.5, 0.5, 0.4]}
    - {position: [1.2, -1, 1.3], look_at: [0, 0.5, 0.4]}
    - {position: [0, -1.2, 1.5], look_at: [0, 0.5, 0.4]}
  total_time: 6
agents:
  - {name: view, position: [-1.6, -1.2, 1.6], rotation: [0, 25, 40], rate: 0}
"""

COURSE = """
version: 1
rate: 30
episode: 6
visit: 2
rooms: {scenes: [%s, %s]}
eye: {width: 48, height: 32, fov: 70, picture: {smooth_edges: false}}
moves: {open: 1, pushed: 1}
drift:
  daylight: {day: 40, year: 4000}
  lamps: {onset: 5, life: 20, left: 0.5}
  paint: {onset: 12, every: 12, colours: ["#ff0000", "#00ff00", "#0000ff"]}
  wear: {onset: 0, over: 100, most: 1}
  mount: {onset: 18, every: 6, turn: 10, shift: 0.1, zoom: 0.2}
  sensor: [{setting: gain, onset: 10, over: 20, begin: 0, end: 2}]
  classes: [{category: cup, begin: 12}, {category: laptop, end: 24}]
"""


@pytest.fixture(scope="session")
def course_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("course")
    for name in ("one", "two"):
        (folder / f"{name}.yaml").write_text(ROOM)
    path = folder / "short.yaml"
    path.write_text(COURSE % (folder / "one.yaml", folder / "two.yaml"))
    return path


@pytest.fixture(scope="session")
def course(course_file: Path) -> Course:
    return streams.load_course(course_file)


@pytest.fixture(scope="session")
def stream(course: Course) -> Iterator[Stream]:
    with streams.open(course, seed=5, length=100) as opened:
        yield opened
