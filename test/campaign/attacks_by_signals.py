"""Attacks by what surrounds a process: signals at the wrong moment, a pipe whose reader died or stopped, memory that is cut off, the
clock."""
import fcntl
import os
import signal
import time

import numpy as np
import rospy

from knee_robot.msg import ControllerState, Margins, PlayGoal, Residual, Timing
from knee_robot.srv import GetEvents

from attack import how_it_ended, needs, play_client, preloaded
from session import NoAnswer, is_alive


def restart(a, name, command, **streams):
    """The process anew with other streams; then the robot is ready again."""
    s = a.session
    getattr(s, name).terminate()
    getattr(s, name).wait()
    setattr(s, name, s.spawn(name, *command, **streams))
    time.sleep(0.3)  # whoever misses the old one has missed it by then
    end = time.monotonic() + 15.0
    while True:
        try:
            s.trigger("reset_faults")
            if s.state().state == "disabled":
                return
        except NoAnswer:
            pass
        if time.monotonic() > end:
            raise RuntimeError(f"the robot is not ready after the {name} was started anew")
        time.sleep(0.1)


def guardian_ends_while_it_carries(number):
    def attack(a):
        a.enable()
        a.begin()
        a.kill("controller")
        time.sleep(0.02)
        a.session.guardian.send_signal(number)
        text, good = a.look(1.0)
        return f"the guardian {'lives' if is_alive(a.session.guardian) else 'has ended'}; ", text, good
    attack.__doc__ = f"SIGKILL of the controller; 20 ms later, while the drives carry until the brakes hold, {signal.Signals(number).name} of the guardian."
    return attack


def signals_that_nobody_expects(a):
    """SIGUSR1, SIGALRM, SIGXCPU and SIGPWR to both processes while the platform moves."""
    a.enable()
    a.play()
    a.begin()
    for number in (signal.SIGUSR1, signal.SIGALRM, signal.SIGXCPU, signal.SIGPWR):
        for process in (a.session.guardian, a.session.controller):
            process.send_signal(number)
    time.sleep(1.0)
    lives = [name for name, p in (("guardian", a.session.guardian), ("controller", a.session.controller)) if is_alive(p)]
    if len(lives) == 2:
        text, good = a.disable_and_look()
    else:
        text, good = a.look(1.0)
    return f"live: {', '.join(lives) or 'none'}; ", text, good and len(lives) == 2


def both_stand_still_for_three_seconds(a):
    """Guardian and controller stopped together while the platform moves, woken after 3 s. Its heir is all that is left: the simulated robot has
    no relay on the heartbeat output."""
    a.enable()
    a.play()
    a.begin()
    for name in ("guardian", "controller"):
        a.stop(name)
    time.sleep(3.0)
    rows = a.rows()
    fallen = rows["pose"][0][1] - np.min(rows["pose"][:, 1])
    for name in ("controller", "guardian"):
        getattr(a.session, name).send_signal(signal.SIGCONT)
    a.begin()
    text, good = a.look(1.0)
    return f"without the relay it fell by {fallen:.2f} m in 3 s; after waking: ", text, good and fallen < 0.05


def guardian_whose_reader_died(a):
    """The guardian's output is a pipe that nobody reads any more (a closed terminal behind | tee); then the controller dies."""
    reader, writer = os.pipe()
    restart(a, "guardian", a.session.guardian_command(), stream=writer)
    time.sleep(1.0)  # until it has said that it is ready
    os.close(writer)
    os.close(reader)
    a.enable()
    a.begin()
    a.kill("controller")
    text, good = a.look(1.0)
    lives = is_alive(a.session.guardian)
    return f"the guardian {'lives' if lives else 'has died'}; ", text, good and lives


def guardian_killed_and_not_buried(a):
    """SIGKILL of the guardian, whose parent does not wait for it (a container without an init); another is started, then the controller dies."""
    a.enable()
    dead = a.session.guardian
    dead.send_signal(signal.SIGKILL)
    a.session.start_guardian()
    time.sleep(1.0)
    if a.session.state().state == "faulted":
        a.session.trigger("reset_faults")
        a.session.trigger("enable")
    state = a.state()
    a.begin()
    a.kill("controller")
    text, good = a.look(1.0)
    dead.wait()
    return f"after the new guardian's start {state}; then ", text, good and "holding" in state


def link_cut_off(a):
    """The file of the link between controller and guardian is truncated while the robot holds: both are cut off from it."""
    a.enable()
    a.begin()
    os.truncate("/dev/shm" + a.session.shm + "_guardian", 0)
    text, good = a.look(1.0)
    return f"{sum(is_alive(p) for p in (a.session.guardian, a.session.controller))} of the two live; ", text, good


