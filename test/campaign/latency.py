#!/usr/bin/python3
"""Timing of the product's controller beside cyclictest in the same run: scripts/latency starts it with everything built.

Lateness of a cycle is taken from the recording: time_s is when the counters were latched, on the deployment's clock, whose whole
milliseconds are the planned releases; so it holds the wake-up, the way through the first component, and the card model's latch.
CPU time is the kernel's account of the servo thread (/proc/PID/task/TID/schedstat), sampled ten times a second: the whole cycle with
its system calls, without what others took. The median is over these samples."""
import argparse
import os
import pathlib
import re
import subprocess
import sys
import threading
import time

import numpy as np
import rospy

import robot_path
from knee_robot.msg import ControllerState, Tracking
from knee_robot.srv import WatchPort
from recording import Recording
from session import Master, NoAnswer, Session

ROOT = pathlib.Path(__file__).resolve().parents[2]
PERIOD_S = 0.001
QUANTILES = (50.0, 90.0, 99.0, 99.9, 99.99, 100.0)
BEGIN, END = "<!-- latency: begin -->", "<!-- latency: end -->"


def arguments():
    p = argparse.ArgumentParser(prog="scripts/latency", description="Lateness and CPU time beside cyclictest in the same run.")
    p.add_argument("--minutes", type=float, default=1.0, help="30 for the whole claim")
    p.add_argument("--robot", default="A")
    p.add_argument("--output", default=str(ROOT / "output" / "latency"))
    p.add_argument("--silence-ms", type=float, default=100.0, help="of the guardian")
    p.add_argument("--topic-rate", type=float, default=100.0, help="Hz")
    p.add_argument("--watch", action="store_true", help="every other 10 s eight ports are watched, every value of them: what that costs")
    p.add_argument("--table", default="", help="Markdown file whose marked part gets the result")
    p.add_argument("--programs", default=str(ROOT / "build" / "devel" / "lib" / "knee_robot"), help=argparse.SUPPRESS)
    return p.parse_args()


class CpuTime:
    """CPU time of the servo thread: the one with the deployment's priority."""

    def __init__(self, pid, priority=80):
        self.samples, self.stop_ = [], False
        self.path = None
        for task in pathlib.Path(f"/proc/{pid}/task").iterdir():
            fields = (task / "stat").read_text().rsplit(")", 1)[1].split()
            if fields[37] == str(priority):  # rt_priority, field 40 of the line
                self.path = task / "schedstat"
        self.thread = threading.Thread(target=self.sample, daemon=True)

    def sample(self):
        last = None
        while not self.stop_ and self.path is not None:
            now, used = time.monotonic(), int(self.path.read_text().split()[0])
            if last is not None:
                self.samples.append((now, (used - last[1]) * 1e-9 / (now - last[0])))
            last = (now, used)
            time.sleep(0.1)

    def stop(self):
        self.stop_ = True
        self.thread.join()


def cyclictest_quantiles(text):
    """us, from the histogram of cyclictest -h; and the number of cycles."""
    counts = np.array([(int(a), int(b)) for a, b in re.findall(r"^(\d{6}) (\d{6,})", text, re.M)])
    overflow = int((re.search(r"# Histogram Overflows: (\d+)", text) or [0, "0"])[1])
    largest = int(re.search(r"# Max Latencies: (\d+)", text)[1])
    total = int(counts[:, 1].sum()) + overflow
    running = np.cumsum(counts[:, 1])
    result = []
    for q in QUANTILES:
        at = np.searchsorted(running, q / 100.0 * total)
        result.append(float(largest) if q == 100.0 or at >= len(counts) else float(counts[at, 0]))
    return result, total


def lateness_us(time_s):
    """Per cycle, us after its planned release; a cycle after skipped ones counts from the first release that was missed."""
    cycle = np.floor(time_s / PERIOD_S + 1e-9)
    late = time_s - cycle * PERIOD_S
    skipped = np.diff(cycle, prepend=cycle[0] - 1) - 1
    return 1e6 * (late + skipped * PERIOD_S), int(skipped.sum())


