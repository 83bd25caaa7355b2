"""What an attack may use (attacks.py)."""
import contextlib
import os
import pathlib
import signal
import subprocess
import threading
import time

import actionlib
import numpy as np
import rospy

import robot_path
from knee_robot.msg import PlayAction
from session import NoAnswer

LOOK_S = 3.0


def how_it_ended(seconds):
    """What end_controller() found, in words."""
    return f"the controller ended after {seconds:.1f} s; " if seconds is not None else "the controller does not end; "


def down_now(a):
    """What the service manager calls; its exit status."""
    return subprocess.run([*map(str, a.session.guardian_command()), "--down-now"], check=False, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                          timeout=20).returncode


def drop_of(text):
    """mm, of what look() found."""
    return float(text.split("drop ")[1].split(" ")[0])


class Attack:
    """What an attack may use. `left_on_ms`: from `begin()` until every drive was off and every brake engaged."""

    def __init__(self, session, geometry, master):
        self.session, self.geometry, self.master = session, geometry, master

    def begin(self):
        self.row = self.session.truth.written()
        self.began = time.monotonic()

    def rows(self):
        return self.session.truth.since(self.row)

    def look(self, seconds=LOOK_S):
        time.sleep(seconds)
        rows = self.rows()
        safe = (rows["drives"] == 0) & (rows["holds"] == 15)
        on = np.nonzero(~safe)[0]
        drop = 1e3 * (rows["pose"][0][1] - np.min(rows["pose"][:, 1]))
        if not safe[-1]:
            return f"drives still on after {1e3 * (rows['monotonic_s'][-1] - self.began):.0f} ms, drop {drop:.1f} mm", False
        last = rows["monotonic_s"][on[-1]] if len(on) else self.began
        return f"held and off after {1e3 * (last - self.began):.0f} ms, drop {drop:.1f} mm", True

    def disable_and_look(self):
        self.begin()
        self.session.trigger("disable")
        return self.look(1.0)

    def moved_mm(self):
        """How far the platform's origin got from where it was at begin()."""
        way = self.rows()["pose"][:, :2]
        return 1e3 * float(np.max(np.linalg.norm(way - way[0], axis=1)))

    def enable(self):
        answer = self.session.trigger("enable")
        if not answer.success:
            raise RuntimeError(answer.message)
        time.sleep(1.0)

    def write_path(self):
        now = self.session.truth.last()
        points = robot_path.movement(self.geometry, now["pose"], now["length_m"])
        path = self.session.references / "attack.txt"
        robot_path.write(path, points)
        return path

    def play(self):
        path = self.write_path()
        for answer in (self.session.load(path.name), self.session.trigger("start")):
            if not answer.success:
                raise RuntimeError(answer.message)
        time.sleep(0.7)

    def kill(self, *names):
        for name in names:
            process = getattr(self.session, name)
            process.send_signal(signal.SIGKILL)
            process.wait()

    def stop(self, name):
        os.kill(getattr(self.session, name).pid, signal.SIGSTOP)

    def wait_for_end(self, seconds=25.0):
        return self.session.controller.wait(seconds)

    def state(self):
        try:
            state = self.session.state()
            return f"{state.state}, {state.fault or 'no fault'}"
        except NoAnswer as error:
            return str(error)

    # ---- services while something hangs

    def call_aside(self, call):
        """`call` in a thread of its own; its answer, or what it raised, is put into the list that is returned."""
        answers = []

        def ask():
            try:
                answers.append(call())
            except Exception as error:  # of any kind: it did not answer
                answers.append(error)
        threading.Thread(target=ask, daemon=True).start()
        return answers

    def slowest_ms(self, call, times=10):
        """The longest that `call` takes; None: it did not answer."""
        slowest = 0.0
        for _ in range(times):
            began = time.monotonic()
            try:
                call()
            except NoAnswer:
                return None
            slowest = max(slowest, 1e3 * (time.monotonic() - began))
        return slowest

    def end_controller(self, seconds):
        """SIGTERM; seconds until it has ended, None: it has not."""
        began = time.monotonic()
        self.session.controller.terminate()
        try:
            self.session.controller.wait(seconds)
        except subprocess.TimeoutExpired:
            return None
        return time.monotonic() - began


def preloaded(name, folder):
    """The library made of NAME.c beside this file."""
    library = folder / f"{name}.so"
    source = pathlib.Path(__file__).resolve().parent / f"{name}.c"
    subprocess.run(["cc", "-shared", "-fPIC", "-O1", "-o", str(library), str(source), "-ldl"], check=True)
    return str(library)


def needs(**what):
    """Of an attack: `parameters` of the controller, `hardware` (changes to the hardware file), `on_can` (drives on a simulated bus instead of
    cards), `preload` (of a session, the environment of its processes: hung_disk.c, stepped_clock.c)."""
    def mark(function):
        function.needs = what
        return function
    return mark


@contextlib.contextmanager
def play_client():
    """A client of the play action that leaves nothing behind: topics that stay open are never told of the next robot's master."""
    client = actionlib.SimpleActionClient("/controller/play", PlayAction)
    try:
        if not client.wait_for_server(rospy.Duration(5.0)):
            raise RuntimeError("no action server")
        yield client
    finally:
        inner = client.action_client
        for topic in (inner.pub_goal, inner.pub_cancel, inner.status_sub, inner.result_sub, inner.feedback_sub):
            topic.unregister()
