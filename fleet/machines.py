"""The campaign's fleet: simulated robots whose lives are drawn from their numbers, a session a week.

Everything here is the truth that nothing else of this package reads: simulated sessions leave this module as recordings only. Robots A and
B, three sets of gains, friction drawn for every leg. From day to day friction changes with the season (one hall), the robot's warmth and
each leg's mood, amplifiers by some thousandths, homing by some hundredths of a millimetre; forces have noise. On top of that, some wear,
some drift in gain, some get play between motor and screw, some carry a load that nobody declared, and most do nothing.
"""
from __future__ import annotations

import dataclasses
import datetime
import json
import math
import os
import pathlib
import re

import numpy as np
import numpy.typing as npt
import pandas as pd

from fleet.programs import ROOT, Limits, run

WEEKS = 26
FIRST_DAY = datetime.date(2026, 1, 5)
QUIET_WEEKS = 6  # nothing happens before
KINDS = ["wear"] * 10 + ["gain"] * 3 + ["play"] * 3 + ["load"] * 4 + ["none"] * 30  # of every 50 machines
GAINS = [(60000, 300000, 1500), (75000, 300000, 1600), (90000, 300000, 1800)]  # proportional, integral, derivative; softer ones stick
FRICTION = [(150.0, 15.0)] * 3 + [(400.0, 60.0)]  # N s/m, N: nominal
SEASON = (0.06, 0.02)  # amplitude over a year: viscous, Coulomb
WARMTH = (0.04, 0.02)  # standard deviation a day, all legs alike
MOOD = (0.02, 0.015)  # the same, each leg on its own
AMPLIFIER = 0.003
HOMING_M = 3e-5
NOISE_N = 0.5  # of a row of 10 ms
LIMITS = Limits(seconds=120.0)
Vector = npt.NDArray[np.float64]


@dataclasses.dataclass(frozen=True)
class Machine:
    """One robot's life. `leg` counts from 1; `size`: growth of friction, change of gain, play in m, load in kg."""

    number: int
    kind: str
    robot: str
    gains: tuple[int, int, int]
    friction: tuple[tuple[float, float], ...]
    leg: int
    onset: int
    weeks: int  # over which it grows; 0: at once
    size: float
    loaded: tuple[int, ...]

    @property
    def name(self) -> str:
        return f"robot-{self.number:03d}"

    def share(self, week: int) -> float:
        """How much of `size` is there in a week, 0 to 1."""
        return min(1.0, max(0.0, (week - self.onset + 1) / (self.weeks + 1)))


