#!/usr/bin/python3
"""The ROS master dies while the robot moves, and comes back: the robot comes to rest on its path and is disabled, the controller
lives, and answers the new master's clients. With a master of its own; looked at through robot_status, which needs no ROS."""
import csv
import io
import os
import pathlib
import signal
import socket
import subprocess
import sys
import time
import unittest

import rospy
import rostest
import yaml

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import movements  # noqa: E402

SHARED_MEMORY = "/knee_robot_test_master_restart"


def free_port():
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


def robot_status():
    text = subprocess.run(["rosrun", "knee_robot", "robot_status", "--shm", SHARED_MEMORY, "--duration", "0"],
                          capture_output=True, text=True, check=True, timeout=20).stdout
    return {name: float(value) for name, value in list(csv.DictReader(io.StringIO(text)))[-1].items()}


class MasterRestart(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(os.environ.get("KNEE_TEST_FOLDER", "/tmp/knee_robot_tests")) / "master_restart"
        self.folder.mkdir(parents=True, exist_ok=True)
        self.port = free_port()
        self.environment = dict(os.environ, ROS_MASTER_URI=f"http://127.0.0.1:{self.port}", ROS_IP="127.0.0.1",
                                ROS_HOME=str(self.folder / "ros"))
        self.processes = []
        self.start_master()
        self.robot = self.start("roslaunch", "knee_robot", "simulation.launch", "name:=A", "cpu:=0", f"shm:={SHARED_MEMORY}",
                                f"references:={self.folder}", f"recordings:={self.folder}", "master_timeout_s:=1.0", "empty:=true")

    def tearDown(self):
        for process in reversed(self.processes):
            process.send_signal(signal.SIGINT)
            try:
                process.wait(30)
            except subprocess.TimeoutExpired:
                process.kill()

    def start(self, *command):
        with open(self.folder / f"{command[0]}.log", "a") as log:
            process = subprocess.Popen(command, env=self.environment, stdout=log, stderr=log)
        self.processes.append(process)
        return process

    def start_master(self):
        self.master = self.start("rosmaster", "--core", "-p", str(self.port))

    def call(self, service, request="{}", patience=20):
        """The answer, as soon as there is one."""
        end = time.monotonic() + patience
        while True:
            done = subprocess.run(["rosservice", "call", f"/controller/{service}", request], env=self.environment,
                                  capture_output=True, text=True, timeout=30)
            if done.returncode == 0:
                return yaml.safe_load(done.stdout)
            self.assertLess(time.monotonic(), end, f"{service}: {done.stderr}")
            time.sleep(0.3)

    def wait_for(self, state, seconds=20):
        end = time.monotonic() + seconds
        while self.call("get_state")["state"]["state"] != state:
            self.assertLess(time.monotonic(), end, f"never {state}")

    def test_the_robot_comes_to_rest_and_the_controller_answers_the_new_master(self):
        movements.write(self.folder, "long.txt", movements.rise(20.0, height=0.06))
        self.call("get_state", patience=40)
        self.assertTrue(self.call("load_reference", "{file: long.txt, space: ''}")["success"])
        self.assertTrue(self.call("enable")["success"])
        self.assertTrue(self.call("approach")["success"])
        self.wait_for("holding")
        self.assertTrue(self.call("start")["success"])
        time.sleep(1.0)
        before = robot_status()
        self.assertEqual(15, before["drives_enabled"], before)

        self.master.kill()
        self.master.wait()
        died = time.monotonic()
        while robot_status()["drives_enabled"] != 0:
            self.assertLess(time.monotonic() - died, 15, "nothing was disabled")
            time.sleep(0.1)
        after = time.monotonic() - died
        status = robot_status()
        print(f"after the master's death: disabled within {after:.1f} s; the platform moved on by "
              f"{1e3 * (status['Zm_m'] - before['Zm_m']):.1f} mm along its path")
        self.assertEqual(15, status["brakes_engaged"])
        self.assertGreater(status["Zm_m"], before["Zm_m"] - 1e-3, "it fell")
        time.sleep(1.0)
        self.assertLess(abs(robot_status()["Zm_m"] - status["Zm_m"]), 1e-3)
        self.assertIsNone(self.robot.poll(), "the launch ended")

        self.start_master()
        state = self.call("get_state")["state"]
        self.assertEqual("disabled", state["state"])
        self.assertEqual("", state["fault"])
        self.assertEqual("long.txt", state["reference_file"])
        self.assertTrue(self.call("enable")["success"])
        topics = subprocess.run(["rostopic", "list"], env=self.environment, capture_output=True, text=True).stdout.split()
        for topic in ("/controller/state", "/controller/tracking", "/controller/path", "/controller/play/status",
                      "/joint_states", "/diagnostics"):
            self.assertIn(topic, topics)
        self.assertTrue(self.call("disable")["success"])


if __name__ == "__main__":
    rospy.init_node("master_restart_test")
    rostest.rosrun("knee_robot", "master_restart", MasterRestart)
