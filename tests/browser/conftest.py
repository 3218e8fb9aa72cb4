"""A real Chromium without a screen, and pages of a real run for it to open."""

import os
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

import suite
from suite.cli.main import main

REQUIRED = "SUITE_REQUIRE_BROWSER"
"""Set where a browser has to be there: a test that has none then fails."""
FLAGS = (
    "--headless", "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
    "--hide-scrollbars", "--disable-dev-shm-usage", "--window-size=1000,800",
)  # fmt: skip


@pytest.fixture(scope="session")
def browser() -> Iterator[object]:
    """A driver of Chromium; console messages are kept."""
    chromium, driver = shutil.which("chromium") or shutil.which("chromium-browser"), shutil.which("chromedriver")
    if not (chromium and driver):
        reason = "found no chromium and chromedriver; Debian has them in packages chromium and chromium-driver"
        (pytest.fail if os.environ.get(REQUIRED) else pytest.skip)(reason)
    from selenium import webdriver

    options = webdriver.ChromeOptions()
    options.binary_location = chromium
    for flag in FLAGS:
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    chrome = webdriver.Chrome(options, webdriver.ChromeService(driver))
    yield chrome
    chrome.quit()


@pytest.fixture(scope="session")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two planners on a few scenarios, some of which one solves and the other does not."""
    folder = tmp_path_factory.mktemp("browser") / "run"
    suite.run("pf,h", out=folder, obstacles=(1, 5), trials=4, seed=1000)
    return folder


@pytest.fixture(scope="session")
def replay(run: Path) -> Path:
    """The page of the first trial that failed, beside one that did not."""
    assert main(["show", str(run), "--out", str(run / "replay.html")]) == 0
    return run / "replay.html"


@pytest.fixture(scope="session")
def report(run: Path) -> Path:
    """The page of the whole run."""
    assert main(["report", str(run), "-o", str(run / "report.html")]) == 0
    return run / "report.html"
