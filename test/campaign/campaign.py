#!/usr/bin/python3
"""The fault campaign: scripts/fault_campaign starts it with everything built and the ROS environment set."""
import argparse
import json
import os
import pathlib
import signal
import subprocess
import sys
import time

import rospy
import yaml

from faults import all_faults
from robot_path import Geometry
from run import NotValid, Run
from session import Master, NoAnswer, Session, complain
from table import render

ROOT = pathlib.Path(__file__).resolve().parents[2]
ATTEMPTS = 3
BEGIN, END = "<!-- fault_campaign: begin -->", "<!-- fault_campaign: end -->"


def arguments():
    p = argparse.ArgumentParser(prog="scripts/fault_campaign", description="Named faults during motion, judged by the simulated robot.")
    p.add_argument("--repeat", type=int, default=1, help="runs of each fault")
    p.add_argument("--only", default="", help="names, comma-separated; a name that ends in * stands for all that begin so")
    p.add_argument("--list", action="store_true", help="print the names and end")
    p.add_argument("--fresh", action="store_true", help="forget earlier results; otherwise what is done is not repeated")
    p.add_argument("--table", default="", help="Markdown file whose marked part gets the table")
    p.add_argument("--output", default=str(ROOT / "output" / "fault_campaign"))
    p.add_argument("--payload", type=float, default=15.0, help="kg")
    p.add_argument("--robot", default="A", help="of config/robots")
    p.add_argument("--hardware", default="simulated", help="of config/hardware; cards: its delays, homing and start, on the simulated robot")
    p.add_argument("--silence-ms", type=float, default=10.0, help="of the guardian")
    p.add_argument("--minutes", type=float, default=0.0, help="begin no further fault after so long; 0: no limit")
    p.add_argument("--programs", default=str(ROOT / "build" / "devel" / "lib" / "knee_robot"), help=argparse.SUPPRESS)
    return p.parse_args()


def chosen(names):
    faults = all_faults()
    wanted = [n for n in names.split(",") if n]
    if not wanted:
        return faults
    matches = lambda f: any(f.name == n or (n.endswith("*") and f.name.startswith(n[:-1])) for n in wanted)
    found = [f for f in faults if matches(f)]
    if not found:
        sys.exit(f"fault_campaign: no fault is called {names}; --list prints all names")
    return found


