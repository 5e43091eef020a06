"""The present scene as a file of another program, from the page and by its address."""

from __future__ import annotations

import io
import json
import urllib.error
import urllib.request
import zipfile

import pytest
from playwright.sync_api import expect

from sailenv_ros.simulation import Simulation
from sailenv_ros.viewer import ViewerServer
from tests.support.browser import OpenPage


def _asked(server: ViewerServer, path: str) -> tuple[int, str, bytes]:
    """Return status, proposed name and bytes."""
    try:
        with urllib.request.urlopen(f"http://127.0.0.1:{server.port}/{path}", timeout=60.0) as got:
            return got.status, got.headers.get("Content-Disposition", ""), got.read()
    except urllib.error.HTTPError as refusal:
        return refusal.code, "", refusal.read()


def test_a_scene_is_one_file_or_an_archive(server: ViewerServer, simulation: Simulation) -> None:
    """What was added a moment ago is in it."""
    simulation.spawn_object("cube", (0.0, 0.0, 3.0), object_name="newcomer", scale=0.2)
    status, name, data = _asked(server, "export/glb")
    assert (status, name) == (200, 'attachment; filename="optical.glb"')
    length = int.from_bytes(data[12:16], "little")
    nodes = json.loads(data[20 : 20 + length])["nodes"]
    assert "newcomer" in {node.get("name") for node in nodes}
    status, name, data = _asked(server, "export/xml")
    assert (status, name) == (200, 'attachment; filename="optical_xml.zip"')
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        names = archive.namelist()
        assert "optical.xml" in names
        assert b"newcomer" in archive.read("optical.xml")
    assert all(not name.startswith(("/", "..")) for name in names)


@pytest.mark.parametrize("wanted", ["obj", "glb.zip", "..%2F..%2Fetc", "GLB"])
def test_other_formats_are_refused(server: ViewerServer, wanted: str) -> None:
    status, _, told = _asked(server, f"export/{wanted}")
    assert status == 404
    assert b"glb, usda, usdz, xml, sdf" in told or b"404" in told


@pytest.mark.slow
def test_the_page_downloads_it(opened: OpenPage) -> None:
    opened.tab("Scene")
    opened.page.select_option("#export-format", "usdz")
    with opened.page.expect_download() as coming:
        opened.page.click("button.export")
    assert coming.value.suggested_filename == "optical.usdz"
    expect(opened.page.locator("#exported")).to_contain_text("optical.usdz, ")
