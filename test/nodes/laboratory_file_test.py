#!/usr/bin/python3
"""The laboratory's own reference file for robot A plays through the launch file as it is."""
import os
import pathlib
import sys
import unittest

import rospy
import rostest

sys.path.insert(0, str(pathlib.Path(__file__).parent))
from robot_client import ROOT, RobotClient, parameter, read_recording, root_mean_square  # noqa: E402

FILE = ROOT.parent / "shared" / "data" / "references" / "refeprism_indep_TRR8.txt"


class LaboratoryFile(unittest.TestCase):
    recording = f"laboratory_{os.getpid()}.csv"

    @unittest.skipUnless(FILE.exists(), "the laboratory's files are not here (they are not part of the repository)")
    def test_the_laboratorys_file_is_played(self):
        robot = RobotClient()
        (pathlib.Path(parameter("references")) / FILE.name).write_bytes(FILE.read_bytes())
        loaded = robot.load(FILE.name)
        self.assertTrue(loaded.success, loaded.message)
        self.assertEqual(8793, loaded.points)
        for command in ("enable", "approach"):
            answer = robot.trigger(command)
            self.assertTrue(answer.success, answer.message)
        self.assertEqual("holding", robot.wait_for("holding", 120).state)
        self.assertTrue(robot.record(True, self.recording).success)
        answer = robot.trigger("start")
        self.assertTrue(answer.success, answer.message)
        ended = robot.wait_for("holding", loaded.duration_s + 60)
        self.assertEqual("holding", ended.state, ended.cause)
        answer = robot.record(False)
        self.assertTrue(answer.success, answer.message)
        recording = read_recording(pathlib.Path(parameter("recordings")) / self.recording)
        for axis in range(1, 5):
            error = [r - p for r, p in zip(recording[f"reference_{axis}_m"], recording[f"position_{axis}_m"])]
            print(f"axis {axis}: tracking error rms {1e3 * root_mean_square(error):.3f} mm, "
                  f"largest {1e3 * max(map(abs, error)):.3f} mm")
            self.assertLess(root_mean_square(error), 1e-3)


if __name__ == "__main__":
    rospy.init_node("laboratory_file_test")
    rostest.rosrun("knee_robot", "laboratory_file", LaboratoryFile)
