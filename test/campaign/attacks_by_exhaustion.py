"""Attacks that use something up: descriptors, threads, memory, callers that are many or say nothing. Whoever is in the machine needs that a stop
works or the robot stops by itself, and that it can be used again afterwards."""
import os
import pathlib
import re
import resource
import socket
import struct
import subprocess
import time

import numpy as np
import rosgraph
import rospy
from std_srvs.srv import Trigger

from knee_robot.msg import PlayGoal, Tracking

from attack import how_it_ended, needs, play_client, preloaded
from session import NoAnswer, is_alive

# Within half a second: test pulses for encoders move an axis by up to 0.6 mm (docs/safety.md); what plays moves 6 mm and more.
AT_REST_M = 1e-3


def service_port():
    """Of the controller, for topics and services."""
    return int(rosgraph.Master("/attacks").lookupService("/controller/get_state").rsplit(":", 1)[1].rstrip("/"))


def api_port():
    """Of the controller, for XML-RPC."""
    return int(re.search(r":(\d+)/?$", rosgraph.Master("/attacks").lookupNode("/controller")).group(1))


def header(**fields):
    """A TCPROS connection header."""
    lines = [f"{key}={value}".encode() for key, value in fields.items()]
    return struct.pack("<I", sum(4 + len(one) for one in lines)) + b"".join(struct.pack("<I", len(one)) + one for one in lines)


def connect(port):
    one = socket.create_connection(("127.0.0.1", port), timeout=2.0)
    one.settimeout(10.0)
    return one


def descriptors(process):
    return len(os.listdir(f"/proc/{process.pid}/fd"))


def fill_descriptors(a, port, room=60):
    """Connections that say nothing, until the controller has no descriptor left."""
    used = descriptors(a.session.controller)
    resource.prlimit(a.session.controller.pid, resource.RLIMIT_NOFILE, (used + room, used + room))
    silent = []
    while len(silent) < 2 * room:
        try:
            silent.append(connect(port))
        except OSError:
            break
    time.sleep(0.3)
    return silent


def asked(a, service):
    """What a new client of the controller is told, and after how many ms."""
    began = time.monotonic()
    try:
        answer = a.session.trigger(service)
    except NoAnswer:
        return f"{service} is not answered", False
    return f"{service} {'succeeded' if answer.success else 'refused'} after {1e3 * (time.monotonic() - began):.0f} ms", answer.success


def descriptors_used_up(port_of, what):
    def attack(a):
        a.enable()
        a.play()
        a.begin()
        silent = fill_descriptors(a, port_of())
        said, stopped = asked(a, "stop")
        time.sleep(4.0)
        still = bool((np.ptp(a.rows()["pose"][-500:, :2], axis=0) < AT_REST_M).all())
        for one in silent:
            one.close()
        time.sleep(1.0)
        state = a.state()
        a.begin()
        off, _ = asked(a, "disable")
        text, good = a.look(1.0)
        rests = state.startswith(("holding", "disabled"))
        return f"{said}; afterwards {state}, {off}; ", text, good and rests and still and is_alive(a.session.controller)
    attack.__doc__ = f"While playing: connections to the controller's port of {what} that say nothing, until it has no descriptor left; then stop by a new client."
    return attack


def subscribers_that_do_not_read(a):
    """While playing: a hundred subscribers of the fastest topic that never read; then stop by a new client."""
    a.enable()
    a.play()
    a.begin()
    silent = []
    for number in range(100):
        one = connect(service_port())
        one.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 2048)
        one.sendall(header(callerid=f"/silent_{number}", topic="/controller/tracking", md5sum=Tracking._md5sum, type=Tracking._type))
        silent.append(one)
    time.sleep(3.0)
    said, stopped = asked(a, "stop")
    state = a.session.wait_for(("holding",), 5.0).state
    text, good = a.disable_and_look()
    for one in silent:
        one.close()
    return f"{said}, then {state}; ", text, good and stopped and state == "holding"


def a_thousand_calls_at_once(a):
    """While playing: eight hundred requests to load a file at once; then stop by a new client, while they wait."""
    a.enable()
    path = a.write_path()
    a.play()
    callers = []
    request = struct.pack("<I", len(path.name)) + path.name.encode() + struct.pack("<I", 0)
    a.begin()
    for number in range(800):
        one = connect(service_port() if number == 0 else callers[0].getpeername()[1])
        one.sendall(header(callerid=f"/caller_{number}", service="/controller/check_reference", md5sum="*") + struct.pack("<I", len(request)) + request)
        callers.append(one)
    said, stopped = asked(a, "stop")
    state = a.session.wait_for(("holding",), 5.0).state
    text, good = a.disable_and_look()
    for one in callers:
        one.close()
    return f"{said}, then {state}; ", text, good and stopped and state == "holding"


