#!/usr/bin/python3
"""Launch files started with roslaunch as a user does, each with a master of its own: industrial_pc.launch on a machine without cards."""
import os
import pathlib
import signal
import socket
import subprocess
import tempfile
import unittest

import rostest


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

    @unittest.skipIf(pathlib.Path("/sys/bus/pci/devices").exists() and any(
        (device / "device").exists() and (device / "device").read_text().strip() in ("0x1720", "0x1784")
        for device in pathlib.Path("/sys/bus/pci/devices").iterdir()), "this machine has the cards")
    def test_the_industrial_pc_without_cards_refuses_in_one_sentence_and_ends(self):
        process = self.session.launch("industrial_pc.launch", "bag:=false", f"guardian_link:=/knee_robot_launch_guardian_{os.getpid()}",
                                      *self.folders())
        process.wait(150)
        said = self.session.output("industrial_pc.launch")
        self.assertRegex(said, r"no PCI card 13fe:17(20|84)", said[-3000:])
        self.assertNotIn("Traceback", said)


if __name__ == "__main__":
    rostest.rosrun("knee_robot", "launch_files", LaunchFiles)
