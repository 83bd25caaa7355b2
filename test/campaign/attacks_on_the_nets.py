"""What is left when the safe stop, the guardian or the brakes themselves fail: the drives that carry, the load that the guardian was
offered, the service manager's `guardian --down-now`."""
import os
import pathlib
import signal
import subprocess
import time

import numpy as np

from attack import down_now, drop_of
from session import NoAnswer, is_alive

ROOT = pathlib.Path(__file__).resolve().parents[2]


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


def how_it_is_carried(a):
    """How far the platform has sunk, mm, and whether all drives carry it; then the brakes hold again."""
    rows = a.rows()
    a.session.inject("clear")
    return 1e3 * (rows["pose"][0][1] - np.min(rows["pose"][:, 1])), bool(rows["drives"][-1] == 15)


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
    drop, carried = how_it_is_carried(a)
    return f"{state}; the controller {'lives' if lives else 'has ended'}, ", f"drop {drop:.1f} mm in 10 s", (
        carried and lives and "hold_device_slips" in state and drop < 5.0)


def through_roslaunch(a):
    """Controller and guardian anew, started by controller.launch as on the real robot: in sessions of their own."""
    s = a.session
    for process in (s.controller, s.guardian):
        process.terminate()
        process.wait(20.0)
    launch = s.spawn("launch", "roslaunch", ROOT / "launch" / "controller.launch", "own_session:=true", "empty:=true", "bag:=false",
                     f"robot:={s.files['robot']}", f"urdf:={ROOT}/urdf/A.urdf", f"hardware:={s.files['hardware']}",
                     f"deployment:={s.files['deployment']}", f"shm:={s.shm}", f"guardian_link:={s.shm}_guardian",
                     f"references:={s.references}", f"recordings:={s.recordings}", f"state:={s.recordings}/state")
    s.others.append(launch)
    end = time.monotonic() + 30.0
    while "disabled" not in a.state():
        if time.monotonic() > end:
            raise RuntimeError(f"no robot, see {s.folder}/launch.log: {a.state()}")
        time.sleep(0.2)
        try:
            s.trigger("reset_faults")
        except NoAnswer:
            pass
    return launch


def left_behind(session):
    """Controller and guardian that roslaunch did not kill. They end with the attack."""
    asked = subprocess.run(["pgrep", "-f", f"^{session.programs}/(controller|guardian) .*--own-session"], capture_output=True, text=True,
                           check=False)
    return [int(pid) for pid in asked.stdout.split()]


def roslaunch_kills_what_carries(a):
    """Holding behind brakes that stay open: emergency_stop, then Ctrl-C in roslaunch, which kills its nodes after 17 s. Only the drives
    carry; 5 s later the brakes hold again."""
    launch = through_roslaunch(a)
    a.enable()
    a.session.inject("hold_open")
    a.begin()
    a.session.trigger("emergency_stop")
    time.sleep(1.5)
    state = a.state()
    launch.send_signal(signal.SIGINT)
    launch.wait(40.0)
    time.sleep(5.0)
    drop, carried = how_it_is_carried(a)
    time.sleep(7.0)
    rows = a.rows()
    off = bool(rows["drives"][-1] == 0)
    left = left_behind(a.session)
    for pid in left:
        os.kill(pid, signal.SIGKILL)
    return (f"{state}; roslaunch has ended, the drives {'carry' if carried else 'do not carry'}; with brakes that hold again ",
            f"they are {'off' if off else 'on'}, {len(left)} processes left, drop {drop:.1f} mm",
            carried and off and not left and "hold_device_slips" in state and drop < 5.0)


def attacks():
    return {f.__name__: f for f in (guardian_killed_then_down_now, both_killed_then_down_now_without_link, controller_killed_while_it_stops,
                                    brakes_that_do_not_hold_then_terminated, roslaunch_kills_what_carries)}
