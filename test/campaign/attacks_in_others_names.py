"""Attacks in the names of others: goals that were sent long ago, services whose names another node has taken, requests within requests,
folders that are others from elsewhere."""
import contextlib
import pathlib
import subprocess
import threading
import time
import urllib.request
import xmlrpc.client

import rosgraph
import rospy
from actionlib_msgs.msg import GoalID
from std_srvs.srv import Trigger, TriggerResponse

from knee_robot.msg import PlayActionGoal, PlayGoal
from knee_robot.srv import LoadPatient

from attacks_by_others import lives_on
from attacks_in_disorder import PATIENT, comes_up, end, other_parameters
from session import NoAnswer, free_port, is_alive

ROOT = pathlib.Path(__file__).resolve().parents[2]
STOPS = ("stop", "pause", "disable", "emergency_stop")


def goal_of_an_hour_ago(a):
    """Disabled: a bag of an hour ago, with a goal that enables, is played beside the robot (the launch files' `bag:=true` records goals)."""
    return goal_stamped(a, -3600.0)


def goal_of_next_year(a):
    """Disabled: the same with a bag of a computer whose clock was a year ahead."""
    return goal_stamped(a, 365 * 86400.0)


def goal_that_a_stop_has_overtaken(a):
    """The robot is stopped; 0.5 s later a goal arrives that was sent 3 s ago, before the stop: the network was away."""
    a.enable()
    a.session.trigger("stop")
    return goal_stamped(a, -3.0, "holding, no fault")


def goal_stamped(a, ahead_s, stays="disabled, no fault"):
    path = a.write_path()
    goals = rospy.Publisher("/controller/play/goal", PlayActionGoal, queue_size=2)
    time.sleep(0.5)
    then = rospy.Time.now() + rospy.Duration(ahead_s)
    goal = PlayActionGoal(goal_id=GoalID(stamp=then, id="/operator_page-1"), goal=PlayGoal(file=path.name, enable=True))
    goal.header.stamp = then
    a.begin()
    goals.publish(goal)
    time.sleep(4.0)
    moved, state = a.moved_mm(), a.state()
    goals.unregister()
    a.session.trigger("stop")
    text, good = a.disable_and_look()
    return f"{state}, moved {moved:.1f} mm; ", text, good and moved < 0.2 and state == stays


@contextlib.contextmanager
def said_every_second(a, stamp):
    """A script says a goal that enables once a second (`rostopic pub -r 1`)."""
    goal = PlayActionGoal(goal_id=GoalID(stamp=stamp), goal=PlayGoal(file=a.write_path().name, enable=True, approach=True))
    goals = rospy.Publisher("/controller/play/goal", PlayActionGoal, queue_size=2)
    ended = threading.Event()

    def say():
        while not ended.wait(1.0):
            goals.publish(goal)
    script = threading.Thread(target=say)
    script.start()
    try:
        yield
    finally:
        ended.set()
        script.join()
        goals.unregister()


def moved_afterwards(a):
    a.begin()
    time.sleep(4.0)
    moved, state = a.moved_mm(), a.state()
    return f"{state}, moved {moved:.1f} mm; ", moved < 0.2 and state in ("disabled, no fault", "holding, no fault")


def cancel(a):
    cancels = rospy.Publisher("/controller/play/cancel", GoalID, queue_size=1)
    time.sleep(0.5)
    cancels.publish(GoalID())
    time.sleep(0.5)
    cancels.unregister()
    a.session.wait_for(("holding",), 3.0)


def said_again_after(*requests):
    def attack(a):
        with said_every_second(a, rospy.Time(0)):
            began = a.session.wait_for(("playing",), 5.0).state
            for request in requests:
                if request == "cancel":
                    cancel(a)
                else:
                    a.session.trigger(request)
                time.sleep(1.5)
            found, still = moved_afterwards(a)
        a.session.trigger("stop")
        text, good = a.disable_and_look()
        return f"{began}, then {found}", text, good and still and began == "playing"
    attack.__doc__ = f"A script says the same goal, which enables, once a second; {', '.join(requests)}: does it move again?"
    return attack


def stop_when(a, happens):
    """Playing; `happens`, 3 s later stop."""
    a.enable()
    a.play()
    happens()
    time.sleep(3.0)
    before = a.session.state().state
    try:
        answer = a.session.trigger("stop").message
    except NoAnswer:
        answer = "no answer"
    time.sleep(1.5)
    after = a.session.state().state
    return f"{before}; stop: {answer}; then {after}; ", "", after == "holding"


def stop_services_are_taken(a):
    """Playing: another node offers services of the controller's names, which say that it is done; 3 s later stop."""
    taken = []
    found = stop_when(a, lambda: taken.extend(rospy.Service(f"/controller/{name}", Trigger, lambda _: TriggerResponse(True, "done by another node"))
                                              for name in STOPS))
    for service in taken:
        service.shutdown()
    return found


