"""The report in a real browser."""

import pytest
from browser_page import Page, share, until
from selenium.webdriver.common.keys import Keys

import suite


@pytest.fixture
def page(browser, report) -> Page:
    return Page(browser, report)


def column(page: Page, table: str, k: int) -> list[str]:
    return page.ask(f"[...document.querySelectorAll('{table} tbody tr')].map((row) => row.cells[{k}].textContent)")


def test_it_opens_within_two_seconds_without_complaint(page) -> None:
    assert page.console() == []
    spent = page.ask("performance.getEntriesByType('navigation')[0].loadEventEnd")
    assert 0 < spent < 2000
    assert page.ask("document.documentElement.scrollWidth") <= 1000


def test_the_table_says_what_the_run_says_and_sorts(page, run) -> None:
    table = suite.load(run).table()
    assert len(page.all(".main tbody tr")) == len(table)
    heads = page.texts(".main th")
    swept = heads.index("swept %")
    shown = [text.split()[0] for text in column(page, ".main", swept)]
    assert shown == [f"{percent:.0f}" for percent in table["success_swept_percent"]]
    page.all(".main th button")[swept].click()
    ascending = [int(text.split()[0]) for text in column(page, ".main", swept)]
    assert ascending == sorted(ascending)
    page.all(".main th button")[swept].click()
    assert column(page, ".main", swept)[0].split()[0] == str(ascending[-1])


def test_the_verdict_switches_everything(page, run) -> None:
    before = page.one(".headline").text
    page.one("input[value=executable]").click()
    assert "executable %" in page.texts(".main th")
    assert page.one(".headline").text != before
    assert "executable" in page.one(".headline").text
    marks = page.ask("[...document.querySelectorAll('.trials tbody .good')].length")
    assert marks == int(suite.load(run).trials["success_executable"].sum())


def test_trials_are_filtered(page, run) -> None:
    trials = suite.load(run).trials

    def choose(label: str, value: str) -> None:
        (select,) = [each for each in page.all(".filters label:has(select)") if each.text.startswith(label)]
        select.find_element("css selector", f"option[value='{value}']").click()

    assert len(page.all(".trials tbody tr")) == len(trials)
    choose("planner", "pf")
    assert len(page.all(".trials tbody tr")) == (trials["planner"] == "pf").sum()
    choose("outcome", "reached")
    assert len(page.all(".trials tbody tr")) == ((trials["planner"] == "pf") & (trials["outcome"] == "reached")).sum()
    choose("outcome", "")
    choose("planner", "")
    page.one(".filters input[type=checkbox]").click()
    won = trials.groupby("scenario_id")["success_swept"].agg(["any", "all"])
    disagreed = won.index[won["any"] & ~won["all"]]
    assert len(disagreed) > 0
    assert sorted(set(column(page, ".trials", 0))) == sorted(disagreed)


def test_a_trials_replay_is_a_click_away_beside_one_that_fared_otherwise(page, run) -> None:
    trials = suite.load(run).trials
    won = trials.groupby("scenario_id")["success_swept"].agg(["any", "all"])
    disagreed = won.index[won["any"] & ~won["all"]][0]
    next(link for link in page.all(".trials .link") if link.text == disagreed).click()
    until(lambda: bool(page.all("dialog [data-ready]")), "the replay is there")
    assert sorted(page.texts("dialog .verdicts span:nth-child(2)")) == ["✓ swept", "✗ swept"]
    assert share(page.picture("dialog .screen"), "#0072B2") > 5e-4
    page.ask("document.querySelector('dialog .replay').clock.seek(0.5)")
    page.press(Keys.ESCAPE)
    until(lambda: not page.all("dialog"), "it is closed")
    assert page.console() == []


def test_charts_have_a_line_for_every_planner(page) -> None:
    for chart in page.all(".charts svg.chart"):
        assert len(chart.find_elements("css selector", "polyline")) == 2


def test_it_fits_a_narrow_screen(browser, report) -> None:
    page = Page(browser, report, (390, 800))
    assert page.ask("document.documentElement.scrollWidth") <= 390
