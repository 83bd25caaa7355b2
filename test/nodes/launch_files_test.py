#!/usr/bin/python3
"""monitor.launch beside a robot that plays a movement, and industrial_pc.launch on a machine without cards, each started with roslaunch
as a user does (identification.launch: identification_test.py)."""
import json
import os
import pathlib
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest

import rostest

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import movements  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[2]


def free_port():
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


class Session:
    """A roslaunch with a master of its own; `environment` is for programs beside it."""

    def __init__(self, folder, port=None):
        self.folder, self.port = folder, port or free_port()
        self.environment = dict(os.environ, ROS_MASTER_URI=f"http://127.0.0.1:{self.port}", ROS_IP="127.0.0.1")
        self.running = []

    def launch(self, file, *arguments):
        log = open(self.folder / f"{file}.log", "w", encoding="utf-8")  # pylint: disable=consider-using-with
        self.running.append(subprocess.Popen(["roslaunch", "--port", str(self.port), "knee_robot", file, *map(str, arguments)],
                                             stdout=log, stderr=subprocess.STDOUT, env=self.environment))
        return self.running[-1]

    def run(self, *command, seconds=60):
        return subprocess.run(list(map(str, command)), env=self.environment, capture_output=True, text=True, timeout=seconds,
                              check=False)

    def output(self, file):
        return (self.folder / f"{file}.log").read_text(encoding="utf-8", errors="replace")

    def end(self):
        for process in reversed(self.running):
            if process.poll() is None:
                process.send_signal(signal.SIGINT)
                process.wait(30)


class LaunchFiles(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory(prefix="knee_launch_")  # pylint: disable=consider-using-with
        self.folder = pathlib.Path(self.temporary.name)
        for name in ("references", "recordings"):
            (self.folder / name).mkdir()
        self.session = Session(self.folder)

    def tearDown(self):
        self.session.end()
        self.temporary.cleanup()

    def folders(self):
        return [f"references:={self.folder}/references", f"recordings:={self.folder}/recordings"]

    def wait_for(self, condition, seconds, what):
        end = time.monotonic() + seconds
        while not condition():
            self.assertLess(time.monotonic(), end, what)
            time.sleep(0.5)

    def test_a_movement_is_played_while_the_monitor_shows_it_and_the_end_is_no_fault(self):
        self.session.launch("simulation.launch", "name:=A", "cpu:=0", "empty:=true", f"shm:=/knee_robot_launch_{os.getpid()}", *self.folders())
        movements.write(self.folder / "references", "rise.txt", movements.rise(4.0))
        self.wait_for(lambda: self.session.run("rosservice", "call", "/controller/get_state").returncode == 0, 60, "no robot")
        self.session.launch("monitor.launch", "name:=A", "rviz:=false", "terminal:=true")
        played = self.session.run("rosrun", "knee_robot", "play_movement", "rise.txt", "--enable", "--approach", "--approach-speed", 0.03,
                                  "--record", "rise.csv", seconds=120)
        self.assertEqual(0, played.returncode, played.stdout + played.stderr)
        self.assertTrue((self.folder / "recordings" / "rise.csv").exists())
        self.wait_for(lambda: "holding" in self.session.output("monitor.launch"), 20, self.session.output("monitor.launch"))
        topics = self.session.run("rostopic", "list").stdout
        self.assertIn("marker", topics)

        refused = self.session.run("rosrun", "knee_robot", "play_movement", "none.txt")
        self.assertEqual(3, refused.returncode, refused.stdout + refused.stderr)
        self.assertIn("none.txt", refused.stderr)

        movements.write(self.folder / "references", "slow_rise.txt", movements.rise(20.0))  # longer than `rosnode` may take
        for number in (signal.SIGTERM, signal.SIGHUP, None):
            player = subprocess.Popen(["rosrun", "knee_robot", "play_movement", "slow_rise.txt", "--approach"], env=self.session.environment,
                                      stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
            self.wait_for(lambda: "state: \"playing\"" in self.session.run("rosservice", "call", "/controller/get_state").stdout, 60, "never plays")
            if number is None:
                name = next(name for name in self.session.run("rosnode", "list").stdout.split() if name.startswith("/play_movement"))
                self.session.run("rosnode", "kill", name)
            else:
                player.send_signal(number)
            self.assertEqual(3, player.wait(30), player.stdout.read())
            state = self.session.run("rosservice", "call", "/controller/get_state").stdout
            self.assertIn("state: \"holding\"", state, f"{number}: who plays has gone, and the platform goes on")

        disabled = self.session.run("rosservice", "call", "/controller/disable")
        self.assertIn("disabled", disabled.stdout + disabled.stderr)
        self.session.end()
        events = [json.loads(line) for line in (self.folder / "recordings" / "events" / "controller.jsonl").read_text().splitlines()]
        self.assertEqual("end", events[-1]["what"], events[-3:])
        self.assertEqual([], [event for event in events if event["kind"] == "fault"], "ended in order: no fault")

    @unittest.skipIf(pathlib.Path("/sys/bus/pci/devices").exists() and any(
        (device / "device").exists() and (device / "device").read_text().strip() in ("0x1720", "0x1784")
        for device in pathlib.Path("/sys/bus/pci/devices").iterdir()), "this machine has the cards")
    def test_the_industrial_pc_without_cards_refuses_in_one_sentence_and_ends(self):
        process = self.session.launch("industrial_pc.launch", f"robot:={ROOT}/config/robots/final.yaml", f"urdf:={ROOT}/urdf/final.urdf", "bag:=false", f"guardian_link:=/knee_robot_launch_guardian_{os.getpid()}",
                                      *self.folders())
        process.wait(60)
        said = self.session.output("industrial_pc.launch")
        self.assertRegex(said, r"no PCI card 13fe:17(20|84)", said[-3000:])
        self.assertNotIn("Traceback", said)

    def test_the_industrial_pc_does_not_start_without_its_own_robot_file(self):
        process = self.session.launch("industrial_pc.launch", *self.folders())
        process.wait(60)
        self.assertRegex(self.session.output("industrial_pc.launch"), r"requires? the '(robot|urdf)' arg")

    def test_the_industrial_pc_without_its_can_interface_refuses_in_one_sentence_and_ends(self):
        process = self.session.launch("can_industrial_pc.launch", f"robot:={ROOT}/config/robots/final.yaml", f"urdf:={ROOT}/urdf/final.urdf",
                                      f"hardware:={ROOT}/config/hardware/can_simulated.yaml", "can:=knee_none0", "bag:=false",
                                      f"guardian_link:=/knee_robot_launch_guardian_{os.getpid()}", *self.folders())
        process.wait(60)
        said = self.session.output("can_industrial_pc.launch")
        self.assertRegex(said, r"controller: .*(knee_none0|CAN)", said[-3000:])
        self.assertNotIn("Traceback", said)


if __name__ == "__main__":
    rostest.rosrun("knee_robot", "launch_files", LaunchFiles)
