"""Attacks while the guardian lets the drives carry a dead or silent controller's load until brakes that engage 0.5 s late hold: it dies of that
and is started again, together with a controller or later; and what the operator reads meanwhile."""
import os
import pathlib
import signal
import time

import numpy as np
import yaml

from attack import down_now, drop_of
from session import NoAnswer, is_alive


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


def down_now_behind_late_brakes(a):
    """Holding, brakes that are late: guardian --down-now beside a guardian and a controller that live."""
    a.enable()
    a.session.inject("hold_late")
    a.begin()
    status = down_now(a)
    return (f"--down-now ends with {status}; ", *small(*a.look()))


def both_killed_behind_late_brakes(a):
    """Holding, brakes that are late: guardian and controller die together, and the guardian is started again."""
    a.enable()
    a.session.inject("hold_late")
    a.begin()
    a.kill("guardian", "controller")
    a.session.start_guardian()
    return ("", *small(*a.look()))


def both_killed_behind_late_brakes_then_down_now(a):
    """The same; instead of the guardian the service manager's guardian --down-now runs."""
    a.enable()
    a.session.inject("hold_late")
    a.begin()
    a.kill("guardian", "controller")
    status = down_now(a)
    text, good = small(*a.look())
    return f"--down-now ends with {status}; ", text, good and status == 0


def hardware_file_changed_since_the_guardian_read_it(a):
    """Drive enable and brakes have changed places in the hardware file, and only the controller is started anew; then it is killed."""
    s = a.session
    content = yaml.safe_load(pathlib.Path(s.files["hardware"]).read_text(encoding="utf-8"))
    outputs = content["digital_outputs"]
    outputs["drive_enable"], outputs["hold_release"] = outputs["hold_release"], outputs["drive_enable"]
    other = s.folder / "before.yaml"
    other.write_text(yaml.safe_dump(content))
    for process in (s.controller, s.guardian):
        process.terminate()
        process.wait(10.0)
    now, s.files = s.files, {**s.files, "hardware": other}
    s.start_guardian()
    s.files = now
    a.begin()
    s.start_controller()
    end = time.monotonic() + 15.0
    while is_alive(s.controller) and time.monotonic() < end:
        try:
            a.session.state()
            break
        except NoAnswer:
            time.sleep(0.1)
    if not is_alive(s.controller):
        return ("the controller refuses; ", *a.look(0.5))
    a.enable()
    a.begin()
    a.kill("controller")
    text, good = a.look(2.0)
    return "enabled, then the controller was killed; ", text, good and drop_of(text) < 2.0


def attacks():
    return {f.__name__: f for f in (guardian_restarted_while_it_carries, controller_back_while_the_guardian_is_dead, says_off_while_the_guardian_carries,
                                    down_now_behind_late_brakes, both_killed_behind_late_brakes, both_killed_behind_late_brakes_then_down_now,
                                    hardware_file_changed_since_the_guardian_read_it)}
