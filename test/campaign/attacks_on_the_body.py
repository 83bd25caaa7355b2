"""Attacks by what the robot is made of: encoders that miss counts for a while, brakes that hold late or give way, drives that come on late,
weak or the wrong way round, an emergency stop that bounces; and what the controller says of it."""
import threading
import time

import numpy as np
import rospy

from attacks_on_the_nets import down_now
from knee_robot.msg import Tracking
from session import NoAnswer


def drop_mm(rows):
    return 1e3 * float(rows["pose"][0][1] - np.min(rows["pose"][:, 1]))


def wrong_mm(a):
    """How far the reported lengths are from the true ones."""
    said = np.array(rospy.wait_for_message("/controller/tracking", Tracking, 3.0).position_m)
    return 1e3 * float(np.max(np.abs(said - a.session.truth.last()["length_m"])))


def recover(a):
    """reset and enable, as somebody does who has put a cable back; the answers in words."""
    try:
        reset = a.session.trigger("reset_faults")
        answer = a.session.trigger("enable")
    except NoAnswer as error:
        return str(error), False
    return f"reset {'succeeded' if reset.success else 'refused'}, enable {'succeeded' if answer.success else 'refused'}", answer.success


def interrupted(axis, push_N):
    def attack(a):
        a.enable()
        a.session.inject("encoder_interrupted", axis)
        time.sleep(0.5)
        a.session.inject("push_down", size=push_N)
        time.sleep(2.0)
        state = a.state()
        a.session.inject("clear")
        said, enabled = recover(a)
        time.sleep(1.0)
        wrong = wrong_mm(a)
        homed = all(a.session.state().homed)
        return f"{state}; {said}; ", f"{'' if homed else 'not '}homed, lengths wrong by {wrong:.1f} mm", not enabled and not homed
    which = f"encoder {axis} counts" if axis else "all encoders count"
    attack.__doc__ = f"Holding: {which} nothing during a push of {push_N:g} N, and on from there afterwards; reset, enable."
    return attack


def interrupted_in_motion(axis, size_m, stopped=False):
    def attack(a):
        a.enable()
        a.play()
        a.begin()
        a.session.inject("encoder_interrupted", axis, size_m)
        if stopped:
            a.session.trigger("emergency_stop")
        time.sleep(2.0)
        state = a.state()
        a.session.inject("clear")
        said, enabled = recover(a)
        time.sleep(1.0)
        wrong = wrong_mm(a)
        homed = all(a.session.state().homed)
        return f"{state}; {said}; ", f"{'' if homed else 'not '}homed, lengths wrong by {wrong:.1f} mm", not (enabled and wrong > 0.5)
    how = f"dithers by {1e6 * size_m:g} um" if size_m else "counts nothing"
    also = "; emergency_stop at once" if stopped else ""
    attack.__doc__ = f"Playing: {f'encoder {axis}' if axis else 'every encoder'} {how} for 2 s and counts on from there{also}; reset, enable."
    return attack


def sinks_by(a, fault, wait_s):
    """State and way, mm, after the brakes have given way for so long; then they are as they were."""
    a.begin()
    a.session.inject(fault)
    time.sleep(wait_s)
    state = a.session.state()
    fell = drop_mm(a.rows())
    a.session.inject("clear")
    return state, fell


def gives_way(fault):
    def attack(a):
        a.enable()
        answer = a.session.trigger("disable")
        time.sleep(0.5)
        state, fell = sinks_by(a, fault, 2.0)
        return f"disable {'succeeded' if answer.success else 'failed'}; sinks {fell:.1f} mm; ", f"{state.state}, {state.fault or 'no fault'}", \
            fell > 1.0 and state.state == "faulted" and state.fault == "moved_while_off"
    attack.__doc__ = f"Disabled, the brakes hold; then {fault}: the platform sinks with the drives off."
    return attack


