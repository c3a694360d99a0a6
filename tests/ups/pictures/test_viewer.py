"""Choices of the viewer and what follows from them; the window and the page that put controls to it."""

import importlib.util
import os
import re
import shutil
import socket
import subprocess
import sys
import time
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from PIL import Image

from cli import main
from ups.archive import Archive, ArchiveError, ArchiveWriter
from ups.pictures.plot import plot
from ups.pictures.solid import new_plotter, pixels
from ups.pictures.viewer import Viewer

ROOT = Path(__file__).resolve().parents[3]
BROWSER, DRIVER = shutil.which("chromium"), shutil.which("chromedriver")
BROWSER_OPTIONS = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--window-size=1200,900",
)
HOME, END, CONTROL, NO_MORE = "\ue011", "\ue010", "\ue009", "\ue000"
"""Keys, as WebDriver names them."""


@pytest.fixture
def look():
    """Return a function that makes a viewer of an archive, off screen."""
    plotters = []

    def make_viewer(archive, **options):
        plotters.append(new_plotter(off_screen=True))
        return Viewer(archive, plotters[-1], **options)

    yield make_viewer
    for plotter in plotters:
        plotter.close()


def add_step(directory, step):
    """Write one more time step, as a run that goes on does."""
    archive = Archive(directory)
    last = archive.timesteps[-1]
    fields = archive.fields(last.step)
    with ArchiveWriter.open_existing(
        directory, archive.grid(last.step), step=last.step, time=last.time
    ) as writer:
        writer.write_timestep(step, last.time + 1.0, 1.0, fields)


def test_what_can_be_chosen(make, look):
    viewer = look(make((4, 2, 1)))
    assert (viewer.variable, viewer.material, viewer.materials) == ("p.velocity:magnitude", "all", ["all"])
    assert viewer.variables == [
        "p.velocity:magnitude",
        "p.deformationMeasure:equivalentStrain",
        "p.volume",
        "g.temperature",
        "press_CC",
    ]
    assert {"p.velocity:X", "p.deformationMeasure:determinant"} <= set(viewer.measures)
    assert not set(viewer.variables) & set(viewer.measures)
    viewer.show_variable("g.temperature")
    assert (viewer.material, viewer.materials) == ("all", ["all", "0"])
    viewer.show_material("0")
    assert (viewer.material, viewer.view.materials) == ("0", (0,))
    viewer.show_variable("press_CC")
    assert viewer.materials == ["0"]


def test_colours_cover_what_was_shown(make, look):
    viewer = look(make((4, 2, 1)), step=2)
    viewer.draw()
    assert viewer.limits == (2 * 0.125, 2 * 1.875)
    viewer.show_next()
    viewer.draw()
    assert viewer.limits == (2 * 0.125, 6 * 1.875)
    viewer.fit_step()
    viewer.draw()
    assert viewer.limits == (6 * 0.125, 6 * 1.875)
    viewer.fit_all()
    assert viewer.limits == (2 * 0.125, 6 * 1.875)
    viewer.set_limits(1.0, 2.0)
    viewer.draw()
    assert viewer.limits == (1.0, 2.0)
    assert viewer.plotter.scalar_bar.GetLookupTable().GetTableRange() == (1.0, 2.0)
    assert viewer.covered == (2 * 0.125, 6 * 1.875)
    with pytest.raises(ValueError, match="2 is not below 1"):
        viewer.set_limits(2.0, 1.0)
    viewer.show_variable("p.volume")
    viewer.draw()
    assert viewer.limits == pytest.approx((0.99 / 32, 1.01 / 32))


def test_a_choice_that_is_not_stored_is_said_once(make, look):
    viewer = look(make((4, 2, 1)))
    viewer.show_variable("p.stress")
    viewer.draw()
    assert "there is no variable p.stress" in viewer.trouble
    assert viewer.variable == "p.velocity:magnitude"
    viewer.draw()
    assert viewer.trouble == ""


def test_steps_go_round_and_stop_at_the_ends(make, look):
    viewer = look(make((4, 2, 1)))
    assert viewer.step == 6
    viewer.show_next()
    assert viewer.step == 2
    viewer.show_position(-3)
    assert viewer.step == 2
    viewer.show_position(9)
    assert viewer.step == 6


def test_an_archive_that_grows_is_followed(make, look):
    archive = make((4, 2, 1))
    at_end, before = look(archive), look(archive, step=2)
    assert not at_end.refresh()
    add_step(archive, 9)
    assert at_end.refresh()
    assert before.refresh()
    assert (at_end.step, before.step) == (9, 2)
    assert not at_end.refresh()


