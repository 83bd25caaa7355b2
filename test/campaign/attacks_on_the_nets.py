"""What is left when the safe stop, the guardian or the brakes themselves fail: the drives that carry, the load that the guardian was
offered, the service manager's `guardian --down-now`."""
import pathlib
import signal
import subprocess
import time

import numpy as np

from session import is_alive


def down_now(a):
    """What the service manager calls; its exit status."""
    return subprocess.run([*map(str, a.session.guardian_command()), "--down-now"], check=False, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                          timeout=20).returncode


def drop_of(text):
    return float(text.split("drop ")[1].split(" ")[0])


def guardian_killed_then_down_now(a):
    """Holding: the guardian dies, and the service manager's hook runs at once, beside a controller that lives and stops by itself."""
    a.enable()
    a.begin()
    a.kill("guardian")
    status = down_now(a)
    text, good = a.look(1.5)
    return f"--down-now ends with {status}; {a.state()}; ", text, good and status == 0 and drop_of(text) < 0.5


def both_killed_then_down_now_without_link(a):
    """Both die with the drives on, and their link's file is something else: the outputs come down without it."""
    a.enable()
    a.begin()
    a.kill("guardian", "controller")
    (pathlib.Path("/dev/shm") / (a.session.shm.strip("/") + "_guardian")).write_bytes(bytes(10))
    status = down_now(a)
    text, good = a.look(1.5)
    return f"--down-now ends with {status}; ", text, good and status == 0


def controller_killed_while_it_stops(a):
    """Playing: disable, and 0.1 s later, while it slows down along the path, SIGKILL."""
    a.enable()
    a.play()
    a.begin()
    a.call_aside(lambda: a.session.trigger("disable"))
    time.sleep(0.1)
    a.kill("controller")
    text, good = a.look(1.5)
    return "", text, good and drop_of(text) < 2.0


def brakes_that_do_not_hold_then_terminated(a):
    """Holding with brakes that stay open: emergency_stop, then SIGTERM of the controller. Only the drives carry: it stays, and says why."""
    a.enable()
    a.session.inject("hold_open")
    a.begin()
    a.session.trigger("emergency_stop")
    time.sleep(1.5)
    state = a.state()
    a.session.controller.send_signal(signal.SIGTERM)
    time.sleep(8.0)
    lives = is_alive(a.session.controller)
    rows = a.rows()
    drop = 1e3 * (rows["pose"][0][1] - np.min(rows["pose"][:, 1]))
    carried = bool(rows["drives"][-1] == 15)
    a.session.inject("clear")
    return f"{state}; the controller {'lives' if lives else 'has ended'}, ", f"drop {drop:.1f} mm in 10 s", (
        carried and lives and "hold_device_slips" in state and drop < 5.0)


def attacks():
    return {f.__name__: f for f in (guardian_killed_then_down_now, both_killed_then_down_now_without_link, controller_killed_while_it_stops,
                                    brakes_that_do_not_hold_then_terminated)}