def gives_way_after_a_fault(fault):
    def attack(a):
        a.enable()
        a.session.trigger("emergency_stop")
        time.sleep(1.5)
        state, fell = sinks_by(a, fault, 5.0)
        said, _ = recover(a)
        return f"{state.state}, {state.fault}; sinks {fell:.1f} mm; ", said, fell > 1.0 and state.fault == "moved_while_off"
    attack.__doc__ = f"An emergency stop, faulted, the brakes hold; then {fault}: the platform sinks; reset, enable."
    return attack


def dies_at_disable(axis):
    def attack(a):
        a.enable()
        a.play()
        asked = threading.Thread(target=lambda: a.session.trigger("disable"))
        a.begin()
        asked.start()
        time.sleep(0.05)
        a.session.inject("encoder_frozen", axis)
        asked.join()
        time.sleep(1.0)
        rows = a.rows()
        way = 1e3 * float(np.max(np.abs(rows["length_m"] - rows["length_m"][0])))
        state = a.session.state()
        wrong = wrong_mm(a)
        a.session.inject("clear")
        return f"{state.state}, {state.fault or 'no fault'}; ", f"a leg moves {way:.1f} mm, sinks {drop_mm(rows):.1f} mm; wrong by {wrong:.1f} mm" \
            f"{'' if all(state.homed) else ', not homed'}", drop_mm(rows) < 5.0 and not (all(state.homed) and wrong > 5.0)
    attack.__doc__ = f"Playing, disable; encoder {axis} dies while the robot slows down."
    return attack


def at_disable(fault, axis=0):
    def attack(a):
        a.enable()
        a.session.inject(fault, axis)
        a.begin()
        try:
            answer = a.session.trigger("disable")
            said = f"disable {'succeeded' if answer.success else 'failed'}"
        except NoAnswer as error:
            said = str(error)
        time.sleep(3.0)
        fell = drop_mm(a.rows())
        state = a.state()
        a.session.inject("clear")
        time.sleep(0.5)
        text, off = "", True
        try:
            a.session.trigger("disable")
            time.sleep(1.0)
            text, off = a.look(0.2)
        except NoAnswer:
            pass
        return f"{said}; {state}; sinks {fell:.1f} mm; ", text, fell < 5.0 and off
    attack.__doc__ = f"Holding, {fault}{f' {axis}' if axis else ''}, then disable."
    return attack


def behind_a_late_brake(fault, axis, late, size=0.0):
    def attack(a):
        a.enable()
        a.play()
        a.session.inject("hold_late", late)
        a.begin()
        a.session.inject(fault, axis, size)
        time.sleep(2.0)
        fell = drop_mm(a.rows())
        state = a.state()
        a.session.inject("clear")
        text, off = a.disable_and_look()
        return f"{state}; sinks {fell:.1f} mm; ", text, fell < 15.0 and off
    attack.__doc__ = f"Playing: {fault} {axis}, which stops at once, and brake {late} engages 0.5 s late; then disable."
    return attack


# Behind closed brakes a force moves nothing: a drive without power or of the wrong sign is found when the platform begins to fall, at 1 or 2 g.
FALLS_MM = {"drive_dead": 10.0, "drive_reversed": 30.0}


def at_enable(fault, axis=0):
    largest_mm = FALLS_MM.get(fault, 5.0)

    def attack(a):
        a.session.inject(fault, axis)
        a.begin()
        try:
            answer = a.session.trigger("enable")
            said = f"enable {'succeeded' if answer.success else 'failed'}"
        except NoAnswer as error:
            said = str(error)
        time.sleep(2.0)
        rows = a.rows()
        way = 1e3 * float(np.max(np.abs(rows["length_m"] - rows["length_m"][0])))
        return f"{said}; {a.state()}; ", f"sinks {drop_mm(rows):.1f} mm, a leg moves {way:.1f} mm", drop_mm(rows) < largest_mm
    attack.__doc__ = f"Disabled, {fault}{f' {axis}' if axis else ''}, then enable."
    return attack


