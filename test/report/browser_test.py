#!/usr/bin/python3
"""Every kind of report's page in a real browser: written by report_tests (pages_test.cpp) with hostile names, opened as files. Skipped, and said so,
where there is no Chromium."""
import json
import math
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import rosunit

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "test" / "nodes"))
import page_browser  # noqa: E402

WHY_NOT = page_browser.why_not()
TESTS = pathlib.Path(os.environ.get("KNEE_BUILD", ROOT / "build")) / "devel" / "lib" / "knee_robot" / "report_tests"
KINDS = {  # canvases, and headings that no such page lacks
    "identify": (14, ["Errors", "Validation: run", "Training: run", "Spectrum of the residual: run", "Error against the prior's strength", "Parameters",
                      "Friction near rest", "Physically consistent parameters", "What was left out", "Cut-off", "What was done with the signals"]),
    "identify_chain": (14, ["Errors"]),
    "trace": (22, ["Effects", "What of the given model still holds", "Next experiment", "Errors before and after", "Where the error that is left lies",
                  "Pose: camera against encoders", "Residual against velocity and position, validation: run"]),
    "compare": (16, ["Errors beside the paper's", "Camera", "Notes", "Actuators (the paper's Fig. 15)", "Pose (the paper's Fig. 16)"]),
    "predict": (4, ["Errors", "Predicted: run"]),
    "drive_gains": (0, ["Gains", "Payload's centre"]),
    "tune_pid": (3, ["leg 2 ()"]),
}

# Of every canvas whether the line that is drawn on top has left ink of its colour.
INK = """return [...document.querySelectorAll('canvas')].map(canvas => {
  const chart = Chart.getChart(canvas), sets = chart.data.datasets.filter(s => s.data.some(p => Number.isFinite(p.y)));
  if (!sets.length) return 'no numbers';
  const hex = sets[sets.length - 1].borderColor, own = [1, 3, 5].map(k => parseInt(hex.slice(k, k + 2), 16));
  const area = chart.chartArea, ratio = chart.currentDevicePixelRatio;
  const data = canvas.getContext('2d').getImageData(area.left * ratio, area.top * ratio, area.width * ratio, area.height * ratio).data;
  let ink = 0;
  for (let k = 0; k < data.length; k += 4)
    ink += data[k + 3] > 100 && own.every((c, n) => Math.abs(data[k + n] - c) < 60);
  return ink > 20 ? '' : canvas.getAttribute('aria-label') + ': ' + ink;
}).filter(Boolean)"""


def shown(value):
    """As the pages write numbers: three digits."""
    return "\u2013" if value is None else float(f"{value:.3g}")


