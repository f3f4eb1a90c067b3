"""The page in a real browser: it draws without errors, its slider moves the cable and the cursors, and it asks for nothing outside."""

from __future__ import annotations

import json
import re
import shutil
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cable_model import CableChain, load, simulate
from cable_model.page import write_page

CHROMIUM, DRIVER = shutil.which("chromium"), shutil.which("chromedriver")
pytestmark = [
    pytest.mark.long,
    pytest.mark.skipif(find_spec("selenium") is None, reason="selenium is not installed (pip install selenium)"),
    pytest.mark.skipif(not (CHROMIUM and DRIVER), reason="no browser (apt-get install chromium chromium-driver)"),
]
SCREEN = (1366, 768)
OPTIONS = (
    "--headless=new",
    "--no-sandbox",
    "--disable-dev-shm-usage",
    "--enable-unsafe-swiftshader",
    f"--window-size={SCREEN[0]},{SCREEN[1]}",
)
DRAWN = (
    "return document.querySelectorAll('#cable canvas').length > 0 && document.getElementById('cable')._transitionData._frames.length > 0"
)
CABLE = "return document.getElementById('cable').data.find(trace => trace.type === 'scatter3d' && trace.name === 'CableChain')"
CURSOR = "return document.getElementById('cable').data.at(-1).x[0]"


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    from selenium import webdriver

    options = webdriver.ChromeOptions()
    options.binary_location = CHROMIUM
    for option in OPTIONS:
        options.add_argument(option)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    opened = webdriver.Chrome(options=options, service=webdriver.ChromeService(DRIVER))
    yield opened
    opened.quit()


def test_the_slider_moves_the_cable_and_nothing_is_asked_of_a_network(browser: Any, tmp_path: Path) -> None:
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.common.by import By
    from selenium.webdriver.support.ui import WebDriverWait

    scene = load("towed_body")
    run = simulate(CableChain(scene), duration=40.0)
    write_page({"CableChain": run}, scene, tmp_path / "page.html", [])
    browser.get((tmp_path / "page.html").as_uri())
    wait = WebDriverWait(browser, 60.0)
    wait.until(lambda _: browser.execute_script(DRAWN))
    before = browser.execute_script(CABLE)
    assert np.column_stack([before[axis] for axis in "xyz"]) == pytest.approx(run.shapes[0], abs=0.006)

    rail = browser.find_element(By.CSS_SELECTOR, ".slider-rail-touch-rect")
    ActionChains(browser).move_to_element(rail).click().perform()  # in its middle
    wait.until(lambda _: browser.execute_script(CURSOR) > 0.0)
    time, after = browser.execute_script(CURSOR), browser.execute_script(CABLE)
    assert time == pytest.approx(20.0, abs=1.0)
    row = int(np.argmin(np.abs(run["time"] - time)))
    assert np.column_stack([after[axis] for axis in "xyz"]) == pytest.approx(run.shapes[row], abs=0.006)
    assert after["line"]["color"] != before["line"]["color"]

    browser.find_element(By.CSS_SELECTOR, ".updatemenu-button").click()  # play
    wait.until(lambda _: browser.execute_script(CURSOR) > time + 1.0)

    messages = [json.loads(entry["message"])["message"] for entry in browser.get_log("performance")]
    asked = [message["params"]["request"]["url"] for message in messages if message["method"] == "Network.requestWillBeSent"]
    assert asked and all(url.split(":")[0] in ("file", "data", "blob") for url in asked), asked
    errors = [entry for entry in browser.get_log("browser") if entry["level"] == "SEVERE"]
    assert not errors

    titles = browser.execute_script("return [...document.querySelectorAll('.modebar-btn')].map(one => one.dataset.title)")
    assert titles and not re.search("share|cloud|send", " ".join(titles), re.IGNORECASE)
    height = browser.execute_script("return [document.documentElement.scrollHeight, innerHeight]")
    assert height[0] <= height[1]  # all of it fits on a small screen