def a_message_without_memory(a):
    """While playing: a caller announces a message of a gigabyte, for which there is no memory."""
    a.enable()
    a.play()
    with open(f"/proc/{a.session.controller.pid}/statm", encoding="ascii") as file:
        most = int(file.read().split()[0]) * 4096 + 200_000_000
    resource.prlimit(a.session.controller.pid, resource.RLIMIT_AS, (most, most))
    a.begin()
    caller = connect(service_port())
    caller.sendall(struct.pack("<I", 900_000_000))
    time.sleep(1.5)
    lives = is_alive(a.session.controller)
    if lives:
        a.session.trigger("disable")
    text, good = a.look(1.5)
    caller.close()
    return f"the controller {'lives' if lives else 'has ended'}; ", text, good


def preload(session):
    session.no_threads = session.folder / "no_threads"
    return {"LD_PRELOAD": preloaded("no_threads", session.folder), "KNEE_NO_THREADS": str(session.no_threads)}


@needs(preload=preload)
def no_thread_can_be_begun(a):
    """Holding: no thread can be begun any more; a recording, a goal that records, a fault with its black box, then disable and SIGTERM."""
    a.enable()
    path = a.write_path()
    a.session.no_threads.touch()
    a.begin()
    recorded = a.session.record(True, "r.csv")
    with play_client() as client:
        client.send_goal(PlayGoal(file=path.name, record=True, recording="goal.csv"))
        ended = client.wait_for_result(rospy.Duration(8.0))
        result = client.get_result().message if ended and client.get_result() else "no result"
    a.session.inject("hand_switch")
    text, good = a.look(1.0)
    last = a.end_controller(20.0)
    said = f"recording {'begun' if recorded.success else 'refused'}; the goal: {result[:60]}; "
    said += how_it_ended(last)
    return said, text, good and not recorded.success and ended and last is not None


@needs(preload=preload)
def no_thread_can_be_begun_and_the_master_is_restarted(a):
    """Holding: no thread can be begun any more, and another master answers."""
    a.enable()
    a.session.keep_connections()
    a.session.kept["disable"] = rospy.ServiceProxy("/controller/disable", Trigger, persistent=True)
    a.session.no_threads.touch()
    a.begin()
    a.master.stop()
    time.sleep(0.8)
    a.master.start()
    time.sleep(3.0)
    lives = is_alive(a.session.controller)
    text, good = a.look(2.0)
    return f"the controller {'lives' if lives else 'has ended'}; ", text, good


class SmallComputer:
    """A control group that has little memory left for whom it holds: the kernel ends one of them then."""

    def __init__(self, processes, left):
        root = pathlib.Path("/sys/fs/cgroup")
        old = (root / "memory").is_dir()
        self.folder = (root / "memory" if old else root) / f"knee_attack_{os.getpid()}"
        self.folder.mkdir()
        for process in processes:
            (self.folder / "cgroup.procs").write_text(str(process))
        # What they have already goes on counting where they came from.
        (self.folder / ("memory.limit_in_bytes" if old else "memory.max")).write_text(str(left))

    def spawn(self, *command):
        return subprocess.Popen(["sh", "-c", f'echo $$ > {self.folder}/cgroup.procs; exec "$@"', "sh", *command], stdout=subprocess.DEVNULL,
                                stderr=subprocess.DEVNULL)

    def end(self):
        for number in (self.folder / "cgroup.procs").read_text().split():
            (self.folder.parent / "cgroup.procs").write_text(number)
        time.sleep(0.2)
        self.folder.rmdir()


HOG = """import time
from knee_robot_operator import out_of_memory
out_of_memory.yielding(0)
kept = []
for _ in range(150):
    kept.append(bytearray(1_000_000))
    time.sleep(0.01)
time.sleep(20)"""


def memory_is_used_up_by_what_the_page_computes(a):
    """Holding; two programs as the page starts them, each smaller than the controller, take all memory that there is: whom does the kernel end?"""
    a.enable()
    a.begin()
    heir = next(int(one.name) for one in pathlib.Path("/proc").glob("[0-9]*")
                if (one / "comm").exists() and (one / "comm").read_text() == "guardian_heir\n" and a.session.shm in (one / "cmdline").read_text())
    computer = SmallComputer([a.session.controller.pid, a.session.guardian.pid, heir], 200_000_000)
    hogs = [computer.spawn("/usr/bin/python3", "-c", HOG) for _ in range(2)]
    time.sleep(4.0)
    ended = sum(not is_alive(one) for one in hogs)
    lives = [is_alive(a.session.controller), is_alive(a.session.guardian), pathlib.Path(f"/proc/{heir}").exists()]
    for one in hogs:
        one.kill()
        one.wait()
    text, good = a.disable_and_look() if lives[0] else a.look(1.0)
    computer.end()
    said = ", ".join(name for name, lived in zip(("controller", "guardian", "heir"), lives) if lived)
    return f"live: {said or 'nobody'}; of the two {ended} have ended; ", text, good and all(lives) and ended > 0


def attacks():
    found = {f"{what}_connections_use_up_the_descriptors": descriptors_used_up(port, what)
             for what, port in (("topic", service_port), ("api", api_port))}
    found.update({f.__name__: f for f in (subscribers_that_do_not_read, a_thousand_calls_at_once, a_message_without_memory, no_thread_can_be_begun,
                                          no_thread_can_be_begun_and_the_master_is_restarted, memory_is_used_up_by_what_the_page_computes)})
    return found
