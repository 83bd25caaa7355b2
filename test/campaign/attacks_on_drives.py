"""Attacks on the robot with drives on a simulated CAN bus: controller and guardian that die or stand still, drives that restart under them."""
import os
import signal
import time

from attack import drop_of, needs
from session import NoAnswer


def gentle(text, good):
    """Drives on the bus stop by themselves and hand nothing over: what the brakes' delay costs is left."""
    return text, good and drop_of(text) < 10.0


def controller_killed(a):
    a.begin()
    a.kill("controller")
    return ("", *gentle(*a.look()))


@needs(on_can=True)
def can_controller_killed_while_holding(a):
    """CAN, holding: the controller is killed."""
    a.enable()
    return controller_killed(a)


@needs(on_can=True)
def can_controller_killed_while_playing(a):
    """CAN, playing: the controller is killed."""
    a.enable()
    a.play()
    return controller_killed(a)


@needs(on_can=True)
def can_both_killed_while_holding(a):
    """CAN, holding: controller and guardian are killed together; the drives stop by themselves."""
    a.enable()
    a.begin()
    a.kill("guardian", "controller")
    return ("", *gentle(*a.look()))


@needs(on_can=True)
def can_guardian_killed_then_the_controller_stands_still(a):
    """CAN, playing: the guardian is killed and the controller stopped 20 ms later, for 1 s."""
    a.enable()
    a.play()
    a.begin()
    a.kill("guardian")
    time.sleep(0.02)
    a.stop("controller")
    time.sleep(1.0)
    os.kill(a.session.controller.pid, signal.SIGCONT)
    found = gentle(*a.look())
    return (f"{a.state()}; ", *found)


def stands_still(seconds):
    @needs(on_can=True)
    def attack(a):
        a.enable()
        a.play()
        a.begin()
        a.stop("controller")
        time.sleep(seconds)
        os.kill(a.session.controller.pid, signal.SIGCONT)
        found = gentle(*a.look())
        return (f"{a.state()}; ", *found)
    attack.__doc__ = f"CAN, playing: SIGSTOP of the controller for {1e3 * seconds:g} ms."
    return attack


@needs(on_can=True)
def can_simulated_drives_are_stopped(a):
    """CAN, holding: the process with the drives stands still for 0.5 s (all feedback stays away), then goes on."""
    a.enable()
    a.begin()
    a.stop("robot")
    time.sleep(0.5)
    os.kill(a.session.robot.pid, signal.SIGCONT)
    found = gentle(*a.look())
    state = a.state()
    reset = a.session.trigger("reset_faults")
    enabled = a.session.trigger("enable")
    return f"{state}; reset {reset.success} ({reset.message[:60]}), enable {enabled.success} ({enabled.message[:60]}); ", *found


@needs(on_can=True)
def can_guardian_restarted_under_a_controller_that_holds(a):
    """CAN, holding: the guardian is killed and started again at once, five times."""
    a.enable()
    a.begin()
    for _ in range(5):
        a.kill("guardian")
        a.session.start_guardian()
        time.sleep(0.5)
    try:
        state = a.session.state().state
    except NoAnswer as error:
        state = str(error)
    text, good = a.look(0.5)
    return f"{a.state()}; ", text, state in ("holding", "faulted") and drop_of(text) < 2.0 and (good or state == "holding")


def attacks():
    all_ = {f.__name__: f for f in (can_controller_killed_while_holding, can_controller_killed_while_playing, can_both_killed_while_holding,
                                    can_guardian_killed_then_the_controller_stands_still, can_simulated_drives_are_stopped,
                                    can_guardian_restarted_under_a_controller_that_holds)}
    for ms in (30, 150, 400):
        all_[f"can_controller_stands_still_for_{ms}_ms"] = stands_still(1e-3 * ms)
    return all_
