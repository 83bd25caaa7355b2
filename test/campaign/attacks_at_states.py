"""Attacks at every state of the robot: the controller or the guardian is stopped and goes on, or dies, while the robot is disabled, is being
enabled, holds, plays, is paused, stops, is brought to rest, looks for its home."""
import os
import signal
import time

from attack import needs
from session import NoAnswer

# Every axis against an end 30 mm below its home, which the simulated robot does not have: each attack comes before it would be found.
HOMING = {"homing": {"method": "hard_stop", "order": [4, 1, 2, 3],
                     "axes": [{"length_m": length_m, "direction": "shorten", "speed_m_per_s": 0.01, "force_N": 80.0, "back_off_m": 0.01,
                               "travel_m": 0.35} for length_m in (0.578, 0.622, 0.633, 0.588)]}}


def bring_to(a, state):
    """Begins what leads to `state`; comes back while the robot is in it."""
    if state == "disabled":
        return
    if state in ("enabling", "homing"):
        a.call_aside(lambda: a.session.trigger("enable" if state == "enabling" else "home"))
        a.session.wait_for((state,), 3.0)
        time.sleep(0.15 if state == "enabling" else 1.5)
        return
    a.enable()
    if state in ("playing", "paused", "stopping"):
        a.play()
    if state == "paused":
        a.session.trigger("pause")
        a.session.wait_for(("paused",), 3.0)
    if state in ("stopping", "safe_stopping"):
        a.call_aside(lambda: a.session.trigger("stop" if state == "stopping" else "disable"))
        time.sleep(0.06)


def stopped_while(process, state):
    def attack(a):
        bring_to(a, state)
        a.begin()
        a.stop(process)
        time.sleep(0.6)
        os.kill(getattr(a.session, process).pid, signal.SIGCONT)
        text, good = a.look(1.5)
        refused = ""
        if state != "disabled":
            try:
                allowed = a.session.trigger("enable").success and a.session.state().state != "disabled"
                faulted = a.session.state().state in ("faulted", "disabled")
                refused = "" if faulted or not allowed else "enabled again without a reset; "
            except NoAnswer as error:
                refused = f"{error}; "
        return f"{a.state()}; {refused}", text, good and not refused
    attack.__doc__ = f"SIGSTOP of the {process} while {state}, SIGCONT 0.6 s later."
    return needs(hardware=HOMING)(attack) if state == "homing" else attack


def restarted_while(processes, state):
    def attack(a):
        bring_to(a, state)
        a.begin()
        a.kill(*processes)
        for name in processes:
            getattr(a.session, f"start_{name}")()
        text, good = a.look(4.0)
        said = a.state()
        if not good and processes == ("guardian",):  # back before it was missed: it has to be as good as the first
            a.begin()
            a.kill("controller")
            text, good = a.look(1.0)
            text = "went on, then the controller was killed: " + text
        return f"{said}; ", text, good
    attack.__doc__ = f"SIGKILL of {' and '.join(processes)} while {state}, started again at once in that order."
    return needs(hardware=HOMING)(attack) if state == "homing" else attack


@needs(hardware=HOMING)
def encoder_frozen_while_homing(a):
    """The encoder of the axis that looks for its stop dies: where it stands is no stop."""
    bring_to(a, "homing")
    homed = list(a.session.state().homed)
    a.begin()
    a.session.inject("encoder_frozen", 4)
    time.sleep(4.0)
    state = a.session.state()
    a.session.trigger("disable")
    text, good = a.look(1.0)
    return (f"{state.state}, {state.fault or 'no fault'}; homed before {homed.count(True)}, after {list(state.homed).count(True)}; ", text,
            good and state.state == "faulted")


def attacks():
    states = ("disabled", "enabling", "holding", "playing", "paused", "stopping", "safe_stopping", "homing")
    found = {}
    for state in states:
        found[f"controller_stopped_while_{state}"] = stopped_while("controller", state)
        if state not in ("disabled", "holding", "playing"):
            found[f"guardian_stopped_while_{state}"] = stopped_while("guardian", state)
    for state in ("enabling", "playing", "safe_stopping", "homing"):
        found[f"both_restarted_while_{state}"] = restarted_while(("controller", "guardian"), state)
    found["controller_restarted_while_playing"] = restarted_while(("controller",), "playing")
    found["guardian_restarted_while_playing"] = restarted_while(("guardian",), "playing")
    found["encoder_frozen_while_homing"] = encoder_frozen_while_homing
    return found
