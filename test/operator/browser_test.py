#!/usr/bin/python3
"""The page itself in a real browser, with a robot that only remembers: what the rostest's robot does not come to. Skipped, and said so,
where there is no Chromium."""
import asyncio
import pathlib
import sys
import time
import unittest

import rosunit
from page_rig import PAGE, ROOT, PageTest, Rig, ToyRobot

sys.path.insert(0, str(ROOT / "test" / "nodes"))
import page_browser  # noqa: E402

WHY_NOT = page_browser.why_not()


@unittest.skipIf(WHY_NOT, f"NO BROWSER TEST: {WHY_NOT}; scripts/install_dependencies installs it")
class ThePageInABrowser(PageTest):
    async def use(self, robot, work, size=page_browser.PHONE, prepare=lambda _rig: None):
        """work(page) on a thread, beside the server's loop; prepare(rig) before."""
        async with Rig(robot) as rig:
            prepare(rig)
            def run():
                page = page_browser.Page(rig.url, size, pathlib.Path(rig.folder))
                try:
                    return work(page)
                finally:
                    page.close()
            await asyncio.get_running_loop().run_in_executor(None, run)
            return [service for service, _ in rig.robot.asked]

    async def test_nothing_is_offered_before_somebody_says_who_is_on_the_robot(self):
        robot = ToyRobot("disabled")
        robot._state.update(occupancy="unknown")

        def work(page):
            page.wait_for_state("disabled")
            page.wait(lambda: "who is on the robot" in page.text("#status-next"), what="the question")
            self.assertFalse(page.find("[data-order=enable]").is_enabled())
            page.tab("patient")
            page.order("declare_empty")
            robot._state.update(occupancy="empty")
            page.wait(lambda: "Nobody" in page.text("#status-patient"), what="the answer")
            page.tab("exercise")
            page.order("enable")

        self.assertEqual(["declare_empty", "enable"], await self.use(robot, work))

    async def test_the_state_is_there_while_the_pictures_of_the_exercises_are_not(self):
        def prepare(rig):
            (rig.folder / "check_reference").write_text("#!/bin/sh\nsleep 60\n")
            for k in range(30):
                (rig.folder / "references" / f"exercise_{k}.txt").write_text("0.6 0.6 0.6 0.6\n")

        def work(page):
            page.wait_for_state("holding", seconds=10)
            page.wait(lambda: page.find("[data-order=disable]").is_enabled(), what="the orders")
            page.tab("patient")
            self.assertEqual(10, len(page.all("#ranges input")))

        await self.use(ToyRobot(), work, prepare=prepare)

    async def test_nothing_can_be_ordered_before_the_state_is_known(self):
        def work(page):
            page.run("window.stop()")
            self.assertFalse(page.run("""const page = new DOMParser().parseFromString(arguments[0], 'text/html');
                return [...page.querySelectorAll('[data-order]')].some((b) => !b.disabled)""", (PAGE / "index.html").read_text()))

        await self.use(ToyRobot(), work)

    async def test_files_are_shown_by_whatever_name_they_have_and_unreadable_ones_with_their_reason(self):
        names = ["flexión de rodilla.txt", "a \"quoted\" name.txt", "n" * 180 + ".txt", "it's <b>bold.txt"]

        def prepare(rig):
            for name in names:
                (rig.folder / "references" / name).write_text("0.6 0.6 0.6 0.6\n")
            (rig.folder / "patients" / "broken.yaml").write_text("patient: [1, {")
            (rig.folder / "patients" / "número 5.yaml").write_text("patient: '5'\n")
            for k in range(510):
                (rig.folder / "recordings" / f"r{k}.csv").write_text("time_s\n")

        def work(page):
            page.wait_for_state("disabled")
            page.wait(lambda: len(page.all("#exercises .card svg, #exercises .card small")) >= len(names), what="the exercises")
            shown = {card.get_attribute("data-file") for card in page.all("#exercises .card")}
            self.assertLessEqual(set(names), shown)
            self.assertEqual([], page.all("#exercises .card b b"))
            self.assertLessEqual(page.run("return document.documentElement.scrollWidth"), page_browser.PHONE[0])
            page.run("[...document.querySelectorAll('#exercises .card')].find((c) => c.dataset.file === arguments[0]).click()", names[0])
            page.tab("patient")
            page.wait(lambda: "broken.yaml" in page.text("#patients"), what="the broken file")
            self.assertIn("Cannot be used", page.text("#patients"))
            self.assertFalse(next(c for c in page.all("#patients .card") if "broken" in c.text).is_enabled())
            page.tab("recordings")
            page.wait(lambda: "10 older recordings" in page.text("#older-recordings"), what="how many are not shown")

        robot = ToyRobot("disabled")
        await self.use(robot, work, prepare=prepare)
        self.assertEqual([("load_reference", {"file": names[0], "space": ""})], [(s, dict(f)) for s, f in robot.asked])

    async def test_one_press_of_stop_is_one_stop_however_slow_the_tablet(self):
        def work(page):
            page.wait_for_state("playing")
            page.run("addEventListener('pointerdown', () => { const end = performance.now() + 900; while (performance.now() < end); }, true)")
            page.stop()
            page.wait(lambda: page.find("#answer").is_displayed(), what="STOP's answer")

        self.assertEqual(["stop"], await self.use(ToyRobot("playing", stop_s=2.0), work))

    async def test_a_fault_is_said_in_spanish_with_what_to_do(self):
        robot = ToyRobot("faulted")
        robot._state.update(fault="stalled", cause="leg 2: the drive pushes and the axis stands still; look for an obstacle")

        def work(page):
            page.wait_for_state("faulted")
            page.language("es")
            page.wait(lambda: "El motor empuja" in page.text("#status-next"), what="the sentence")
            self.assertIn("Atienda primero al paciente", page.text("#status-next"))
            self.assertTrue(page.stop_is_on_top())
            page.order("reset_faults")

        self.assertEqual(["reset_faults"], await self.use(robot, work))

    async def test_a_silent_controller_is_said_and_nothing_can_be_ordered_but_stop(self):
        robot = ToyRobot()
        robot.silent = True

        def work(page):
            page.wait_for_state("lost")
            self.assertIn("hand switch", page.text("#status-next"))
            self.assertFalse(any(b.is_enabled() for b in page.all("[data-order]")))
            page.stop()

        self.assertEqual(["stop"], await self.use(robot, work))

    async def test_a_hostile_report_runs_but_reaches_neither_the_robot_nor_the_session(self):
        def prepare(rig):
            (rig.folder / "reports" / "r").mkdir()
            (rig.folder / "reports" / "r" / "report.html").write_text("""<title>-</title><form id=f method=post action=/api/stop></form><script>
                const tried = [];
                const attempt = (name, act) => { try { const r = act(); if (r && r.then) r.then(() => tried.push(name), () => {}); else if (r) tried.push(name); } catch (_) {} };
                attempt('session', () => fetch('/api/session').then(r => r.json()).then(s => fetch('/api/robot/enable', {method: 'POST', headers: {'X-CSRF-Token': s.csrf}, body: '{}'})));
                attempt('stop', () => fetch('/api/stop', {method: 'POST', mode: 'no-cors'}));
                attempt('beacon', () => { const r = new XMLHttpRequest(); r.open('POST', '/api/stop', false); r.send(); return true; });
                attempt('cookie', () => document.cookie || localStorage.length + 1);
                attempt('window', () => window.open('/'));
                attempt('opener', () => window.opener && window.opener.document);
                document.getElementById('f').submit();
                new Image().src = '/api/stop';
                setTimeout(() => { document.title = 'ran:' + tried.join(','); }, 700);</script>""")

        def work(page):
            page.wait_for_state("disabled")
            page.driver.get(page.driver.current_url.rstrip("/") + "/api/reports/r/report.html")
            end = time.monotonic() + 20.0
            while not page.driver.title.startswith("ran:") and time.monotonic() < end:
                time.sleep(0.05)
            self.assertEqual("ran:", page.driver.title, "it ran, and nothing that it tried came about")

        self.assertEqual([], await self.use(ToyRobot("disabled"), work, prepare=prepare))


if __name__ == "__main__":
    rosunit.unitrun("knee_robot", "operator_browser", "browser_test", sys.argv)
