"""Attacks by processes in the wrong order and number: guardians that die where nobody starts them again, controllers and guardians that were not told
of each other, masters that stand still."""
import contextlib
import mmap
import os
import pathlib
import shutil
import signal
import struct
import time

import numpy as np
import rospy

from attack import drop_of
from attacks_on_the_hand_over import small
from knee_robot.srv import LoadPatient
from session import NoAnswer, is_alive

PATIENT = "patient: \"17\"\npose: {X_m: [-0.1, 0.1], Z_m: [0.3, 1.0], theta_deg: [-20, 20], psi_deg: [-20, 20]}\n"

_CONTROLLER_PID, _LOAD_V = 8, 40  # bytes into hardware::GuardianLink


@contextlib.contextmanager
def other_parameters(session, **parameters):
    """Of the controllers that are started meanwhile."""
    before, session.parameters = session.parameters, {**session.parameters, **parameters}
    try:
        yield
    finally:
        session.parameters = before


def end(process):
    process.terminate()
    process.wait(20.0)


def comes_up(a, seconds=15.0):
    """The controller answers; False: it has ended."""
    until = time.monotonic() + seconds
    while is_alive(a.session.controller) and time.monotonic() < until:
        try:
            a.session.state()
            return True
        except NoAnswer:
            time.sleep(0.1)
    return False


def kill_controller_until_the_force_is_down(a):
    """Holding, brakes 0.5 s late, the controller killed: until a tenth of the force that its guardian took over is left."""
    a.enable()
    before = float(np.max(np.abs(a.session.truth.last()["volts"])))
    a.session.inject("hold_late")
    a.begin()
    a.kill("controller")
    until = time.monotonic() + 1.0
    while time.monotonic() < until and float(np.max(np.abs(a.session.truth.last()["volts"]))) > 0.1 * before:
        pass


def guardian_dies_while_the_force_goes_down(a):
    """Holding, brakes 0.5 s late: the controller is killed, and its guardian while the force goes down; nobody starts it again."""
    kill_controller_until_the_force_is_down(a)
    a.kill("guardian")
    return ("", *small(*a.look()))


def both_die_and_nobody_comes_back(a):
    """Holding: guardian and controller are killed together, and nobody starts them again."""
    a.enable()
    a.begin()
    a.kill("guardian", "controller")
    return ("", *small(*a.look()))


def both_die_in_motion_and_nobody_comes_back(a):
    """Playing: the same."""
    a.enable()
    a.play()
    a.begin()
    a.kill("guardian", "controller")
    return ("", *small(*a.look()))


def guardian_dies_and_its_controller_later(a):
    """Holding: the guardian is killed, and the controller 20 ms later, before it has missed it; nobody starts them again."""
    a.enable()
    a.begin()
    a.kill("guardian")
    time.sleep(0.02)
    a.kill("controller")
    return ("", *small(*a.look()))


def guardian_stands_still_and_its_controller_dies(a):
    """Holding: SIGSTOP of the guardian, and the controller is killed 20 ms later, before it has missed it."""
    a.enable()
    a.begin()
    a.stop("guardian")
    time.sleep(0.02)
    a.kill("controller")
    found = small(*a.look())
    os.kill(a.session.guardian.pid, signal.SIGCONT)
    return ("", *found)


def guardian_stands_still_while_the_force_goes_down(a):
    """Holding, brakes 0.5 s late: the controller is killed, and its guardian stopped while the force goes down."""
    kill_controller_until_the_force_is_down(a)
    a.stop("guardian")
    text, good = a.look()
    os.kill(a.session.guardian.pid, signal.SIGCONT)
    return "", text, good


