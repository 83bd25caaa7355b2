"""Attacks on what the robot says of itself: answers and topics that outlive what they were about."""
import shutil
import time

import rospy
from nav_msgs.msg import Path

from attacks_by_others import load_patient
from knee_robot.srv import CheckReference
from session import NoAnswer


class Shown:
    """The latched path of the loaded reference, as rviz shows it."""

    def __init__(self):
        self.poses = None
        self.subscriber = rospy.Subscriber("/controller/path", Path, self.take)
        time.sleep(0.5)

    def take(self, message):
        self.poses = len(message.poses)


def path_of_a_forgotten_reference(a):
    """A reference is loaded, then its patient leaves: the reference is forgotten, and its path has to go from the displays."""
    path = a.write_path()
    a.session.load(path.name)
    shown = Shown()
    before = shown.poses
    a.session.trigger("clear_patient")
    time.sleep(1.0)
    loaded, after = a.session.state().reference_file, shown.poses
    shown.subscriber.unregister()
    return f"{before} points shown; after clear_patient ", f"'{loaded}' is loaded, {after} points are shown", bool(before) and not loaded and after == 0


def check_reference_for_a_patient(a):
    """A patient with narrow limits is loaded; check_reference of a file that leaves them, then load_reference of it."""
    path = a.write_path()
    z = a.session.truth.last()["pose"][1]
    load_patient(a, f'patient: "17"\npose: {{X_m: [-0.3, 0.3], Z_m: [{z - 0.002:.4f}, {z + 0.002:.4f}], theta_deg: [-40, 40], psi_deg: [-40, 40]}}\n')
    checked = a.session.call("check_reference", CheckReference, path.name, "")
    loaded = a.session.load(path.name)
    said = f"check_reference: {'may be played' if checked.success else 'refused'}, load_reference: {'loaded' if loaded.success else 'refused'}"
    return "", said, checked.success == loaded.success and "patient" in checked.message


def state_folder_removed_with_a_patient(a):
    """A patient is loaded, somebody clears the recordings with the state in them; 4 s later the controller is killed and started (empty)."""
    load_patient(a)
    shutil.rmtree(a.session.recordings)
    time.sleep(4.0)
    a.kill("controller")
    a.session.start_controller()
    end = time.monotonic() + 15.0
    while True:
        try:
            state = a.session.state()
            break
        except NoAnswer:
            if time.monotonic() > end:
                raise
            time.sleep(0.1)
    return "", f"occupancy {state.occupancy}, patient '{state.patient}'", state.patient == "17"


def attacks():
    return {f.__name__: f for f in (path_of_a_forgotten_reference, check_reference_for_a_patient, state_folder_removed_with_a_patient)}
