"""Contexts: which device is taken, what is said of it, and what is left when it is given back."""

from __future__ import annotations

import json
import logging
import subprocess
import sys
import threading
from collections.abc import Callable
from pathlib import Path

import pytest

from sailenv_ros.errors import ContextError, InvalidRequest, RenderError
from sailenv_ros.render.contract import RenderBackend, RenderRequest
from sailenv_ros.render.gl import context as contexts
from sailenv_ros.render.gl.context import DeviceReport, create_context, is_software, probe_devices
from sailenv_ros.render.gl.renderer import Renderer
from tests.render.conftest import Render
from tests.support.tiny_scenes import camera_at, snapshot_of

ROOT = Path(__file__).parents[2]


def test_every_device_is_reported_once_with_a_renderer_or_a_reason() -> None:
    """Devices are EGL's, numbered from 0 without gaps; each has a name or a refusal, not both."""
    reports = probe_devices()
    assert [report.index for report in reports] == list(range(len(reports)))
    assert any(not report.refused for report in reports)
    for report in reports:
        assert bool(report.renderer) != bool(report.refused)
        assert f"EGL device {report.index}: " in str(report)


def test_a_device_that_is_not_there_is_refused_with_the_driver_s_words() -> None:
    """Device 15 does not exist here: one error of our own, which tells what was tried."""
    with pytest.raises(ContextError, match="no OpenGL context could be created") as caught:
        Renderer(device=15)
    assert caught.value.attempts


@pytest.mark.parametrize("device", [-1, 16, 1.5, True, "0"])
def test_a_number_that_is_no_device_is_refused(device: object) -> None:
    """Anything but a number from 0 to 15 is refused in the parameter's own name."""
    with pytest.raises(InvalidRequest, match="render_device must be a number from 0 to 15"):
        create_context(device)  # type: ignore[arg-type]  # the mistake under test


def test_where_nothing_works_every_device_tried_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    """The error lists all devices with the reason of each."""
    reasons = ("no driver", "too old")
    refusals = [DeviceReport(index=i, refused=reason) for i, reason in enumerate(reasons)]
    monkeypatch.setattr(contexts, "probe_devices", lambda: tuple(refusals))
    with pytest.raises(ContextError) as caught:
        create_context()
    assert caught.value.attempts == ("EGL device 0: no driver", "EGL device 1: too old")