def emergency_stop_bounces(a):
    """Playing: the emergency stop is pressed and comes back eight times within some 400 ms."""
    a.enable()
    a.play()
    a.begin()
    for _ in range(8):
        a.session.inject("emergency_stop")
        time.sleep(0.02)
        a.session.inject("clear")
    text, good = a.look(1.5)
    return f"{a.state()}; ", f"{text}, sinks {drop_mm(a.rows()):.1f} mm", good and a.session.state().fault == "emergency_stop"


def counter_card_lost_then_killed(a):
    """Holding: the counter card goes, and with it encoders and brakes; then the controller dies. 3 s later the card is back."""
    a.enable()
    a.session.inject("counter_card_lost")
    time.sleep(0.5)
    a.begin()
    a.kill("controller")
    time.sleep(3.0)
    fell = drop_mm(a.rows())
    a.session.inject("clear")
    text, good = a.look(2.0)
    return f"sinks {fell:.1f} mm in 3 s; ", text, good and fell < 5.0


def counter_card_lost_then_killed_then_down_now(a):
    """As before, and the service manager calls `guardian --down-now`, as it does when its controller has ended."""
    a.enable()
    a.session.inject("counter_card_lost")
    time.sleep(0.5)
    a.begin()
    a.kill("controller")
    status = down_now(a)
    time.sleep(1.0)
    fell = drop_mm(a.rows())
    a.session.inject("clear")
    text, good = a.look(2.0)
    return f"--down-now ends with {status}, sinks {fell:.1f} mm; ", text, good and status != 0 and fell < 0.3


def counter_card_lost_within_emergency_stop(a):
    """Holding: emergency_stop; while the load is handed over the counter card goes: drives stay on that nothing can be told any more."""
    a.enable()
    asked = a.call_aside(lambda: a.session.trigger("emergency_stop"))
    time.sleep(0.1)
    a.session.inject("counter_card_lost")
    time.sleep(1.0)
    state = a.session.state()
    on = int(a.session.truth.last()["drives"])
    a.session.inject("clear")
    return f"{len(asked)} answer; ", f"{state.state}, {state.fault}; drives {'on' if on else 'off'}", state.fault == "output_lost"


def attacks():
    found = {f.__name__: f for f in (emergency_stop_bounces, counter_card_lost_then_killed, counter_card_lost_then_killed_then_down_now,
                                     counter_card_lost_within_emergency_stop)}
    for axis in (0, 1, 4):
        found[f"encoder_{axis or 'all'}_interrupted_at_rest"] = interrupted(axis, 150.0)
    for axis in (0, 1, 4):
        for size_m, name in ((0.0, "interrupted"), (4e-5, "open"), (3e-4, "wild")):
            found[f"encoder_{axis or 'all'}_{name}_in_motion"] = interrupted_in_motion(axis, size_m)
        found[f"encoder_{axis or 'all'}_interrupted_before_emergency_stop"] = interrupted_in_motion(axis, 0.0, stopped=True)
    for fault in ("hold_creeps", "hold_open"):
        found[f"{fault}_when_disabled"] = gives_way(fault)
        found[f"{fault}_when_faulted"] = gives_way_after_a_fault(fault)
    for axis in (1, 4):
        found[f"encoder_{axis}_dies_at_disable"] = dies_at_disable(axis)
    for fault, axis in (("hold_late", 0), ("hold_late", 4), ("hold_creeps", 0), ("hold_creeps", 4)):
        found[f"{fault}_{axis or 'all'}_at_disable"] = at_disable(fault, axis)
    for fault, size in (("encoder_jump", 0.005), ("encoder_frozen", 0.0), ("drive_reversed", 0.0)):
        found[f"{fault}_1_and_hold_late_4"] = behind_a_late_brake(fault, 1, 4, size)
    for fault in ("drive_late", "drive_weak", "drive_dead", "drive_reversed"):
        for axis in (0, 1, 2, 3, 4):
            found[f"{fault}_{axis or 'all'}_at_enable"] = at_enable(fault, axis)
    return found
