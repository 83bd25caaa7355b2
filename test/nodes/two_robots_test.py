#!/usr/bin/python3
"""Two robots in two namespaces under one master: each does what it is told, and nothing of the other."""
import pathlib
import sys
import unittest

import rospy
import rosservice
import rostest
import rostopic
from sensor_msgs.msg import JointState
from tf2_msgs.msg import TFMessage

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import movements  # noqa: E402
from robot_client import Player, RobotClient  # noqa: E402


class TwoRobots(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.robots = {side: RobotClient(f"{side}/controller") for side in ("left", "right")}
        for side, height in (("left", 0.03), ("right", 0.05)):
            movements.write(cls.robots[side].parameter("references"), f"{side}.txt", movements.rise(4.0, height=height))

    def test_1_only_the_one_that_is_told_moves(self):
        left, right = self.robots["left"], self.robots["right"]
        before = right.tracking().position_m
        state, result = Player(left).send("left.txt", enable=True, approach=True).end()
        self.assertEqual("SUCCEEDED", state, result)
        self.assertEqual("disabled", right.state().state)
        self.assertEqual(before, right.tracking().position_m)
        self.assertFalse(right.load("left.txt").success, "the other's folder")

    def test_2_both_at_once(self):
        players = {side: Player(robot).send(f"{side}.txt", enable=True, approach=True) for side, robot in self.robots.items()}
        self.assertTrue(players["left"].wait_for_phase("playing"))
        self.assertTrue(players["right"].wait_for_phase("playing"))
        self.assertTrue(self.robots["left"].trigger("pause").success)
        self.assertEqual("paused", self.robots["left"].wait_for("paused", 5).state)
        state, result = players["right"].end()
        self.assertEqual("SUCCEEDED", state, result)
        self.assertTrue(self.robots["left"].trigger("resume").success)
        state, result = players["left"].end()
        self.assertEqual("SUCCEEDED", state, result)

    def test_3_nothing_but_diagnostics_and_ros_itself_is_outside_of_the_namespaces(self):
        topics = [name for group in rostopic.get_topic_list() for name, *_ in group]
        outside = {t for t in topics if not t.startswith(("/left/", "/right/"))}
        self.assertEqual(set(), outside - {"/diagnostics", "/rosout", "/rosout_agg", "/clock"})
        services = {s for s in rosservice.get_service_list() if not s.startswith(("/left/", "/right/"))}
        self.assertEqual(set(), {s for s in services if not s.startswith(("/rosout", "/two_robots"))})
        for side in ("left", "right"):
            self.assertEqual(15, len(rospy.wait_for_message(f"/{side}/joint_states", JointState, 10).name))
            self.assertTrue(rospy.wait_for_message(f"/{side}/tf", TFMessage, 10).transforms)


if __name__ == "__main__":
    rospy.init_node("two_robots_test")
    rostest.rosrun("knee_robot", "two_robots", TwoRobots)
