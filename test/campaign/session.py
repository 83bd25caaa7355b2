"""One robot for the campaign: master, simulated robot, guardian and controller as processes of our own, without roslaunch, and the
controller's public interface."""
import concurrent.futures
import os
import pathlib
import signal
import socket
import subprocess
import sys
import time
import xmlrpc.client

import rospy
import yaml
from std_srvs.srv import Trigger

from knee_robot.srv import GetState, LoadReference, SetRecording

import truth

ANSWER_S = 5.0
START_S = 30.0
# Of robot, servo cycle and guardian: on a virtual machine that pauses its processors one at a time, each would call the others dead.
PROCESSOR = min(os.sched_getaffinity(0))


class NoAnswer(Exception):
    """The controller did not answer; the sentence says to what."""


def free_port():
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


def is_alive(process):
    return process is not None and process.poll() is None


class Master:
    """A ROS master for the whole campaign."""

    def __init__(self, folder):
        self.folder = folder
        self.port = free_port()
        self.uri = f"http://127.0.0.1:{self.port}"
        os.environ.update(ROS_MASTER_URI=self.uri, ROS_IP="127.0.0.1", ROS_LOG_DIR=str(folder / "ros"), ROS_HOME=str(folder / "ros"))
        self.process = None
        self.start()

    def start(self):
        self.process = subprocess.Popen(["rosmaster", "--core", "-p", str(self.port)], stdout=subprocess.DEVNULL,
                                        stderr=subprocess.DEVNULL, start_new_session=True)
        end = time.monotonic() + START_S
        while time.monotonic() < end:
            try:
                xmlrpc.client.ServerProxy(self.uri).getPid("/fault_campaign")
                return
            except OSError:
                time.sleep(0.05)
        raise RuntimeError("the ROS master does not answer")

    def stop(self):
        if is_alive(self.process):
            self.process.kill()
            self.process.wait()