def heir_is_killed(a):
    """Holding: the guardian's heir is killed; then the controller."""
    a.enable()
    parent = a.session.guardian.pid
    children = pathlib.Path(f"/proc/{parent}/task/{parent}/children").read_text().split()
    if len(children) != 1:
        return f"{len(children)} heirs; ", "", False
    os.kill(int(children[0]), signal.SIGKILL)
    time.sleep(0.3)
    said = "HEIR IS GONE" in a.session.log_text("guardian")
    a.begin()
    a.kill("controller")
    text, good = a.look()
    return f"the guardian {'says so' if said else 'says nothing'}; ", text, good and said


def controller_that_is_not_told_of_its_guardian(a):
    """The controller is started again without its parameter ~guardian, beside a guardian that waits; enabled, and killed."""
    end(a.session.controller)
    with other_parameters(a.session, guardian=""):
        a.session.start_controller()
    if not comes_up(a):
        a.begin()
        return ("the controller refuses; ", *a.look(0.5))
    a.enable()
    a.begin()
    a.kill("controller")
    return ("enabled, then killed; ", *a.look())


def guardian_beside_a_controller_that_was_not_told(a):
    """A controller without a guardian holds; then a guardian is started."""
    end(a.session.controller)
    end(a.session.guardian)
    with other_parameters(a.session, guardian=""):
        a.session.start_controller()
    if not comes_up(a):
        return "the controller refuses; ", "", False
    a.enable()
    a.begin()
    a.session.start_guardian()
    time.sleep(5.0)
    rows = a.rows()
    drop = 1e3 * (rows["pose"][0][1] - np.min(rows["pose"][:, 1]))
    off = int(np.sum(rows["drives"] != 15)) + int(np.sum(rows["holds"] != 0))
    lives = "the guardian lives" if is_alive(a.session.guardian) else "the guardian has ended"
    return f"{lives}; {a.state()}; ", f"a drive off or a brake engaged in {off} ms, drop {drop:.1f} mm", off == 0 and not is_alive(a.session.guardian)


def second_simulated_robot(a):
    """Holding: a second simulated robot is started on the same shared memory, as launching twice does."""
    a.enable()
    a.begin()
    s = a.session
    second = s.spawn("second_robot", s.programs / "simulated_robot", "--robot", s.files["robot"], "--simulation", s.files["simulation"], "--shm", s.shm)
    s.others.append(second)
    time.sleep(2.0)
    lives = is_alive(second)
    return f"the second {'lives' if lives else 'has ended'}; ", a.state(), not lives and a.session.state().state == "holding"


def master_stands_still_while_playing(a):
    """Playing: SIGSTOP of the ROS master."""
    a.enable()
    a.session.keep_connections()
    a.play()
    a.begin()
    os.kill(a.master.process.pid, signal.SIGSTOP)
    try:
        text, good = a.look(5.0)
        state = a.state()
    finally:
        os.kill(a.master.process.pid, signal.SIGCONT)
    return f"{state}; ", text, good


def killed_while_a_patient_is_loaded(a):
    """load_patient, and the controller is killed 0 to 0.14 s later, eight times; who is on the robot when it is back?"""
    s = a.session
    (s.references / "17.yaml").write_text(PATIENT)
    said = []
    for i in range(8):
        asked = a.call_aside(lambda: s.call("load_patient", LoadPatient, "17.yaml"))
        time.sleep(0.02 * i)
        a.kill("controller")
        time.sleep(0.3)
        told = bool(asked and getattr(asked[0], "success", False))
        s.start_controller()
        comes_up(a)
        state = s.state()
        said.append((told, state.occupancy))
        if state.occupancy == "patient":
            s.trigger("clear_patient")
    wrong = [one for one in said if one[0] and one[1] != "patient"]
    return f"{sum(o == 'patient' for _, o in said)} of 8 remembered; ", f"{len(wrong)} of those that were told forgotten", not wrong


def state_folder_becomes_read_only(a):
    """A file takes the place of the state folder; load_patient: who is on the robot cannot be remembered."""
    s = a.session
    (s.references / "17.yaml").write_text(PATIENT)
    folder = s.recordings / "black_box"
    if folder.exists():
        shutil.rmtree(folder)
    folder.write_text("")
    time.sleep(2.5)
    answer = s.call("load_patient", LoadPatient, "17.yaml")
    state = s.state()
    return f"load_patient {'succeeded' if answer.success else 'refused'} ({answer.message[:90]}); ", f"occupancy {state.occupancy}", not answer.success


