#!/usr/bin/python3
"""A therapist shows a movement by hand, through the public interface: the platform follows while the enabling switch is held, holds when it is let go
of, and plays what it was shown."""
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import rospy
import rostest

sys.path.insert(0, str(pathlib.Path(__file__).parent))
from robot_client import ROOT, RobotClient, run_program  # noqa: E402
from knee_robot.srv import LoadReference  # noqa: E402

SHARED = f"/knee_robot_test_guiding_{os.getpid()}"
ROBOT = ROOT / "config/robots/A.yaml"
HAND_N = 55.0  # upwards; the free robot needs about 130 N, the guided one 37


def identified(folder):
    """A model file of the simulated robot A, from a movement in simulated time."""
    reference, recording = folder / "excitation.txt", folder / "excitation.csv"
    config = ROOT / "config"
    for command in (["plan_excitation", "--robot", ROBOT, "--seed", 3, "--duration", 15, "-o", reference],
                    ["simulate", reference, "--robot", ROBOT, "--simulation", config / "simulation/A.yaml", "--hardware", config / "hardware/simulated.yaml",
                     "--deployment", config / "deployment/simulation.yaml", "-o", recording],
                    ["identify", "--robot", ROBOT, "--train", recording, "--output", folder / "identified"]):
        done = run_program(*command)
        assert done.returncode == 0, done.stderr
    return folder / "identified" / "model.yaml"


def surroundings(*order):
    done = run_program("inject_fault", "--shm", SHARED, *order)
    assert done.returncode == 0, done.stderr


class Guiding(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="knee_guiding_")  # pylint: disable=consider-using-with
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        model = identified(self.folder)
        with open(self.folder / "launch.log", "w", encoding="utf-8") as log:
            self.launch = subprocess.Popen(["roslaunch", "knee_robot", "simulation.launch", "name:=A", "cpu:=0", "empty:=true", f"model:={model}", f"shm:={SHARED}",
                                            f"references:={self.folder}", f"recordings:={self.folder}"], stdout=log, stderr=subprocess.STDOUT)
        self.addCleanup(self.end)
        self.robot = RobotClient()

    def end(self):
        self.launch.send_signal(signal.SIGINT)
        self.launch.wait(30)

    def save(self, file):
        return self.robot.service("save_guided", LoadReference)(file, "")

    def test_a_movement_that_is_shown_by_hand_is_played(self):
        robot = self.robot
        robot.bring_to("holding")
        refused = robot.trigger("guide")
        self.assertFalse(refused.success, "the switch is not held")
        self.assertIn("enabling switch", refused.message)
        self.assertFalse(self.save("nothing.txt").success, "nothing was shown")

        surroundings("enabling_switch")
        answer = robot.trigger("guide")
        self.assertTrue(answer.success, answer.message)
        self.assertEqual("guiding", robot.wait_for("guiding", 5).state)
        time.sleep(1.0)
        began = robot.tracking().position_m
        # The hand is a force only, which would go on getting faster: two short pushes. On a busy machine they are longer than that, and the robot
        # holds because it was guided too fast; what was shown until then counts.
        for push in (-HAND_N, 0.0, -HAND_N, 0.0):
            surroundings("push_down", "--size", push)
            time.sleep(0.3)
        shown, state = robot.tracking().position_m, robot.state()
        self.assertIn(state.state, ("guiding", "holding"), state.cause)
        surroundings("clear")  # hand and switch are let go of
        self.assertEqual("holding", robot.wait_for("holding", 5).state)
        time.sleep(1.0)  # the loops take over what the hand held
        stood = robot.tracking().position_m
        time.sleep(1.0)
        self.assertLess(max(abs(a - b) for a, b in zip(stood, robot.tracking().position_m)), 2e-4, "letting go holds")

        answer = self.save("shown.txt")
        self.assertTrue(answer.success, answer.message)
        print(answer.message)
        loaded = robot.load("shown.txt")
        self.assertTrue(loaded.success, loaded.message)
        self.assertGreater(loaded.duration_s, 1.0)
        rows = [list(map(float, line.split())) for line in (self.folder / "shown.txt").read_text().splitlines() if line and not line.startswith("#")]
        travel = [1e3 * (max(column) - min(column)) for column in zip(*rows)]
        print("shown, mm:", [round(t, 1) for t in travel], "began", began, "turned", shown)
        self.assertGreater(max(travel), 5.0, "the platform did not follow the hand")
        for command in ("approach", "start"):
            answer = robot.trigger(command)
            self.assertTrue(answer.success, answer.message)
            self.assertEqual("holding", robot.wait_for("holding", loaded.duration_s + 60).state)
        self.assertLess(max(abs(a - b) for a, b in zip(rows[-1], robot.tracking().position_m)), 1e-3, "it ends where the hand ended")


if __name__ == "__main__":
    rospy.init_node("guiding_test")
    rostest.rosrun("knee_robot", "guiding", Guiding, sys.argv)
