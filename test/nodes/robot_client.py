"""What the rostests share: a client of the controller's public interface, and files to play."""
import csv
import math
import pathlib
import subprocess
import threading
import time

import actionlib
import rospy
from actionlib_msgs.msg import GoalStatus
from std_srvs.srv import Trigger

from knee_robot.msg import PlayAction, PlayGoal, Tracking
from knee_robot.srv import CheckReference, GetState, LoadPatient, LoadReference, SetRecording, SetSpeed

ROOT = pathlib.Path(__file__).resolve().parents[2]


def has_result(client, seconds):
    """Waits for the result of a simple action client's goal; False when none came. Its own wait_for_result never ends where the result comes
    before send_goal has returned (it then drops the goal handle's transitions); the handle itself knows."""
    end = time.monotonic() + seconds
    while client.gh.get_comm_state() != actionlib.CommState.DONE:
        if time.monotonic() > end:
            return False
        time.sleep(0.01)
    return True


class RobotClient:
    """`name`: the controller's, with its namespace."""

    def __init__(self, name="controller"):
        self.name = name
        rospy.wait_for_service(f"/{name}/get_state", 60)

    def service(self, name, kind):
        return rospy.ServiceProxy(f"/{self.name}/{name}", kind)

    def trigger(self, service):
        return self.service(service, Trigger)()

    def load(self, file, space=""):
        return self.service("load_reference", LoadReference)(str(file), space)

    def load_patient(self, file):
        return self.service("load_patient", LoadPatient)(str(file))

    def check(self, file, space=""):
        return self.service("check_reference", CheckReference)(str(file), space)

    def record(self, on, file=""):
        return self.service("set_recording", SetRecording)(on, file)

    def set_speed(self, percent):
        return self.service("set_speed", SetSpeed)(percent)

    def state(self):
        return self.service("get_state", GetState)().state

    def tracking(self):
        return rospy.wait_for_message(f"/{self.name}/tracking", Tracking, 10)

    def parameter(self, name):
        return rospy.get_param(f"/{self.name}/{name}")

    def wait_for(self, wanted, seconds):
        """The state that ended the waiting: the wanted one, Faulted, or whatever it is after so many seconds."""
        end = time.monotonic() + seconds
        while True:
            state = self.state()
            if state.state in (wanted, "faulted") or time.monotonic() > end:
                return state
            time.sleep(0.05)

    def bring_to(self, wanted):
        """disabled or holding, from wherever the last test left the robot."""
        state = self.state().state
        if state == "faulted":
            self.trigger("reset_faults")
        if state in ("playing", "paused", "stopping"):
            self.trigger("stop")
            self.wait_for("holding", 20)
        if wanted == "holding" and self.state().state == "disabled":
            answer = self.trigger("enable")
            assert answer.success, answer.message
        if wanted == "disabled" and self.state().state != "disabled":
            answer = self.trigger("disable")
            assert answer.success, answer.message
        self.set_speed(100.0)
        state = self.wait_for(wanted, 20)
        assert state.state == wanted, state


class Player:
    """One client of the action `play`; keeps the feedback of its last goal."""

    def __init__(self, robot):
        self.client = actionlib.SimpleActionClient(f"/{robot.name}/play", PlayAction)
        assert self.client.wait_for_server(rospy.Duration(30)), "no action server"
        self.feedback = []
        self.heard = threading.Event()

    def send(self, file="", **fields):
        self.feedback = []
        self.heard.clear()
        self.client.send_goal(PlayGoal(file=file, **fields), feedback_cb=self.listen)
        return self

    def listen(self, feedback):
        self.feedback.append(feedback)
        self.heard.set()

    def wait_for_phase(self, phase, seconds=20, path_time_s=0.0):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            if any(f.phase == phase and f.path_time_s >= path_time_s for f in self.feedback[-1:]):
                return True
            time.sleep(0.02)
        return False

    def end(self, seconds=60):
        """(state of the goal, result)"""
        assert has_result(self.client, seconds), "the goal has no result"
        return GoalStatus.to_string(self.client.get_state()), self.client.get_result()


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
