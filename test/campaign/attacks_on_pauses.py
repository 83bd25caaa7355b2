"""Attacks on who wants the robot to be slower or to pause: what was answered is obeyed, whatever had been asked for before."""
import contextlib
import time

import numpy as np
import rospy
from actionlib_msgs.msg import GoalStatus
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


def pause_while_another_goal_is_checked(a):
    """A goal is played; one of a long file comes and is being checked; somebody presses pause and is told that it is done."""
    a.enable()
    path = write_away(a, "next.txt")
    lines = path.read_text().splitlines(keepends=True)
    path.write_text("".join(lines + lines[-1:] * 400_000))
    with play_client() as first, play_client() as second:
        first.send_goal(PlayGoal(file=a.write_path().name))
        a.session.wait_for(("playing",), 5.0)
        time.sleep(0.7)
        second.send_goal(PlayGoal(file=path.name, approach=True))
        time.sleep(0.3)
        waits = second.get_state() == GoalStatus.PENDING
        answer = a.session.trigger("pause")
        a.session.wait_for(("paused",), 5.0)
        a.begin()
        second.wait_for_result(rospy.Duration(15.0))
        time.sleep(1.0)
        moved, state = a.moved_mm(), a.state()
        for client in (first, second):
            client.cancel_goal()
            client.wait_for_result(rospy.Duration(5.0))
    text, good = a.disable_and_look()
    said = f"pause {'succeeded' if answer.success else 'refused'} while the goal {'was pending' if waits else 'was not pending any more'}"
    return f"{said}; then it moved {moved:.1f} mm ({state}); ", text, good and answer.success and waits and moved < 1.0


def another_loaded_while_a_goal_enables(a, same_name=False):
    """A goal plays the loaded reference, and enables before; meanwhile somebody else loads another one, twice as far away."""
    path = write_away(a)
    a.session.load(path.name)
    other = path if same_name else path.with_name("other.txt")
    with play_client() as client:
        a.begin()
        client.send_goal(PlayGoal(enable=True, approach=True, approach_speed=0.05))
        a.session.wait_for(("enabling",), 5.0)
        write_away(a, other.name, rise_m=0.05)
        answer = a.session.load(other.name)
        client.wait_for_result(rospy.Duration(30.0))
        moved, message = a.moved_mm(), client.get_result().message.split(";")[0]
    text, good = a.disable_and_look()
    said = f"{'another content of the same file' if same_name else other.name} was {'loaded' if answer.success else 'refused'} meanwhile"
    return f"{said}; the goal: {message}; it moved {moved:.1f} mm; ", text, good and answer.success and moved < 1.0


def its_file_loaded_anew_while_a_goal_enables(a):
    """A goal plays the loaded reference, and enables before; meanwhile somebody replaces the file and loads it again."""
    return another_loaded_while_a_goal_enables(a, same_name=True)


def attacks():
    found = {f.__name__: f for f in (paused_at_the_end_of_an_approach, resume_waits_then_pause, pause_while_another_goal_is_checked,
                                     another_loaded_while_a_goal_enables, its_file_loaded_anew_while_a_goal_enables)}
    found["slowed_down_while_a_goal_enables"] = slowed_down_while_a_goal_enables(5.0)
    found["speed_zero_while_a_goal_enables"] = slowed_down_while_a_goal_enables(0.0)
    return found
