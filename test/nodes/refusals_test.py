#!/usr/bin/python3
"""What may not be played is refused with a reason, and nothing moves."""
import math
import os
import pathlib
import subprocess
import sys
import unittest

import roslib.packages
import rospy
import rostest

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import movements  # noqa: E402
from robot_client import Player, RobotClient, parameter  # noqa: E402


class Refusals(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.robot = RobotClient()
        cls.folder = pathlib.Path(parameter("references"))

    def write(self, name, points):
        (self.folder / name).write_text("".join(" ".join(map(str, point)) + "\n" for point in points))
        return name

    def setUp(self):
        self.robot.bring_to("disabled")
        self.home = list(self.robot.tracking().position_m)

    def assert_refused(self, name, *words):
        loaded = self.robot.state().reference_file
        answer = self.robot.load(name)
        self.assertFalse(answer.success, answer.message)
        for word in words:
            self.assertIn(word, answer.message)
        self.assertEqual("disabled", self.robot.state().state)
        self.assertEqual(loaded, self.robot.state().reference_file)
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

    def assert_services_refused(self, state, *services):
        for service in services:
            answer = self.robot.trigger(service)
            self.assertFalse(answer.success, service)
            self.assertGreater(len(answer.message), 10, service)
            self.assertEqual(state, self.robot.state().state, service)

    def test_what_the_state_forbids_is_refused_and_changes_nothing(self):
        self.robot.bring_to("disabled")
        self.assert_services_refused("disabled", "pause", "resume", "start", "approach")
        self.robot.bring_to("holding")
        self.assertTrue(self.robot.load(movements.write(self.folder, "rise.txt", movements.rise(4.0))).success)
        self.assert_services_refused("holding", "pause", "resume", "reset_faults", "home", "confirm_home")
        self.assertTrue(self.robot.trigger("approach").success)
        self.robot.wait_for("holding", 20)
        self.assertTrue(self.robot.trigger("start").success)
        self.assert_services_refused("playing", "enable", "start", "approach", "reset_faults", "home", "confirm_home")
        self.assertFalse(self.robot.load("rise.txt").success)
        self.assertTrue(self.robot.trigger("emergency_stop").success)
        self.assertEqual("faulted", self.robot.wait_for("faulted", 10).state)
        self.assert_services_refused("faulted", "enable", "start", "approach", "pause", "resume", "home")
        self.assertIn("emergency stop", self.robot.trigger("enable").message)
        self.assertTrue(self.robot.trigger("reset_faults").success)
        self.assertEqual("disabled", self.robot.state().state)

    def test_nothing_of_ours_begins_by_somebody_elses_clock(self):
        rospy.set_param("/use_sim_time", True)
        try:
            for program in (["controller", "__name:=of_another_clock"], ["play_movement", "rise.txt"], ["operator_page"], ["identification_server"]):
                ended = subprocess.run([roslib.packages.find_node("knee_robot", program[0])[0], *program[1:]], timeout=30, capture_output=True, text=True)
                self.assertEqual(2, ended.returncode, program)
                self.assertIn("use_sim_time", ended.stderr, program)
        finally:
            rospy.delete_param("/use_sim_time")

    def test_impossible_speeds_are_refused(self):
        for percent in (-1.0, 100.1, math.nan, math.inf):
            self.assertFalse(self.robot.set_speed(percent).success, percent)
        self.assertEqual(100.0, self.robot.state().speed_percent)

    def test_a_patients_range_and_speed_bind_until_they_are_cleared(self):
        (self.folder / "patient.yaml").write_text(
            "patient: test\npose: {X_m: [-0.05, 0.05], Z_m: [0.59, 0.62], theta_deg: [-5, 5], psi_deg: [-5, 5]}\n")
        self.robot.load(movements.write(self.folder, "before.txt", movements.rise(4.0)))
        answer = self.robot.load_patient("patient.yaml")
        self.assertTrue(answer.success, answer.message)
        self.assertEqual("test", self.robot.state().patient)
        self.assertEqual("", self.robot.state().reference_file, "it was judged for somebody else")
        try:
            self.assert_refused(movements.write(self.folder, "high.txt", movements.rise(8.0)), "Z")
            self.assert_refused(movements.write(self.folder, "fast.txt", movements.rise(2.0, height=0.015, angle_deg=0.0)), "mm/s")
            small = self.robot.load(movements.write(self.folder, "small.txt", movements.rise(6.0, height=0.015, angle_deg=1.0)))
            self.assertTrue(small.success, small.message)
            self.robot.bring_to("holding")
            self.assertFalse(self.robot.load_patient("patient.yaml").success)
            self.assertFalse(self.robot.trigger("clear_patient").success)
            state, result = Player(self.robot).send("small.txt", approach=True).end()
            self.assertEqual("SUCCEEDED", state, result)
        finally:
            self.robot.bring_to("disabled")
            self.assertTrue(self.robot.trigger("clear_patient").success)
            self.assertEqual("unknown", self.robot.state().occupancy)
            refused = self.robot.trigger("enable")
            self.assertFalse(refused.success)
            self.assertIn("declare_empty", refused.message)
            self.assertTrue(self.robot.trigger("declare_empty").success)
            self.assertEqual("empty", self.robot.state().occupancy)
        self.assertEqual("", self.robot.state().patient)
        self.assertTrue(self.robot.load("high.txt").success)

    def test_patient_files_are_read_strictly_and_from_their_folder_only(self):
        (self.folder / "bad.yaml").write_text("patient: test\npose: {X_m: [0.1, -0.1]}\n")
        for name in ("bad.yaml", "../outside.yaml", "/etc/passwd", "", "no_such.yaml"):
            self.assertFalse(self.robot.load_patient(name).success, name)
        self.assertEqual("", self.robot.state().patient)

    def test_a_huge_file_and_a_folder_are_refused(self):
        huge = self.folder / "huge.txt"
        with open(huge, "wb") as file:
            file.truncate(100 << 20)
        self.assert_refused("huge.txt", "more than the limit")
        huge.unlink()
        (self.folder / "folder.txt").mkdir(exist_ok=True)
        self.assert_refused("folder.txt", "not a regular file")

    def test_recordings_get_plain_new_names_only(self):
        for name in ("../x.csv", "/tmp/x.csv", ".hidden", "a b.csv"):
            self.assertFalse(self.robot.record(True, name).success, name)
        self.assertFalse(self.robot.state().recording)


if __name__ == "__main__":
    rospy.init_node("refusals_test")
    rostest.rosrun("knee_robot", "refusals", Refusals)
