"""Cases of the compatibility test, as tasks: the two references of a geometry, and one virtual plant on both."""
import csv
import json
import math
import pathlib
import re
import subprocess

ROOT = pathlib.Path(__file__).resolve().parents[2]
# Options of plan_excitation. The starting geometry's condition is 86 to 100 all along its vertical: nothing is gained by worse poses.
GEOMETRIES = {"final": [], "starting": ["--condition-max", "110"]}
DIRECTIONS = 51  # the number at which the condition number k is minimised and reported

# viscous (N s/m, N m s/rad) and Coulomb (N, N m)
FRICTION = "--actuator-friction 150 15 --passive-friction 0.5 0.2".split()
PRESLIDING = "--presliding 1e-5 2.5e-5".split()
SPHERICAL = "--spherical-friction 0.5 0.2".split()
PLANTS = {
    "none": ("no friction at all, encoders of 5 um", []),
    "eq23": ("Coulomb and viscous friction in the 11 joints of eq. (23), encoders of 5 um", FRICTION),
    "exact": ("the same with exact encoders", FRICTION + ["--exact-encoders"]),
    "presliding": ("as the first, friction builds up over 10 um and 25 urad (as simulation packages do)", FRICTION + PRESLIDING),
    "spherical": ("as the first, with friction in the spherical joints, which the model does not have", FRICTION + SPHERICAL),
}
MOVING_M_PER_S = 0.0005  # 5 % of the speed limit
# The training data choose the width over which friction reverses, down to nearly zero: nothing flickers here. The geometry is exact, so
# no margin of the assembly mode is needed. Positions are low-passed at three times the planned motions' highest harmonic (7 / 7 s). The plant has the URDF's inertias: as a prior they would be the truth, so they are not used.
IDENTIFY = ("--joint-friction --no-physical --narrowest-counts 0.0001 --fold-margin-m 0 --rate-hz 500 --cutoff-hz 3 --motion-cutoff-hz 3 "
            "--condition-max 150 --moving-m-per-s").split() + [str(MOVING_M_PER_S)]


class Failed(RuntimeError):
    """A program of the chain ended badly."""


def run(*command):
    done = subprocess.run([str(part) for part in command], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)
    if done.returncode != 0:
        raise Failed(f"{' '.join(str(p) for p in command)}\n{done.stderr}")
    return done.stdout


def plan(programs, robot, references, options):
    """Plans the two references of a geometry; the lines with k."""
    common = ["--robot", robot, "--velocity", "0.01", "--seconds-budget", "120", *options]
    first, second = references
    text = run(programs / "plan_excitation", *common, "--duration", "20", "--directions", DIRECTIONS, "--candidates", "200",
               "--starts", "6", "--iterations", "100", "-o", first)
    said = ["  identification: " + re.search(r"after .*", text)[0] + f" (r = {DIRECTIONS})"]
    text = run(programs / "plan_excitation", *common, "--duration", "10", "--ramp", "1.5", "--twin-legs", "--seed", "2",
               "--directions", DIRECTIONS, "-o", second)
    return said + ["  verification:   " + re.search(r"after .*", text)[0] + f" (r = {DIRECTIONS})"]


def raw_errors(prediction, recording):
    """Errors of the rows as recorded and as predicted, nothing filtered: of those at which every axis moves, and of all."""
    with open(prediction, encoding="utf-8") as p, open(recording, encoding="utf-8") as r:
        predicted, recorded = list(csv.DictReader(p)), list(csv.DictReader(r))
    moving, every = Sums(), Sums()
    for before, here, after, model in zip(recorded, recorded[1:], recorded[2:], predicted[1:]):
        time = float(after["time_s"]) - float(before["time_s"])
        speeds = [abs(float(after[f"reference_{i}_m"]) - float(before[f"reference_{i}_m"])) / time for i in (1, 2, 3, 4)]
        forces = [(float(here[f"force_{i}_N"]), float(model[f"predicted_{i}_N"])) for i in (1, 2, 3, 4)]
        every.add(forces)
        if min(speeds) >= MOVING_M_PER_S:
            moving.add(forces)
    return {**moving.result(), "share": moving.rows / len(recorded), "all": every.result()}


class Sums:
    """Of errors and forces per leg."""

    def __init__(self):
        self.squares, self.forces, self.low, self.high, self.rows = [0.0] * 4, [0.0] * 4, [math.inf] * 4, [-math.inf] * 4, 0

    def add(self, forces):
        self.rows += 1
        for i, (force, predicted) in enumerate(forces):
            self.squares[i] += (force - predicted) ** 2
            self.forces[i] += force ** 2
            self.low[i], self.high[i] = min(self.low[i], force), max(self.high[i], force)

    def result(self):
        return {"error": [math.sqrt(s / self.rows) for s in self.squares], "force": [math.sqrt(f / self.rows) for f in self.forces],
                "range": [h - l for h, l in zip(self.high, self.low)]}


def references_of(folder):
    return [pathlib.Path(folder) / "identification.txt", pathlib.Path(folder) / "verification.txt"]


def plan_geometry(programs, geometry, folder):
    """On a worker."""
    return plan(pathlib.Path(programs), ROOT / "config" / "robots" / f"{geometry}.yaml", references_of(folder), GEOMETRIES[geometry])


def play_plant(programs, geometry, plant, folder, again):
    """On a worker: moves one plant along both references (or takes an earlier run's recordings), identifies, and returns the report."""
    programs, folder, robot = pathlib.Path(programs), pathlib.Path(folder), ROOT / "config" / "robots" / f"{geometry}.yaml"
    recordings = [folder / f"{plant}_{reference.stem}.csv" for reference in references_of(folder)]
    for reference, recording in zip(references_of(folder), recordings):
        if not again:
            recording.unlink(missing_ok=True)  # of a worker that died here
            run(programs / "virtual_plant", reference, "--robot", robot, "--period", "0.001", *PLANTS[plant][1], "-o", recording)
    output = folder / plant
    run(programs / "identify", "--robot", robot, *IDENTIFY, "--train", recordings[0], "--validate", recordings[1], "--output", output)
    report = json.loads((output / "report.json").read_text())
    report["rows"] = raw_errors(output / f"prediction_{recordings[1].stem}.csv", recordings[1])
    return report
