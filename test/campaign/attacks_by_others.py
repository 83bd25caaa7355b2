"""Attacks by others: a second pair of guardian and controller, a guardian of another machine, files that change, many clients, a master that
goes."""
import http.client
import socket
import threading
import time
import xmlrpc.client

import numpy as np
import rosgraph
import rospy
from actionlib_msgs.msg import GoalID, GoalStatus
from dynamic_reconfigure.msg import Config, DoubleParameter
from dynamic_reconfigure.srv import Reconfigure
from roscpp.srv import GetLoggers
from std_srvs.srv import Trigger

from knee_robot.msg import PlayActionGoal, PlayGoal
from knee_robot.srv import CheckReference, LoadPatient, LoadReference

import robot_path
from attack import play_client
from session import PROCESSOR, NoAnswer, is_alive

PATIENT = ("patient: \"17\"\npose: {X_m: [-0.1, 0.1], Z_m: [0.3, 0.9], theta_deg: [-20, 20], psi_deg: [-20, 20]}\n"
           "speed: {linear_mm_per_s: 20, angular_deg_per_s: 2}\n")


def second_guardian(a, link, shm=None):
    s = a.session
    process = s.spawn("second_guardian", s.programs / "guardian", "--hardware", s.files["hardware"], "--shm", shm or s.shm, "--link", link,
                      "--silence-ms", s.silence_ms, "--priority", 90 if s.real_time else 0, "--cpu", PROCESSOR)
    s.others.append(process)
    return process


def second_controller(a, link):
    s = a.session
    command = [c for c in s.controller_command("second", s.program) if not str(c).startswith("_guardian:=")]
    process = s.spawn("second", *command, f"_guardian:={link}")
    s.others.append(process)
    return process


def second_controller_of_the_same_name(a):
    """A second controller with the first one's name, on the same master, which would shut the first one down."""
    a.enable()
    a.play()
    a.begin()
    s = a.session
    process = s.spawn("second", *[c for c in s.controller_command("controller", s.program)])
    s.others.append(process)
    text, good = goes_on(a, 5.0)
    return f"the second {'lives' if is_alive(process) else 'ended'}; ", text, good and not is_alive(process)


def values_within_values(a):
    """One request of 200000 values within each other, to the port on which every node answers the master."""
    a.enable()
    a.play()
    a.begin()
    port = int(rosgraph.Master("/attacks").lookupNode("/controller").rsplit(":", 1)[1].strip("/"))
    deep = "<value><array><data>" * 200000 + "</data></array></value>" * 200000
    body = f'<?xml version="1.0"?><methodCall><methodName>getPid</methodName><params><param>{deep}</param></params></methodCall>'.encode()
    with socket.create_connection(("127.0.0.1", port)) as connection:
        connection.sendall(b"POST /RPC2 HTTP/1.1\r\nHost: x\r\nContent-Type: text/xml\r\nContent-Length: %d\r\n\r\n" % len(body) + body)
        text, good = goes_on(a, 3.0)
    return f"the controller {'lives' if is_alive(a.session.controller) else 'has died'}; ", text, good


def goes_on(a, seconds):
    """Drives on and brakes open all the time."""
    time.sleep(seconds)
    rows = a.rows()
    fine = bool(((rows["drives"] == 15) & (rows["holds"] == 0)).all())
    return f"the first robot {'goes on' if fine else 'was disturbed'} ({a.state()})", fine


def second_pair_on_another_link(a):
    """Another guardian and another controller, with a link of their own, on the same cards."""
    a.enable()
    a.begin()
    link = a.session.shm + "_other"
    guardian, controller = second_guardian(a, link), second_controller(a, link)
    text, good = goes_on(a, 5.0)
    alive = [name for name, p in (("guardian", guardian), ("controller", controller)) if is_alive(p)]
    return f"of the second pair live: {', '.join(alive) or 'none'}; ", text, good and not alive


