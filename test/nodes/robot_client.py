"""What the rostests share: a client of the controller's public interface, and files to play."""
import csv
import math
import os
import pathlib
import subprocess
import tempfile
import time

import rospy
from std_srvs.srv import Trigger

from knee_robot.msg import Tracking
from knee_robot.srv import GetState, LoadReference, SetRecording

ROOT = pathlib.Path(__file__).resolve().parents[2]


class RobotClient:
    def __init__(self, name="controller"):
        self.name = name
        rospy.wait_for_service(f"/{name}/get_state", 60)

    def trigger(self, service):
        return rospy.ServiceProxy(f"/{self.name}/{service}", Trigger)()

    def load(self, file, space=""):
        return rospy.ServiceProxy(f"/{self.name}/load_reference", LoadReference)(str(file), space)

    def record(self, on, file=""):
        return rospy.ServiceProxy(f"/{self.name}/set_recording", SetRecording)(on, file)

    def state(self):
        return rospy.ServiceProxy(f"/{self.name}/get_state", GetState)().state

    def tracking(self):
        return rospy.wait_for_message(f"/{self.name}/tracking", Tracking, 10)

    def wait_for(self, wanted, seconds):
        """The state that ended the waiting: the wanted one, Faulted, or whatever it is after so many seconds."""
        end = time.monotonic() + seconds
        while True:
            state = self.state()
            if state.state in (wanted, "faulted") or time.monotonic() > end:
                return state
            time.sleep(0.2)


def parameter(name):
    return rospy.get_param(f"/controller/{name}")


def run_program(program, *arguments):
    return subprocess.run(["rosrun", "knee_robot", program, *map(str, arguments)], capture_output=True, text=True, timeout=300)


def read_recording(path):
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    return {name: [float(row[name]) for row in rows] for name in rows[0]}


def root_mean_square(values):
    return math.sqrt(sum(v * v for v in values) / len(values))