def stop_services_are_withdrawn(a):
    """Playing: somebody withdraws the controller's services from the master; 3 s later stop."""
    def withdraw():
        master = rosgraph.Master("/attacks")
        for name in STOPS:
            service = f"/controller/{name}"
            xmlrpc.client.ServerProxy(a.master.uri).unregisterService("/controller", service, master.lookupService(service))
    return stop_when(a, withdraw)


def request_within_a_request(a):
    """Holding: one XML-RPC request for several, within another one."""
    a.enable()
    controller = xmlrpc.client.ServerProxy(rosgraph.Master("/attacks").lookupNode("/controller"))
    try:
        controller.system.multicall([{"methodName": "system.multicall", "params": [[]]}])
        answer = "done"
    except xmlrpc.client.Fault:
        answer = "answered as a fault"
    except OSError:
        answer = "no answer"
    return f"{answer}; ", *lives_on(a)


@contextlib.contextmanager
def state_folder(session, path):
    """Of the controllers that are started meanwhile; the parameter server would tell the next robot's, too."""
    with other_parameters(session, state=path):
        try:
            yield
        finally:
            rospy.delete_param("/controller/state")


def started_from_another_folder_with_a_patient(a):
    """The state folder is a relative path; with a patient the controller ends, and is started from another folder."""
    s = a.session
    (s.references / "17.yaml").write_text(PATIENT)
    end(s.controller)
    with state_folder(s, "state"):
        for place in ("here", "there"):
            (s.folder / place).mkdir()
            s.controller = subprocess.Popen([str(c) for c in s.controller_command(program=s.program)], cwd=s.folder / place, env=s.environment,
                                            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
            if not comes_up(a):
                return "the controller refuses; ", "", True
            if place == "here":
                if not (answer := s.call("load_patient", LoadPatient, "17.yaml")).success:
                    raise RuntimeError(answer.message)
                end(s.controller)
    state = s.state()
    return "started from there: ", f"occupancy {state.occupancy} {state.patient}", state.occupancy == "patient"


def state_folder_behind_a_link_that_leads_nowhere(a):
    """The state folder is a link to another disk; with a patient the controller ends, and is started while the disk is not mounted."""
    s = a.session
    (s.references / "17.yaml").write_text(PATIENT)
    end(s.controller)
    disk = s.folder / "disk"
    disk.mkdir()
    (s.folder / "state").symlink_to(disk)
    with state_folder(s, s.folder / "state"):
        s.start_controller()
        comes_up(a)
        if not (answer := s.call("load_patient", LoadPatient, "17.yaml")).success:
            raise RuntimeError(answer.message)
        end(s.controller)
        disk.rename(s.folder / "unmounted")
        s.start_controller()
        comes_up(a)
        answer = s.trigger("enable")
        state = s.state()
    return f"occupancy {state.occupancy}; ", f"enable {'succeeded' if answer.success else 'refused: ' + answer.message[:160]}", not answer.success


def second_page_of_the_same_name(a):
    """The operator's page runs, and is started a second time, as launching twice does; the first one's STOP."""
    s = a.session
    for name, value in (("/run_id", "attacks"), ("/controller/recordings", s.recordings), ("/controller/references", s.references),
                        ("/controller/robot", s.files["robot"])):
        rospy.set_param(name, str(value))
    port = free_port()
    first, second = (s.spawn(f"page_{number}", "/usr/bin/python3", ROOT / "src" / "nodes" / "operator_page", f"_port:={port}") for number in waits())
    s.others.extend((first, second))
    time.sleep(5.0)
    try:
        request = urllib.request.Request(f"http://127.0.0.1:{port}/api/stop", data=b"{}", method="POST",
                                         headers={"Content-Type": "application/json", "Origin": f"http://127.0.0.1:{port}"})
        with urllib.request.urlopen(request, timeout=5.0) as answer:
            stopped = answer.status == 200
    except OSError:
        stopped = False
    lives = is_alive(first)
    return (f"the first {'lives' if lives else 'was ended'}, the second {'lives' if is_alive(second) else 'has ended'}; ",
            f"STOP {'is answered' if stopped else 'is not answered'}", lives and stopped and not is_alive(second))


def waits():
    """1, and 2 when the first has had time to come up."""
    yield 1
    time.sleep(5.0)
    yield 2


def attacks():
    found = {f.__name__: f for f in (goal_of_an_hour_ago, goal_of_next_year, goal_that_a_stop_has_overtaken, stop_services_are_taken, stop_services_are_withdrawn,
                                     request_within_a_request, started_from_another_folder_with_a_patient,
                                     state_folder_behind_a_link_that_leads_nowhere, second_page_of_the_same_name)}
    for requests in (("stop",), ("cancel",), ("disable",), ("disable", "enable"), ("emergency_stop", "reset_faults")):
        found[f"goal_said_again_after_{'_'.join(requests)}"] = said_again_after(*requests)
    return found