def second_controller_without_guardian(a):
    """A second controller that was told of no guardian at all, on the same cards."""
    a.enable()
    a.begin()
    controller = second_controller(a, "")
    text, good = goes_on(a, 5.0)
    return f"the second {'lives' if is_alive(controller) else 'ended'}; ", text, good and not is_alive(controller)


def guardian_of_another_machine(a):
    """The guardian is started anew for another machine, on this controller's link; then the controller."""
    a.enable()
    a.begin()
    a.kill("guardian", "controller")
    other = a.session.shm + "_elsewhere"
    robot = a.session.spawn("other_robot", a.session.programs / "simulated_robot", "--robot", a.session.files["robot"], "--simulation",
                            a.session.files["simulation"], "--shm", other)
    a.session.others.append(robot)
    time.sleep(1.0)
    second_guardian(a, a.session.shm + "_guardian", other)
    a.session.start_controller()
    text, good = a.look(4.0)
    lives = is_alive(a.session.controller)
    return f"the controller {'lives, watched by a guardian of another machine' if lives else 'refuses'}; ", text, good and not lives


def load_patient(a, content=PATIENT):
    path = a.session.references / "p17.yaml"
    path.write_text(content)
    answer = a.session.call("load_patient", LoadPatient, path.name)
    if not answer.success:
        raise RuntimeError(answer.message)
    return path


def patient_file_becomes(content, what):
    def attack(a):
        path = load_patient(a)
        path.write_text(content)
        kept = a.session.state().patient
        a.enable()
        a.begin()
        a.kill("controller")
        a.session.start_controller()
        end = time.monotonic() + 15.0
        enabled = None
        while enabled is None and time.monotonic() < end:
            try:
                enabled = a.session.trigger("enable")
            except NoAnswer:
                time.sleep(0.1)
        text, good = a.look(1.0)
        said = "no answer" if enabled is None else "succeeded" if enabled.success else "refused: " + enabled.message[:90]
        return f"before the restart still patient {kept}; enable after it {said}; ", text, good and kept == "17" and enabled is not None and not enabled.success
    attack.__doc__ = f"The loaded patient's file becomes {what}; then the controller dies and is started again."
    return attack


def master_restarted_while_playing(a):
    """The master dies and is back within a second, with nothing registered."""
    a.enable()
    a.play()
    a.session.keep_connections()
    a.begin()
    a.master.stop()
    time.sleep(0.8)
    a.master.start()
    end = time.monotonic() + 10.0
    answer = None
    while answer is None and time.monotonic() < end:
        try:
            answer = a.session.trigger("disable")
        except NoAnswer:
            time.sleep(0.2)
    a.begin()
    text, good = a.look(1.5)
    return f"disable {'answers again' if answer is not None else 'never answers again'}; ", text, good and answer is not None


PAIRS = (("enable", "disable"), ("start", "stop"), ("pause", "resume"), ("declare_empty", "clear_patient"), ("home", "confirm_home"),
         ("reset_faults", "emergency_stop"), ("declare_empty", "enable"), ("approach", "start"))


def four_clients_on_every_pair(a):
    """Four clients at once on each pair of services, 3 s a pair; every call has to be answered within 15 s."""
    hung, calls = [], 0
    for pair in PAIRS:
        end, count, threads = time.monotonic() + 3.0, [0] * 4, []

        def client(number, pair=pair, end=end, count=count):
            proxy = rospy.ServiceProxy(f"/controller/{pair[number % 2]}", Trigger)
            while time.monotonic() < end:
                try:
                    proxy()
                except rospy.ServiceException:
                    return
                count[number] += 1
        for number in range(4):
            threads.append(threading.Thread(target=client, args=(number,), daemon=True))
            threads[-1].start()
        for one in threads:
            one.join(max(0.1, end + 15.0 - time.monotonic()))
        calls += sum(count)
        if any(one.is_alive() for one in threads):
            hung.append("/".join(pair))
        if not is_alive(a.session.controller):
            return f"the controller ended under {pair}; ", *a.look(1.0)[:1], False
    text, good = a.disable_and_look()
    return f"{calls} calls; hung: {', '.join(hung) or 'none'}; {a.state()}; ", text, good and not hung


