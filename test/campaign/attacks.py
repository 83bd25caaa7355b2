#!/usr/bin/python3
"""Attacks that are no single fault during motion: hand-over between guardian and controller in the wrong order, a guardian that hangs,
clients at once, faults at rest. Real processes on the simulated robot; judged by what it wrote down. scripts/attacks starts this; with
--programs of an older build it prints the figures before."""
import argparse
import os
import pathlib
import shutil
import signal
import sys
import threading
import time

import numpy as np
import rospy
import yaml

from knee_robot.srv import SetRecording

import attacks_at_states
import attacks_by_a_crowd
import attacks_by_exhaustion
import attacks_by_others
import attacks_by_signals
import attacks_in_disorder
import attacks_in_others_names
import attacks_on_disk
import attacks_on_drives
import attacks_on_pauses
import attacks_on_power
import attacks_on_sessions
import attacks_on_the_body
import attacks_on_the_hand_over
import attacks_on_the_nets
import attacks_on_versions
import attacks_on_what_is_carried
import attacks_on_what_is_said
from attack import Attack
from robot_path import Geometry
from session import Master, NoAnswer, Session, is_alive

ROOT = pathlib.Path(__file__).resolve().parents[2]
# ---- hand-over

def refused_restart(a):
    """Guardian and controller die, the controller comes back first and is refused, then the guardian comes back."""
    a.enable()
    a.begin()
    a.kill("guardian", "controller")
    a.session.start_controller()
    status = a.wait_for_end()
    a.session.start_guardian()
    return (f"controller ended with {status}; ", *a.look())


def guardian_back_alone(a):
    """Both die, only the guardian comes back, and the link's memory is gone."""
    a.enable()
    a.begin()
    a.kill("guardian", "controller")
    os.unlink("/dev/shm" + a.session.shm + "_guardian")
    a.session.start_guardian()
    return ("", *a.look())


def controller_back_alone(a):
    """Both die, only the controller comes back: it may not control, and must not leave on what it found."""
    a.enable()
    a.begin()
    a.kill("guardian", "controller")
    a.session.start_controller()
    return ("", *a.look())


def three_controllers_at_once(a):
    """Both die; a guardian and three controllers are started at the same moment."""
    a.enable()
    a.begin()
    a.kill("guardian", "controller")
    others = [a.session.spawn(f"controller_{i}", *a.session.controller_command(f"controller_{i}", a.session.program)) for i in (1, 2)]
    a.session.others.extend(others)
    a.session.start_guardian()
    a.session.start_controller()
    text, good = a.look(4.0)
    alive = sum(is_alive(p) for p in (*others, a.session.controller))
    return f"{alive} of 3 controllers live; ", text, good and alive == 1


def stopped_controller_and_new_one(a):
    """The controller is stopped (not dead), a second one is started, the first is woken up."""
    a.enable()
    a.begin()
    a.stop("controller")
    second = a.session.spawn("second", *a.session.controller_command("second", a.session.program))
    a.session.others.append(second)
    time.sleep(1.0)
    os.kill(a.session.controller.pid, signal.SIGCONT)
    return ("", *a.look())


# ---- a guardian that hangs

def guardian_stopped_then_enable(a):
    """SIGSTOP of the guardian with the drives off; then enable."""
    a.stop("guardian")
    time.sleep(0.5)
    a.begin()
    answer = a.session.trigger("enable")
    text, good = a.look(1.0)
    os.kill(a.session.guardian.pid, signal.SIGCONT)
    return f"enable {'succeeded' if answer.success else 'refused'} ({answer.message[:60]}); ", text, good and not answer.success


def guardian_stopped_while_holding(a):
    a.enable()
    return stop_guardian(a)


def guardian_stopped_while_playing(a):
    a.enable()
    a.play()
    return stop_guardian(a)


def stop_guardian(a):
    a.begin()
    a.stop("guardian")
    text, good = a.look(1.5)
    state = a.state()
    os.kill(a.session.guardian.pid, signal.SIGCONT)
    return f"{state}; ", text, good


def guardian_killed_while_holding(a):
    a.enable()
    a.begin()
    a.kill("guardian")
    text, good = a.look(1.5)
    return f"{a.state()}; ", text, good


# ---- clients

def four_recording_clients(a):
    """Four clients end recordings as fast as they can while a fifth begins them; 8 s, then 6 s for the last answers. Of a bare roscpp server
    about one connection in ten thousand breaks off under such calls: those are counted, and more than one in a thousand is bad."""
    end = time.monotonic() + 8.0
    calls, broken = [0] * 5, [0] * 5
    answered = [False] * 5

    def client(number):
        proxy = rospy.ServiceProxy("/controller/set_recording", SetRecording)
        while time.monotonic() < end:
            begins = number == 0
            try:
                proxy(begins, f"r_{number}_{calls[number]}.csv" if begins else "")
            except rospy.ServiceException as error:
                if "transport error" not in str(error):
                    return  # ended together with the controller
                broken[number] += 1
            calls[number] += 1
        answered[number] = True

    threads = [threading.Thread(target=client, args=(i,), daemon=True) for i in range(5)]
    for one in threads:
        one.start()
    for one in threads:
        one.join(max(0.1, end + 6.0 - time.monotonic()))
    hung = answered.count(False)
    return f"{sum(calls)} calls answered; ", f"{hung} of 5 clients hung, {sum(broken)} connections broke off; {a.state()}", \
        hung == 0 and sum(broken) <= 1e-3 * sum(calls)


# ---- at rest