def test_damage_is_said_and_the_rest_still_shown(make, look):
    archive = make((4, 2, 1))
    viewer = look(archive, step=2)
    for file in (archive / "t00006" / "l0").glob("*.data"):
        file.write_bytes(b"")
    viewer.fit_all()
    viewer.draw()
    assert str(archive) in viewer.trouble
    viewer.show_next()
    viewer.draw()
    assert str(archive) in viewer.trouble
    for file in (archive / "t00006" / "l0").glob("*.xml"):
        file.unlink()
    viewer = look(archive, step=2)
    viewer.show_next()
    viewer.draw()
    assert str(archive) in viewer.trouble
    assert viewer.variables == ["p.velocity:magnitude"]
    assert (viewer.measures, viewer.materials) == ([], ["all"])
    viewer.show_next()
    viewer.draw()
    assert viewer.trouble == ""


@pytest.mark.parametrize(
    ("cells", "variable", "plane"), [((4, 2, 1), "speed", False), ((4, 4, 4), "g.temperature", True)]
)
def test_colours_stand_where_the_numbers_are(make, look, cells, variable, plane):
    """In a plane the colour grows with x, as the numbers do; beside it is nothing."""
    from ups.pictures.view import Slice

    viewer = look(make(cells), variable=variable, plane=Slice(2, 0.75) if plane else None)
    viewer.draw()
    row = pixels(viewer.plotter)[400, 150:700].astype(int)
    inside = np.flatnonzero(np.ptp(row, axis=1) > 40)
    assert len(inside) > 200
    left, right = row[inside[5]], row[inside[-5]]
    assert left[2] > left[1]  # viridis goes from a dark violet
    assert right[1] > 150 > right[2]  # to a light yellow
    assert np.all(pixels(viewer.plotter)[790, 20] == 255)


@pytest.mark.parametrize("cells", [(4, 1, 1), (4, 2, 1), (4, 2, 2)])
def test_nothing_is_drawn_where_no_particles_are_left(make, look, tmp_path, cells):
    full = Archive(make(cells))
    fields = {
        variable: {m: values[:0] for m, values in held.items()}
        for variable, held in full.fields(6).items()
        if variable.is_particle
    }
    archive = tmp_path / "empty.uda"
    with ArchiveWriter.create(archive, full.grid(6), input_xml="<a/>") as writer:
        writer.write_timestep(1, 1.0, 1.0, fields)
    viewer = look(archive)
    viewer.draw()
    assert viewer.trouble == ""
    assert not np.any(np.ptp(pixels(viewer.plotter).astype(int), axis=2) > 60)
    assert plot(archive, tmp_path / "x.png").is_file()


def test_a_chart_where_there_is_one_axis(make, look):
    viewer = look(make((8, 1, 1)))
    viewer.draw()
    (chart,) = viewer.plotter.renderer._charts
    assert chart.x_range == [0.0, 4.0]
    shown = pixels(viewer.plotter)[100:760, 100:950].reshape(-1, 3).astype(int)
    assert np.mean(shown[:, 2] - shown[:, 0] > 60) > 3e-4  # blue dots
    viewer.show_variable("g.temperature")
    viewer.draw()
    assert viewer.trouble == ""


WINDOW = """
import sys
from ups.pictures.plot import plot
from ups.pictures.solid import new_plotter, pixels
from ups.pictures.viewer import Viewer
from ups.pictures.window import FRAME, Window

plotter = new_plotter(off_screen=False)
window = Window(Viewer(sys.argv[1], plotter, frame=FRAME), frames_per_second=1.0)
plotter.show(auto_close=False, interactive=False)
first = pixels(plotter)
viewer, slider = window.viewer, plotter.slider_widgets[0].GetRepresentation()
print(viewer.step, round(slider.GetValue()), len(plotter.radio_button_widget_dict["variable"]))
window._play(True)
for now in (10.0, 10.5, 11.2, 12.4):
    window.tick(now)
print(viewer.step, round(slider.GetValue()))
window._play(False)
window.choose(lambda: viewer.show_variable("press_CC"))
window._limit(True, 2.0)
window.tick(20.0)
print(viewer.variable, viewer.limits, (pixels(plotter) != first).any())
"""


@pytest.mark.skipif(shutil.which("xvfb-run") is None, reason="needs xvfb-run, a display in memory")
def test_the_window(make, tmp_path):
    script = tmp_path / "window.py"
    script.write_text(WINDOW)
    command = ["xvfb-run", "-a", sys.executable, str(script), str(make((4, 2, 1)))]
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    outcome = subprocess.run(
        command, env=environment, capture_output=True, text=True, timeout=120, check=False
    )
    assert outcome.stdout.splitlines() == [
        "6 1 5",
        "2 0",  # three frames of a second each, beginning with the last step
        "press_CC (0.0, 2.0) True",
    ], outcome.stderr