class Traffic:
    """Listeners of all topics and a caller of get_state, as displays are."""

    def __init__(self, session):
        self.session, self.messages, self.calls, self.stop_ = session, 0, 0, False
        count = lambda _message: setattr(self, "messages", self.messages + 1)
        self.listeners = [rospy.Subscriber("/controller/tracking", Tracking, count),
                          rospy.Subscriber("/controller/state", ControllerState, count)]
        self.thread = threading.Thread(target=self.call, daemon=True)
        self.thread.start()

    def call(self):
        while not self.stop_:
            try:
                self.session.state()
                self.calls += 1
            except NoAnswer:
                pass
            time.sleep(0.1)

    def stop(self):
        self.stop_ = True
        self.thread.join()
        for one in self.listeners:
            one.unregister()


class Watcher:
    """Watches eight ports, and does not, in turns of TURN_S."""
    TURN_S, MARGIN_S = 10.0, 1.0
    PORTS = ("AxesInput.measurement", "Driver1.command", "Driver2.command", "Driver3.command", "Driver4.command", "Supervisor.orders",
             "Monitors.verdict", "AxesOutput.written")

    def __init__(self, wanted):
        self.begin, self.messages, self.stop_ = time.monotonic(), 0, threading.Event()
        self.thread = threading.Thread(target=self.run, daemon=True)
        if wanted:
            self.thread.start()

    def run(self):
        call = rospy.ServiceProxy("/controller/watch_port", WatchPort)
        while not self.stop_.wait(self.TURN_S):
            answers = [call(port, True, 0.0) for port in self.PORTS]
            listeners = [rospy.Subscriber(answer.topic, rospy.AnyMsg, self.count) for answer in answers]
            self.stop_.wait(self.TURN_S)
            for port, listener in zip(self.PORTS, listeners):
                call(port, False, 0.0)
                listener.unregister()

    def count(self, _message):
        self.messages += 1

    def watched(self, at):
        """1, 0, or -1 near a change, for instants of time.monotonic()."""
        turn = np.floor((at - self.begin) / self.TURN_S)
        inside = at - self.begin - turn * self.TURN_S
        return np.where((inside < self.MARGIN_S) | (inside > self.TURN_S - self.MARGIN_S), -1, turn % 2)


def watching_table(watcher, cpu, late, late_at):
    """Lateness and CPU time without and with watched ports, turn about in the same run."""
    of_cpu, of_late = watcher.watched(cpu[:, 0]), watcher.watched(late_at)
    lines = [f"Eight ports watched every other {Watcher.TURN_S:.0f} s, {watcher.messages} messages:", "",
             "| | not watched | watched |", "| --- | --- | --- |"]
    rows = [("CPU time of the cycle, median us", [1e6 * PERIOD_S * np.median(cpu[of_cpu == k, 1]) for k in (0, 1)])]
    rows += [(f"lateness, {q:g} % us", [np.percentile(late[of_late == k], q) for k in (0, 1)]) for q in (50.0, 90.0, 99.0, 99.9)]
    return "\n".join(lines + [f"| {name} | {without:.1f} | {with_:.1f} |" for name, (without, with_) in rows]) + "\n"


def play_until(session, end):
    """The same path again and again."""
    geometry = robot_path.Geometry(session.files["robot"])
    now = session.truth.last()
    robot_path.write(session.references / "latency.txt", robot_path.movement(geometry, now["pose"], now["length_m"]))
    for answer in (session.load("latency.txt"), session.trigger("enable")):
        if not answer.success:
            raise RuntimeError(answer.message)
    time.sleep(1.0)
    plays = 0
    while time.monotonic() < end:
        answer = session.trigger("start")
        if not answer.success:
            raise RuntimeError(f"start: {answer.message}")
        plays += 1
        state = session.wait_for(("holding", "faulted"), min(20.0, max(0.1, end - time.monotonic())))
        if state.state == "faulted":
            raise RuntimeError(f"{state.fault}: {state.cause}")
    return plays