class Campaign:
    def __init__(self, options):
        self.options = options
        self.folder = pathlib.Path(options.output)
        self.folder.mkdir(parents=True, exist_ok=True)
        self.results_file = self.folder / "results.jsonl"
        if options.fresh and self.results_file.exists():
            self.results_file.unlink()
        self.master = Master(self.folder)
        rospy.init_node("fault_campaign", anonymous=True, disable_signals=True, disable_rosout=True)
        self.session = self.session_key = None
        self.number = 0
        self.robot_file = ROOT / "config" / "robots" / f"{options.robot}.yaml"
        self.geometry = Geometry(self.robot_file)

    def results(self):
        if not self.results_file.exists():
            return []
        return [json.loads(line) for line in self.results_file.read_text().splitlines() if line]

    def simulation_file(self, changes):
        with open(ROOT / "config" / "simulation" / f"{self.options.robot}.yaml", encoding="utf-8") as file:
            content = yaml.safe_load(file)
        if self.options.payload > 0:
            content["payload"] = {"mass_kg": self.options.payload, "center_m": [0, 0, 0.1], "radius_of_gyration_m": 0.1}
        self.hold_delays(content)
        content.update(changes)
        path = self.folder / f"simulation_{abs(hash(json.dumps(changes, sort_keys=True))) % 10**8}.yaml"
        path.write_text(yaml.safe_dump(content))
        return path

    def hardware_file(self, changes=None):
        """What the controller is told of the machine, with the simulated robot behind it whatever the file's cards are."""
        path = ROOT / "config" / "hardware" / f"{self.options.hardware}.yaml"
        content = yaml.safe_load(path.read_text(encoding="utf-8"))
        if content["backend"] == "simulated" and not changes:
            return path
        content["backend"] = "simulated"
        content.pop("cards", None)
        content.update(changes or {})
        here = self.folder / f"{self.options.hardware}_simulated{'_changed' if changes else ''}.yaml"
        here.write_text(yaml.safe_dump(content))
        return here

    def hold_delays(self, content):
        """The simulated brakes take as long as the hardware file says."""
        told = yaml.safe_load(self.hardware_file().read_text(encoding="utf-8"))["axes"]
        for k, axis in enumerate(content["axes"]):
            delay = told[min(k, len(told) - 1)]["hold_delay_s"]
            axis.update(hold_engage_delay_s=delay, hold_release_delay_s=delay)

    def session_for(self, fault):
        key = json.dumps([fault.simulation, fault.hardware, fault.on_can])
        if self.session is not None and self.session_key == key and self.session.is_whole():
            return self.session
        self.end_session()
        config = ROOT / "config"
        files = {"robot": self.robot_file, "simulation": self.simulation_file(fault.simulation),
                 "hardware": self.hardware_file(fault.hardware), "deployment": config / "deployment" / "simulation.yaml"}
        if fault.on_can:
            files.update(hardware=config / "hardware" / "can_simulated.yaml", deployment=config / "deployment" / "can.yaml",
                         objects=config / "hardware" / "can_objects.yaml")
        self.session = Session(self.folder / "session", self.options.programs, files, self.options.silence_ms,
                               real_time=os.geteuid() == 0)
        self.session_key = key
        self.session.start()
        self.geometry.home_pose = self.session.truth.last()["pose"]
        return self.session

    def end_session(self):
        if self.session is not None:
            self.session.stop()
        self.session = None

    def one(self, fault):
        """The result of a valid run, or None."""
        for _ in range(ATTEMPTS):
            self.number += 1
            run = None
            try:
                session = self.session_for(fault)
                run = Run(fault, session, self.master, self.geometry, self.number)
                run.prepare()
                run.execute()
                result = run.judge()
                result["load_average"] = os.getloadavg()[0]
            except (NotValid, NoAnswer, RuntimeError) as error:
                complain(f"{fault.name}: run {self.number} is not valid: {error}")
                if self.session is not None:
                    self.keep_logs(fault)
                self.abandon(run)
                continue
            if not result["cause_right"] or result["wrong"] or result["recording"]:
                self.keep_logs(fault)
            if not run.recover():
                self.end_session()
            if run.recording.exists():
                run.recording.unlink()
            return result
        return None

    def abandon(self, run):
        if run is not None and hasattr(run, "small_disk"):
            subprocess.run(["umount", "-l", str(self.session.recordings)], check=False)
        self.end_session()
        if self.master.process.poll() is not None:
            self.master.start()

    def keep_logs(self, fault):
        target = self.folder / "logs"
        target.mkdir(exist_ok=True)
        for name in ("controller", "guardian", "robot"):
            (target / f"{fault.name}.{name}.log").write_text(self.session.log_text(name))

    def execute(self, faults):
        started = time.monotonic()
        done = {}
        for r in self.results():
            done[r["fault"]] = done.get(r["fault"], 0) + 1
        try:
            for fault in faults:
                for _ in range(done.get(fault.name, 0), self.options.repeat):
                    if self.options.minutes > 0 and time.monotonic() - started > 60 * self.options.minutes:
                        return
                    result = self.one(fault)
                    if result is None:
                        print(f"{fault.name:44} no valid run", flush=True)
                        continue
                    with open(self.results_file, "a", encoding="utf-8") as file:
                        file.write(json.dumps(result) + "\n")
                    print(sentence(result), flush=True)
        finally:
            self.end_session()
            self.master.stop()


def sentence(r):
    ms = lambda v: "never" if v is None else f"{v:.1f}"
    text = (f"{r['fault']:44} begins {ms(r['stop_begins_ms']):>6} held {ms(r['held_ms']):>7} ms  drop {r['drop_mm']:6.2f} mm  "
            f"{r['state']}, {r['cause'] or 'no fault'}{'' if r['cause_right'] else '  WRONG CAUSE'}")
    for key in ("recording", "wrong"):
        if r[key]:
            text += f"  {key.upper()}: {r[key][:160]}"
    return text


def write_table(path, text):
    path = pathlib.Path(path)
    content = path.read_text(encoding="utf-8") if path.exists() else f"{BEGIN}\n{END}\n"
    if BEGIN not in content or END not in content:
        sys.exit(f"fault_campaign: {path} has no lines {BEGIN} and {END}")
    head, tail = content.split(BEGIN)[0], content.split(END)[1]
    path.write_text(head + BEGIN + "\n" + text + END + tail, encoding="utf-8")


def main():
    options = arguments()
    faults = chosen(options.only)
    if options.list:
        for fault in faults:
            print(f"{fault.name:44} {fault.outcome:28} {', '.join(fault.causes)}")
        return 0
    campaign = Campaign(options)
    # Whoever ends this from outside must not leave a controller behind that holds a robot.
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))
    started = time.monotonic()
    campaign.execute(faults)
    results = campaign.results()
    loads = [r["load_average"] for r in results] or [0.0]
    conditions = (f"Robot {options.robot}, hardware file {options.hardware}, {options.payload:g} kg, guardian's silence {options.silence_ms:g} ms, {os.cpu_count()} processors, "
                  f"load average {min(loads):.1f} to {max(loads):.1f}.")
    text = render(results, conditions)
    print("\n" + text)
    print(f"{time.monotonic() - started:.0f} s")
    if options.table:
        write_table(options.table, text)
    return 0


if __name__ == "__main__":
    status = main()
    sys.stdout.flush()
    os._exit(status)  # threads that wait for a dead controller's answer would hold the interpreter
