# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""A page in Chromium, handled as a reader does: clicks, drags, keys."""

import json
import os
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(__file__), "..", "programs"))
from proof import skip  # noqa: E402

try:
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.common.by import By
except ImportError as error:
    skip(f"reports in a browser: python3-selenium is not installed ({error})")

DRIVER = "/usr/bin/chromedriver"
if not os.path.exists(DRIVER):
    skip("reports in a browser: chromium-driver is not installed")

OPTIONS = ("--headless", "--no-sandbox", "--disable-quic", "--no-first-run", "--disable-sync",
           "--disable-background-networking", "--disable-component-update",
           "--disable-dev-shm-usage", "--enable-unsafe-swiftshader", "--window-size=1200,1000")
SECONDS = 120  # for what takes some on a busy machine


class Page:
    """The page that is shown; `opened` ones are told apart by their path."""

    def __init__(self, *options):
        chosen = webdriver.ChromeOptions()
        for option in OPTIONS + options:
            chosen.add_argument(option)
        chosen.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
        self.driver = webdriver.Chrome(service=Service(DRIVER), options=chosen)
        self.driver.set_script_timeout(SECONDS)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.driver.quit()

    def open(self, path, state=""):
        """Waits until the page says that it is there; returns what it has against itself."""
        self.driver.get("about:blank")
        self.driver.get_log("performance")
        self.driver.get(f"file://{path}" + (f"#{state}" if state else ""))
        self.wait("return document.documentElement.dataset.ready")
        self.settle()
        complaints = [entry["message"] for entry in self.driver.get_log("browser")
                      if entry["level"] in ("SEVERE", "ERROR")]
        return complaints + self.foreign_requests()

    def foreign_requests(self):
        """Addresses that were asked for, beside the page and what it holds itself."""
        asked = []
        for entry in self.driver.get_log("performance"):
            message = json.loads(entry["message"])["message"]
            if message["method"] == "Network.requestWillBeSent":
                asked.append(message["params"]["request"]["url"])
        return [address for address in asked
                if not address.startswith(("file:", "data:", "blob:", "about:"))]

    def wait(self, script):
        end = time.time() + SECONDS
        while time.time() < end:
            value = self.run(script)
            if value:
                return value
            time.sleep(0.05)
        raise AssertionError(f"waited in vain for: {script}")

    def run(self, script, *arguments):
        return self.driver.execute_script(script, *arguments)

    def settle(self):
        """Until what is due has been drawn."""
        self.driver.execute_async_script(
            "const done = arguments[0]; requestAnimationFrame(() => requestAnimationFrame(() => "
            "done()));")

    def find(self, selector):
        return self.driver.find_element(By.CSS_SELECTOR, selector)

    def button(self, text):
        return self.driver.find_element(By.XPATH, f"//button[normalize-space()='{text}']")

    def click_at(self, selector, x, y, shift=False):
        """A place in pixels from the left and the top of an element."""
        node = self.find(selector)
        self.run("arguments[0].scrollIntoView({block: 'center'})", node)
        size = node.size
        actions = ActionChains(self.driver)
        if shift:
            actions.key_down("\ue008")
        actions.move_to_element_with_offset(node, round(x - size["width"] / 2),
                                            round(y - size["height"] / 2))
        actions.click()
        if shift:
            actions.key_up("\ue008")
        actions.perform()

    def drag(self, node, start, stop):
        """Between places that are shares of its size."""
        self.run("arguments[0].scrollIntoView({block: 'center'})", node)
        width, height = node.size["width"], node.size["height"]
        place = [(round((x - 0.5) * width), round((y - 0.5) * height)) for x, y in (start, stop)]
        ActionChains(self.driver).move_to_element_with_offset(node, *place[0]).click_and_hold() \
            .move_to_element_with_offset(node, *place[1]).release().perform()

    def screen(self, width, height, **features):
        """Of exactly so many pixels; `features`: of the reader's wishes or paper, as in CSS."""
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {
            "width": width, "height": height, "deviceScaleFactor": 1, "mobile": False})
        self.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {
            "media": features.pop("media", ""),
            "features": [{"name": f"prefers-{name.replace('_', '-')}", "value": value}
                         for name, value in features.items()]})
        self.settle()

    def selected(self):
        """Labels of the selected grains."""
        return self.run("const {selection, sample} = window.report;"
                        "return [...selection.selected].map((row) => sample.ids[row]).sort((a, b) "
                        "=> a - b)")
