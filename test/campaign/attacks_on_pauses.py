"""Attacks on who wants the robot to be slower or to pause: what was answered is obeyed, whatever had been asked for before."""
import contextlib
import time

import numpy as np
import rospy
from std_srvs.srv import Trigger

from knee_robot.msg import PlayGoal
from knee_robot.srv import CheckReference, SetSpeed

import robot_path
from attack import play_client

JUST_BEFORE_ITS_END_S = 0.05


def write_away(a, name="attack.txt", rise_m=0.02):
    """A movement that begins some millimetres above where the robot stands, as something to approach."""
    now = a.session.truth.last()
    away = robot_path.climb(a.geometry, now["pose"], now["length_m"], rise_m=rise_m)[-1]
    way = robot_path.climb(a.geometry, np.add(now["pose"], (0.0, rise_m, 0.0, 0.0)), away, rise_m=0.04)
    path = a.session.references / name
    robot_path.write(path, way)
    return path


def set_speed(a, percent):
    return a.session.call("set_speed", SetSpeed, percent)


@contextlib.contextmanager
def goal_under_way(path, **fields):
    with play_client() as client:
        client.send_goal(PlayGoal(file=path.name, approach=True, **fields))
        yield client
        client.cancel_goal()
        client.wait_for_result(rospy.Duration(5.0))


def paused_at_the_end_of_an_approach(a):
    """A goal approaches its first point; pause is answered just before it is there: does the movement begin?"""
    a.enable()
    with goal_under_way(write_away(a)):
        state = a.session.wait_for(("playing",), 5.0)
        while state.state == "playing" and state.duration_s - state.path_time_s > JUST_BEFORE_ITS_END_S:
            state = a.session.state()
        answer = a.session.trigger("pause")
        time.sleep(0.5)
        a.begin()
        time.sleep(3.0)
        moved, state = a.moved_mm(), a.state()
    text, good = a.disable_and_look()
    return f"pause {'succeeded' if answer.success else 'refused'}; 0.5 s later it moved {moved:.1f} mm ({state}); ", text, \
        good and answer.success and moved < 1.0


def slowed_down_while_a_goal_enables(percent):
    def attack(a):
        with goal_under_way(write_away(a), enable=True, approach_speed=0.02):
            a.session.wait_for(("enabling",), 5.0)
            a.begin()
            answer = set_speed(a, percent)
            a.session.wait_for(("playing", "paused"), 5.0)
            time.sleep(1.5)
            moved, speed = a.moved_mm(), a.session.state().speed_percent
        set_speed(a, 100.0)
        text, good = a.disable_and_look()
        return f"set_speed {percent:g} {'succeeded' if answer.success else 'refused'}; then at {speed:g} %, moved {moved:.1f} mm within 1.5 s; ", text, \
            good and answer.success and speed == percent
    attack.__doc__ = f"A goal that enables and approaches; somebody sets the speed to {percent:g} % while the robot is being enabled."
    return attack


def resume_waits_then_pause(a):
    """Paused; three long files are being checked, a resume waits behind them; somebody presses pause once more and is told that it is done."""
    a.enable()
    a.play()
    a.session.trigger("pause")
    a.session.wait_for(("paused",), 5.0)
    now = a.session.truth.last()
    robot_path.write(a.session.references / "long.txt", np.repeat([now["length_m"]], 400_000, axis=0))
    for _ in range(3):
        a.call_aside(lambda: rospy.ServiceProxy("/controller/check_reference", CheckReference)("long.txt", ""))
    time.sleep(0.5)
    resume = a.call_aside(lambda: rospy.ServiceProxy("/controller/resume", Trigger)())
    time.sleep(0.3)
    waits = not resume
    a.begin()
    answer = a.session.trigger("pause")
    end = time.monotonic() + 15.0
    while not resume and time.monotonic() < end:
        time.sleep(0.1)
    time.sleep(1.5)
    moved, state = a.moved_mm(), a.state()
    a.session.trigger("stop")
    text, good = a.disable_and_look()
    said = f"pause {'succeeded' if answer.success else 'failed'} while a resume {'waited' if waits else 'was under way'}"
    return f"{said}; then it moved {moved:.1f} mm ({state}); ", text, good and answer.success and waits and moved < 1.0


def attacks():
    found = {f.__name__: f for f in (paused_at_the_end_of_an_approach, resume_waits_then_pause)}
    found["slowed_down_while_a_goal_enables"] = slowed_down_while_a_goal_enables(5.0)
    found["speed_zero_while_a_goal_enables"] = slowed_down_while_a_goal_enables(0.0)
    return found
