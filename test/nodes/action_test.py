#!/usr/bin/python3
"""The action `play` from another process: a whole exercise, pause and resume, speed, cancel, preempt, refusals, a fault on the way."""
import math
import os
import pathlib
import sys
import time
import unittest

import rospy
import rostest

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import movements  # noqa: E402
from knee_robot.msg import Tracking  # noqa: E402
from robot_client import Player, RobotClient, read_recording  # noqa: E402


# A reference is that of the planned time; a cycle that begins 20 ms late on a busy machine is read, and stamped, 20 ms later. A
# platform at rest is moved by such a cycle, too: its drives go on with the last voltage (0.3 mm were seen after 14 ms).
LATE_WAY = 2e-3  # m


class References:
    """Reference positions that were published while this existed."""

    def __init__(self, robot):
        self.rows = []
        self.subscriber = rospy.Subscriber(f"/{robot.name}/tracking", Tracking, self.rows.append, queue_size=1000)

    def largest_jump(self):
        """The farthest that a reference went between two messages beyond 0.08 m/s, m. The movements have 0.04 m/s, the approach 0.05 m/s."""
        self.subscriber.unregister()
        jumps = [0.0]
        for a, b in zip(self.rows, self.rows[1:]):
            way = max(abs(q - p) for p, q in zip(a.reference_m, b.reference_m))
            jumps.append(way - 0.08 * (b.header.stamp - a.header.stamp).to_sec())
        print(f"{len(self.rows)} references, largest jump {1e3 * max(jumps):.2f} mm")
        return max(jumps)