def machine(number: int, drift_free: bool = False) -> Machine:
    """The machine of a number, always the same one."""
    kinds = np.random.default_rng([17, number // len(KINDS)]).permutation(KINDS)
    draw = np.random.default_rng([18, number])
    kind = "none" if drift_free else str(kinds[number % len(KINDS)])
    friction = tuple((v * float(draw.uniform(0.7, 1.4)), c * float(draw.uniform(0.7, 1.4))) for v, c in FRICTION)
    gains, leg = GAINS[draw.integers(len(GAINS))], int(draw.integers(1, 5))
    onset, weeks = int(draw.integers(QUIET_WEEKS, WEEKS - 5)), int(draw.choice([0, 2, 4, 8]))
    size = {"wear": draw.uniform(0.2, 0.6), "gain": float(draw.choice([-1, 1])) * draw.uniform(0.05, 0.15), "play": draw.uniform(0.0005, 0.003),
            "load": draw.uniform(3.0, 8.0), "none": 0.0}[kind]
    loaded = tuple(sorted(int(w) for w in draw.choice(np.arange(QUIET_WEEKS, WEEKS), size=draw.integers(2, 5), replace=False)))
    return Machine(number, kind, "AB"[number % 2], gains, friction, leg, onset, weeks if kind in ("wear", "gain") else 0, float(size),
                   loaded if kind == "load" else ())


def day_of(number: int, week: int) -> datetime.date:
    """Sessions are on a day of the machine's own, sometimes two days late."""
    return FIRST_DAY + datetime.timedelta(days=7 * week + number % 3 + int(np.random.default_rng([19, number, week]).integers(0, 3)))


def friction_on(m: Machine, week: int) -> list[tuple[float, float]]:
    """Viscous (N s/m) and Coulomb friction (N) of every leg in a week."""
    draw = np.random.default_rng([20, m.number, week])
    season = math.sin(2 * math.pi * week / 52.0)
    warm = draw.normal()
    out = []
    for i, (viscous, coulomb) in enumerate(m.friction):
        wear = 1.0 + (m.size * m.share(week) if m.kind == "wear" and m.leg == i + 1 else 0.0)
        factors = [1.0 + SEASON[k] * season + WARMTH[k] * warm + MOOD[k] * draw.normal() for k in (0, 1)]
        out.append((viscous * wear * factors[0], coulomb * wear * factors[1]))
    return out


def effects_on(m: Machine, week: int) -> list[str]:
    """Entries of the simulation file's `effects`."""
    out = []
    if m.kind == "gain" and m.share(week) > 0:
        out.append(f"name: force_gain, actuators: [{m.leg}], factor: {1.0 + m.size * m.share(week):.6g}")
    if m.kind == "play" and m.share(week) > 0:
        out.append(f"name: backlash, actuators: [{m.leg}], width_m: {m.size:.6g}")
    if week in m.loaded:
        out.append(f"name: payload, mass_kg: {m.size:.6g}, center_m: [0.03, 0, 0.1]")
    return out


def reference_of(folder: pathlib.Path, robot: str, week: int) -> pathlib.Path:
    """Two check movements for each kind of robot, in turns."""
    return folder / "references" / f"{robot}_{week % 2 + 1}.txt"


def plan_references(programs: pathlib.Path, folder: pathlib.Path) -> None:
    """Check movements of 12 s at 0.1 m/s; kept."""
    (folder / "references").mkdir(parents=True, exist_ok=True)
    for robot in "AB":
        for which in (1, 2):
            path = folder / "references" / f"{robot}_{which}.txt"
            if path.exists():
                continue
            part = path.with_suffix(".part")
            outcome = run([programs / "plan_excitation", "--robot", ROOT / f"config/robots/{robot}.yaml", "--seed", str(which), "--velocity", "0.1",
                           "--duration", "12", "--starts", "1", "--iterations", "4", "--candidates", "30", "--seconds-budget", "1e5", "-o", part])
            if not outcome.done:
                raise RuntimeError(outcome.sentence)
            part.rename(path)


def write_session(m: Machine, week: int, programs: str, folder: str) -> str:
    """Simulates a session; path of its recording. An existing one is kept. RuntimeError when the robot could not play it."""
    root = pathlib.Path(folder)
    path = root / "recordings" / m.name / f"{m.name}_{day_of(m.number, week).isoformat()}.csv"
    if path.exists():
        return str(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    scratch = root / "scratch" / f"{m.name}-{week}-{os.getpid()}"
    scratch.mkdir(parents=True, exist_ok=True)
    try:
        raw = scratch / "raw.csv"
        raw.unlink(missing_ok=True)
        reference = reference_of(root, m.robot, week)
        outcome = run([pathlib.Path(programs) / "simulate", reference, "--robot", ROOT / f"config/robots/{m.robot}.yaml", "--simulation",
                       _simulation_file(m, week, reference, scratch), "--hardware", ROOT / "config/hardware/simulated.yaml", "--deployment",
                       _deployment_file(m, scratch), "-o", raw], LIMITS)
        if not outcome.done:
            _note_fault(path.parent / "events.jsonl", m, week, outcome.output)
            raise RuntimeError(outcome.sentence)
        part = scratch / "part.csv"
        _as_recorded(raw, m, week).to_csv(part, index=False, float_format="%.7g")
        part.replace(path)
    finally:
        for left in scratch.glob("*"):
            left.unlink()
        scratch.rmdir()
    return str(path)


def _as_recorded(raw: pathlib.Path, m: Machine, week: int) -> pd.DataFrame:
    """Rows of 10 ms with the mean force that held in them, as an ordinary recorder leaves them, with this day's homing and noise."""
    rows = pd.read_csv(raw)
    draw = np.random.default_rng([21, m.number, week])
    count = len(rows) // 10
    out = {"time_s": rows["time_s"].to_numpy()[: 10 * count: 10]}
    for i in range(1, 5):
        home, gain = HOMING_M * draw.normal(), 1.0 + AMPLIFIER * draw.normal()
        for column in ("reference", "position"):
            out[f"{column}_{i}_m"] = rows[f"{column}_{i}_m"].to_numpy()[: 10 * count: 10] + home
        force = rows[f"force_{i}_N"].to_numpy()[: 10 * count].reshape(count, 10).mean(axis=1)
        out[f"force_{i}_N"] = gain * force + NOISE_N * draw.normal(size=count)
    return pd.DataFrame(out)


def _note_fault(log: pathlib.Path, m: Machine, week: int, output: str) -> None:
    """A line in the robot's event log, as the controller's own: the fault in which the session ended."""
    named = re.findall(r"^fault: (\w+): (.*)$", output, re.M)
    noon = datetime.datetime.combine(day_of(m.number, week), datetime.time(12), datetime.timezone.utc).timestamp()
    with open(log, "a", encoding="utf-8") as lines:
        for name, sentence in named[-1:]:
            lines.write(json.dumps({"number": week, "time": noon, "kind": "fault", "who": "", "what": name, "answer": sentence}) + "\n")


def _simulation_file(m: Machine, week: int, reference: pathlib.Path, folder: pathlib.Path) -> pathlib.Path:
    first = next(line for line in reference.read_text(encoding="utf-8").splitlines() if not line.startswith("#"))
    lines = [f"start_lengths_m: [{', '.join(first.split())}]", "axes:"]
    for i, (viscous, coulomb) in enumerate(friction_on(m, week)):
        lines.append(f"  - {{viscous_N_s_per_m: {viscous:.6g}, coulomb_N: {coulomb:.6g}, rotor_mass_kg: 5.6, hold_device: brake, holding_force_N: "
                     f"{1500 if i == 3 else 1000}, hold_engage_delay_s: 0.03, hold_release_delay_s: 0.03}}")
    text = (ROOT / f"config/simulation/{m.robot}.yaml").read_text(encoding="utf-8").splitlines()
    lines += text[next(k for k, line in enumerate(text) if line.startswith("stop_margin_m")):]
    effects = effects_on(m, week)
    lines += ["effects:"] + [f"  - {{{entry}}}" for entry in effects] if effects else []
    path = folder / "simulation.yaml"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def _deployment_file(m: Machine, folder: pathlib.Path) -> pathlib.Path:
    text = (ROOT / "config/deployment/simulation.yaml").read_text(encoding="utf-8")
    for key, old, new in zip(("proportional_N_per_m", "integral_N_per_m_s", "derivative_N_s_per_m"), GAINS[0], m.gains):
        text = text.replace(f"{key}: {old}", f"{key}: {new}")
    path = folder / "deployment.yaml"
    path.write_text(text, encoding="utf-8")
    return path
