"""Attacks while the guardian lets the drives carry a dead or silent controller's load until brakes that engage 0.5 s late hold: it dies of that
and is started again, together with a controller or later; and what the operator reads meanwhile."""
import os
import signal
import time

import numpy as np

from attack import drop_of
from session import NoAnswer


def carried(a):
    """The controller has died 0.1 s ago, the brakes are late, the drives carry."""
    a.enable()
    a.session.inject("hold_late")
    a.begin()
    a.kill("controller")
    time.sleep(0.1)


def small(text, good):
    return text, good and drop_of(text) < 10.0


def guardian_restarted_while_it_carries(a):
    """Holding, brakes that are late: the controller is killed, 0.1 s later the guardian, which is started again at once (roslaunch)."""
    carried(a)
    a.kill("guardian")
    a.session.start_guardian()
    return ("", *small(*a.look()))


def controller_back_while_the_guardian_is_dead(a):
    """The same; the controller is started first, the guardian 0.3 s after it."""
    carried(a)
    a.kill("guardian")
    a.session.start_controller()
    time.sleep(0.3)
    a.session.start_guardian()
    return ("", *small(*a.look(4.0)))


def says_off_while_the_guardian_carries(a):
    """Holding, brakes that are late: the controller stands still for 0.15 s; for how long it calls the robot off while drives are on."""
    a.enable()
    a.session.inject("hold_late")
    a.begin()
    a.stop("controller")
    time.sleep(0.15)
    os.kill(a.session.controller.pid, signal.SIGCONT)
    said = []
    while time.monotonic() - a.began < 3.0:
        try:
            said.append((time.monotonic(), a.session.state().state in ("faulted", "disabled")))
        except NoAnswer:
            pass
        time.sleep(0.01)
    rows = a.rows()
    on = rows["drives"] != 0
    wrong = [at for at, off in said if off and on[min(np.searchsorted(rows["monotonic_s"], at), len(on) - 1)]]
    for_ms = 1e3 * (wrong[-1] - wrong[0]) if wrong else 0.0
    text, good = small(*a.look(0.1))
    return f"says for {for_ms:.0f} ms that it is off while drives are on; {a.state()}; ", text, good and for_ms < 50.0


def attacks():
    return {f.__name__: f for f in (guardian_restarted_while_it_carries, controller_back_while_the_guardian_is_dead, says_off_while_the_guardian_carries)}