def render(options, ours, theirs, cpu, facts):
    lines = [f"{options.minutes:g} min, robot {options.robot}, {os.cpu_count()} processors, load average {facts['load']}; {facts['rows']} rows, "
             f"{facts['theirs']} cycles of cyclictest, {facts['messages']} messages and {facts['calls']} calls beside.", "",
             "| lateness | controller us | cyclictest us | ratio |", "| --- | --- | --- | --- |"]
    for q, a, b in zip(QUANTILES, ours, theirs):
        name = "largest" if q == 100.0 else f"{q:g} %"
        target = " (target 1.3)" if q == 99.0 else ""
        lines.append(f"| {name} | {a:.1f} | {b:.0f} | {a / b if b > 0 else float('nan'):.2f}{target} |")
    share = np.median(cpu) if len(cpu) else float("nan")
    lines += ["", f"CPU time of the full cycle (Sync, four Drivers, Supervisor, outputs, recorder): median {1e3 * share:.1f} us of 1000 us, "
              f"{100 * share:.2f} % of the period (target 3 %).", "",
              f"Rows skipped: {facts['skipped']} of {facts['rows'] + facts['skipped']} (target 0 in 30 min). {facts['answer']}.", "",
              "Timing as the controller kept it: " + facts["own"] if facts["own"] else ""]
    return "\n".join(lines).rstrip() + "\n"


def main():
    o = arguments()
    folder = pathlib.Path(o.output)
    folder.mkdir(parents=True, exist_ok=True)
    config = ROOT / "config"
    files = {"robot": config / "robots" / f"{o.robot}.yaml", "simulation": config / "simulation" / f"{o.robot}.yaml",
             "hardware": config / "hardware" / "simulated.yaml", "deployment": config / "deployment" / "simulation.yaml"}
    master = Master(folder)
    rospy.init_node("latency", anonymous=True, disable_signals=True, disable_rosout=True)
    session = Session(folder / "session", o.programs, files, o.silence_ms, real_time=True, program="controller")
    load = [os.getloadavg()[0]]
    status = 0
    try:
        session.start()
        recording = session.recordings / "latency.csv"
        recording.unlink(missing_ok=True)
        answer, recorded_from = session.record(True, recording.name), time.monotonic()
        if not answer.success:
            raise RuntimeError(answer.message)
        traffic, cpu = Traffic(session), CpuTime(session.controller.pid)
        cpu.thread.start()
        watcher = Watcher(o.watch)
        seconds = max(5, int(60 * o.minutes))
        cyclic = subprocess.Popen(["cyclictest", "-m", "-q", "-p", "80", "-i", "1000", "-h", "40000", "-D", str(seconds)],
                                  stdout=subprocess.PIPE, text=True)
        try:
            play_until(session, time.monotonic() + seconds)
        except RuntimeError as error:
            print(f"latency: the movement ended early: {error}", file=sys.stderr)
            status = 1
        text = cyclic.communicate()[0]
        watcher.stop_.set()
        cpu.stop()
        traffic.stop()
        answer = session.record(False).message
        load.append(os.getloadavg()[0])
        session.stop()
        data = Recording(recording)
        if data.problem:
            raise RuntimeError(f"{recording}: {data.problem}")
        late, skipped = lateness_us(data.time)
        ours = [float(np.percentile(late, q)) for q in QUANTILES]
        theirs, cycles = cyclictest_quantiles(text)
        facts = {"load": f"{load[0]:.1f} to {load[1]:.1f}", "rows": data.rows, "theirs": cycles, "messages": traffic.messages,
                 "calls": traffic.calls, "skipped": skipped, "answer": answer.replace(str(session.recordings) + "/", ""), "own": ""}
        result = render(o, ours, theirs, np.array(cpu.samples)[:, 1], facts)
        if o.watch:
            result += "\n" + watching_table(watcher, np.array(cpu.samples), late, recorded_from + data.time - data.time[0])
        print(result)
        recording.unlink()
        if o.table:
            path = pathlib.Path(o.table)
            content = path.read_text(encoding="utf-8") if path.exists() else f"{BEGIN}\n{END}\n"
            if BEGIN not in content or END not in content:
                raise RuntimeError(f"{path} has no lines {BEGIN} and {END}")
            path.write_text(content.split(BEGIN)[0] + BEGIN + "\n" + result + END + content.split(END)[1], encoding="utf-8")
    except RuntimeError as error:
        print(f"latency: {error}", file=sys.stderr)
        status = 1
    finally:
        session.stop()
        master.stop()
    return status


if __name__ == "__main__":
    status = main()
    sys.stdout.flush()
    os._exit(status)
