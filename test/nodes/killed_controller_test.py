#!/usr/bin/python3
"""A killed controller leaves a readable recording, and the robot alive."""
import os
import pathlib
import signal
import sys
import time
import unittest
import xmlrpc.client

import rosgraph
import rospy
import rostest

sys.path.insert(0, str(pathlib.Path(__file__).parent))
from robot_client import RobotClient, parameter, read_recording  # noqa: E402

SHARED_MEMORY = pathlib.Path("/dev/shm/knee_robot_test_killed_controller")


def pid_of(node):
    uri = rosgraph.Master("/killed_controller_test").lookupNode(node)
    return xmlrpc.client.ServerProxy(uri).getPid("/killed_controller_test")[2]


class KilledController(unittest.TestCase):
    recording = f"killed_{os.getpid()}.csv"

    def test_the_recording_is_readable_and_the_robot_lives(self):
        robot = RobotClient()
        answer = robot.trigger("enable")
        self.assertTrue(answer.success, answer.message)
        self.assertTrue(robot.record(True, self.recording).success)
        time.sleep(3.0)
        folder = pathlib.Path(parameter("recordings"))
        os.kill(pid_of("/controller"), signal.SIGKILL)
        time.sleep(0.5)

        text = (folder / self.recording).read_text()
        self.assertTrue(text.endswith("\n"), "the last line is not whole")
        time_s = read_recording(folder / self.recording)["time_s"]
        self.assertGreater(time_s[-1] - time_s[0], 2.5)
        self.assertTrue(all(b > a for a, b in zip(time_s, time_s[1:])))

        self.assertTrue(SHARED_MEMORY.exists(), "the hardware died with its controller")
        before = SHARED_MEMORY.read_bytes()
        time.sleep(0.1)
        self.assertNotEqual(before, SHARED_MEMORY.read_bytes(), "the simulated robot stands still in time")


if __name__ == "__main__":
    rospy.init_node("killed_controller_test")
    rostest.rosrun("knee_robot", "killed_controller", KilledController)
