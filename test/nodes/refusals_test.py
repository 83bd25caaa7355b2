#!/usr/bin/python3
"""What may not be played is refused with a reason, and nothing moves."""
import os
import pathlib
import sys
import unittest

import rospy
import rostest

sys.path.insert(0, str(pathlib.Path(__file__).parent))
from robot_client import RobotClient, parameter  # noqa: E402


class Refusals(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.robot = RobotClient()
        cls.folder = pathlib.Path(parameter("references"))
        cls.home = list(cls.robot.tracking().position_m)

    def write(self, name, points):
        (self.folder / name).write_text("".join(" ".join(map(str, point)) + "\n" for point in points))
        return name

    def assert_refused(self, name, *words):
        answer = self.robot.load(name)
        self.assertFalse(answer.success, answer.message)
        for word in words:
            self.assertIn(word, answer.message)
        self.assertEqual("disabled", self.robot.state().state)
        self.assertEqual("", self.robot.state().reference_file)
        self.assertEqual(self.home, list(self.robot.tracking().position_m), "something moved")
        self.assertFalse(self.robot.trigger("start").success)

    def test_a_jump_is_refused_by_file_line_and_limit(self):
        jump = [self.home] * 10 + [[q + 0.01 for q in self.home]] * 10
        self.assert_refused(self.write("jump.txt", jump), "jump.txt:11", "beyond its limit of 0.3 m/s")

    def test_a_point_out_of_range_is_refused(self):
        far = [[q + 1e-5 * k for q in self.home] for k in range(0, 60000, 100)]
        self.assert_refused(self.write("far.txt", far), "far.txt")

    def test_what_is_no_number_is_refused(self):
        self.assert_refused(self.write("nan.txt", [self.home, ["nan"] * 4]), "nan.txt:2")

    def test_an_empty_file_is_refused(self):
        self.assert_refused(self.write("empty.txt", []), "empty.txt")

    def test_files_outside_the_folder_are_refused(self):
        outside = self.folder.parent / "outside.txt"
        outside.write_text(" ".join(map(str, self.home)) + "\n")
        link = self.folder / "link.txt"
        if not link.is_symlink():
            os.symlink(outside, link)
        for name in (str(outside), "../outside.txt", "link.txt", "/etc/passwd"):
            self.assert_refused(name, "outside the folder")

    def test_recordings_get_plain_new_names_only(self):
        for name in ("../x.csv", "/tmp/x.csv", ".hidden", "a b.csv"):
            self.assertFalse(self.robot.record(True, name).success, name)
        self.assertFalse(self.robot.state().recording)


if __name__ == "__main__":
    rospy.init_node("refusals_test")
    rostest.rosrun("knee_robot", "refusals", Refusals)