def recordings_vanish_while_recording(a):
    """Playing and recording; the folder of the recordings is removed; then stop, disable."""
    s = a.session
    a.enable()
    s.record(True, "run.csv")
    a.play()
    shutil.rmtree(s.recordings)
    time.sleep(1.0)
    state = a.state()
    ended = s.record(False)
    text, good = a.disable_and_look()
    return f"{state}; recording ended: {ended.success} ({ended.message[:90]}); ", text, good


def emergency_stop_let_go_within_the_hand_over(a):
    """Holding: the emergency stop is pressed for 10 to 80 ms, so that the power comes back while the brakes engage."""
    worst, states = 0.0, []
    for ms in (2, 10, 20, 40, 80):
        a.enable()
        a.begin()
        a.session.inject("emergency_stop")
        time.sleep(1e-3 * ms)
        a.session.inject("clear")
        text, good = a.look(1.0)
        worst = max(worst, drop_of(text))
        states.append(a.session.state().fault + ("" if good else " (drives on)"))
        a.session.trigger("reset_faults")
    return f"{', '.join(states)}; ", f"drop {worst:.1f} mm at most", worst < 5.0 and all(one == "emergency_stop" for one in states)


def link_of_another_user(a):
    """The link lies in /dev/shm before guardian and controller are started, and another user's process may write it: it lets the guardian take
    the controller for dead, and the drives give 9.9 V."""
    s = a.session
    path = "/dev/shm" + s.shm + "_guardian"
    a.end_controller(10.0)
    s.guardian.terminate()
    s.guardian.wait(10.0)
    with contextlib.suppress(FileNotFoundError):
        os.unlink(path)
    descriptor = os.open(path, os.O_RDWR | os.O_CREAT, 0o600)
    a.begin()
    try:
        os.fchmod(descriptor, 0o666)
        s.start_guardian()
        s.start_controller()
        if not _answers(s):
            time.sleep(1.0)
            return f"the guardian {'lives' if is_alive(s.guardian) else 'refuses'}; ", *a.look(0.5)
        a.enable()
        a.begin()
        link = mmap.mmap(descriptor, 0)
        for _ in range(2000):
            struct.pack_into("4d", link, _LOAD_V, 9.9, -9.9, 9.9, -9.9)
            struct.pack_into("i", link, _CONTROLLER_PID, 0x7FFFFFFF)
        time.sleep(3.0)
        lengths = a.rows()["length_m"]
        return f"{a.state()}; ", f"legs went by {1e3 * float(np.max(np.abs(lengths - lengths[0]))):.1f} mm", False
    finally:
        os.close(descriptor)
        with contextlib.suppress(FileNotFoundError):
            os.unlink(path)


def _answers(session, seconds=10.0):
    end = time.monotonic() + seconds
    while is_alive(session.controller) and time.monotonic() < end:
        try:
            return bool(session.state())
        except NoAnswer:
            time.sleep(0.2)
    return False


def attacks():
    return {f.__name__: f for f in (guardian_dies_while_the_force_goes_down, both_die_and_nobody_comes_back, both_die_in_motion_and_nobody_comes_back,
                                    guardian_dies_and_its_controller_later, guardian_stands_still_and_its_controller_dies, heir_is_killed,
                                    guardian_stands_still_while_the_force_goes_down,
                                    controller_that_is_not_told_of_its_guardian,
                                    guardian_beside_a_controller_that_was_not_told, second_simulated_robot, master_stands_still_while_playing,
                                    killed_while_a_patient_is_loaded, state_folder_becomes_read_only, recordings_vanish_while_recording,
                                    emergency_stop_let_go_within_the_hand_over, link_of_another_user)}
