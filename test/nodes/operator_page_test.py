#!/usr/bin/python3
"""A therapist's session on the operator's page, on a tablet and on a phone, with the simulated robot behind it. Skipped, and said so, where
there is no Chromium."""
import pathlib
import subprocess
import sys
import time
import unittest
import urllib.request

import rospy
import rostest

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import movements  # noqa: E402
import page_browser  # noqa: E402
from robot_client import RobotClient  # noqa: E402

WHY_NOT = page_browser.why_not()
PATIENT = """patient: "17"
pose: {X_m: [-0.1, 0.1], Z_m: [0.58, 0.68], theta_deg: [-10, 10], psi_deg: [-10, 10]}
speed: {linear_mm_per_s: 40, angular_deg_per_s: 4}
"""


@unittest.skipIf(WHY_NOT, f"NO BROWSER TEST: {WHY_NOT}; scripts/install_dependencies installs it")
class OperatorPage(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.robot = RobotClient()
        cls.folder = pathlib.Path(rospy.get_param("~folder"))
        references = pathlib.Path(cls.robot.parameter("references"))
        movements.write(references, "lift_and_turn.txt", movements.rise(6.0, height=0.03))
        movements.write(references, "lift_slowly.txt", movements.rise(20.0, height=0.05))
        movements.write(references, "too_fast.txt", movements.rise(0.3, height=0.05))
        (pathlib.Path(cls.robot.parameter("patients")) / "p17.yaml").write_text(PATIENT)

    def setUp(self):
        self.page = None
        self.robot.bring_to("disabled")

    def tearDown(self):
        if self.page:
            try:
                self.page.photograph("at_the_end_of_" + self.id().rsplit(".", 1)[-1])
                print("the page's last words:", self.page.said())
            finally:
                self.page.close()

    def url(self):
        """Where the server answers now: one that was killed comes back at another port."""
        end = time.monotonic() + 60
        while time.monotonic() < end:
            try:
                url = rospy.get_param("/operator_page/url")
                urllib.request.urlopen(url, timeout=2).close()
                return url
            except (KeyError, OSError):
                time.sleep(0.2)
        raise AssertionError("no page is served")

    def open(self, size):
        self.page = page_browser.Page(self.url(), size, self.folder)
        self.page.wait_for_state("disabled")
        return self.page

    def say_who(self, page):
        """A patient file; where the controller asks, it will not move without."""
        page.tab("patient")
        page.wait(lambda: page.all("#patients .card"), what="the patient file")
        page.wait(lambda: page.find("#patients .card").is_enabled())
        page.ask("#patients .card")
        page.wait(lambda: "17" in page.text("#status-patient"), what="the patient's name")
        page.tab("exercise")

    def choose(self, page, name):
        card = f'#exercises [data-file="{name}"]'
        page.wait(lambda: page.all(card), what=f"the exercise {name}")
        page.ask(card)
        page.wait(lambda: page.find(card).get_attribute("aria-pressed") == "true", what=f"{name} being loaded")

    def test_a_whole_exercise_on_a_tablet(self):
        page = self.open(page_browser.TABLET)
        page.wait(lambda: len(page.all("#exercises .card svg")) >= 2, 60, "the pictures of the paths")
        page.wait(lambda: "refused" in page.find('#exercises [data-file="too_fast.txt"]').get_attribute("class"), what="the verdict on too_fast")
        self.say_who(page)
        self.choose(page, "lift_and_turn.txt")
        page.order("enable")
        page.wait_for_state("holding")
        self.begin(page, "lift_and_turn.txt")
        page.wait(lambda: "1 of 1" in page.text("#progress-words"), what="the progress")
        page.photograph("tablet_exercise")
        page.order("pause")
        page.wait_for_state("paused")
        page.order("resume")
        page.wait_for_state("playing")
        page.tab("live")
        page.wait(lambda: page.run("const c = document.getElementById('plot-length'); const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;"
                                   "let n = 0; for (let i = 3; i < d.length; i += 4) n += d[i] > 0; return n > 500"), what="curves")
        time.sleep(1.5)
        page.photograph("tablet_curves")
        page.tab("exercise")
        page.wait_for_state("holding", seconds=60)
        page.wait(lambda: "played to its end" in page.text("#progress-words"), what="the end of the exercise")
        self.compare_the_recording(page)
        page.tab("exercise")
        page.order("disable")
        page.wait_for_state("disabled")
        page.tab("log")
        page.wait(lambda: "Holding" in page.text("#events"), what="the events")
        self.assertEqual([], page.errors())

    def compare_the_recording(self, page):
        page.tab("recordings")
        page.wait(lambda: page.all("#recordings input"), what="the recording")
        page.press("#recordings input")
        page.press("[data-job=compare]")
        page.wait(lambda: page.all("#reports a"), 90, "the report")
        page.photograph("tablet_recordings")
        first = page.driver.current_window_handle
        page.press("#reports a")
        page.wait(lambda: len(page.driver.window_handles) == 2, what="the report's window")
        page.driver.switch_to.window(page.driver.window_handles[1])
        page.wait(lambda: len(page.all("canvas")) >= 16, 60, "the report's plots, drawn in its sandbox")
        self.assertIn("Errors beside the paper's", page.text("body"))
        page.driver.close()
        page.driver.switch_to.window(first)

    def test_stop_on_a_phone_in_spanish_and_start_again_at_once(self):
        page = self.open(page_browser.PHONE)
        page.language("es")
        page.wait(lambda: "Apagado" in page.text("#status-what"), what="Spanish")
        self.say_who(page)
        self.choose(page, "lift_slowly.txt")
        page.order("enable")
        for attempt in range(3):
            self.begin(page, "lift_slowly.txt")
            page.wait(lambda: self.robot.state().path_time_s > 2.0, 20, "two seconds of it")
            page.keep_answers()  # STOP's own answer may come after the refusal and take its place
            page.stop()
            page.run("document.querySelector('[data-order=start]').click()")  # faster than a finger
            page.run("document.querySelector('[data-order=start]').disabled = false; document.querySelector('[data-order=start]').click()")
            page.wait_for_state("holding")
            refusals = page.wait(lambda: [a for a in page.answers() if "STOP" not in a], what="why Start was refused")
            self.assertFalse([a for a in refusals if "ha empezado" in a], refusals)
            if attempt == 0:
                page.photograph("phone_stopped")
            time.sleep(1.0)
            self.assertEqual("holding", self.robot.state().state, "nothing may move by a Start that was refused")
            self.assertTrue(page.find("[data-order=approach]").is_enabled(), page.said())
        self.set_speed(page)
        self.begin(page, "lift_slowly.txt")
        for tab in ("live", "patient", "recordings", "log", "exercise"):
            page.tab(tab)
            self.assertTrue(page.stop_is_on_top(), tab)
            self.assertTrue(page.is_no_wider_than_the_screen(), tab)
            if tab == "live":
                page.photograph("phone_curves")
        page.stop()
        page.wait_for_state("holding")
        page.order("disable")
        page.wait_for_state("disabled")
        self.assertEqual([], page.errors())

    def begin(self, page, name):
        """From wherever the robot holds: to the start, where it is not there, and on."""
        page.wait(lambda: page.find("[data-order=start]").is_enabled() or page.find("[data-order=approach]").is_enabled(), what="a way to begin")
        if not page.find("[data-order=start]").is_enabled():
            page.order("approach")
        page.order("start", 60)
        page.wait(lambda: self.robot.state().playing == name, what="the exercise")

    def set_speed(self, page):
        for _ in range(3):
            page.press("[data-step=speed][data-by='-10']")
            time.sleep(0.2)
        page.wait(lambda: self.robot.state().speed_percent < 75.0, what="the speed")

    def test_neither_a_lost_network_nor_a_dead_page_changes_what_the_robot_does(self):
        page = self.open(page_browser.TABLET)
        self.say_who(page)
        self.choose(page, "lift_and_turn.txt")
        page.order("enable")
        self.begin(page, "lift_and_turn.txt")
        page.driver.set_network_conditions(offline=True, latency=0, download_throughput=0, upload_throughput=0)
        subprocess.run(["rosnode", "kill", "/operator_page"], check=False, capture_output=True, timeout=20)
        page.wait_for_state("lost", seconds=10)
        self.assertTrue(page.stop_is_on_top())
        page.photograph("tablet_lost")
        ended = self.robot.wait_for("holding", 30)
        self.assertEqual("holding", ended.state, ended.cause)
        self.assertGreater(ended.progress, 0.999, "the exercise was played to its end")
        page.driver.set_network_conditions(offline=False, latency=0, download_throughput=-1, upload_throughput=-1)


if __name__ == "__main__":
    rospy.init_node("page_in_a_browser")
    rostest.rosrun("knee_robot", "page_in_a_browser", OperatorPage)
