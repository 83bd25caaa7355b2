"""Recordings of the injection campaign. Everything is drawn from names, so that a record is the same whenever and in whatever order
it is made. Development and judgement never share a reference, a friction or a seed."""
import hashlib
import itertools
import os
import random
import subprocess

import numpy as np

from campaign import effects

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
CONTROLLERS = [(60000, 300000, 1500), (30000, 120000, 1000), (90000, 300000, 1800), (20000, 80000, 900)]
SPEEDS = [0.1, 0.05]
REFERENCES = 8  # per robot, speed and split
SIMBODY_FRICTION = (150.0, 20.0)  # N s/m, N


# Laws of friction near rest of the split "unlike" (src/simulation/effects/near_rest_friction.cpp); the first is the plant's stiction.
NEAR_REST = [
    lambda draw: None,
    lambda draw: f"law: tanh, speed_m_per_s: {draw.choice((0.0004, 0.001, 0.002))}",
    lambda draw: f"law: rational, speed_m_per_s: {draw.choice((0.0003, 0.0008))}",
    lambda draw: f"law: lugre, distance_m: {draw.choice((5e-5, 1e-4, 2e-4)):.1e}",
    lambda draw: f"law: maxwell_slip, distance_m: {draw.choice((5e-5, 2e-4)):.1e}",
]


class Failed(Exception):
    """A program of the chain ended badly."""


class Setting:
    """A machine on two paths, the first to train on, the second to validate on, without effect: the clean record and those with effects
    share it. With `training_paths` 2 there is a third path, also to train on; all else is the same machine."""

    def __init__(self, split, number, plant="robot", training_paths=1):
        draw = random.Random(f"{split} {plant} {number}")
        self.split, self.number, self.plant = split, number, plant
        self.robot = "B" if number % 3 else "A"
        self.speed = SPEEDS[number % 2]
        self.controller = CONTROLLERS[draw.randrange(len(CONTROLLERS))] if plant == "robot" else (0, 0, 0)
        references = range(REFERENCES if plant == "robot" else 4)
        self.paths = draw.sample(references, 2)
        if training_paths == 2:
            self.paths.append(random.Random(f"{split} {plant} {number} third").choice([k for k in references if k not in self.paths]))
        self.friction = [(draw.uniform(0.7, 1.4), draw.uniform(0.7, 1.4)) for _ in range(4)]
        # The split "unlike": machines that rub near rest by laws of their own, in code that trace does not share.
        unlike = split == "unlike" and plant == "robot"
        self.near_rest = NEAR_REST[number % len(NEAR_REST)](draw) if unlike else None
        # Its controllers run on machines that do other things, too: cycles, and rows, are missing.
        self.pauses_per_minute = draw.choice((0, 10, 40)) if unlike else 0

    def name(self):
        return f"{self.split}-{self.plant}-{self.number}"

    def text(self):
        kp, ki, kd = self.controller
        return f"{self.plant} {self.robot} {self.speed} m/s P {kp} I {ki} D {kd} {self.near_rest or ''}".rstrip() + (
            f", {self.pauses_per_minute} pauses a minute" if self.pauses_per_minute else "")


def run(command, log):
    with open(log, "a", encoding="utf-8") as out:
        out.write("$ " + " ".join(command) + "\n")
        out.flush()
        if subprocess.run(command, stdout=out, stderr=out, check=False).returncode != 0:
            raise Failed(os.path.basename(command[0]))