needs_trame = pytest.mark.skipif(
    importlib.util.find_spec("trame") is None, reason="needs trame: pip install 'ups-mpm[view]'"
)


@pytest.fixture
def page(make):
    """Serve the page of an archive; gives its address."""
    archive = make((4, 2, 1))
    options = ["--page", "--port", "0", "--fps", "0.5"]
    command = [sys.executable, str(ROOT / "cli.py"), "view", str(archive), *options]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as server:
        line = server.stdout.readline()
        yield archive, re.match(r"http://localhost:\d+/", line)[0]
        server.terminate()


@pytest.fixture
def browser(tmp_path):
    """Start a browser without a window."""
    if BROWSER is None or DRIVER is None:
        pytest.skip("needs a browser and its driver: chromium and chromedriver")
    webdriver = pytest.importorskip("selenium.webdriver", reason="needs selenium to drive the browser")
    options = webdriver.ChromeOptions()
    options.binary_location = BROWSER
    for option in (*BROWSER_OPTIONS, f"--user-data-dir={tmp_path / 'browser'}"):
        options.add_argument(option)
    driver = webdriver.Chrome(options=options, service=webdriver.ChromeService(DRIVER))
    yield driver
    driver.quit()


def wait_for(what, seconds=30.0):
    """Wait until a function gives something true, and return it."""
    end = time.monotonic() + seconds
    while not (found := what()):
        assert time.monotonic() < end, "nothing came"
        time.sleep(0.2)
    return found


@needs_trame
def test_the_page_in_a_browser(page, browser):
    archive, address = page

    def text(name):
        found = browser.find_elements("id", name)
        return found[0].text if found else ""

    def picture():
        shown = Image.open(BytesIO(browser.get_screenshot_as_png())).convert("RGB")
        return np.asarray(shown)[100:750, 100:1000].astype(int)

    def is_coloured():
        return np.mean(np.ptp(picture(), axis=2) > 60) > 0.05

    browser.get(address)
    wait_for(lambda: text("now") == "step 6, time 1.5 s")
    assert browser.title == "a.uda"
    wait_for(is_coloured)
    before = picture()

    def is_other():
        return np.mean(np.abs(picture() - before).max(axis=2) > 30) > 0.02

    play = browser.find_element("id", "play")
    play.click()
    wait_for(lambda: text("now") == "step 2, time 0.5 s")
    assert text("play").lower() == "pause"
    play.click()
    wait_for(is_other)  # the colours still cover the last step
    slider = browser.find_element("css selector", "[role=slider]")
    for key, step in ((END, "step 6, time 1.5 s"), (HOME, "step 2, time 0.5 s")):
        slider.send_keys(key)
        wait_for(lambda step=step: text("now") == step)
    high = browser.find_element("css selector", "#high input, input#high")
    high.send_keys("1.5\n")
    wait_for(lambda: high.get_attribute("value") == "1.5")
    browser.find_element("id", "fit-step").click()
    wait_for(lambda: high.get_attribute("placeholder") == "3.75")
    variable = browser.find_element("css selector", "#variable input, input#variable")
    variable.send_keys(CONTROL + "a", NO_MORE, "press")
    wait_for(lambda: browser.find_elements("xpath", "//*[@role='option'][contains(., 'press_CC')]"))[
        0
    ].click()
    wait_for(lambda: high.get_attribute("placeholder") == "3")
    add_step(archive, 9)
    wait_for(
        lambda: (
            browser.execute_script(
                "return document.querySelector('[role=slider]').getAttribute('aria-valuemax')"
            )
            == "2"
        )
    )


@needs_trame
def test_a_taken_port_is_said(make):
    with socket.socket() as other:
        other.bind(("localhost", 0))
        other.listen()
        port = str(other.getsockname()[1])
        done = CliRunner().invoke(main, ["view", str(make((4, 2, 1))), "--page", "--port", port])
    assert done.exit_code == 1
    assert f"cannot serve a page on port {port}" in done.output
    assert "choose another with --port" in done.output


def test_missing_trame_is_said(make, monkeypatch):
    monkeypatch.setitem(sys.modules, "trame.widgets.vtk", None)
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.setenv("SSH_CONNECTION", "of a machine without a display")
    done = CliRunner().invoke(main, ["view", str(make((4, 2, 1)))])
    assert done.exit_code == 1
    assert "pip install 'ups-mpm[view]'" in done.output


def test_an_archive_without_steps_is_said(tmp_path):
    done = CliRunner().invoke(main, ["view", str(tmp_path), "--page"])
    assert done.exit_code == 1
    assert "not an archive" in done.output


def test_a_variable_that_is_not_there_is_said(make):
    with pytest.raises(ArchiveError, match="there is no variable nothing"):
        Viewer(make((4, 2, 1)), None, "nothing")
