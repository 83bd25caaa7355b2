#!/usr/bin/python3
"""A short path played on four simulated CiA 402 drives through the public interface; then the drives' process dies in a motion."""
import os
import pathlib
import subprocess
import sys
import time
import unittest

import rospy
import rostest
import yaml

sys.path.insert(0, str(pathlib.Path(__file__).parent))
from robot_client import RobotClient, parameter, read_recording, root_mean_square  # noqa: E402


def home():
    with open(parameter("robot")) as file:
        return [actuator["home_length_m"] for actuator in yaml.safe_load(file)["actuators"]]


def write_lift(path, distance, seconds):
    """All four legs, rest to rest, minimum jerk."""
    count = round(seconds / 0.01)
    lines = []
    for k in range(count + 1):
        x = k / count
        share = x**3 * (10 + x * (6 * x - 15))
        lines.append(" ".join(f"{length + share * distance:.9f}" for length in home()))
    path.write_text("\n".join(lines) + "\n")


class CanPlay(unittest.TestCase):
    recording = f"can_play_{os.getpid()}.csv"

    def test_a_path_is_played_and_lost_drives_end_it(self):
        robot = RobotClient()
        references, recordings = pathlib.Path(parameter("references")), pathlib.Path(parameter("recordings"))
        write_lift(references / "lift.txt", 0.02, 4.0)
        self.enable(robot)
        loaded = robot.load("lift.txt")
        self.assertTrue(loaded.success, loaded.message)
        answer = robot.trigger("approach")
        self.assertTrue(answer.success, answer.message)
        self.assertEqual("holding", robot.wait_for("holding", 60).state, robot.state().cause)
        self.assertTrue(robot.record(True, self.recording).success)
        answer = robot.trigger("start")
        self.assertTrue(answer.success, answer.message)
        ended = robot.wait_for("holding", 30)
        self.assertEqual("holding", ended.state, ended.cause)
        answer = robot.record(False)
        self.assertTrue(answer.success, answer.message)
        self.check_recording(recordings / self.recording)
        self.lose_the_drives(robot)

    def enable(self, robot):
        if robot.state().state == "faulted":
            robot.trigger("reset_faults")
        answer = robot.trigger("enable")
        self.assertTrue(answer.success, answer.message)

    def check_recording(self, path):
        recording = read_recording(path)
        steps = [b - a for a, b in zip(recording["time_s"], recording["time_s"][1:])]
        print(f"median period {1e3 * sorted(steps)[len(steps) // 2]:.3f} ms")
        self.assertAlmostEqual(0.002, sorted(steps)[len(steps) // 2], delta=0.0005)
        for axis in range(1, 5):
            error = [r - p for r, p in zip(recording[f"reference_{axis}_m"], recording[f"position_{axis}_m"])]
            print(f"axis {axis}: tracking error rms {1e3 * root_mean_square(error):.3f} mm")
            self.assertLess(root_mean_square(error), 1e-3)
            moved = max(recording[f"position_{axis}_m"]) - min(recording[f"position_{axis}_m"])
            self.assertAlmostEqual(0.02, moved, delta=0.002)

    def lose_the_drives(self, robot):
        """The simulated drives' process ends while the robot holds: the controller says why it stopped."""
        found = subprocess.run(["pgrep", "-f", "cia402_simulator.*knee_robot_test_can_play"], capture_output=True, text=True)
        os.kill(int(found.stdout.split()[0]), 9)
        ended = robot.wait_for("faulted", 10)
        self.assertEqual("faulted", ended.state)
        self.assertIn(ended.fault, ("bus_down", "drive_lost"), ended.cause)
        time.sleep(1.0)
        self.assertFalse(robot.trigger("enable").success)


if __name__ == "__main__":
    rospy.init_node("can_play_test")
    rostest.rosrun("knee_robot", "can_play", CanPlay)