def test_hardware_is_taken_before_software(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of several devices the first with graphics hardware is opened, wherever it stands."""
    found = (
        DeviceReport(index=0, renderer="llvmpipe (LLVM 15.0.6, 256 bits)", version="4.5"),
        DeviceReport(index=1, refused="permission denied"),
        DeviceReport(index=2, renderer="A Graphics Card", version="4.6"),
    )
    opened: list[int] = []
    monkeypatch.setattr(contexts, "probe_devices", lambda: found)
    monkeypatch.setattr(contexts, "_open", opened.append)
    assert create_context()[1] is found[2]
    assert opened == [2]


def test_software_is_named_as_such_and_loudly(caplog: pytest.LogCaptureFixture) -> None:
    """A renderer on the CPU says so in its description, by a flag and in one warning."""
    with caplog.at_level(logging.WARNING):
        made = Renderer()
    made.close()
    loud = [record for record in caplog.records if "SOFTWARE" in record.getMessage()]
    assert made.software == is_software(made.description)
    assert len(loud) == (1 if made.software else 0)
    assert made.description.startswith("software OpenGL" if made.software else "OpenGL")


def test_a_closed_renderer_says_so(make_renderer: Callable[[], RenderBackend]) -> None:
    """Rendering after close is refused; closing twice does nothing."""
    made = make_renderer()
    made.close()
    made.close()
    with pytest.raises(RenderError, match="closed"):
        made.render(RenderRequest(snapshot_of([]), camera_at(), ["depth"]))


def test_two_renderers_in_two_threads(
    make_renderer: Callable[[], RenderBackend], render: Render
) -> None:
    """Each thread has a renderer of its own; both are right, at once."""
    camera, scene = camera_at(), snapshot_of([])
    expected = render(scene, camera, "rgb")["rgb"].tobytes()
    seen: list[bytes] = []

    def work() -> None:
        made = make_renderer()
        for _ in range(20):
            seen.append(made.render(RenderRequest(scene, camera, ["rgb"])).views["rgb"].tobytes())
        made.close()

    threads = [threading.Thread(target=work) for _ in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(60)
        assert not thread.is_alive()
    assert seen == [expected] * 40


WORK = """
import json, sys
from hashlib import sha256
from sailenv_ros.render.contract import RenderRequest
from sailenv_ros.render.gl.renderer import Renderer
from sailenv_ros.render.cpu.renderer import NativeRenderer
from sailenv_ros.types.snapshot import Observation
from tests.support.tiny_scenes import two_instants
before, after, then, now = two_instants()
digests = {}
for make in (NativeRenderer, Renderer):
    made = make()
    past = Observation(snapshot=before, camera=then)
    views = ["rgb", "depth", "category", "instance", "flow", "flow_valid", "occlusion"]
    rendered = made.render(RenderRequest(after, now, views, past)).views
    for name in views:
        digests[f"{make.__name__} {name}"] = sha256(rendered[name].tobytes()).hexdigest()
    made.close()
print(json.dumps(digests))
"""


def test_two_processes_agree_to_the_byte() -> None:
    """The same two snapshots give the same bytes of every view in another process, twice."""
    first, second = (json.loads(_in_a_process(WORK)) for _ in range(2))
    assert len(first) == 14
    assert first == second


MEASURE = """
import gc
import numpy as np
from sailenv_ros.render.contract import RenderRequest
from sailenv_ros.render.cpu.renderer import NativeRenderer
from sailenv_ros.render.gl.renderer import Renderer
from tests.support.tiny_scenes import *
def resident_kb():
    gc.collect()
    with open("/proc/self/status") as status:
        return next(int(line.split()[1]) for line in status if line.startswith("VmRSS"))
%s
for _ in range(3):
    pass_by()
grown = []
for _ in range(3):
    start = resident_kb()
    for _ in range(10):
        pass_by()
    grown.append(resident_kb() - start)
print(min(grown))  # what leaks does so each time; an allocator grows by leaps
"""

RENDERERS = """
before, after, then, now = two_instants()
def pass_by():
    made = %s()
    made.render(RenderRequest(after, now, ["rgb", "depth", "instance", "normals"]))
    made.close()
"""

SCENES = """
made = %s()
def pass_by():
    mesh = box_mesh(1.0)
    vertices = (np.tile(getattr(mesh, name), (5000, 1)) for name in ("positions", "normals", "uvs"))
    many = mesh_of(*vertices, mesh.triangles)
    model = model_of(many, base_colour_texture=np.full((1024, 1024, 4), 99, np.uint8))
    scene = snapshot_of([Thing(model, Pose((3.0, 0.0, 0.0)))])
    made.render(RenderRequest(scene, camera_at(), ["rgb"]))
"""


@pytest.mark.parametrize("kind", ["NativeRenderer", "Renderer"])
def test_renderers_give_their_memory_back(kind: str) -> None:
    """Ten renderers more leave less than 10 MB behind."""
    assert int(_in_a_process(MEASURE % (RENDERERS % kind))) < 10_000


@pytest.mark.parametrize("kind", ["NativeRenderer", "Renderer"])
def test_scenes_that_are_left_give_their_memory_back(kind: str) -> None:
    """Ten scenes more, each with 8 MB of its own in the renderer, leave less than 20 MB behind."""
    assert int(_in_a_process(MEASURE % (SCENES % kind))) < 20_000


def _in_a_process(program: str) -> str:
    done = subprocess.run(
        [sys.executable, "-c", program],
        capture_output=True,
        text=True,
        timeout=100,
        cwd=ROOT,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.splitlines()[-1]
