#!/usr/bin/python3
"""A reference is planned, loaded, played and recorded through the public interface, and a model identified from it."""
import json
import os
import pathlib
import sys
import unittest

import rospy
import rostest

sys.path.insert(0, str(pathlib.Path(__file__).parent))
from robot_client import RobotClient, parameter, read_recording, root_mean_square, run_program  # noqa: E402


class Play(unittest.TestCase):
    recording = f"play_{os.getpid()}.csv"

    def test_a_planned_reference_is_played_recorded_and_identified(self):
        robot = RobotClient()
        references, recordings = pathlib.Path(parameter("references")), pathlib.Path(parameter("recordings"))
        planned = run_program("plan_excitation", "--robot", parameter("robot"), "--seed", 3, "--duration", 15,
                              "-o", references / "excitation.txt")
        self.assertEqual(0, planned.returncode, planned.stderr)

        self.assertFalse(robot.trigger("start").success, "nothing is loaded, nothing may start")
        loaded = robot.load("excitation.txt")
        self.assertTrue(loaded.success, loaded.message)
        for command in ("enable", "approach"):
            answer = robot.trigger(command)
            self.assertTrue(answer.success, answer.message)
        self.assertEqual("holding", robot.wait_for("holding", 120).state)
        self.assertTrue(robot.record(True, self.recording).success)
        answer = robot.trigger("start")
        self.assertTrue(answer.success, answer.message)
        self.assertFalse(robot.load("excitation.txt").success, "a file must not be replaced while it is played")
        ended = robot.wait_for("holding", loaded.duration_s + 60)
        self.assertEqual("holding", ended.state, ended.cause)
        answer = robot.record(False)
        self.assertTrue(answer.success, answer.message)
        answer = robot.trigger("disable")
        self.assertTrue(answer.success, answer.message)

        self.check_recording(recordings / self.recording, loaded.duration_s)
        self.check_identification(recordings / self.recording, parameter("robot"), recordings / f"identified_{os.getpid()}")

    def check_recording(self, path, duration):
        recording = read_recording(path)
        time = recording["time_s"]
        self.assertGreaterEqual(time[-1] - time[0], duration)
        for axis in range(1, 5):
            error = [r - p for r, p in zip(recording[f"reference_{axis}_m"], recording[f"position_{axis}_m"])]
            print(f"axis {axis}: tracking error rms {1e3 * root_mean_square(error):.3f} mm, "
                  f"largest {1e3 * max(map(abs, error)):.3f} mm")
            # The paper's robot stays below 1 mm in legs 1 to 3 and goes beyond 2 mm in leg 4 (Fig. 15).
            self.assertLess(root_mean_square(error), 1e-3)
            moved = max(recording[f"position_{axis}_m"]) - min(recording[f"position_{axis}_m"])
            self.assertGreater(moved, 0.01, "the robot did not move")

    def check_identification(self, recording, robot, output):
        done = run_program("identify", "--robot", robot, "--train", recording, "--output", output)
        self.assertEqual(0, done.returncode, done.stderr)
        report = json.loads((output / "report.json").read_text())
        print("rms error, % of measured force:", report["after"]["train"]["rms_percent"])
        for percent in report["after"]["train"]["rms_percent"]:
            self.assertLess(percent, 20.0)
        self.assertIn(json.dumps(report["reproduce"]), (output / "report.html").read_text())


if __name__ == "__main__":
    rospy.init_node("play_test")
    rostest.rosrun("knee_robot", "play", Play)
