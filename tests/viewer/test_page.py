"""The page in a real browser: what people see and do there, against the simulation behind it."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest
from playwright.sync_api import Browser, Locator, WebSocketRoute, expect

from sailenv_ros.cli.main import main
from sailenv_ros.simulation import Simulation
from sailenv_ros.simulation.background_build import BackgroundBuild, BuildStep
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.picture_settings import PictureSettings
from sailenv_ros.types.views import FIVE_VIEWS
from sailenv_ros.viewer import ViewerServer
from tests.support.browser import PHONE, OpenPage
from tests.support.waiting import until

pytestmark = pytest.mark.slow


def controller(simulation: Simulation) -> str:
    """What drives the mover."""
    return simulation.info.movers[0].controller


def take_over(opened: OpenPage, simulation: Simulation) -> None:
    """Press Tab until the keys drive the mover."""
    if controller(simulation) == "waypoint":
        opened.page.keyboard.press("Tab")
    until(lambda: controller(simulation) == "rigidbody", "the keys to drive")
    opened.until(lambda: opened.data("controller") == "rigidbody", "the page to know it")


def test_all_five_views_are_shown_and_change(opened: OpenPage) -> None:
    """Every picture is drawn, moves, and the legend tells what is in it."""
    before = {view: opened.picture(view) for view in FIVE_VIEWS}
    opened.until(
        lambda: all(opened.picture(view) != before[view] for view in FIVE_VIEWS), "new pictures"
    )
    assert len(set(before.values())) == len(FIVE_VIEWS)
    expect(opened.page.locator("#legend .row").first).to_be_visible()
    expect(opened.page.locator("#fps")).to_contain_text("fps")


def test_one_view_is_shown_alone_and_another_large(opened: OpenPage) -> None:
    """A click on a small picture makes it the large one; the button hides the others."""
    page = opened.page
    page.click("[data-view=depth]")
    expect(page.locator(".tile.main .label")).to_have_text("depth")
    page.click("#layout")
    expect(page.locator(".tile:visible")).to_have_count(1)
    opened.wait_for_frames()
    before = opened.picture("depth")
    opened.until(lambda: opened.picture("depth") != before, "the picture alone to move")


def test_further_views_are_shown_when_they_are_wanted(
    opened: OpenPage, simulation: Simulation
) -> None:
    """The simulator says which there are; a box adds one, and takes it away again."""
    page = opened.page
    boxes = page.locator("#shown-views input")
    expect(boxes).to_have_count(len(simulation.supported_views))
    expect(page.locator(".tile:visible")).to_have_count(len(FIVE_VIEWS))
    page.check("[data-shows=normals]")
    expect(page.locator(".tile:visible")).to_have_count(len(FIVE_VIEWS) + 1)
    before = opened.picture("normals")
    opened.until(lambda: opened.picture("normals") != before, "the added view to move")
    page.mouse.move(*opened.at(0.5, 0.5))
    expect(page.locator("#probe")).to_contain_text("normals")
    page.uncheck("[data-shows=normals]")
    expect(page.locator(".tile:visible")).to_have_count(len(FIVE_VIEWS))


def test_tab_hands_the_mover_over_and_back(opened: OpenPage, simulation: Simulation) -> None:
    """As in SAILenv: waypoints or keyboard."""
    drivers = ("waypoint", "rigidbody")
    at = drivers.index(controller(simulation))
    for wanted in (drivers[1 - at], drivers[at]):
        opened.page.keyboard.press("Tab")
        until(lambda wanted=wanted: controller(simulation) == wanted, "Tab to hand over")
        opened.until(lambda wanted=wanted: opened.data("controller") == wanted, "it to be shown")


def test_keys_walk_the_mover(opened: OpenPage, simulation: Simulation) -> None:
    """W goes where it looks, A to its left, E up; what is let go stops."""
    take_over(opened, simulation)
    for key, axis in (("w", 0), ("a", 1), ("e", 2)):
        start = simulation.get_mover_pose()
        yaw = math.radians(start.rpy_deg[2])
        towards = {0: (math.cos(yaw), math.sin(yaw), 0.0), 1: (-math.sin(yaw), math.cos(yaw), 0.0)}
        direction = np.array(towards.get(axis, (0.0, 0.0, 1.0)))
        opened.page.keyboard.down(key)
        opened.until(
            lambda start=start, direction=direction: (
                (np.array(simulation.get_mover_pose().position_m) - start.position_m) @ direction
                > 0.1
            ),
            f"{key} to move the mover",
        )
        opened.page.keyboard.up(key)
        moved = np.array(simulation.get_mover_pose().position_m) - start.position_m
        assert np.linalg.norm(moved - (moved @ direction) * direction) < 0.02
        opened.until(lambda: not moves(simulation), "the mover to stand")


def moves(simulation: Simulation) -> bool:
    """True if the mover is elsewhere after a tenth of a simulated second."""
    before, time_ns = simulation.get_mover_pose(), simulation.sim_time_ns
    until(lambda: simulation.sim_time_ns > time_ns + 100_000_000, "simulated time")
    return simulation.get_mover_pose() != before


def test_dragging_turns_and_the_wheel_zooms(opened: OpenPage, simulation: Simulation) -> None:
    """Dragged to the right the picture follows, so the camera turns left; the lens is told."""
    take_over(opened, simulation)
    before = simulation.get_mover_pose().rpy_deg
    page = opened.page
    page.mouse.move(*opened.at(0.4, 0.5))
    page.mouse.down()
    page.mouse.move(*opened.at(0.6, 0.4), steps=4)
    page.mouse.up()
    until(lambda: simulation.get_mover_pose().rpy_deg[2] > before[2] + 5.0, "a turn to the left")
    until(lambda: simulation.get_mover_pose().rpy_deg[1] > before[1] + 2.0, "a look down")
    lens = simulation.info.agents[-1].intrinsics
    page.mouse.wheel(0, 300)
    until(
        lambda: simulation.info.agents[-1].intrinsics.vertical_fov_deg > lens.vertical_fov_deg,
        "a wider lens",
    )


def test_walk_lends_the_mouse_and_takes_over(opened: OpenPage, simulation: Simulation) -> None:
    """The button gives the mover to whoever looks around; to the right is a turn to the right."""
    page = opened.page
    page.click("#walk")
    opened.until(lambda: page.evaluate("document.pointerLockElement !== null"), "the mouse")
    until(lambda: controller(simulation) == "rigidbody", "the keys to drive")
    before = simulation.get_mover_pose().rpy_deg[2]
    x, y = opened.at(0.3, 0.5)
    page.mouse.move(x, y)
    page.mouse.move(x + 100, y, steps=4)
    until(lambda: simulation.get_mover_pose().rpy_deg[2] != before, "a turn")
    assert (simulation.get_mover_pose().rpy_deg[2] - before) % 360.0 > 180.0
    page.evaluate("document.exitPointerLock()")


def test_what_is_dragged_into_the_picture_is_spawned(
    opened: OpenPage, simulation: Simulation
) -> None:
    """From the catalogue to where it is let go; then it is selected, and a click places it."""
    page = opened.page
    opened.tab("Add")
    page.fill("#catalogue-search", "sphere")
    page.drag_and_drop("[data-asset=sphere]", ".tile.main")
    opened.until(lambda: opened.data("selected") not in ("", "0"), "the new object")
    number = int(opened.data("selected"))
    before = simulation.get_object(number)
    assert before.asset == "sphere"
    page.click("text=Place by a click")
    page.mouse.click(*opened.at(0.2, 0.95))
    until(
        lambda: (
            np.linalg.norm(
                np.subtract(
                    simulation.get_object(number).pose.position_m[:2], before.pose.position_m[:2]
                )
            )
            > 0.3
        ),
        "it to be placed elsewhere",
    )


def test_the_probe_shows_the_arrays_values(opened: OpenPage, simulation: Simulation) -> None:
    """While time stands still, what is shown of a pixel is what a capture has there."""
    page = opened.page
    page.click("#play")
    until(lambda: simulation.info.paused, "time to stand")
    opened.until(lambda: not changes(opened), "the last picture")
    frame = simulation.capture(("rgb", "depth", "category", "instance"), agent="debug_agent")
    height, width = frame["depth"].shape
    for u, v in ((0.5, 0.5), (0.2, 0.9)):
        column, row = int(u * width), int(v * height)
        page.mouse.move(*opened.at((column + 0.5) / width, (row + 0.5) / height))
        shown = page.locator("#probe")
        expect(shown).to_contain_text(f"{column}, {row}")
        expect(shown).to_contain_text(f"({frame['category'][row, column]})")
        instance = int(frame["instance"][row, column])
        expect(shown).to_contain_text(f"({instance})" if instance else "none")
        depth = float(frame["depth"][row, column])
        expect(shown).to_contain_text(f"{depth:.3f} m" if math.isfinite(depth) else "nothing hit")
        expect(shown).to_contain_text(", ".join(map(str, frame["rgb"][row, column])))
    page.click("#step")
    page.click("#play")
    until(lambda: not simulation.info.paused, "time to run")


def test_the_probe_follows_a_pointer_that_is_faster_than_answers(
    browser: Browser, server: ViewerServer, simulation: Simulation
) -> None:
    """The last place is asked for even if the pointer got there while an answer was on its way."""
    simulation.change_scene("optical")
    held: list[Callable[[], None]] = []
    holds = True
    opened = OpenPage(browser, "about:blank")

    def between(page_side: WebSocketRoute) -> None:
        server_side = page_side.connect_to_server()

        def passed_on(message: str | bytes) -> None:
            if holds and isinstance(message, str) and '"sequence"' in message:
                held.append(lambda: page_side.send(message))
            else:
                page_side.send(message)

        server_side.on_message(passed_on)

    page = opened.page
    page.route_web_socket("**/socket*", between)
    page.goto(server.url)
    opened.wait_for_frames()
    simulation.pause()
    opened.until(lambda: not changes(opened), "the last picture")
    page.mouse.move(*opened.at(0.25, 0.25))
    opened.until(lambda: held, "an answer")
    page.mouse.move(*opened.at(0.75, 0.75))
    expect(page.locator("#probe")).to_contain_text("Point at a picture")
    holds = False
    for send in held:
        send()
    expect(page.locator("#probe")).to_contain_text("120, 90")
    simulation.resume()
    opened.close()


PAINTED = """() => {
  const over = document.querySelector(".tile.main .over");
  const copy = document.createElement("canvas");
  [copy.width, copy.height] = [over.width, over.height];
  const pen = copy.getContext("2d", { willReadFrequently: true });
  pen.drawImage(over, 0, 0);
  const bytes = pen.getImageData(0, 0, copy.width, copy.height).data;
  return bytes.filter((value, at) => at % 4 === 3 && value > 0).length;
}"""
"""How many pixels are drawn over the large picture."""


def test_objects_are_drawn_over_the_picture(opened: OpenPage, simulation: Simulation) -> None:
    """Boxes, boxes in space, the whole of what is pointed at: each adds to what is drawn."""
    page = opened.page
    simulation.pause()
    opened.until(lambda: not changes(opened), "the last picture")
    empty = page.evaluate(PAINTED)
    for key in ("boxes", "space"):
        page.check(f"[data-draws={key}]")
        opened.until(lambda: page.evaluate(PAINTED) > empty, "something to be drawn")
        page.uncheck(f"[data-draws={key}]")
        opened.until(lambda: page.evaluate(PAINTED) == empty, "it to go")
    frame = simulation.capture(("instance",), agent="debug_agent")
    ids, counts = np.unique(frame["instance"][frame["instance"] > 0], return_counts=True)
    rows, columns = np.nonzero(frame["instance"] == ids[counts.argmax()])
    middle = len(rows) // 2
    height, width = frame["instance"].shape
    page.check("[data-draws=whole]")
    page.mouse.move(*opened.at((columns[middle] + 0.5) / width, (rows[middle] + 0.5) / height))
    opened.until(lambda: page.evaluate(PAINTED) > empty, "the whole object's outline")
    page.uncheck("[data-draws=whole]")
    simulation.resume()


def changes(opened: OpenPage) -> bool:
    """True if another frame is shown within a while."""
    before = opened.frames
    opened.page.wait_for_timeout(400)
    return opened.frames != before


def test_a_scene_is_made_without_code(
    opened: OpenPage, simulation: Simulation, own_scenes: Path
) -> None:
    """Spawn, edit, let move, place waypoints, save; the file is valid and gives it all back."""
    page = opened.page
    # Else the cube falls while it is edited, and the numbers change with it.
    simulation.pause()
    opened.tab("Add")
    page.fill("#catalogue-search", "cube")
    page.click("[data-asset=cube]")
    opened.until(lambda: opened.data("selected") not in ("", "0"), "the new object to be selected")
    number = int(opened.data("selected"))
    fill(opened, "#object-name", "my cube")
    fill(opened, "#scale-x", "0.5")
    fill(opened, "#position-z", "1.5")
    fill(opened, "#rpy_deg-z", "30")
    page.select_option("#object-category", "chair")
    until(lambda: simulation.get_object(number).category == "chair", "the category")
    page.click("summary")
    page.select_option("#behaviour", "rotate_rigidbody")
    page.click("text=Attach")
    until(lambda: simulation.get_object(number).behaviours, "the behaviour")
    opened.tab("Path")
    page.click("text=Clear")
    page.click("text=Add here")
    until(lambda: len(simulation.info.movers[0].waypoints) == 1, "a waypoint")
    opened.tab("Scene")
    page.fill("#save-name", "made_here")
    page.click("button.save")
    file = own_scenes / "made_here.yaml"
    until(file.is_file, "the file")
    assert main(["scene", "check", str(file)]) == 0
    made = simulation.get_object(number)
    page.select_option("#scene", "made_here")
    until(lambda: simulation.info.scene == "made_here", "the saved scene")
    again = simulation.get_object("my cube")
    assert (again.asset, again.category) == ("cube", "chair")
    assert again.scale == pytest.approx((0.5, 1.0, 1.0))
    assert again.pose.position_m[:2] == pytest.approx(made.pose.position_m[:2], abs=0.3)
    assert [kind["type"] for kind in again.behaviours] == ["rotate_rigidbody"]
    assert len(simulation.info.movers[0].waypoints) == 1
    opened.until(lambda: opened.data("scene") == "made_here", "the page to show it")
    simulation.resume()


def fill(opened: OpenPage, selector: str, value: str) -> None:
    """Type into a field and leave it, once the answer has been shown."""
    opened.page.fill(selector, value)
    opened.page.locator(selector).press("Enter")
    opened.page.locator(selector).blur()
    # Numbers come back with more digits.
    expect(opened.page.locator(selector)).to_have_value(re.compile(rf"^{re.escape(value)}\.?0*$"))


def test_a_click_selects_and_delete_deletes(opened: OpenPage, simulation: Simulation) -> None:
    """The outline is drawn around what was clicked; Esc leaves it, Del takes it away."""
    page = opened.page
    number = simulation.info.instances[1].id
    opened.tab("Object")
    page.click(f"#objects [data-id='{number}']")
    opened.until(lambda: opened.data("selected") == str(number), "the selection")
    page.locator("#stage").focus()
    page.keyboard.press("Escape")
    opened.until(lambda: opened.data("selected") == "0", "nothing selected")
    page.mouse.click(*opened.at(0.5, 0.9))
    opened.until(lambda: opened.data("selected") not in ("", "0"), "a click to select")
    page.click(f"#objects [data-id='{number}']")
    page.locator("#stage").focus()
    page.keyboard.press("Delete")
    until(lambda: number not in {i.id for i in simulation.info.instances}, "it to be gone")


def test_lights_time_and_files(opened: OpenPage, simulation: Simulation, tmp_path: Path) -> None:
    """A slider dims a light, buttons pause and begin anew, pictures are saved."""
    page = opened.page
    opened.tab("Light")
    page.locator("[data-light=sun] input[type=range]").fill("0")
    until(lambda: simulation.info.lights[0].intensity == 0.0, "the sun to set")
    shot = cv2.imread(str(opened.download("#screenshot", tmp_path)))
    assert shot.shape == (120, 160, 3)
    sheet = cv2.imread(str(opened.download("#sheet", tmp_path)))
    assert sheet.shape[1] > 3 * 160
    epoch = simulation.info.epoch
    page.click("#reset")
    until(lambda: simulation.info.epoch > epoch, "a new beginning")
    assert simulation.info.lights[0].intensity > 0.0
    opened.wait_for_frames()


def test_a_picture_is_set_by_its_panel(opened: OpenPage, simulation: Simulation) -> None:
    """Slider, list, switch and number reach the watched agent and no other; defaults undo them."""
    page = opened.page
    lens = CameraIntrinsics(width=96, height=72)
    simulation.register_agent(AgentSpec(name="eye", intrinsics=lens))

    def picture(name: str) -> PictureSettings:
        (found,) = (agent.picture for agent in simulation.info.agents if agent.name == name)
        return found

    def control(name: str) -> Locator:
        return page.locator(f"[data-setting={name}] :is(input, select)")

    opened.tab("Picture")
    expect(control("exposure")).to_have_value("0")
    dark = opened.brightness("rgb")
    control("exposure").fill("2")
    until(lambda: picture("debug_agent").exposure == 2.0, "the exposure to be set")
    opened.until(lambda: opened.brightness("rgb") > 1.2 * dark, "a brighter picture")
    control("tone_curve").select_option("linear")
    until(lambda: picture("debug_agent").tone_curve == "linear", "the curve to be set")
    control("smooth_edges").uncheck()
    until(lambda: not picture("debug_agent").smooth_edges, "edges to be left as they are")
    control("full_well").fill("2000")
    control("full_well").press("Enter")
    until(lambda: picture("debug_agent").full_well == 2000.0, "noise")
    control("read_noise").fill("-1")
    control("read_noise").press("Enter")
    expect(page.locator(".toast.error")).to_contain_text("read_noise must be")
    expect(control("read_noise")).to_have_value("0")
    expect(control("full_well")).to_have_value("2000")
    assert picture("eye") == PictureSettings()
    simulation.set_picture(exposure=-5.0, bloom=0.5, agent="eye")
    page.select_option("#agent", "eye")
    expect(control("bloom")).to_have_value("0.5")
    expect(control("exposure")).to_have_value("-5")  # beyond what the slider usually has
    expect(control("smooth_edges")).to_be_checked()
    page.click(".defaults")
    until(lambda: picture("eye") == PictureSettings(), "the defaults")
    page.select_option("#agent", "debug_agent")
    expect(control("exposure")).to_have_value("2")
    page.click(".defaults")
    until(lambda: picture("debug_agent") == PictureSettings(), "the defaults")
    simulation.delete_agent("eye")


def test_lights_are_hung_up_and_taken_down(opened: OpenPage, simulation: Simulation) -> None:
    """With a name of one's own or one that is made; a name in use is refused in words."""
    page = opened.page

    def names() -> list[str]:
        return [light.name for light in simulation.info.lights]

    own = names()
    opened.tab("Light")
    page.get_by_text("Add a light").click()
    page.click(".add-light")
    until(lambda: names() == [*own, "point 1"], "a light of a name that is made")
    expect(page.locator("[data-light='point 1'] .kind")).to_have_text("point")
    page.click(".add-light")
    until(lambda: names() == [*own, "point 1", "point 2"], "another one")
    page.select_option("#light-type", "spot")
    page.fill("#light-name", "reading lamp")
    page.click(".add-light")
    expect(page.locator("[data-light='reading lamp'] .kind")).to_have_text("spot")
    expect(page.locator("#light-name")).to_have_value("")
    page.fill("#light-name", "sun")
    page.click(".add-light")
    expect(page.locator(".toast.error")).to_contain_text("sun")
    page.locator("[data-light='reading lamp'] input[type=range]").fill("0")
    until(lambda: simulation.info.lights[-1].intensity == 0.0, "the lamp to be put out")
    for name in ("reading lamp", "point 1"):
        page.get_by_title(f"Remove {name}").click()
        expect(page.locator(f"[data-light='{name}']")).to_have_count(0)
    assert names() == [*own, "point 2"]