class Action(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.robot = RobotClient()
        cls.player, cls.other = Player(cls.robot), Player(cls.robot)
        cls.folder = pathlib.Path(cls.robot.parameter("references"))
        cls.recordings = pathlib.Path(cls.robot.parameter("recordings"))
        movements.write(cls.folder, "rise.txt", movements.rise(3.0))
        movements.write(cls.folder, "high.txt", movements.rise(6.0, height=0.06))
        movements.write(cls.folder, "jump.txt", [(0, 0.6, 0, 0), (0, 0.65, 0, 0)])

    def setUp(self):
        self.robot.bring_to("holding")

    def play(self, file="rise.txt", **fields):
        return self.player.send(file, approach=True, approach_speed=0.05, **fields)

    def test_a_whole_exercise_is_enabled_approached_recorded_and_played_to_its_end(self):
        self.robot.bring_to("disabled")
        name = f"action_{os.getpid()}.csv"
        state, result = self.play(enable=True, record=True, recording=name).end()
        self.assertEqual("SUCCEEDED", state, result)
        self.assertTrue(result.success)
        self.assertAlmostEqual(3.0, result.path_time_s, places=2)
        self.assertEqual(str(self.recordings.resolve() / name), result.recording)
        self.assertEqual("holding", self.robot.state().state)
        phases = [f.phase for f in self.player.feedback]
        self.assertLess(phases.index("approaching"), phases.index("playing"))
        progress = [f.progress for f in self.player.feedback if f.phase == "playing"]
        self.assertEqual(sorted(progress), progress)
        self.assertGreater(len(progress), 10)
        self.assertGreater(progress[-1], 0.9)
        print("largest tracking errors, mm:", [round(1e3 * e, 3) for e in result.largest_error_m])
        self.assertTrue(all(0.0 < e < 5e-3 for e in result.largest_error_m))
        recording = read_recording(result.recording)
        self.assertGreater(max(recording["position_4_m"]) - min(recording["position_4_m"]), 0.025)
        self.assertFalse(self.robot.state().recording)

    def test_pause_comes_to_rest_on_the_path_and_resume_goes_on_from_there(self):
        references = References(self.robot)
        self.play()
        self.assertTrue(self.player.wait_for_phase("playing", path_time_s=0.5))
        answer = self.robot.trigger("pause")
        self.assertTrue(answer.success, answer.message)
        self.assertEqual("paused", self.robot.wait_for("paused", 5).state)
        time.sleep(0.7)  # the last set point is still being interpolated, and what a late one left is blended for 0.5 s
        before, at = self.robot.tracking(), self.robot.state().path_time_s
        time.sleep(0.7)
        after = self.robot.tracking()
        self.assertEqual("paused", self.player.feedback[-1].phase)
        self.assertEqual(-1.0, self.player.feedback[-1].remaining_s)
        self.assertEqual(at, self.robot.state().path_time_s)
        self.assertEqual(before.reference_m, after.reference_m)
        self.assertLess(max(abs(a - b) for a, b in zip(before.position_m, after.position_m)), LATE_WAY)
        self.assertTrue(self.robot.trigger("resume").success)
        state, result = self.player.end()
        self.assertEqual("SUCCEEDED", state, result)
        self.assertAlmostEqual(3.0, result.path_time_s, places=2)
        self.assertLess(references.largest_jump(), LATE_WAY)

    def test_the_speed_changes_on_the_way_and_the_path_stays(self):
        references = References(self.robot)
        self.play(speed_percent=100)
        self.assertTrue(self.player.wait_for_phase("playing", path_time_s=0.5))
        answer = self.robot.set_speed(40)
        self.assertTrue(answer.success, answer.message)
        self.assertTrue(self.player.wait_for_phase("playing", path_time_s=1.2))
        self.assertAlmostEqual(40.0, self.player.feedback[-1].speed_percent, places=3)
        self.assertTrue(self.robot.set_speed(100).success)
        state, result = self.player.end()
        self.assertEqual("SUCCEEDED", state, result)
        self.assertLess(references.largest_jump(), LATE_WAY)

    def test_a_goal_is_played_at_the_speed_that_it_asks_for(self):
        begin = time.monotonic()
        state, result = self.player.send("rise.txt", approach=True, approach_speed=0.05, speed_percent=50).end()
        self.assertEqual("SUCCEEDED", state, result)
        self.assertGreater(time.monotonic() - begin, 6.0)

    def test_a_speed_that_somebody_lowers_during_the_approach_is_not_raised_for_the_movement(self):
        self.player.send("rise.txt", approach=True, approach_speed=0.02)
        self.assertTrue(self.player.wait_for_phase("approaching"))
        self.assertTrue(self.robot.set_speed(30).success)
        self.assertTrue(self.player.wait_for_phase("playing", path_time_s=0.1))
        self.assertAlmostEqual(30.0, self.robot.state().speed_percent, places=3)
        self.player.client.cancel_goal()
        self.player.end(10)

    def test_a_speed_that_somebody_sets_while_the_robot_is_being_enabled_is_not_raised(self):
        movements.write(self.folder, "above.txt", movements.rise(3.0, height=0.01, home=(0.0, 0.62, 0.0, 0.0)))
        for before in (100, 20):
            self.robot.bring_to("disabled")
            self.robot.set_speed(before)
            self.player.send("above.txt", enable=True, approach=True, approach_speed=0.02)
            self.robot.wait_for("enabling", 5)
            self.assertTrue(self.robot.set_speed(20).success)
            self.assertTrue(self.player.wait_for_phase("approaching"))
            self.assertAlmostEqual(20.0, self.robot.state().speed_percent, places=3)
            self.player.client.cancel_goal()
            self.player.end(10)

    def test_a_pause_at_the_very_end_of_the_approach_ends_the_goal_there(self):
        movements.write(self.folder, "above.txt", movements.rise(3.0, height=0.01, home=(0.0, 0.62, 0.0, 0.0)))
        self.player.send("above.txt", approach=True, approach_speed=0.01)
        state = self.robot.wait_for("playing", 5)
        while state.playing.startswith("the approach") and state.duration_s - state.path_time_s > 0.05:
            state = self.robot.state()
        self.assertTrue(state.playing.startswith("the approach"), state.playing)
        self.assertTrue(self.robot.trigger("pause").success)
        state, result = self.player.end(10)
        self.assertEqual("ABORTED", state, result)
        self.assertIn("paused the robot at the very end of the approach", result.message)
        self.assertEqual("holding", self.robot.state().state)

    def test_cancel_slows_down_along_the_path_and_holds(self):
        self.play()
        self.assertTrue(self.player.wait_for_phase("playing", path_time_s=0.5))
        self.player.client.cancel_goal()
        state, result = self.player.end(10)
        self.assertEqual("PREEMPTED", state)
        self.assertIn("cancelled", result.message)
        self.assertFalse(result.success)
        self.assertLess(result.path_time_s, 2.5)
        self.assertEqual("holding", self.robot.state().state)

    def test_a_newer_goal_preempts_and_is_played(self):
        self.play("high.txt")
        self.assertTrue(self.player.wait_for_phase("playing", path_time_s=0.5))
        self.other.send("rise.txt", approach=True, approach_speed=0.05)
        state, result = self.player.end(10)
        self.assertEqual("PREEMPTED", state)
        self.assertIn("preempted by a newer goal", result.message)
        state, result = self.other.end()
        self.assertEqual("SUCCEEDED", state, result)

    def test_a_goal_that_may_not_be_played_disturbs_nothing(self):
        self.play()
        self.assertTrue(self.player.wait_for_phase("playing"))
        state, result = self.other.send("jump.txt").end(10)
        self.assertEqual("REJECTED", state)
        self.assertIn("jump.txt:3", result.message)
        state, result = self.player.end()
        self.assertEqual("SUCCEEDED", state, result)

    def test_a_fault_aborts_the_goal_with_its_cause(self):
        self.play()
        self.assertTrue(self.player.wait_for_phase("playing", path_time_s=0.3))
        self.assertTrue(self.robot.trigger("emergency_stop").success)
        state, result = self.player.end(15)
        self.assertEqual("ABORTED", state)
        self.assertEqual("faulted", self.robot.wait_for("faulted", 10).state)
        state, result = self.other.send("rise.txt", enable=True).end(10)
        self.assertEqual("REJECTED", state)
        self.assertIn("faulted", result.message)
        self.assertTrue(self.robot.trigger("reset_faults").success)

    def test_a_goal_whose_recording_somebody_else_has_ended_says_so_and_leaves_the_next_one_alone(self):
        own, others = f"action_{os.getpid()}_own.csv", f"action_{os.getpid()}_others.csv"
        self.play(record=True, recording=own)
        self.assertTrue(self.player.wait_for_phase("playing", path_time_s=0.3))
        self.assertTrue(self.robot.record(False).success)
        self.assertTrue(self.robot.record(True, others).success)
        state, result = self.player.end()
        self.assertTrue(self.robot.state().recording, result.message)
        self.assertEqual("ABORTED", state)
        self.assertIn("somebody else has ended the recording", result.message)
        self.assertTrue(self.robot.record(False).success)

    def test_somebody_elses_stop_aborts_the_goal_and_says_so(self):
        self.play()
        self.assertTrue(self.player.wait_for_phase("playing", path_time_s=0.3))
        self.assertTrue(self.robot.trigger("stop").success)
        state, result = self.player.end(15)
        self.assertEqual("ABORTED", state)
        self.assertIn("somebody else stopped it", result.message)

    def test_every_goal_that_makes_no_sense_is_rejected_with_its_reason(self):
        home = self.robot.tracking().position_m
        for reason, fields in (("absent.txt", dict(file="absent.txt")),
                               ("outside the folder", dict(file="/etc/passwd")),
                               ("no space", dict(file="rise.txt", space="joint")),
                               ("speed_percent", dict(file="rise.txt", speed_percent=200)),
                               ("speed_percent", dict(file="rise.txt", speed_percent=math.nan)),
                               ("approach_speed", dict(file="rise.txt", approach=True, approach_speed=1.0)),
                               ("no name for a new file", dict(file="rise.txt", record=True, recording="../x.csv"))):
            state, result = self.player.send(**fields).end(10)
            self.assertEqual("REJECTED", state, fields)
            self.assertIn(reason, result.message)
        self.robot.bring_to("disabled")
        state, result = self.player.send("rise.txt").end(10)
        self.assertEqual("REJECTED", state)
        self.assertIn("the robot is disabled", result.message)
        self.assertLess(max(abs(a - b) for a, b in zip(home, self.robot.tracking().position_m)), 1e-3)


if __name__ == "__main__":
    rospy.init_node("action_test")
    rostest.rosrun("knee_robot", "action", Action)