class Session:
    """The robot with its controller. `files`: robot, simulation, hardware, deployment; `programs`: folder of the programs."""

    def __init__(self, folder, programs, files, silence_ms, real_time, program="campaign_controller"):
        self.folder, self.programs, self.files = folder, pathlib.Path(programs), files
        self.silence_ms, self.real_time = silence_ms, real_time
        self.program = program
        self.shm = f"/knee_campaign_{os.getpid()}"
        self.on_can = "objects" in files  # drives on a simulated CAN bus instead of cards
        self.bus = f"/tmp/knee_campaign_{os.getpid()}"
        self.references, self.recordings = folder / "references", folder / "recordings"
        for one in (folder, self.references, self.recordings):
            one.mkdir(parents=True, exist_ok=True)
        self.robot = self.guardian = self.controller = None
        self.others = []
        self.parameters = {}  # of the controller, beside its own
        self.kept = {}
        self.pool = concurrent.futures.ThreadPoolExecutor(max_workers=16)
        self.environment = dict(os.environ, KNEE_CAMPAIGN_SHM=self.shm)

    # ---- processes

    def spawn(self, name, *command, environment=None, stream=None):
        """`stream`: where its output goes instead of its log."""
        log = open(self.folder / f"{name}.log", "ab")
        out = log if stream is None else stream
        process = subprocess.Popen([str(c) for c in command], stdout=out, stderr=out, env=environment or self.environment,
                                   start_new_session=True)
        log.close()
        return process

    def guardian_command(self):
        return [self.programs / "guardian", "--hardware", self.files["hardware"], "--shm", self.shm, "--can", self.bus, "--link",
                self.shm + "_guardian", "--silence-ms", self.silence_ms, "--priority", 90 if self.real_time else 0, "--cpu", PROCESSOR]

    def start_guardian(self):
        self.guardian = self.spawn("guardian", *self.guardian_command())

    def controller_command(self, name="controller", program="campaign_controller"):
        parameters = {"robot": self.files["robot"], "hardware": self.files["hardware"], "deployment": self.files["deployment"],
                      "shm": self.shm, "guardian": self.shm + "_guardian", "references": self.references, "patients": self.references,
                      "recordings": self.recordings, "can": self.bus, "master_timeout_s": 2.0, "empty": "true", "cpu": PROCESSOR, **self.parameters}
        return [self.programs / program, f"__name:={name}"] + [f"_{key}:={value}" for key, value in parameters.items()]

    def start_controller(self):
        self.controller = self.spawn("controller", *self.controller_command(program=self.program))

    def start(self):
        """Brings everything up; ends when the controller answers."""
        for heat in self.recordings.rglob("heat.yaml"):
            heat.unlink()  # a simulated robot that starts anew is cold
        for name in ("guardian.log", "controller.log", "robot.log"):
            (self.folder / name).write_bytes(b"")
        drives = ("--hardware", self.files["hardware"], "--objects", self.files["objects"], "--bus", self.bus) if self.on_can else ()
        self.robot = self.spawn("robot", self.programs / ("cia402_simulator" if self.on_can else "simulated_robot"),
                                "--robot", self.files["robot"], "--simulation", self.files["simulation"], "--shm", self.shm,
                                "--truth-rows", 40000, "--priority", 70 if self.real_time else 0, "--cpu", PROCESSOR, *drives)
        self.wait_for_file("/dev/shm" + self.shm + "_truth", self.robot)
        self.truth = truth.TruthLog(self.shm)
        self.start_guardian()
        self.start_controller()
        end = time.monotonic() + START_S
        while True:
            try:
                state = self.state()
                break
            except NoAnswer:
                if not is_alive(self.controller) or time.monotonic() > end:
                    raise RuntimeError(f"the controller did not come up, see {self.folder}/controller.log") from None
                time.sleep(0.05)
        if state.state == "faulted":
            self.trigger("reset_faults")
        if not all(state.homed):
            self.trigger("confirm_home")

    def wait_for_file(self, path, process):
        end = time.monotonic() + START_S
        while not truth.is_ready(path):
            if not is_alive(process) or time.monotonic() > end:
                raise RuntimeError(f"the simulated robot did not come up, see {self.folder}/robot.log")
            time.sleep(0.01)

    def stop(self):
        """Ends everything, the controller first and in order when it can."""
        for process in (*self.others, self.controller, self.guardian, self.robot):
            if not is_alive(process):
                continue
            process.send_signal(signal.SIGCONT)
            process.send_signal(signal.SIGTERM)
            try:
                process.wait(2.0)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
        self.end_heirs()
        self.others.clear()
        for left in (self.shm, self.shm + "_truth", self.shm + "_guardian"):
            if os.path.exists("/dev/shm" + left):
                os.unlink("/dev/shm" + left)

    def end_heirs(self):
        """The heir of a guardian that was killed while a brake slips carries the platform as long as the machine is there."""
        for process in pathlib.Path("/proc").glob("[0-9]*"):
            try:
                if (process / "comm").read_text() == "guardian_heir\n" and self.shm + "_guardian" in (process / "cmdline").read_text():
                    os.kill(int(process.name), signal.SIGKILL)
            except (FileNotFoundError, ProcessLookupError):
                pass  # ended by itself

    def hold_delay_s(self):
        """Longest time that a simulated brake takes to engage."""
        with open(self.files["simulation"], encoding="utf-8") as file:
            return max(axis.get("hold_engage_delay_s", 0.0) for axis in yaml.safe_load(file)["axes"])

    def is_whole(self):
        return all(is_alive(p) for p in (self.robot, self.guardian, self.controller))

    def inject(self, fault, axis=0, size=0.0):
        done = subprocess.run([self.programs / "inject_fault", "--shm", self.shm, "--axis", str(axis), "--size", str(size), fault],
                              capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise RuntimeError(done.stderr.strip())

    def log_text(self, name):
        path = self.folder / f"{name}.log"
        return path.read_text(errors="replace") if path.exists() else ""

    # ---- the controller's services

    def call(self, service, kind, *arguments):
        """The answer; NoAnswer when there is none in ANSWER_S (a service has no time limit of its own)."""
        proxy = self.kept.get(service) or rospy.ServiceProxy(f"/controller/{service}", kind)
        waiting = self.pool.submit(proxy, *arguments)
        try:
            return waiting.result(ANSWER_S)
        except Exception as error:  # rospy raises many kinds, all of which mean that nobody answered
            raise NoAnswer(f"{service}: {type(error).__name__} {error}") from None

    def keep_connections(self):
        """From here on these two need no master: their connections stay open."""
        for service, kind in (("get_state", GetState), ("set_recording", SetRecording)):
            self.kept[service] = rospy.ServiceProxy(f"/controller/{service}", kind, persistent=True)
        self.state()
        self.record(True, "..")  # refused

    def trigger(self, service):
        return self.call(service, Trigger)

    def state(self):
        return self.call("get_state", GetState).state

    def load(self, file, space=""):
        return self.call("load_reference", LoadReference, str(file), space)

    def record(self, on, file=""):
        return self.call("set_recording", SetRecording, on, file)

    def wait_for(self, wanted, seconds):
        end = time.monotonic() + seconds
        while True:
            state = self.state()
            if state.state in wanted or time.monotonic() > end:
                return state
            time.sleep(0.02)


def complain(sentence):
    print(f"fault_campaign: {sentence}", file=sys.stderr, flush=True)
