"""The replay in a real browser."""

import json

import numpy as np
import pytest
from browser_page import Page, share, until
from selenium.webdriver.common.keys import Keys

import suite
from suite.cli.main import main
from suite.show.replay.chosen import choose

ARM, OBSTACLE = ("#0072B2", "#56B4E9", "#009E73"), "#D55E00"


@pytest.fixture
def page(browser, replay) -> Page:
    return Page(browser, replay)


def now(page: Page) -> float:
    return page.ask("document.querySelector('.replay').clock.time")


def test_arm_and_obstacles_are_drawn_and_move(page) -> None:
    page.press(Keys.HOME)
    picture = page.picture(".screen")
    for colour in (*ARM, OBSTACLE):
        assert share(picture, colour) > 5e-4, colour
    pixels = page.ask(
        "(() => { const canvas = document.querySelector('canvas'), gl = canvas.getContext('webgl2');"
        " const read = new Uint8Array(4 * gl.drawingBufferWidth * gl.drawingBufferHeight);"
        " gl.readPixels(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight, gl.RGBA, gl.UNSIGNED_BYTE, read);"
        " return new Set(new Uint32Array(read.buffer)).size; })()"
    )
    assert pixels > 200  # shades, not an empty canvas
    page.press(Keys.END)
    assert np.abs(page.picture(".screen") - picture).max(axis=2).mean() > 1e-3
    assert page.console() == []


def test_what_is_drawn_is_where_it_is(page, run) -> None:
    chosen = choose(run, None, ())
    trial = chosen.trials[0]
    for time_s in (0.0, 1.37, float(trial.executed.times_s[-1])):
        page.ask(f"document.querySelector('.replay').clock.seek({time_s})")
        tip = page.ask("document.querySelector('.replay').views[0].tube.end.position.toArray()")
        times, states = trial.executed.times_s, trial.executed.configurations_rad
        q = np.array([np.interp(time_s, times, column) for column in states.T])
        assert np.allclose(tip, chosen.scenario.arm.tip(q), atol=5e-4)
        centers = page.ask("document.querySelector('.replay').views[0].obstacles.map((o) => o.body.position.toArray())")
        truth = [obstacle.position(np.array([time_s]))[0] for obstacle in chosen.scenario.obstacles]
        assert np.allclose(centers, truth, atol=1e-4)


def test_it_opens_before_the_first_contact_and_says_what_touched(page, run) -> None:
    row = choose(run, None, ()).trials[0].row
    assert row["violation_swept_kind"] == "collision"
    assert now(page) == pytest.approx(max(0.0, row["violation_swept_time_s"] - 2.0), abs=1e-3)
    said = page.one(".stories").text
    assert f"obstacle {row['contact_obstacle']} touched section {row['contact_section']}" in said
    assert "expected obstacle" in said
    page.ask(f"document.querySelector('.replay').clock.seek({row['violation_swept_time_s'] + 0.01})")
    assert page.all(".panel.touched")
    assert "contact" in page.texts(".panel.touched .readout")[0]


def test_it_plays_seeks_and_obeys_the_keyboard(page) -> None:
    page.press(Keys.HOME)
    assert now(page) == 0
    page.press(Keys.ARROW_RIGHT)
    assert now(page) == pytest.approx(0.1)
    page.press(Keys.SHIFT, Keys.ARROW_RIGHT)
    page.press(".")
    assert page.ask("document.querySelector('.replay').clock.speed") == 5
    before = now(page)
    page.press(Keys.SPACE)
    until(lambda: now(page) > before + 0.2, "the clock runs")
    page.press(Keys.SPACE)
    stopped = now(page)
    assert page.one(".play").text == "Play"
    assert now(page) == stopped
    page.press("v")
    assert now(page) != stopped
    bar = page.one(".bars svg")
    bar.click()  # in the middle
    end = page.ask("document.querySelector('.replay').clock.end")
    assert now(page) == pytest.approx(end / 2, rel=0.02)
    assert float(page.one("input[type=range]").get_attribute("value")) == pytest.approx(now(page), abs=0.02)
    page.one(".play").click()
    until(lambda: now(page) > end / 2 + 0.2, "the clock runs")
    assert page.console() == []


def test_it_fits_a_narrow_screen(browser, replay) -> None:
    page = Page(browser, replay, (390, 800))
    assert page.ask("document.documentElement.scrollWidth") <= 390
    assert share(page.picture(".screen"), ARM[0]) > 5e-4
    for button in page.all(".controls button"):
        assert button.size["height"] >= 28


def test_every_shape_is_drawn(browser, tmp_path) -> None:
    assert main(["show", "scenarios/examples/shapes.yaml", "--out", str(tmp_path / "a.html")]) == 0
    page = Page(browser, tmp_path / "a.html")
    kinds = page.ask("document.querySelector('.replay').views[0].obstacles.map((o) => o.body.geometry.type)")
    assert kinds == ["SphereGeometry", "BoxGeometry", "CapsuleGeometry", "CylinderGeometry", "BufferGeometry"]
    assert share(page.picture(".screen"), OBSTACLE) > 2e-3
    assert page.console() == []


def test_a_name_that_is_markup_stays_text(browser, run, tmp_path) -> None:
    evil = "<img src=x onerror=window.pwned=1></script><script>window.pwned=1</script>"
    text = (run / "replay.html").read_text(encoding="utf-8")
    (tmp_path / "a.html").write_text(text, encoding="utf-8")
    planner = suite.load(run).trials["planner"].iloc[0]
    escaped = json.dumps(evil).replace("<", "\\u003c").replace(">", "\\u003e")
    (tmp_path / "a.html").write_text(text.replace(f'"planner":"{planner}"', f'"planner":{escaped}'), encoding="utf-8")
    page = Page(browser, tmp_path / "a.html")
    assert evil in page.one("main").text
    assert page.ask("window.pwned") is None
