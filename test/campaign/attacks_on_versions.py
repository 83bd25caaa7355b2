"""Attacks with programs of two versions: what one has written into the link, the other cannot read."""
import os
import pathlib
import struct
import time
import urllib.request

import rospy

from attack import down_now, drop_of
from session import free_port, is_alive

ROOT = pathlib.Path(__file__).resolve().parents[2]
OTHER_MESSAGES = """import importlib.abc, sys
class Finder(importlib.abc.MetaPathFinder):
    def find_spec(self, name, path, target=None):
        if name == "knee_robot_operator":
            from knee_robot import msg, srv
            msg.ControllerState._md5sum = srv.GetState._md5sum = srv.GetState._request_class._md5sum = "0" * 32
        return None
sys.meta_path.insert(0, Finder())
"""


def link_of(a):
    return "/dev/shm" + a.session.shm + "_guardian"


def becomes_of_another_version(a):
    """The running processes do not look again at what the link is; whoever is started now does."""
    with open(link_of(a), "r+b") as link:
        link.write(struct.pack("<Q", 0x6b6e65655f677230))


def goes_on(a, status):
    time.sleep(1.0)
    moved, state, rows = a.moved_mm(), a.state(), a.rows()
    off = 1e3 * float((rows["drives"] != 15).mean()) * (rows["monotonic_s"][-1] - rows["monotonic_s"][0])
    text, good = a.disable_and_look()
    return f"--down-now ends with {status}; moved {moved:.1f} mm, drives off for {off:.0f} ms ({state}); ", text, \
        good and status == 1 and off < 5.0 and state == "holding, no fault"


def down_now_of_another_version_while_holding(a):
    """Holding: guardian --down-now of a version that was built meanwhile, beside guardian and controller that live."""
    a.enable()
    becomes_of_another_version(a)
    a.begin()
    return goes_on(a, down_now(a))


def down_now_without_the_link_beside_both(a):
    """Holding: the link's name was removed from /dev/shm; guardian --down-now beside guardian and controller that live."""
    a.enable()
    os.unlink(link_of(a))
    a.begin()
    return goes_on(a, down_now(a))


def down_now_of_another_version_while_the_guardian_carries(a):
    """Brakes that engage 0.5 s late: the controller dies, its service calls the new --down-now while the old guardian carries."""
    a.enable()
    a.session.inject("hold_late")
    becomes_of_another_version(a)
    a.begin()
    a.kill("controller")
    time.sleep(0.05)
    status = down_now(a)
    text, good = a.look()
    return f"--down-now ends with {status}; ", text, good and drop_of(text) < 10.0


def guardian_of_another_version_in_the_place_of_one_that_died(a):
    """Playing: the guardian dies, its service calls the new --down-now and starts the new guardian."""
    a.enable()
    a.play()
    becomes_of_another_version(a)
    a.begin()
    a.kill("guardian")
    status = down_now(a)
    a.session.start_guardian()
    time.sleep(0.5)
    text, good = a.look()
    said = "another version" in a.session.log_text("guardian")
    return f"--down-now ends with {status}; the new guardian {'lives' if is_alive(a.session.guardian) else 'has ended'}; {a.state()}; ", \
        text, good and drop_of(text) < 10.0 and status == 1 and said


def stop_on_a_page_of_another_version(a):
    """The operator's page has another version's messages and hears no state; STOP while the robot is being enabled."""
    s = a.session
    for name, value in (("/run_id", "attacks"), ("/controller/recordings", s.recordings), ("/controller/references", s.references),
                        ("/controller/robot", s.files["robot"])):
        rospy.set_param(name, str(value))
    (s.folder / "sitecustomize.py").write_text(OTHER_MESSAGES)
    port = free_port()
    path = f"{s.folder}:{os.environ.get('PYTHONPATH', '')}"
    s.others.append(s.spawn("page", "/usr/bin/python3", ROOT / "src" / "nodes" / "operator_page", f"_port:={port}",
                            environment=dict(s.environment, PYTHONPATH=path)))
    time.sleep(5.0)
    a.begin()
    a.call_aside(lambda: s.trigger("enable"))
    s.wait_for(("enabling",), 3.0)
    request = urllib.request.Request(f"http://127.0.0.1:{port}/api/stop", data=b"{}", method="POST",
                                     headers={"Content-Type": "application/json", "Origin": f"http://127.0.0.1:{port}"})
    with urllib.request.urlopen(request, timeout=5.0) as answer:
        said = answer.read(200).decode()
    time.sleep(1.0)
    text, good = a.look(0.5)
    return f"STOP: {said}; {a.state()}; ", text, good and '"success": true' in said


def attacks():
    return {f.__name__: f for f in (down_now_of_another_version_while_holding, down_now_without_the_link_beside_both,
                                    down_now_of_another_version_while_the_guardian_carries,
                                    guardian_of_another_version_in_the_place_of_one_that_died, stop_on_a_page_of_another_version)}
