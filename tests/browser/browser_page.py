"""What a person does with a page, and what is seen then."""

from __future__ import annotations

import io
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.image import imread

PATIENCE_S = 30.0


class Page:
    """A page in a browser; what it writes to the console is an error."""

    def __init__(self, browser: Any, file: Path, size: tuple[int, int] = (1000, 800)) -> None:
        self.browser = browser
        browser.execute_cdp_cmd(
            "Emulation.setDeviceMetricsOverride",
            {"width": size[0], "height": size[1], "deviceScaleFactor": 1, "mobile": False},
        )
        browser.get(file.as_uri())
        self.wait("document.querySelector('main > [data-ready]') !== null")

    def ask(self, expression: str) -> Any:
        """Value of a JavaScript expression."""
        return self.browser.execute_script(f"return {expression}")

    def all(self, selector: str) -> list[Any]:
        return list(self.browser.find_elements("css selector", selector))

    def one(self, selector: str) -> Any:
        return self.browser.find_element("css selector", selector)

    def texts(self, selector: str) -> list[str]:
        return [element.text for element in self.all(selector)]

    def press(self, *keys: str) -> None:
        self.one("body").send_keys(*keys)

    def wait(self, expression: str) -> None:
        until(lambda: bool(self.ask(expression)), expression)

    def console(self) -> list[str]:
        """What has been written since it was last asked; a driver's own remarks on its GPU do not count."""
        lines = [line for line in self.browser.get_log("browser") if line["level"] in {"SEVERE", "WARNING"}]
        return [line["message"] for line in lines if "GPU stall" not in line["message"]]

    def picture(self, selector: str) -> np.ndarray:
        """Pixels of an element as they are on the screen, (height, width, 3) in [0, 1]."""
        return imread(io.BytesIO(self.one(selector).screenshot_as_png))[:, :, :3]


def until(holds: Callable[[], bool], what: str) -> None:
    """Wait for something to hold."""
    end = time.monotonic() + PATIENCE_S
    while not holds():
        assert time.monotonic() < end, what
        time.sleep(0.05)


def share(picture: np.ndarray, colour: str, tolerance: float = 0.12) -> float:
    """Share of the pixels that have the hue of ``colour``, whatever the light on them."""
    wanted = np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)]) / 255
    length = np.linalg.norm(picture, axis=2)
    cosine = picture @ wanted / np.maximum(length * np.linalg.norm(wanted), 1e-9)
    return float(((np.arccos(np.clip(cosine, -1, 1)) < tolerance) & (length > 0.25)).mean())