@unittest.skipIf(WHY_NOT, f"NO BROWSER TEST: {WHY_NOT}; scripts/install_dependencies installs it")
class PagesInABrowser(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.holder = tempfile.TemporaryDirectory(prefix="knee_pages_")
        cls.folder = pathlib.Path(cls.holder.name)
        subprocess.run([TESTS, "--file=pages_test"], env={**os.environ, "KNEE_PAGES": str(cls.folder)}, check=True, stdout=subprocess.DEVNULL)
        cls.page = page_browser.Page("about:blank", page_browser.TABLET, cls.folder)

    @classmethod
    def tearDownClass(cls):
        cls.page.close()
        cls.holder.cleanup()

    def resize(self, size):
        self.page.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                                         {"width": size[0], "height": size[1], "deviceScaleFactor": 1, "mobile": size[0] < 600})

    def open(self, kind, size=page_browser.TABLET):
        self.resize(size)
        self.page.driver.get((self.folder / kind / "report.html").as_uri())
        return json.loads((self.folder / kind / "report.json").read_text())

    def row(self, *beginning):
        """Numbers of the first row that begins with these words, after the group's row if two are given."""
        cells = self.page.run("""const rows = [...document.querySelectorAll('tr')], at = arguments.length > 1 ? rows.findIndex(r => r.innerText.startsWith(arguments[0])) : 0;
            const row = rows.slice(at).find(r => r.cells[0].innerText.startsWith(arguments[arguments.length - 1]));
            return [...row.cells].slice(1).map(c => c.innerText.trim())""", *beginning)
        numbers = [re.match(r"-?[\d.]+(?:e[-+]?\d+)?", cell) for cell in cells]
        return [float(number[0]) if number else cell for number, cell in zip(numbers, cells)]

    def test_every_page_draws_all_it_has_and_nothing_of_its_data_is_markup(self):
        for kind, (canvases, headings) in KINDS.items():
            self.open(kind)
            self.assertEqual([], self.page.errors(), kind)
            self.assertIsNone(self.page.run("return window.pwned || null"), kind)
            self.assertEqual(0, len(self.page.all("img, #without-scripts, body > *:not(main):not(script)")), f"{kind}: no markup out of names")
            self.assertEqual([], self.page.run("return performance.getEntriesByType('resource').map(r => r.name)"), f"{kind}: nothing is fetched")
            found = self.page.run("return [...document.querySelectorAll('h2')].map(h => h.innerText)")
            self.assertEqual([], [h for h in headings + ["Reproduce"] if h not in found], (kind, found))
            self.assertEqual([], self.page.run(INK), kind)
            self.assertTrue(self.page.is_no_wider_than_the_screen(), f"{kind} on a tablet")
            self.assertEqual(canvases, len(self.page.all("canvas")), kind)
            text = self.page.text("main")
            for wrong in ("NaN", "undefined", "[object", "Infinity", "null"):
                self.assertNotIn(wrong, text, kind)
            self.assertIn("<img src=x onerror=", text, f"{kind}: names are shown as they are")

    def test_no_page_is_wider_than_a_phone_or_paper(self):
        beyond = "return [...document.querySelectorAll('canvas')].filter(c => c.getBoundingClientRect().right > innerWidth).map(c => c.ariaLabel)"
        for kind in KINDS:
            self.open(kind, page_browser.PHONE)
            self.assertTrue(self.page.is_no_wider_than_the_screen(), f"{kind} on a phone")
            self.assertEqual([], self.page.run(beyond), f"{kind} on a phone")
            self.page.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print"})
            try:
                self.resize((720, 1020))  # A4 between usual margins
                self.assertTrue(self.page.is_no_wider_than_the_screen(), f"{kind} on paper")
            finally:
                self.page.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": ""})

    def test_tables_have_the_numbers_of_report_json(self):
        report = self.open("identify")
        for group, side, kind in (("Validation (", "after", "validate"), ("Training (", "after", "train"), ("Validation, model without", "before", "validate")):
            self.assertEqual([shown(v) for v in report[side][kind]["rms_N"]], self.row(group, "rms, all samples, N"))
            self.assertEqual([shown(v) for v in report[side][kind]["max_N"]], self.row(group, "largest error, N"))
        p = next(p for p in report["parameters"] if p["name"] == "Fc_2")
        self.assertEqual([float(f"{p['value']:.4g}"), shown(p["std"])], self.row("Fc_2")[:2])
        report = self.open("trace")
        self.assertEqual([shown(v) for v in report["before"]["validate"]["rms_N"]], self.row("Validation", "before: rms, all samples"))
        self.assertEqual([shown(v) for v in report["after"]["train"]["max_N"]], self.row("Training", "after: largest"))
        self.assertEqual([shown(v) for v in report["unexplained"]["noise_floor_N"]], self.row("noise floor"))
        effect, at = report["effects"][0], report["effects"][0]["actuators"][0] - 1
        self.assertEqual([shown(effect["explained_rms_N"][at]), shown(effect["null_rms_N"][at]), shown(effect["p"])], self.row(effect["name"])[1:4])
        self.assertEqual([shown(1e3 * v) for v in report["pose"]["after"]["validate"][0]["rms_m"]], self.row("Validation: ", "after")[:2])
        report = self.open("compare")
        self.assertEqual([shown(1e3 * report["pose"]["x"][k]) for k in ("max_m",)], self.row("X, mm")[:1])
        self.assertAlmostEqual(shown(180 / math.pi * report["camera"]["camera_minus_encoders"]["psi"]["rms_rad"]), self.row("camera minus encoders, all", "psi")[2], places=5)
        report = self.open("predict")
        self.assertEqual([shown(v) for v in report["recordings"][0]["rms_raw_N"]], self.row("rms, all rows"))
        report = self.open("drive_gains")
        self.assertEqual([float(f"{report['drive_gains'][2][k]:.4g}") for k in ("torque_per_ampere_Nm", "low", "high")], self.row("shoulder")[:3])

    def test_a_chain_has_its_joints_names_and_units(self):
        report = self.open("identify_chain")
        self.assertEqual(["Nm", "A"], report["units"])
        labels = self.page.run("return [...document.querySelectorAll('canvas')].map(c => c.getAttribute('aria-label'))")
        self.assertTrue(any(label.startswith("torque, N\u00a0m over time, s") for label in labels), labels)
        self.assertTrue(any(label.startswith("current, A over time, s") for label in labels), labels)
        self.assertIn("joint 2 (elbow)", self.page.text("table"))
        self.assertIn("mrad/s", self.page.text("main"))
        self.assertNotIn("ctuator", self.page.text("main"))

    def test_without_scripts_the_page_says_where_the_figures_are(self):
        self.page.driver.execute_cdp_cmd("Emulation.setScriptExecutionDisabled", {"value": True})
        try:
            self.open("compare")
            self.assertIn("report.json beside it holds every figure", self.page.text("body"))
        finally:
            self.page.driver.execute_cdp_cmd("Emulation.setScriptExecutionDisabled", {"value": False})


if __name__ == "__main__":
    rosunit.unitrun("knee_robot", "report_browser", PagesInABrowser, sys.argv)
