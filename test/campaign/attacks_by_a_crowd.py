"""Attacks by several clients who ask for everything at once, in any order; then all are silent, and one stops the robot: what was answered holds."""
import random
import threading
import time

import numpy as np
import rospy
from std_srvs.srv import Trigger

from knee_robot.msg import PlayGoal
from knee_robot.srv import LoadPatient, LoadReference, SetRecording, SetSpeed

import robot_path
from attack import play_client
from session import NoAnswer, is_alive

PATIENT = """patient: "{name}"
pose: {{X_m: [-0.05, 0.05], Z_m: [0.5, 0.75], theta_deg: [-10, 10], psi_deg: [-10, 10]}}
speed: {{linear_mm_per_s: {fastest:g}, angular_deg_per_s: 2}}
"""
FASTEST_MM_PER_S = {"slow": 12.0, "quick": 30.0}
ROUNDS, ROUND_S = 8, 5.0
OFTEN = {"approach": 5, "start": 6, "resume": 5, "goal": 4, "speed": 4, "pause": 3, "load": 2, "enable": 2, "stop": 1, "cancel": 1, "record": 1,
         "declare_empty": 0.5, "patient": 0.5, "clear_patient": 0.3, "disable": 0.3, "guide": 0.5, "reset_faults": 0.5}
REST_S = 3.0   # from full speed, or behind the brakes
AT_REST_M = 1e-3
WINDOW_S = 0.25
SPEED_FACTOR = 1.3  # the monitor's, and some noise


def files(a):
    now = a.session.truth.last()
    for name, below in (("low.txt", 0.0), ("high.txt", 0.01)):
        x, z, theta, psi = now["pose"]
        correction = now["length_m"] - a.geometry.lengths(now["pose"])
        way = [a.geometry.lengths((x, z + below + 0.015 * np.sin(np.pi * k / 600.0) ** 2, theta, psi)) + correction for k in range(601)]
        robot_path.write(a.session.references / name, np.array(way))
    for name, fastest in FASTEST_MM_PER_S.items():
        (a.session.references / f"{name}.yaml").write_text(PATIENT.format(name=name, fastest=fastest))


def prepared(a, has_patient):
    """Holding, with a reference."""
    a.session.trigger("disable")
    a.session.trigger("reset_faults")
    a.session.wait_for(("disabled",), 5.0)
    a.session.call("load_patient", LoadPatient, "slow.yaml") if has_patient else a.session.trigger("declare_empty")
    a.session.load("low.txt")
    a.session.trigger("enable")
    a.session.call("set_speed", SetSpeed, 100.0)
    return a.session.state()


class Crowd:
    """Clients who ask at random, and what they were answered of who is on the robot."""

    def __init__(self, session, seed):
        self.session, self.seed = session, seed
        self.unanswered = 0

    def call(self, service, kind, *arguments):
        return rospy.ServiceProxy(f"/controller/{service}", kind)(*arguments).success

    def ask(self, dice, client):
        what = dice.choices(list(OFTEN), OFTEN.values())[0]
        if what == "speed":
            self.call("set_speed", SetSpeed, dice.choice((0.0, 40.0, 100.0, 100.0)))
        elif what == "load":
            self.call("load_reference", LoadReference, dice.choice(("low.txt", "high.txt")), "")
        elif what == "patient":
            self.call("load_patient", LoadPatient, dice.choice(("slow.yaml", "quick.yaml")))
        elif what == "record":
            self.call("set_recording", SetRecording, dice.random() < 0.5, f"r_{dice.randrange(10**9)}.csv")
        elif what == "goal":
            client.send_goal(PlayGoal(file=dice.choice(("low.txt", "high.txt")), enable=dice.random() < 0.5, approach=dice.random() < 0.7,
                                      approach_speed=0.02))
        elif what == "cancel":
            client.cancel_all_goals()
        else:
            self.call(what, Trigger)

    def round(self, number):
        """Until all have been answered."""
        end = time.monotonic() + ROUND_S

        def one(who):
            dice = random.Random(f"{self.seed} {number} {who}")
            with play_client() as client:
                while time.monotonic() < end:
                    try:
                        self.ask(dice, client)
                    except rospy.ServiceException:
                        self.unanswered += 1
                    time.sleep(dice.expovariate(1.0 / 0.15))
        threads = [threading.Thread(target=one, args=(who,)) for who in range(4)]
        for thread in threads:
            thread.start()
        return threads


def watch(a, threads, found):
    """What the robot says while they ask, beside what it does."""
    wrong = {}
    while any(thread.is_alive() for thread in threads):
        try:
            state = a.session.state()
        except NoAnswer as error:
            found.append(str(error))
            return
        row = a.session.truth.last()
        lies = (state.state == "holding" and row["drives"] != 15) or (state.state == "disabled" and row["drives"] != 0)
        wrong[state.state] = wrong.get(state.state, 0) + 1 if lies else 0
        if wrong[state.state] == 20:
            found.append(f"says {state.state}, drives {row['drives']}")
        time.sleep(0.02)


def fastest_of(rows):
    """mm/s of the platform's origin, in the mean over WINDOW_S."""
    step = max(1, int(round(WINDOW_S / np.median(np.diff(rows["time_s"])))))
    way = rows["pose"][step:, :2] - rows["pose"][:-step, :2]
    return 1e3 * float(np.max(np.linalg.norm(way, axis=1), initial=0.0)) / WINDOW_S


def four_clients_in_any_order(seed):
    def attack(a):
        files(a)
        crowd, found, moved_most, way = Crowd(a.session, seed), [], 0.0, 0.0
        for number in range(ROUNDS):
            before = prepared(a, number % 2 == 1)
            a.begin()
            threads = crowd.round(number)
            watch(a, threads, found)
            for thread in threads:
                thread.join()
            last = random.Random(f"{seed} {number}").choice(("stop", "stop", "disable", "emergency_stop"))
            answer = a.session.trigger(last)
            rows = a.rows()
            after = a.session.state()
            way += 1e3 * float(np.sum(np.linalg.norm(np.diff(rows["pose"][::50, :2], axis=0), axis=1)))
            time.sleep(REST_S)
            a.begin()
            time.sleep(1.0)
            moved, state = a.moved_mm(), a.session.state()
            moved_most = max(moved_most, moved)
            if moved > 1e3 * AT_REST_M or state.state not in ("holding", "disabled", "faulted"):
                found.append(f"round {number}: {last} {'succeeded' if answer.success else 'refused'} ({answer.message[:60]}), then {state.state}, "
                             f"moved {moved:.1f} mm")
            if before.patient == after.patient == "slow" and fastest_of(rows) > SPEED_FACTOR * FASTEST_MM_PER_S["quick"]:
                found.append(f"round {number}: patient {before.patient}, {fastest_of(rows):.0f} mm/s")
            if state.state == "faulted" and state.fault not in ("emergency_stop",):
                found.append(f"round {number}: {state.fault}")
            if state.state == "faulted":
                a.session.trigger("reset_faults")
        text, good = a.disable_and_look()
        lives = is_alive(a.session.controller)
        said = "; ".join(found[:4]) or f"{way:.0f} mm in all, after the last stop at most {moved_most:.1f} mm"
        return f"{said}, {crowd.unanswered} unanswered; ", text, good and lives and not found
    attack.__doc__ = f"Four clients ask for {len(OFTEN)} things at random ({ROUNDS} times {ROUND_S:g} s, seed {seed}), then one stops the robot."
    return attack


def attacks():
    return {f"four_clients_in_any_order_{seed}": four_clients_in_any_order(seed) for seed in (1, 2)}