def enabled_again_without_a_master(a):
    """The master dies, the robot is brought to rest; a client that is still connected enables it again, and dies."""
    a.session.keep_connections()
    a.session.kept["enable"] = rospy.ServiceProxy("/controller/enable", Trigger, persistent=True)
    a.enable()
    a.master.stop()
    before = a.session.wait_for(("disabled",), 6.0).state
    a.begin()
    answer = a.session.trigger("enable")
    text, good = a.look(6.0)
    return f"without a master {before}; enabled again ({answer.message}): ", text, good and before == "disabled"


def another_reference_within_a_goal(a):
    """A play goal approaches its reference, while another client loads another one as often as it can: the goal plays its own or nothing."""
    a.enable()
    path = a.write_path()
    path.with_name("other.txt").write_text(path.read_text())
    with play_client() as client:
        loads, ended = [], []

        def load():
            proxy = rospy.ServiceProxy("/controller/load_reference", LoadReference, persistent=True)
            while not ended:
                loads.append(proxy("other.txt", "").success)
        threading.Thread(target=load, daemon=True).start()
        client.send_goal(PlayGoal(file=path.name, approach=True, record=True, recording="goal.csv"))
        client.wait_for_result(rospy.Duration(30.0))
        ended.append(True)
        result = client.get_result()
    text, good = a.disable_and_look()
    done = f"{'succeeded' if result.success else 'failed'} ({result.message.split(';')[0]})"
    return f"other.txt was loaded {loads.count(True)} times; the goal {done}; ", text, good and not (
        result.success and "other.txt was played" in result.message)


def stop_while_a_goal_is_checked(a):
    """A play goal of a long file is being checked; somebody presses stop and is told that it is done: nothing moves any more."""
    a.enable()
    path = a.write_path()
    lines = path.read_text().splitlines(keepends=True)
    path.with_name("long.txt").write_text("".join(lines + lines[-1:] * 400_000))
    with play_client() as client:
        client.send_goal(PlayGoal(file="long.txt"))
        time.sleep(0.3)
        before = client.get_state()
        a.begin()
        answer = a.session.trigger("stop")
        client.wait_for_result(rospy.Duration(10.0))
        time.sleep(1.0)
        moved, state = a.moved_mm(), a.state()
        client.cancel_goal()
    a.session.wait_for(("holding",), 10.0)
    text, good = a.disable_and_look()
    said = f"stop {'succeeded' if answer.success else 'failed'} while the goal was {'pending' if before == GoalStatus.PENDING else before}"
    return f"{said}; then it moved {moved:.1f} mm ({state}); ", text, good and answer.success and moved < 0.2 and before == GoalStatus.PENDING


def stop_while_an_approach_waits(a):
    """Three long files are being checked, an approach waits behind them; somebody presses stop and is told that it is done: nothing moves."""
    a.enable()
    path = a.write_path()
    now = a.session.truth.last()
    away = robot_path.climb(a.geometry, now["pose"], now["length_m"], rise_m=0.01)[-1:]
    robot_path.write(path, np.repeat(away, 200, axis=0))
    robot_path.write(path.with_name("long.txt"), np.repeat(away, 400_000, axis=0))
    a.session.load(path.name)
    for _ in range(3):
        a.call_aside(lambda: rospy.ServiceProxy("/controller/check_reference", CheckReference)("long.txt", ""))
    time.sleep(0.5)
    approach = a.call_aside(lambda: rospy.ServiceProxy("/controller/approach", Trigger)())
    time.sleep(0.3)
    waits = not approach
    a.begin()
    answer = a.session.trigger("stop")
    end = time.monotonic() + 10.0
    while not approach and time.monotonic() < end:
        time.sleep(0.1)
    time.sleep(1.0)
    moved, state = a.moved_mm(), a.state()
    a.session.trigger("stop")
    a.session.wait_for(("holding",), 10.0)
    text, good = a.disable_and_look()
    said = f"stop {'succeeded' if answer.success else 'failed'} while the approach {'waited' if waits else 'was under way'}"
    return f"{said}; then it moved {moved:.1f} mm ({state}); ", text, good and answer.success and waits and moved < 0.2


