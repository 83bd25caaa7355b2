"""Attacks on who plays: identification_session, stopped by somebody else or ended while it plans or plays, and play_movement ended by its name."""
import time

import rosnode
import rospy

from knee_robot.msg import PlayGoal
from knee_robot.srv import GetEvents

from attack import play_client
from attacks_by_others import load_patient
from session import NoAnswer, is_alive

PLANNING_S = 6.0


def begin_session(a):
    """identification_session with two short movements, until the first one has been played."""
    s = a.session
    session = s.spawn("identification", s.programs / "identification_session", "--robot", s.files["robot"], "--references", s.references,
                      "--recordings", s.recordings, "--output", s.folder / "identified", "--duration", "6", "--planning", str(PLANNING_S))
    s.others.append(session)
    return session


def wait_until(condition, seconds):
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            return False
        time.sleep(0.05)
    return True


def looks(a, session, said):
    """Until the session has ended, and 1 s beyond."""
    wait_until(lambda: not is_alive(session), 60.0)
    time.sleep(1.0)
    moved = a.moved_mm()
    last = (a.session.log_text("identification").strip().splitlines() or [""])[-1]
    return f"{said}; ", f"then it moved {moved:.1f} mm; {a.state()}; the session {'lives' if is_alive(session) else 'has ended'} ({last[:120]})", \
        moved < 1.0 and not is_alive(session)


def after_planning(a, do, said):
    session = begin_session(a)
    time.sleep(0.6 * PLANNING_S)
    a.begin()
    do(session)
    return looks(a, session, said)


def session_plans_and_somebody_disables(a):
    """identification_session plans; somebody says disable."""
    return after_planning(a, lambda _: a.session.trigger("disable"), "disabled while it planned")


def session_plans_and_somebody_stops(a):
    """identification_session plans; the robot holds; somebody says stop."""
    a.enable()
    return after_planning(a, lambda _: a.session.trigger("stop"), "stopped while it planned")


def session_plans_and_the_controller_is_started_anew(a):
    """identification_session plans; somebody stops, ends the controller, starts it again, and asks it for this and that."""
    def do(_):
        a.session.trigger("disable")
        last = newest_event()
        a.end_controller(10.0)
        a.session.start_controller()
        if not wait_until(answers, 20.0):
            raise RuntimeError("the controller did not come up")
        while newest_event() <= last:
            a.session.load("nothing.txt")

    def answers():
        try:
            return bool(a.session.state())
        except NoAnswer:
            return False

    def newest_event():
        return max(event.number for event in a.session.call("get_events", GetEvents, 0).events)

    return after_planning(a, do, "started anew while it planned")


WIDE_PATIENT = ("patient: \"17\"\npose: {X_m: [-0.3, 0.3], Z_m: [0.2, 1.0], theta_deg: [-60, 60], psi_deg: [-60, 60]}\n"
                "speed: {linear_mm_per_s: 190, angular_deg_per_s: 30}\n")


def session_plans_and_a_patient_is_loaded(a):
    """identification_session plans, with nobody on the robot; somebody loads a patient, whose limits are wide."""
    return after_planning(a, lambda _: load_patient(a, WIDE_PATIENT), "a patient was loaded while it planned")


def session_plans_and_somebody_plays(a):
    """identification_session plans; somebody else plays a movement of 12 s meanwhile: does it go on to its end?"""
    a.enable()
    session = begin_session(a)
    time.sleep(PLANNING_S)
    path = a.write_path()
    with play_client() as client:
        client.send_goal(PlayGoal(file=path.name))
        client.wait_for_result(rospy.Duration(60.0))
        result = client.get_result()
        a.begin()
        said, text, good = looks(a, session, f"played while it planned: {result.message.split(';')[0]}")
    return said, text, good and result.success


def between(a, do, said):
    session = begin_session(a)
    if not wait_until(lambda: a.session.state().state == "playing", 60.0) or not wait_until(lambda: a.session.state().recording, 60.0):
        return "nothing was played; ", a.session.log_text("identification")[-300:], False
    if not wait_until(lambda: a.session.state().state == "holding", 60.0):
        return "the first movement has no end; ", "", False
    do(session)
    time.sleep(1.0)
    a.begin()
    return looks(a, session, said)


def session_between_movements_and_somebody_disables(a):
    """identification_session has played its first movement; somebody says disable."""
    return between(a, lambda _: a.session.trigger("disable"), "disabled after its first movement")


def session_is_killed_by_its_name(a):
    """identification_session plays; rosnode kill."""
    session = begin_session(a)
    if not wait_until(lambda: a.session.state().recording, 60.0):
        return "nothing was played; ", a.session.log_text("identification")[-300:], False
    time.sleep(1.0)
    shut_down("/identification_session")
    time.sleep(2.0)
    a.begin()
    return looks(a, session, "ended while it played")


def session_is_terminated(a):
    """identification_session plans; SIGTERM to it alone."""
    return after_planning(a, lambda session: session.terminate(), "terminated while it planned")


def player_is_killed_by_its_name(a):
    """play_movement plays; rosnode kill."""
    a.enable()
    player = a.session.spawn("player", a.session.programs / "play_movement", a.write_path().name)
    a.session.others.append(player)
    if not wait_until(lambda: a.session.state().state == "playing", 30.0):
        return "nothing was played; ", a.session.log_text("player")[-300:], False
    time.sleep(0.7)
    a.begin()
    shut_down("/play_movement")
    time.sleep(3.0)
    moved = a.moved_mm()
    return f"{a.state()}; ", f"moved {moved:.1f} mm; play_movement {'lives' if is_alive(player) else 'has ended'}", moved < 40.0 and not is_alive(player)


def shut_down(prefix):
    """rosnode kill of every node whose name begins so."""
    names = [name for name in rosnode.get_node_names() if name.startswith(prefix)]
    if not names:
        raise RuntimeError(f"no node {prefix}")
    rosnode.kill_nodes(names)


def attacks():
    return {f.__name__: f for f in (session_plans_and_somebody_disables, session_plans_and_somebody_stops, session_plans_and_a_patient_is_loaded,
                                    session_plans_and_somebody_plays, session_between_movements_and_somebody_disables,
                                    session_plans_and_the_controller_is_started_anew, session_is_killed_by_its_name, session_is_terminated,
                                    player_is_killed_by_its_name)}
