"""Attacks on power: the computer stands still (suspended, frozen) in the middle of each state and wakes up again; the drives lose their supply
and it comes back. The cards and the simulated robot go on meanwhile, with what was written last."""
import os
import pathlib
import signal
import time

from attack import needs
from attacks_at_states import HOMING, bring_to

STATES = ("enabling", "holding", "playing", "paused", "stopping", "safe_stopping", "homing")


def everybody(a):
    """Guardian, its heir and controller."""
    guardian = a.session.guardian.pid
    heirs = pathlib.Path(f"/proc/{guardian}/task/{guardian}/children").read_text().split()
    return [guardian, *map(int, heirs), a.session.controller.pid]


def frozen_while(state, seconds, first):
    def attack(a):
        bring_to(a, state)
        a.begin()
        all_of_them = everybody(a)
        for one in all_of_them:
            os.kill(one, signal.SIGSTOP)
        time.sleep(seconds)
        for one in (all_of_them if first == "guardian" else reversed(all_of_them)):
            os.kill(one, signal.SIGCONT)
        time.sleep(2.5)
        said = a.state()
        rows = a.rows()
        on = rows["drives"] != 0
        drop = 1e3 * (rows["pose"][0][1] - rows["pose"][:, 1].min())
        text = f"moved {a.moved_mm():.1f} mm, drop {drop:.1f} mm, drives {'on' if on[-1] else 'off'}, brakes {rows['holds'][-1]:04b}"
        untrue = "master is gone" in a.session.log_text("controller")
        truth_fits = (said.split(",")[0] in ("faulted", "disabled")) == (not on[-1] and rows["holds"][-1] == 15)
        again = ""
        if not on[-1]:
            reset, enable = a.session.trigger("reset_faults"), a.session.trigger("enable")
            again = f"; reset {reset.success}, enable {enable.success} {enable.message[:50]}"
        return f"{said}{', says that the master is gone' if untrue else ''}; ", text + again, bool(truth_fits) and not untrue and drop < 5.0
    attack.__doc__ = f"Guardian, heir and controller stand still for {seconds:g} s while {state}; the {first} wakes up first."
    return needs(hardware=HOMING)(attack) if state == "homing" else attack


def supply_fails_while(state, seconds):
    def attack(a):
        bring_to(a, state)
        a.begin()
        a.session.inject("drive_dead")
        time.sleep(seconds)
        a.session.inject("clear")
        time.sleep(2.0)
        rows, said = a.rows(), a.state()
        drop = 1e3 * (rows["pose"][0][1] - rows["pose"][:, 1].min())
        went_on = said.split(",")[1] == " no fault"
        text, good = (a.disable_and_look() if went_on else a.look(0.5))
        return f"{said}, sank {drop:.1f} mm; ", text, good and drop < 15.0
    attack.__doc__ = f"All drives lose their supply for {seconds:g} s while {state}."
    return needs(hardware=HOMING)(attack) if state == "homing" else attack


def attacks():
    found = {}
    for state in STATES:
        for ms, first in ((60, "guardian"), (300, "guardian"), (300, "controller"), *([(3000, "controller")] if state == "holding" else [])):
            found[f"stand_still_for_{ms}_while_{state}_{first}_first"] = frozen_while(state, 1e-3 * ms, first)
        for ms in (20, 1000):
            found[f"supply_fails_for_{ms}_while_{state}"] = supply_fails_while(state, 1e-3 * ms)
    return found