def stop_the_terminal(a):
    """Ctrl-S: nothing more is read of what the controller says. A refused request is the first that is said afterwards."""
    reader, writer = os.pipe()
    restart(a, "controller", a.session.controller_command(program=a.session.program), stream=writer)
    a.enable()
    flags = fcntl.fcntl(writer, fcntl.F_GETFL)
    fcntl.fcntl(writer, fcntl.F_SETFL, flags | os.O_NONBLOCK)
    try:
        while True:
            os.write(writer, b"\n")
    except BlockingIOError:
        pass
    fcntl.fcntl(writer, fcntl.F_SETFL, flags)
    a.terminal = (reader, writer)  # open until the end
    for _ in range(5):
        try:
            a.session.trigger("pause")
        except NoAnswer:
            return False
    return True


def terminal_stopped_then_emergency_stop(a):
    """Nobody reads the controller's output any more (Ctrl-S); five refused requests, then emergency_stop, then SIGTERM."""
    answers = stop_the_terminal(a)
    a.begin()
    try:
        a.session.trigger("emergency_stop")
    except NoAnswer:
        answers = False
    text, good = a.look(1.5)
    ended = a.end_controller(20.0)
    last = f"the services {'answer' if answers else 'do not answer'}; "
    last += how_it_ended(ended)
    return last, text, good and answers and ended is not None


def terminal_stopped_then_master_dies(a):
    """Nobody reads the controller's output any more (Ctrl-S); then the master dies, and nobody can stop the robot but itself."""
    stop_the_terminal(a)
    a.begin()
    a.master.stop()
    text, good = a.look(5.0)
    return "", text, good


def stepped_clock(session):
    session.stepped = session.folder / "stepped"
    return {"LD_PRELOAD": preloaded("stepped_clock", session.folder), "KNEE_STEPPED_CLOCK": str(session.stepped)}


@needs(preload=stepped_clock)
def clock_an_hour_back(a):
    """While a goal is played the system's clock is set back by an hour: everything that tells of the robot goes on telling."""
    a.enable()
    path = a.write_path()
    heard = dict.fromkeys(("state", "margins", "residual", "timing", "feedback"), 0)

    def count(name):
        heard[name] += 1
    listeners = [rospy.Subscriber(f"/controller/{name}", kind, lambda _, name=name: count(name))
                 for name, kind in (("state", ControllerState), ("margins", Margins), ("residual", Residual), ("timing", Timing))]
    with play_client() as client:
        client.send_goal(PlayGoal(file=path.name, approach=True), feedback_cb=lambda _: count("feedback"))
        a.session.wait_for(("playing",), 5.0)
        time.sleep(1.0)
        a.session.stepped.touch()
        time.sleep(0.5)
        heard.update(dict.fromkeys(heard, 0))
        time.sleep(2.5)
        silent = [name for name, times in heard.items() if times == 0]
        for one in listeners:
            one.unregister()
        client.cancel_goal()
        a.session.wait_for(("holding",), 5.0)
    text, good = a.disable_and_look()
    return f"silent in the next seconds: {', '.join(silent) or 'nothing'}; ", text, good and not silent


def fault_behind_a_step_of_the_clock(seconds):
    def attack(a):
        a.enable()
        a.play()
        a.session.stepped.write_text(f"{seconds}")
        time.sleep(0.5)
        a.begin()
        a.session.inject("hand_switch")
        text, good = a.look(2.0)
        known = [event.what for event in a.session.call("get_events", GetEvents, 0).events if event.kind == "fault"]
        a.session.inject("clear")
        time.sleep(0.2)
        reset = a.session.trigger("reset_faults")
        enabled = a.session.trigger("enable")
        a.session.trigger("disable")
        usable = reset.success and enabled.success
        said = f"the event log has the faults: {', '.join(known) or 'none'}; reset and enable {'succeeded' if usable else 'refused'}; "
        return said, text, good and known == ["hand_switch"] and usable
    attack.__doc__ = f"Playing; the system's clock is set by {seconds} s, then the hand switch is pressed: who reads the event log has to hear of it."
    return needs(preload=stepped_clock)(attack)


def attacks():
    found = {f"guardian_gets_{signal.Signals(n).name.lower()}_while_it_carries": guardian_ends_while_it_carries(n)
             for n in (signal.SIGTERM, signal.SIGINT)}
    found["fault_after_the_clock_went_an_hour_back"] = fault_behind_a_step_of_the_clock(-3600)
    found["fault_after_the_clock_went_a_year_ahead"] = fault_behind_a_step_of_the_clock(365 * 86400)
    found.update({f.__name__: f for f in (signals_that_nobody_expects, both_stand_still_for_three_seconds, guardian_whose_reader_died, guardian_killed_and_not_buried, link_cut_off,
                                          clock_an_hour_back, terminal_stopped_then_emergency_stop, terminal_stopped_then_master_dies)})
    return found