def test_who_may_only_watch_sees_no_tools(browser: Browser, simulation: Simulation) -> None:
    """From elsewhere, without --viewer-control: pictures, but nothing to change."""
    with ViewerServer(simulation, host="0.0.0.0", port=0) as server:
        token = server.url.partition("?")[2]
        opened = OpenPage(browser, f"http://127.0.0.1:{server.port}/?{token}")
        opened.wait_for_frames()
        expect(opened.page.locator("#watching-only")).to_be_visible()
        expect(opened.page.locator("#time-buttons")).to_be_hidden()
        before = controller(simulation)
        opened.page.keyboard.press("Tab")
        opened.wait_for_frames()
        assert controller(simulation) == before
        opened.close()


@pytest.mark.parametrize(("size", "scheme"), [((1280, 720), "light"), ((400, 800), "dark")])
def test_the_page_fits(
    browser: Browser, server: ViewerServer, size: tuple[int, int], scheme: str
) -> None:
    """Nothing is wider than the window; large pictures are visible; colours follow the system."""
    opened = OpenPage(
        browser,
        server.url,
        viewport={"width": size[0], "height": size[1]},
        color_scheme=scheme,
        has_touch=size == (PHONE["width"], PHONE["height"]),
    )
    opened.wait_for_frames(1)
    page = opened.page
    for title in ("View", "Object", "Add", "Light", "Picture", "Path", "Scene"):
        opened.tab(title)
        assert page.evaluate("document.documentElement.scrollWidth") <= size[0]
        hidden = page.evaluate(
            "document.querySelector('#tabs').scrollWidth - "
            "document.querySelector('#tabs').clientWidth"
        )
        assert hidden <= 0, f"{hidden} px of the tabs with {title} open"
    box = page.locator(".tile.main").bounding_box()
    assert box is not None
    assert box["x"] >= 0
    assert box["x"] + box["width"] <= size[0]
    assert box["y"] + box["height"] <= size[1]
    paper = page.evaluate("getComputedStyle(document.body).backgroundColor")
    brightness = sum(map(int, paper.removeprefix("rgb(").removesuffix(")").split(",")))
    assert (brightness < 3 * 60) is (scheme == "dark")
    opened.close()


LONG = "furniture: 3 of 9, " + 30 * "one more thing, " + "about 7 min"


def test_what_is_built_in_the_background_is_shown(
    opened: OpenPage, simulation: Simulation, tmp_path: Path
) -> None:
    """As long as it is being built, in the words of who builds it."""
    go_on = tmp_path / "go_on"
    step = BuildStep(
        command=("sh", "-c", f"echo {LONG}; until [ -e {go_on} ]; do sleep 0.1; done"),
        by_hand="-",
    )
    shown = opened.page.locator("#building")
    with BackgroundBuild(simulation, [step]):
        expect(shown).to_have_text(LONG)
        # Cut where there is no room for it: nothing else is covered, and all of it is its title.
        expect(shown).to_have_attribute("title", LONG)
        line, rate = shown.bounding_box(), opened.page.locator("#fps").bounding_box()
        assert line is not None
        assert rate is not None
        assert line["x"] + line["width"] <= rate["x"]
        assert rate["x"] + rate["width"] <= opened.page.viewport_size["width"]
        go_on.touch()
        expect(shown).to_have_text("")
