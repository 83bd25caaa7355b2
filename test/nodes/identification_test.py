#!/usr/bin/python3
"""identification.launch from planning to the report, and the action identify_recordings with what it records."""
import json
import math
import pathlib
import shutil
import sys
import threading
import time
import unittest

import actionlib
import rospy
import rostest
from actionlib_msgs.msg import GoalStatus

from knee_robot.msg import IdentifyRecordingsAction, IdentifyRecordingsGoal

sys.path.insert(0, str(pathlib.Path(__file__).parent))
from robot_client import RobotClient, has_result  # noqa: E402


def wait_until(condition, seconds, what):
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            raise AssertionError(f"{what} did not come about in {seconds} s")
        time.sleep(0.1)


class Identification(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(rospy.get_param("~folder"))
        cls.report = cls.folder / "identified" / "report.json"
        for left in (cls.folder / "reports").glob("*"):  # by an earlier run: an output that exists is refused
            shutil.rmtree(left, ignore_errors=True)
        began = rospy.get_time()
        robot = RobotClient()

        def is_reported():
            state = robot.state()
            assert state.state != "faulted", state.cause  # no report would come
            return cls.report.exists() and cls.report.stat().st_mtime > began - 60

        wait_until(is_reported, 420, "the report of identification.launch")
        cls.recordings = [p.name for p in sorted((cls.folder / "recordings").glob("excitation_*.csv"))][-2:]
        cls.near_rest = sorted(p.name for p in (cls.folder / "recordings").glob("near_rest_*.csv"))[-1]
        cls.client = actionlib.SimpleActionClient("identify_recordings", IdentifyRecordingsAction)
        assert cls.client.wait_for_server(rospy.Duration(30)), "no action server"

    def send(self, **fields):
        self.feedback, self.heard = [], threading.Event()

        def listen(message):
            self.feedback.append((message.stage, message.share))
            self.heard.set()

        self.client.send_goal(IdentifyRecordingsGoal(**fields), feedback_cb=listen)

    def end(self, seconds=240):
        self.assertTrue(has_result(self.client, seconds), "the goal has no result")
        return GoalStatus.to_string(self.client.get_state()), self.client.get_result()

    def unfinished(self):
        return list((self.folder / "reports").glob(".unfinished_*"))

    def test_1_the_launch_file_identifies_a_model_that_holds_on_the_held_out_recording(self):
        report = json.loads(self.report.read_text())
        before, after = (report[when]["validate"]["rms_N"] for when in ("before", "after"))
        print("held-out error, N, without and with friction:", before, after)
        self.assertEqual(4, len(after))
        self.assertTrue((self.folder / "identified" / "model.yaml").exists())
        for without, with_friction in zip(before, after):
            self.assertLess(with_friction, 0.7 * without)
        trained = [pathlib.Path(p).name.split("_20")[0] for p in report["data"]["train"]]
        self.assertEqual(["near_rest", "excitation"], trained)

    def test_2_the_action_identifies_with_feedback_and_figures(self):
        self.send(command="identify", train=[self.near_rest, *self.recordings[:1]], validate=self.recordings[1:], output="by_action",
                  model=str(self.folder / "identified" / "model.yaml"))
        state, result = self.end()
        self.assertEqual(("SUCCEEDED", True), (state, result.success), result.message)
        self.assertTrue({"model.yaml", "report.html", "report.json"} <= set(result.files))
        shares = [share for _, share in self.feedback]
        self.assertEqual(sorted(shares), shares)
        self.assertGreater(max(shares), 0.2)
        for values in (result.before_rms_N, result.after_rms_N, result.in_use_rms_N, result.new_rms_N):
            self.assertEqual(4, len(values))
            self.assertTrue(all(math.isfinite(v) and v > 0 for v in values))
        for in_use, new in zip(result.in_use_rms_N, result.new_rms_N):  # the session's recordings, so its model
            self.assertAlmostEqual(in_use, new, delta=1e-3 * new)
        self.assertEqual([], self.unfinished())

    def test_3_goals_that_cannot_be_run_are_rejected_by_a_sentence(self):
        one = self.recordings[0]
        for wrong, word in (({"command": "format"}, "none of"), ({"command": "identify"}, "at least one"), ({"command": "identify", "train": ["../x.csv"]}, "no name"),
                            ({"command": "identify", "train": ["no.csv"]}, "no recording"), ({"command": "identify", "train": [one], "validate": [one]}, "twice"),
                            ({"command": "compare", "train": self.recordings}, "exactly one"), ({"command": "identify", "train": [one], "output": "../out"}, "no name"),
                            ({"command": "identify", "train": [one], "options": ["output=/tmp"]}, "not among"), ({"command": "trace", "train": [one], "model": "/no.yaml"}, "no model"),
                            ({"command": "identify", "train": [one], "robot": "/no.yaml"}, "no robot file"), ({"command": "identify", "train": [one], "start_from_model": True}, "needs")):
            self.send(**wrong)
            state, result = self.end(20)
            self.assertEqual("REJECTED", state, wrong)
            self.assertIn(word, result.message, wrong)

    def test_4_what_the_program_refuses_is_the_results_sentence_and_leaves_nothing(self):
        (self.folder / "recordings" / "empty.csv").write_text("time_s,position_1_m\n")
        self.send(command="identify", train=["empty.csv"], output="refused")
        state, result = self.end()
        self.assertEqual("ABORTED", state)
        self.assertIn("empty.csv", result.message)
        self.assertFalse((self.folder / "reports" / "refused").exists())
        self.assertEqual([], self.unfinished())

    def test_5_a_run_can_be_cancelled_a_second_goal_is_rejected_meanwhile_and_nothing_stays(self):
        self.send(command="trace", train=self.recordings[:1], validate=self.recordings[1:], output="cancelled")
        self.assertTrue(self.heard.wait(120))
        second = actionlib.SimpleActionClient("identify_recordings", IdentifyRecordingsAction)
        self.assertTrue(second.wait_for_server(rospy.Duration(10)))
        second.send_goal(IdentifyRecordingsGoal(command="compare", train=self.recordings[:1]))
        self.assertTrue(has_result(second, 20))
        self.assertIn("another identification", second.get_result().message)
        self.client.cancel_goal()
        state, result = self.end(30)
        self.assertEqual("PREEMPTED", state, result.message)
        self.assertFalse((self.folder / "reports" / "cancelled").exists())
        self.assertEqual([], self.unfinished())
        self.send(command="compare", train=self.recordings[:1], output="after_it")
        self.assertEqual("SUCCEEDED", self.end()[0], "the server goes on")


if __name__ == "__main__":
    rospy.init_node("identified")
    rostest.rosrun("knee_robot", "identified", Identification)
