#!/usr/bin/python3
"""rviz as launch files start it, with a stand-in that notes what it was given: it comes back when it dies, and costs little in software."""
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import rosunit

ROOT = pathlib.Path(__file__).resolve().parents[2]
STAND_IN = """#!/bin/bash
echo "$@" >> "$NOTES"
for configuration in "$@"; do [[ $configuration == *.rviz ]] && cat "$configuration" >> "$NOTES"; done
[[ $(grep -c "^rviz rviz" "$NOTES") -gt $DEATHS ]] || kill -SEGV $$
exit "$LEAVES"
"""


class ShowRviz(unittest.TestCase):
    def show(self, deaths=0, leaves=0, software=False, arguments=None):
        """Status, what the stand-in noted, and what was said."""
        with tempfile.TemporaryDirectory() as folder:
            rosrun, notes = pathlib.Path(folder, "rosrun"), pathlib.Path(folder, "notes")
            rosrun.write_text(STAND_IN, encoding="utf-8")
            rosrun.chmod(0o755)
            environment = {**os.environ, "PATH": f"{folder}:{os.environ['PATH']}", "NOTES": str(notes), "DEATHS": str(deaths),
                           "LEAVES": str(leaves), "LIBGL_ALWAYS_SOFTWARE": "1" if software else "0"}
            arguments = ["-d", str(ROOT / "config/rviz/robot.rviz")] if arguments is None else arguments
            done = subprocess.run([sys.executable, ROOT / "src/nodes/show_rviz", *arguments], env=environment, capture_output=True,
                                  text=True, check=False)
            return done.returncode, notes.read_text(encoding="utf-8"), done.stderr

    def test_is_shown_as_it_is_configured(self):
        status, notes, said = self.show()
        self.assertEqual((status, said), (0, ""))
        self.assertIn("Frame Rate: 30", notes)

    def test_draws_five_frames_a_second_where_opengl_is_software(self):
        status, notes, _ = self.show(software=True)
        self.assertEqual(status, 0)
        self.assertIn("Frame Rate: 5}", notes)
        written = (ROOT / "config/rviz/robot.rviz").read_text(encoding="utf-8")
        self.assertIn(written.replace("Frame Rate: 30", "Frame Rate: 5"), notes, "nothing else is changed")

    def test_leaves_a_configuration_that_is_not_there_to_rviz(self):
        _, notes, _ = self.show(software=True, arguments=["-d", "/nowhere/robot.rviz"])
        self.assertIn("/nowhere/robot.rviz", notes)
        _, notes, _ = self.show(software=True, arguments=["-d"])
        self.assertEqual(notes.strip(), "rviz rviz -d")

    def test_comes_back_when_it_dies_and_says_so(self):
        status, notes, said = self.show(deaths=2)
        self.assertEqual(status, 0)
        self.assertEqual(notes.count("rviz rviz"), 3)
        self.assertIn("rviz died of signal 11 (SIGSEGV); starting it again (2 of 5)", said)

    def test_gives_up_after_five_deaths(self):
        status, notes, said = self.show(deaths=9)
        self.assertEqual(status, 1)
        self.assertEqual(notes.count("rviz rviz"), 5)
        self.assertIn("giving up", said)

    def test_stays_closed_when_it_ends_by_itself(self):
        status, notes, _ = self.show(leaves=3)
        self.assertEqual(status, 3)
        self.assertEqual(notes.count("rviz rviz"), 1)


if __name__ == "__main__":
    rosunit.unitrun("knee_robot", "show_rviz", ShowRviz)