def stop_while_being_disabled(a):
    """Three clients press stop as often as they can while a fourth disables: it is told when the drives are off."""
    a.enable()
    a.play()
    ended = []

    def stop():
        proxy = rospy.ServiceProxy("/controller/stop", Trigger, persistent=True)
        while not ended:
            proxy()
    for _ in range(3):
        threading.Thread(target=stop, daemon=True).start()
    time.sleep(0.1)
    a.begin()
    answer = a.session.trigger("disable")
    ended.append(True)
    text, good = a.look(1.0)
    return f"disable {'succeeded' if answer.success else 'failed'} ({answer.message}); ", text, good and answer.success


def lives_on(a, seconds=1.0):
    time.sleep(seconds)
    status, state = a.session.controller.poll(), a.state()
    return f"the controller {'lives' if status is None else f'ended with {status}'}; {state}", state == "holding, no fault"


def loggers_are_listed(a):
    """Holding: rqt_logger_level asks the controller for its loggers; then something logs from a place that has not logged yet."""
    a.enable()
    a.begin()
    try:
        rospy.ServiceProxy("/controller/get_loggers", GetLoggers)()
        asked = "answered"
    except rospy.ServiceException:
        asked = "not there"
    try:
        rospy.ServiceProxy("/controller/feedforward/set_parameters", Reconfigure)(Config(doubles=[DoubleParameter("nonsense", 1.0)]))
    except rospy.ServiceException:
        pass
    return f"get_loggers {asked}; ", *lives_on(a, 0.5)


def update_of_a_parameter_without_a_name(a):
    """Holding: the master's call for parameters that have changed, with a name that is none, from somebody who is no master."""
    a.enable()
    controller = xmlrpc.client.ServerProxy(rosgraph.Master("/attacks").lookupNode("/controller"))
    answers = []
    for name in ("..", "", "/", "\u00e9"):
        try:
            controller.paramUpdate("/attacks", name, 1)
            answers.append("done")
        except xmlrpc.client.Fault:
            answers.append("fault")
        except (OSError, http.client.HTTPException):
            answers.append("no answer")
    return f"{', '.join(answers)}; ", *lives_on(a)


def stamps_at_the_end_of_time(a):
    """Holding: goals that are refused and cancels of goals that are not there, stamped with the last second of ROS time, twice each."""
    a.enable()
    goals = rospy.Publisher("/controller/play/goal", PlayActionGoal, queue_size=10)
    cancels = rospy.Publisher("/controller/play/cancel", GoalID, queue_size=10)
    time.sleep(0.5)
    last = rospy.Time(2**32 - 1, 0)
    for _ in range(2):
        goals.publish(PlayActionGoal(goal_id=GoalID(stamp=last, id="late"), goal=PlayGoal(file="nothing.txt", speed_percent=1e308)))
        cancels.publish(GoalID(stamp=last, id="nobody"))
        time.sleep(0.5)
    goals.unregister()
    cancels.unregister()
    return "", *lives_on(a)


def attacks():
    found = {f.__name__: f for f in (second_pair_on_another_link, second_controller_without_guardian, second_controller_of_the_same_name,
                                     values_within_values, guardian_of_another_machine,
                                     master_restarted_while_playing, four_clients_on_every_pair, another_reference_within_a_goal,
                                     stop_while_a_goal_is_checked, stop_while_an_approach_waits, stop_while_being_disabled, enabled_again_without_a_master,
                                     loggers_are_listed, update_of_a_parameter_without_a_name, stamps_at_the_end_of_time)}
    found["patient_file_becomes_garbage"] = patient_file_becomes("}{ nan \0 :::\n" * 50, "garbage")
    found["patient_file_becomes_wider"] = patient_file_becomes(PATIENT.replace("0.9", "0.95"), "one with other limits")
    return found
