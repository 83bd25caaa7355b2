"""One fault, once: play, inject, look on, judge by what the simulated robot really did."""
import os
import pathlib
import subprocess
import time

import numpy as np

import robot_path
import truth
from faults import CARRIED, DISABLED, DOWN, GOES_ON, SAFE_STOP, STRANDED
from recording import Recording
from session import NoAnswer, is_alive

MOVING_M_PER_S = 0.01
BEFORE_S = 0.45


class NotValid(Exception):
    """The run says nothing about the fault; the sentence says why."""


class Run:
    def __init__(self, fault, session, master, geometry, number):
        self.fault, self.session, self.master, self.geometry, self.number = fault, session, master, geometry, number
        self.injected_at = None
        self.note = self.wrong = ""
        self.recording_answer = None
        self.session_is_spent = False

    def at_injection(self):
        self.injected_at = time.monotonic()

    # ---- before

    def prepare(self):
        """Drives on, a path that begins where the robot stands, a recording; the robot moves at the end."""
        s = self.session
        now = s.truth.last()
        self.points = robot_path.movement(self.geometry, now["pose"], now["length_m"])
        if not robot_path.fits(self.geometry, self.points):  # a robot whose home is the bottom of its range
            self.climb()
            now = s.truth.last()
            self.points = robot_path.movement(self.geometry, now["pose"], now["length_m"])
        self.reference = s.references / f"path_{self.number}.txt"
        for most in (1.0, 0.7, 0.5):  # joints may have less room than legs
            self.points = robot_path.movement(self.geometry, now["pose"], now["length_m"], most)
            robot_path.write(self.reference, self.points)
            if (answer := s.load(self.reference.name)).success:
                break
        if not answer.success:
            raise NotValid(answer.message)
        before = s.truth.written()
        if not (answer := s.trigger("enable")).success:
            raise NotValid(f"enable: {answer.message}")
        self.settle(before)
        self.recording = s.recordings / f"run_{self.number}.csv"
        if self.fault.name.startswith("disk_full"):
            self.mount_small_disk()
        if not (answer := s.record(True, self.recording.name)).success:
            raise NotValid(f"record: {answer.message}")
        self.first_row = s.truth.written()
        if self.fault.at_rest:
            time.sleep(2.2)  # long enough for every axis to have been looked at
            return
        if not (answer := s.trigger("start")).success:
            raise NotValid(f"start: {answer.message}")
        time.sleep(BEFORE_S + 0.11 * (self.number % 5))

    def climb(self):
        """Up to where there is room for the movement; the robot stands there with its drives off."""
        s = self.session
        now = s.truth.last()
        way = s.references / f"climb_{self.number}.txt"
        self.points = robot_path.climb(self.geometry, now["pose"], now["length_m"])
        robot_path.write(way, self.points)
        for step in (lambda: s.load(way.name), lambda: s.trigger("enable")):
            if not (answer := step()).success:
                raise NotValid(f"climb: {answer.message}")
        self.settle(s.truth.written())
        if not (answer := s.trigger("start")).success:
            raise NotValid(f"climb: {answer.message}")
        s.wait_for(("playing", "faulted"), 2.0)
        if (state := s.wait_for(("holding", "faulted"), 10.0)).state != "holding":
            raise NotValid(f"climb: {state.state} {state.fault} {state.cause}")
        s.trigger("disable")
        if (state := s.wait_for(("disabled", "faulted"), 5.0)).state != "disabled":
            raise NotValid(f"climb: {state.state} {state.fault} {state.cause}")

    def settle(self, first_row):
        """When the brakes open, the platform sinks until the Drivers carry it: waits, and notes how far."""
        s = self.session
        end = time.monotonic() + 2.0
        at_rest_since = time.monotonic()
        while time.monotonic() < min(end, at_rest_since + 0.25):
            if np.max(np.abs(s.truth.last()["length_m"] - self.points[0])) > 5e-4:
                at_rest_since = time.monotonic()
            time.sleep(0.02)
        heights = s.truth.since(first_row)["pose"][:, 1]
        self.sag_mm = 1e3 * float(heights[0] - np.min(heights))

    def mount_small_disk(self):
        done = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=1m", "tmpfs", str(self.session.recordings)],
                              capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise NotValid(f"no small file system can be mounted here: {done.stderr.strip()}")
        self.small_disk = True

    # ---- the fault

    def execute(self):
        s = self.session
        generation = int(s.truth.last()["faults"])
        moving = s.truth.since(s.truth.written() - 20)
        speed = np.max(np.abs(moving["length_m"][-1] - moving["length_m"][0])) / (moving["time_s"][-1] - moving["time_s"][0])
        state = s.state()
        if self.fault.at_rest and state.state != "holding":
            raise NotValid(f"the robot did not hold when the fault was due: {state.state} {state.fault} {state.cause}")
        if not self.fault.at_rest and (state.state != "playing" or speed < MOVING_M_PER_S):
            raise NotValid(f"the robot did not move when the fault was due (state {state.state}, {1e3 * speed:.1f} mm/s) "
                           f"{state.fault} {state.cause}")
        self.fault.do(self)
        self.look_on()
        self.rows = s.truth.since(self.first_row)
        if self.injected_at is None:
            ordered = np.nonzero(self.rows["faults"] > generation)[0]
            if len(ordered) == 0:
                raise NotValid("the simulated robot did not see the order")
            self.injected_at = float(self.rows["monotonic_s"][ordered[0]])

    def look_on(self):
        """Until the axes have been held for a while and the state is settled, at most observe_s."""
        end = time.monotonic() + self.fault.observe_s
        held_since = None
        while time.monotonic() < end:
            time.sleep(0.02)
            if self.fault.outcome == GOES_ON:
                continue
            if not bool(truth.is_held(self.session.truth.last())):
                held_since = None
                continue
            held_since = held_since or time.monotonic()
            if time.monotonic() - held_since > 0.25:
                return

    # ---- the judgement

    def judge(self):
        rows, at = self.rows, self.injected_at
        self.final_state()
        after = rows[rows["monotonic_s"] >= at]
        before = rows[rows["monotonic_s"] < at]
        if len(after) < 50 or len(before) < 50:
            raise NotValid("the truth log does not reach from before the fault to after it")
        result = {"fault": self.fault.name, "number": self.number, "outcome": self.fault.outcome, "injected_at": at}
        # Pauses of the machine: the simulated robot has the second highest priority here.
        result["largest_pause_ms"] = 1e3 * float(np.max(np.diff(rows["monotonic_s"])))
        self.measure_stop(result, before, after)
        self.measure_excess(result, rows, after)
        self.judge_cause(result)
        self.judge_recording(result)
        if self.fault.after is not None:
            wrong = self.fault.after(self)
            self.wrong = self.wrong or (wrong or "")
        if self.fault.outcome == GOES_ON:
            self.judge_going_on(result, after)
        result["wrong"], result["note"] = self.wrong, self.note
        return result

    def measure_stop(self, result, before, after):
        at = self.injected_at
        held = truth.is_held(after)
        unpowered = (after["outputs"] & truth.POWER_BITS) != truth.POWER_BITS
        first = lambda mask: 1e3 * float(after["monotonic_s"][np.nonzero(mask)[0][0]] - at) if np.any(mask) else None
        # Held for good: the last time it became so.
        result["held_ms"] = None
        if held[-1]:
            free = np.nonzero(~held)[0]
            result["held_ms"] = 1e3 * float(after["monotonic_s"][min(len(after) - 1, free[-1] + 1) if len(free) else 0] - at)
        # With a relay the outputs may stay as they were and the power goes all the same.
        result["outputs_down_ms"] = first(unpowered) if np.any(unpowered) else first(after["drives"] == 0)
        # Carried by the drives, because a brake slips: they are on and the platform stands.
        result["carried"] = bool(self.fault.outcome == CARRIED and np.all(after["drives"][-20:] == 15)
                                 and abs(after["pose"][-1][1] - after["pose"][-200][1]) < 1e-4)
        result["drop_mm"] = 1e3 * float(before["pose"][-1][1] - np.min(after["pose"][:, 1]))
        # What brakes cannot save that are ordered in the very moment of the fault.
        soon = after[after["monotonic_s"] <= at + self.session.hold_delay_s()]
        result["least_mm"] = 1e3 * float(before["pose"][-1][1] - np.min(soon["pose"][:, 1])) if len(soon) else 0.0
        result["enable_sag_mm"] = self.sag_mm
        self.begins = [result["outputs_down_ms"]]

    def measure_excess(self, result, rows, after):
        over = np.maximum(rows["length_m"] - self.geometry.longest, self.geometry.shortest - rows["length_m"])
        result["beyond_limits_mm"] = 1e3 * max(0.0, float(np.max(over)))
        volts = np.abs(rows["volts"]) - self.geometry.clamp_V
        result["above_clamp_V"] = max(0.0, float(np.max(volts)) - 0.0049)  # the converter's step
        speed = np.diff(after["length_m"], axis=0) / np.diff(after["time_s"])[:, None]
        result["largest_speed_m_per_s"] = float(np.max(np.abs(speed)))

    def final_state(self):
        """What the controller or, when it is dead, the guardian says."""
        s = self.session
        self.state, self.cause = "none", ""
        if self.fault.outcome == DISABLED and self.fault.name.startswith("controller_"):
            try:
                s.controller.wait(10.0)  # it ends by itself, in order
            except subprocess.TimeoutExpired:
                self.wrong = "the controller did not end"
        if is_alive(s.controller) and self.fault.outcome != DOWN:
            try:
                end = time.monotonic() + 1.5
                while True:
                    answer = s.state()
                    self.state, self.cause = answer.state, answer.fault
                    self.sentence = answer.cause
                    if answer.state not in ("safe_stopping",) or time.monotonic() > end:
                        break
                    time.sleep(0.05)
            except NoAnswer as error:
                self.state, self.sentence = "does not answer", str(error)
        if self.fault.outcome == DOWN:
            time.sleep(0.05)
            said = s.log_text("guardian").splitlines()
            by_heir = [line for line in said if "hands over to the brakes" in line]
            trips = [line for line in said if "TRIPPED" in line] or by_heir
            self.state = "guardian's heir: down" if by_heir else "guardian: down" if trips else "nobody acted"
            self.sentence = trips[-1] if trips else ""
            for words in ("has died", "is silent", "has ended"):
                if words in self.sentence:
                    self.cause = words
        elif not is_alive(s.controller):
            self.state = "ended, status %d" % s.controller.returncode

    def judge_cause(self, result):
        result["state"], result["cause"], result["sentence"] = self.state, self.cause, getattr(self, "sentence", "")
        result["expected"] = list(self.fault.causes)
        good = self.cause in self.fault.causes if self.fault.causes else self.cause in ("", "none")
        if self.fault.outcome == SAFE_STOP:
            good = good and self.state == "faulted"
        if self.fault.outcome == STRANDED:
            good = good and self.state in ("faulted", "safe_stopping")
        if self.fault.outcome == CARRIED:
            good = good and self.state == "safe_stopping"
        if self.fault.outcome == DISABLED:
            good = good and self.state in ("disabled", "ended, status 0")
        result["cause_right"] = bool(good)

    def judge_going_on(self, result, after):
        """Nothing may have stopped: drives on and brakes open in every row."""
        if np.any(after["drives"] != 15) or np.any(after["holds"] != 0):
            self.wrong = self.wrong or "the robot did not go on"
        speed = np.max(np.abs(after["length_m"][-1] - after["length_m"][max(0, len(after) - 300)]))
        if speed < 1e-3 and not self.wrong:
            self.wrong = "the robot does not move any more"

    def judge_recording(self, result):
        s = self.session
        result["recording"] = ""
        if is_alive(s.controller) and self.fault.outcome != DOWN:
            try:
                answer = s.record(False)
                self.recording_answer = answer.message
                if not answer.success:
                    result["recording"] = answer.message
            except NoAnswer as error:
                result["recording"] = str(error)
        data = Recording(self.recording)
        if hasattr(self, "small_disk"):
            subprocess.run(["umount", "-l", str(s.recordings)], check=False)
        if data.problem:
            result["recording"] = data.problem
            result["stop_begins_ms"] = result["outputs_down_ms"]
            return
        result["recording_rows"], result["recording_skipped"] = data.rows, data.skipped
        offset = data.clock_offset(self.rows, self.injected_at)
        begins = [b for b in self.begins if b is not None]
        if self.fault.at_rest:
            pass  # nothing moves by which the clocks could be fitted
        elif offset is not None:
            lost = self.injected_at - (data.time[-1] + offset)
            result["recording_lost_s"] = max(0.0, float(lost))
            if lost > 1.0:
                result["recording"] = result["recording"] or f"the last {lost:.2f} s before the fault are missing"
            if begins:
                fault_at = self.injected_at - offset
                # Once the brakes are ordered to engage the reference follows the measured position.
                until = min(begins)
                left = data.leaves_path_at(self.points, fault_at, fault_at + 1e-3 * until - 0.002)
                if left is not None:
                    begins.append(1e3 * (left - fault_at))
        elif not result["recording"]:
            result["recording"] = "does not show the movement"
        result["stop_begins_ms"] = max(0.0, min(begins)) if begins else None
        leftovers = [p.name for p in pathlib.Path(s.recordings).glob("*") if p.suffix not in (".csv",) and p.is_file()]
        if leftovers:
            result["recording"] = result["recording"] or f"left behind: {leftovers}"

    # ---- after

    def recover(self):
        """True when the robot stands disabled, whole and without fault: the next run may use it."""
        s = self.session
        # Without its small disk, the controller still writes there what it had opened.
        if self.fault.fresh or self.session_is_spent or hasattr(self, "small_disk") or not s.is_whole():
            return False
        try:
            s.inject("clear")
            time.sleep(0.03)
            state = s.state()
            if state.state not in ("disabled", "faulted"):
                s.trigger("disable")
            if s.wait_for(("faulted", "disabled"), 2.0).state == "faulted" and not s.trigger("reset_faults").success:
                return False
            # A platform that has sunk or tilted far has no room left for the next movement.
            pose = np.abs(s.truth.last()["pose"] - self.geometry.home_pose)
            near = bool(np.all(pose < (0.085, 0.004, 0.105, 0.125)))
            state = s.state()
            return state.state == "disabled" and all(state.homed) and os.path.isdir(s.recordings) and near
        except (NoAnswer, RuntimeError):
            return False
