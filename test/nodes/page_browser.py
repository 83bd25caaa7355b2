"""A headless Chromium that uses the operator's page as a hand does. Needs Debian's chromium, chromium-driver and python3-selenium."""
import os
import pathlib
import shutil
import time

try:
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service
    from selenium.webdriver.common.by import By
    from selenium.webdriver.support.ui import Select
except ImportError:
    webdriver = None

TABLET, PHONE = (1024, 768), (390, 844)


def why_not():
    """Why there is no browser here, or None."""
    if webdriver is None:
        return "python3-selenium is not installed"
    missing = [name for name in ("chromium", "chromedriver") if not shutil.which(name)]
    return f"{' and '.join(missing)} not installed" if missing else None


class Page:
    def __init__(self, url, size, folder):
        options = webdriver.ChromeOptions()
        for argument in ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--hide-scrollbars", "--lang=en",
                         f"--user-data-dir={folder}/profile_{size[0]}_{os.getpid()}"):
            options.add_argument(argument)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        self.driver = webdriver.Chrome(service=Service("/usr/bin/chromedriver"), options=options)
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                                    {"width": size[0], "height": size[1], "deviceScaleFactor": 1, "mobile": size[0] < 600})
        self._folder = pathlib.Path(folder)
        self.driver.get(url)

    def close(self):
        self.driver.quit()

    def find(self, selector):
        return self.driver.find_element(By.CSS_SELECTOR, selector)

    def all(self, selector):
        return self.driver.find_elements(By.CSS_SELECTOR, selector)

    def text(self, selector):
        return self.find(selector).text

    def run(self, script, *arguments):
        return self.driver.execute_script(script, *arguments)

    def state(self):
        return self.find("#status").get_attribute("data-state")

    def wait(self, condition, seconds=20.0, what=""):
        """The first true value of condition()."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            value = condition()
            if value:
                return value
            time.sleep(0.05)
        raise AssertionError(f"{what or 'it'} did not come about in {seconds:g} s; the page says: {self.said()}")

    def wait_for_state(self, *wanted, seconds=20.0):
        return self.wait(lambda: self.state() in wanted, seconds, f"state {' or '.join(wanted)}")

    def said(self):
        return " | ".join(self.text(s) for s in ("#status-what", "#status-next", "#answer", "#progress-words")
                          if self.all(s) and self.find(s).is_displayed())

    def keep_answers(self):
        """From now on every sentence that the page answers with is kept for answers(), however short it is seen."""
        self.run("""const box = document.getElementById('answer');
            window.answers = [];
            if (window.answer_watch) window.answer_watch.disconnect();
            window.answer_watch = new MutationObserver(() => window.answers.push(box.textContent));
            window.answer_watch.observe(box, {childList: true, characterData: true, subtree: true})""")

    def answers(self):
        return self.run("return window.answers")

    def order(self, name, seconds=20.0):
        """Presses the order's button as soon as the page lets it be pressed."""
        selector = f"[data-order={name}]"
        self.wait(lambda: self.find(selector).is_displayed() and self.find(selector).is_enabled(), seconds, f"the button {name}")
        self.press(selector)

    def press(self, selector):
        element = self.find(selector)
        self.run("arguments[0].scrollIntoView({block: 'center'})", element)
        element.click()

    def ask(self, selector):
        """Presses a card and waits for the answer to what it asks."""
        self.press(selector)
        self.wait(lambda: "busy" not in self.find(selector).get_attribute("class").split(), what=f"the answer to {selector}")

    def stop(self):
        self.find("#stop").click()

    def tab(self, name):
        self.press(f"[data-tab={name}]")

    def language(self, code):
        Select(self.find("#language")).select_by_value(code)

    def stop_is_on_top(self):
        """STOP is what a finger meets at its whole place, and it is large."""
        return self.run("""const b = document.getElementById('stop').getBoundingClientRect();
            const inside = b.top >= 0 && b.bottom <= innerHeight && b.left >= 0 && b.right <= innerWidth && b.height >= 60 && b.width >= innerWidth / 2;
            return inside && [0.1, 0.5, 0.9].every(x => [0.1, 0.5, 0.9].every(y =>
              document.elementFromPoint(b.left + x * b.width, b.top + y * b.height).id === 'stop'))""")

    def is_no_wider_than_the_screen(self):
        return self.run("return document.documentElement.scrollWidth <= innerWidth")

    def errors(self):
        """What the browser's console says is wrong, but for answers that refuse."""
        return [e["message"] for e in self.driver.get_log("browser") if e["level"] == "SEVERE" and "status of 4" not in e["message"]]

    def photograph(self, name):
        """Into the test's folder, and where KNEE_SCREENSHOTS says."""
        for folder in (self._folder, os.environ.get("KNEE_SCREENSHOTS")):
            if folder:
                self.driver.save_screenshot(str(pathlib.Path(folder) / f"operator_{name}.png"))