def at_rest(fault, axis, push_N, wait_s):
    def attack(a):
        a.enable()
        a.begin()
        a.session.inject(fault, axis)
        time.sleep(wait_s)
        if push_N:
            a.session.inject("push_down", size=push_N)
        time.sleep(2.0)
        rows = a.rows()
        drop = 1e3 * (rows["pose"][0][1] - np.min(rows["pose"][:, 1]))
        turn = np.degrees(np.max(np.abs(rows["pose"][:, 2:] - rows["pose"][0][2:])))
        state = a.state()
        a.session.inject("clear")
        return f"{state}; ", f"sinks {drop:.1f} mm, turns {turn:.1f} deg", drop < 5.0 and "frozen" in state
    attack.__doc__ = f"Holding: {fault} {axis}, {wait_s:g} s later a push of {push_N:g} N downwards."
    return attack


ATTACKS = {f.__name__: f for f in (refused_restart, guardian_back_alone, controller_back_alone, three_controllers_at_once,
                                   stopped_controller_and_new_one, guardian_stopped_then_enable, guardian_stopped_while_holding,
                                   guardian_stopped_while_playing, guardian_killed_while_holding, four_recording_clients)}
for number in (1, 2, 3, 4):
    ATTACKS[f"frozen_{number}_at_rest_push_150"] = at_rest("encoder_frozen", number, 150.0, 2.5)
ATTACKS["frozen_4_at_rest_push_100"] = at_rest("encoder_frozen", 4, 100.0, 2.5)
ATTACKS["frozen_4_at_rest_push_150_at_once"] = at_rest("encoder_frozen", 4, 150.0, 0.2)
for module in (attacks_at_states, attacks_by_a_crowd, attacks_by_exhaustion, attacks_by_others, attacks_by_signals, attacks_in_disorder,
               attacks_in_others_names, attacks_on_disk, attacks_on_drives, attacks_on_pauses, attacks_on_power, attacks_on_sessions, attacks_on_the_body,
               attacks_on_the_hand_over, attacks_on_the_nets, attacks_on_versions, attacks_on_what_is_carried, attacks_on_what_is_said):
    ATTACKS.update(module.attacks())


def main():
    p = argparse.ArgumentParser(prog="scripts/attacks", description=__doc__)
    p.add_argument("--only", default="", help="names, comma-separated; NAME* stands for all that begin so")
    p.add_argument("--list", action="store_true")
    p.add_argument("--robot", default="A")
    p.add_argument("--output", default=str(ROOT / "output" / "attacks"))
    p.add_argument("--programs", default=str(ROOT / "build" / "devel" / "lib" / "knee_robot"))
    p.add_argument("--silence-ms", type=float, default=10.0, help="of the guardian")
    options = p.parse_args()
    wanted = [n for n in options.only.split(",") if n]
    names = [n for n in ATTACKS if not wanted or any(n == w or (w.endswith("*") and n.startswith(w[:-1])) for w in wanted)]
    if not names:
        p.error(f"no attack is called {options.only}; --list prints all")
    if options.list:
        for name in names:
            print(f"{name:40} {(ATTACKS[name].__doc__ or '').strip()}")
        return 0
    folder = pathlib.Path(options.output)
    folder.mkdir(parents=True, exist_ok=True)
    master = Master(folder)
    rospy.init_node("attacks", anonymous=True, disable_signals=True, disable_rosout=True)
    config = ROOT / "config"
    robot = config / "robots" / f"{options.robot}.yaml"
    simulation = folder / "simulation.yaml"
    content = yaml.safe_load((config / "simulation" / f"{options.robot}.yaml").read_text(encoding="utf-8"))
    simulation.write_text(yaml.safe_dump(content))
    files = {"robot": robot, "simulation": simulation, "hardware": config / "hardware" / "simulated.yaml",
             "deployment": config / "deployment" / "simulation.yaml"}
    bad = 0
    for name in names:
        session = session_for(name, folder, options, files)
        try:
            session.start()
            before, text, good = ATTACKS[name](Attack(session, Geometry(robot), master))
            bad += not good
            print(f"{name:40} {'good' if good else 'BAD '}  {before}{text}", flush=True)
        except (NoAnswer, RuntimeError, rospy.ServiceException) as error:
            bad += 1
            print(f"{name:40} BAD   no valid run: {error}", flush=True)
        finally:
            attacks_on_disk.let_go(session)
            session.stop()
            if not is_alive(master.process):
                master.start()
    master.stop()
    print(f"{len(names) - bad} of {len(names)} good")
    return 1 if bad else 0


def session_for(name, folder, options, files):
    """A robot of its own for the attack, as it needs it."""
    needs = getattr(ATTACKS[name], "needs", {})
    own = folder / name
    if own.exists():
        shutil.rmtree(own)
    own.mkdir(parents=True)
    if needs.get("on_can"):
        config = ROOT / "config"
        files = {**files, "hardware": config / "hardware" / "can_simulated.yaml", "deployment": config / "deployment" / "can.yaml",
                 "objects": config / "hardware" / "can_objects.yaml"}
    if "hardware" in needs:
        hardware = own / "hardware.yaml"
        content = yaml.safe_load(files["hardware"].read_text(encoding="utf-8"))
        hardware.write_text(yaml.safe_dump({**content, **needs["hardware"]}))
        files = {**files, "hardware": hardware}
    session = Session(own, options.programs, files, options.silence_ms, os.geteuid() == 0, program="controller")
    session.parameters = needs.get("parameters", {})
    if "preload" in needs:
        session.environment.update(needs["preload"](session))
    return session


if __name__ == "__main__":
    status = main()
    sys.stdout.flush()
    os._exit(status)  # threads that wait for a dead controller's answer would hold the interpreter