class Workshop:
    """Makes references and recordings in a folder."""

    def __init__(self, programs, folder):
        self.programs, self.folder = programs, folder
        os.makedirs(folder, exist_ok=True)

    def program(self, name):
        return os.path.join(self.programs, name)

    def robot_file(self, setting):
        return f"{ROOT}/config/robots/{setting.robot}.yaml"

    def reference(self, setting, which):
        path = f"{self.folder}/reference-{setting.split}-{setting.robot}-{setting.speed}-{setting.paths[which]}.txt"
        if not os.path.exists(path):
            seed = int(hashlib.sha256(os.path.basename(path).encode()).hexdigest()[:6], 16)
            part = f"{path}.{os.getpid()}.{random.getrandbits(32)}"
            run([self.program("plan_excitation"), "--robot", self.robot_file(setting), "--seed", str(seed), "--velocity", str(setting.speed),
                 "--duration", "40", "--starts", "1", "--iterations", "4", "--candidates", "30", "--seconds-budget", "1e5", "-o", part],
                f"{self.folder}/references.log")
            os.replace(part, path)
        return path

    def deployment(self, setting, folder):
        with open(f"{ROOT}/config/deployment/simulation.yaml", encoding="utf-8") as source:
            text = source.read()
        for key, old, new in zip(("proportional_N_per_m", "integral_N_per_m_s", "derivative_N_s_per_m"), CONTROLLERS[0], setting.controller):
            text = text.replace(f"{key}: {old}", f"{key}: {new}")
        return write(folder + "/deployment.yaml", text)

    def simulation(self, setting, entries, folder):
        with open(f"{ROOT}/config/simulation/{setting.robot}.yaml", encoding="utf-8") as source:
            lines = source.read().split("\n")
        tail = lines[next(k for k, line in enumerate(lines) if line.startswith("stop_margin_m")):]
        axes = ["axes:"]
        for i, (viscous, coulomb) in enumerate(setting.friction):
            base = (150, 15, 1000) if i < 3 else (400, 60, 1500)
            axes.append(f"  - {{viscous_N_s_per_m: {base[0] * viscous:.6g}, coulomb_N: {base[1] * coulomb:.6g}, rotor_mass_kg: 5.6, hold_device: brake, "
                        f"holding_force_N: {base[2]}, hold_engage_delay_s: 0.03, hold_release_delay_s: 0.03}}")
        if setting.near_rest:
            entries = entries + [("near_rest_friction", setting.near_rest)]  # last: on levels that the effects have changed
        if entries:
            tail += ["effects:"] + [f"  - {{name: {name}, {text}}}" for name, text in entries]
        return write(folder + "/simulation.yaml", "\n".join(axes + tail) + "\n")

    def on_robot(self, setting, entries, folder):
        """A recording of the simulated robot on each path. Somebody pushes during the first one only. With effects, also what a robot
        without them would have needed (ideal_1.csv, ...): what the simulator took of every command for its effects is given back."""
        out = []
        for which in range(len(setting.paths)):
            path, truth = f"{folder}/path_{which + 1}.csv", f"{folder}/truth_{which + 1}.csv"
            remove(path)
            remove(truth)
            kept = [e for e in entries if which == 0 or e[0] != "external_force"]
            run([self.program("simulate"), self.reference(setting, which), "--robot", self.robot_file(setting), "--simulation",
                 self.simulation(setting, kept, folder), "--hardware", f"{ROOT}/config/hardware/simulated.yaml", "--deployment",
                 self.deployment(setting, folder), "-o", path, "--truth", truth, "--pauses-per-minute", str(setting.pauses_per_minute),
                 "--seed", str(2 * setting.number + which if which < 2 else 1000 + setting.number)], folder + "/log.txt")
            if entries:
                write_ideal(path, truth, f"{folder}/ideal_{which + 1}.csv")
            out.append(path)
        return out

    def simbody_base(self, setting, which):
        """The Simbody plant without effect; kept, because effects on it are forces in addition."""
        path = f"{self.folder}/simbody-{setting.split}-{setting.robot}-{setting.speed}-{setting.paths[which]}.csv"
        if not os.path.exists(path):
            part = f"{path}.{os.getpid()}.{random.getrandbits(32)}"
            run([self.program("virtual_plant"), self.reference(setting, which), "--robot", self.robot_file(setting), "-o", part,
                 "--actuator-friction", *map(str, SIMBODY_FRICTION), "--presliding", "2e-5", "1e-4", "--rotor-mass", "5"],
                f"{self.folder}/references.log")
            os.replace(part, path)
        return path

    def on_simbody(self, setting, entries, folder):
        """A recording of the Simbody plant on each path; `entries`: (force law, actuator from 0, size)."""
        out, first = [], None
        for which in range(len(setting.paths)):
            with open(self.simbody_base(setting, which), encoding="utf-8") as source:
                header = source.readline().strip().split(",")
            rows = np.loadtxt(self.simbody_base(setting, which), delimiter=",", skiprows=1)
            column = {name: k for k, name in enumerate(header)}
            pick = lambda kind: rows[:, [column[kind.replace("#", str(i))] for i in range(1, 5)]]
            force = pick("force_#_N")
            motion = effects.Motion(rows[:, column["time_s"]], pick("reference_#_m"), force, SIMBODY_FRICTION[1], SIMBODY_FRICTION[0], first)
            first = first or motion
            added = force.copy()
            for law, actuator, size in entries:
                added[:, actuator] += law(motion, actuator, size)
            noise = np.random.default_rng(1000 * setting.number + which).normal(0.0, 0.5, added.shape)
            keep = ["time_s"] + [f"{kind}_{i}_m" for i in range(1, 5) for kind in ("reference", "position")]
            known = rows[:, [column[name] for name in keep]]
            for name, forces in (("path", added), ("ideal", force)):
                np.savetxt(f"{folder}/{name}_{which + 1}.csv", np.column_stack([known, forces + noise]), delimiter=",", fmt="%.9g", comments="",
                           header=",".join(keep + [f"force_{i}_N" for i in range(1, 5)]))
            out.append(f"{folder}/path_{which + 1}.csv")
        return out


def read_table(path):
    with open(path, encoding="utf-8") as source:
        header = source.readline().strip().split(",")
        values = np.fromstring(source.read().replace("\n", ","), sep=",")
    return header, values.reshape(-1, len(header))


def write_ideal(recording, truth, path):
    """The recording (its times, references, positions and forces) without what effects took of the commands."""
    header, rows = read_table(recording)
    taken = read_table(truth)[1]
    at = np.clip(np.searchsorted(taken[:, 0], rows[:, header.index("time_s")] - 5e-4), 0, len(taken) - 1)
    names = ["time_s"] + [f"{kind}_{i}_{unit}" for i in range(1, 5) for kind, unit in (("reference", "m"), ("position", "m"), ("force", "N"))]
    table = rows[:, [header.index(name) for name in names]]
    table[:, 3::3] -= taken[at, 1:5]
    np.savetxt(path, table, delimiter=",", fmt="%.9g", comments="", header=",".join(names))


def low_passed_forces(recording):
    """Forces of a recording, means over tenths of a second (N): what sizes are measured on."""
    with open(recording, encoding="utf-8") as source:
        header = source.readline().strip().split(",")
        columns = [header.index("time_s")] + [header.index(f"force_{i}_N") for i in range(1, 5)]
        first, second = source.readline(), source.readline()
        period = float(second.split(",")[columns[0]]) - float(first.split(",")[columns[0]])
        every = max(1, int(round(0.01 / period)))
        rows = np.loadtxt(itertools.islice(source, 0, None, every), delimiter=",", usecols=columns)
    each = 10
    count = len(rows) // each
    return rows[:count * each, 1:].reshape(count, each, 4).mean(axis=1)


def write(path, text):
    with open(path, "w", encoding="utf-8") as out:
        out.write(text)
    return path


def remove(path):
    if os.path.exists(path):
        os.remove(path)
