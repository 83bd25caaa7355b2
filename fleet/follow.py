"""What a recording says about a machine whose model of the first day is known: friction and gain of each leg, ripple, delay, load, residual.

The first day's model keeps its structure; a later day may differ from it in few, physical ways. The columns of these ways are differences of
predictions: `predict` is run with the model and with the model whose one kind of parameter is changed by one unit, so that geometry, filters
and friction's memory are the program's own. A ridge (what a change may plausibly be, against blocks of independent samples) keeps directions
that a short movement does not tell at the first day's value; without it delay, gain and friction ran away together. What the model gets wrong
repeats with the movement: values are compared between days of the same movement only (changes.py).
"""
from __future__ import annotations

import dataclasses
import hashlib
import pathlib
import re

import numpy as np
import numpy.typing as npt
import pandas as pd
import yaml
from scipy.signal import butter, sosfiltfilt
from statsmodels.robust.norms import HuberT

from fleet.programs import Limits, run

Array = npt.NDArray[np.float64]
INDEPENDENT_S = 0.3  # samples nearer than this say the same
STEEP = 5.0  # times the usual force that a kilogram on the platform takes: nearer to a singular pose nothing is believed
PASSES = 4  # of reweighting what lies far from the rest
MOTION_HZ = 6.0  # low-pass of positions before their speed is taken
EDGE_S = 0.3  # left out at both ends, where the low-pass reaches beyond
ENTRY = re.compile(r'^(\s*- \{name: "([^"]+)", unit: "[^"]*", value: )([-+0-9.eE]+)(.*)$')
PAYLOAD = ("m_M", "mX_M", "mZ_M")
# Standard deviations of what may plausibly change: share of friction, share of force, N, ripple in N, s, kg, kg m, kg m.
PRIOR = {"friction": 0.5, "gain": 0.2, "offset": 5.0, "ripple_sine": 10.0, "ripple_cosine": 10.0, "delay": 0.005, "m_M": 5.0, "mX_M": 1.0, "mZ_M": 1.0}
UNITS = {"friction": "1", "gain": "1", "offset": "N", "ripple": "N", "residual": "N", "roughness": "N", "delay": "s", "payload": "kg"}


class Unusable(ValueError):
    """A recording or a model that cannot be followed; the text says why. `final`: the same input would fail again."""

    def __init__(self, text: str, final: bool = True) -> None:
        super().__init__(text)
        self.final = final


@dataclasses.dataclass(frozen=True)
class Quantity:
    """One number of one day. `leg` is 0 for what belongs to the whole robot; `std` rests on this recording's blocks alone."""

    name: str
    leg: int
    value: float
    std: float
    unit: str


@dataclasses.dataclass(frozen=True)
class RobotFacts:
    """What following needs of a robot file."""

    axes: int
    leads_m: tuple[float, ...]
    parallel: bool


def read_robot(path: str | pathlib.Path) -> RobotFacts:
    """The robot file's number of axes and screw leads. Unusable when it is no robot file."""
    try:
        content = yaml.safe_load(pathlib.Path(path).read_text(encoding="utf-8"))
        actuators = content["actuators"]
        parallel = content.get("mechanism", "3UPS+1RPU") == "3UPS+1RPU"
        if parallel and len(actuators) == 1:
            actuators = actuators * 4
        return RobotFacts(len(actuators), tuple(float(a["screw_lead_m"]) for a in actuators), parallel)
    except (yaml.YAMLError, KeyError, TypeError, ValueError) as error:
        raise Unusable(f"{path}: not a robot file that can be followed ({' '.join(str(error).split())})") from error


def changed_model(text: str, names: list[str], by: float) -> str:
    """A model file whose named parameters are larger by `by`. Unusable when one is not there."""
    lines, seen = [], set()
    for line in text.split("\n"):
        entry = ENTRY.match(line)
        if entry and entry[2] in names:
            seen.add(entry[2])
            line = f"{entry[1]}{float(entry[3]) + by!r}{entry[4]}"
        lines.append(line)
    if seen != set(names):
        raise Unusable(f"the first day's model has no parameter {', '.join(sorted(set(names) - seen))}")
    return "\n".join(lines)


def parameters(text: str) -> dict[str, float]:
    """Names and values of a model file's parameters."""
    return {m[2]: float(m[3]) for m in map(ENTRY.match, text.split("\n")) if m}


def movement_of(recording: pd.DataFrame, axes: int) -> str:
    """A name for the path that was commanded, the same for every recording of one reference whenever it starts and however it was homed: from
    each axis' travel, in steps of 2 mm. Recordings without references share one."""
    names = [f"reference_{i}_m" for i in range(1, axes + 1)]
    if not set(names) <= set(recording.columns) or len(recording) < 2:
        return "unknown"
    travel = np.ptp(recording[names].to_numpy(), axis=0)
    return hashlib.sha256(np.round(travel / 0.002).astype(int).tobytes()).hexdigest()[:8]


class Predictor:
    """Predictions of one recording by the first day's model and by changed ones."""

    def __init__(self, programs: pathlib.Path, robot: str, model: str, recording: str, folder: pathlib.Path, limits: Limits) -> None:
        self._programs, self._robot, self._recording, self._folder, self._limits = programs, robot, recording, folder, limits
        self.text = pathlib.Path(model).read_text(encoding="utf-8")
        self.processor_s = 0.0
        self.base = self._table(self.text)

    def _table(self, text: str) -> pd.DataFrame:
        model = self._folder / "changed.yaml"
        model.write_text(text, encoding="utf-8")
        outcome = run([self._programs / "predict", "--robot", self._robot, "--model", model, "--output", self._folder / "out", self._recording], self._limits)
        self.processor_s += outcome.processor_s
        if not outcome.done:
            raise Unusable(outcome.sentence, outcome.final)
        return pd.read_csv(self._folder / "out" / f"prediction_{pathlib.Path(self._recording).stem}.csv")

    def forces(self, kind: str, table: pd.DataFrame | None = None) -> Array:
        """`force` or `predicted`, rows x axes, N."""
        table = self.base if table is None else table
        columns = sorted(c for c in table.columns if re.fullmatch(rf"{kind}_\d+_N", c))
        return np.asarray(table[columns].to_numpy(), dtype=float)

    def slope(self, names: list[str]) -> Array:
        """Change of the predicted forces per unit of the named parameters, all changed together."""
        return self.forces("predicted", self._table(changed_model(self.text, names, 1.0))) - self.forces("predicted")


def follow(programs: pathlib.Path, robot: str, model: str, recording: str, folder: pathlib.Path, limits: Limits = Limits()) -> tuple[list[Quantity], str, float]:
    """Quantities of one recording, its movement, and the processor time that the programs took (s). `folder` is for scratch files."""
    facts = read_robot(robot)
    predictor = Predictor(programs, robot, model, recording, folder, limits)
    rows = pd.read_csv(recording)
    lacking = [f"position_{i}_m" for i in range(1, facts.axes + 1) if f"position_{i}_m" not in rows.columns]
    if lacking:
        raise Unusable(f"{recording}: has no column {', '.join(lacking)}")
    values = parameters(predictor.text)
    friction = _friction(predictor, values, facts)
    position = rows[[f"position_{i}_m" for i in range(1, facts.axes + 1)]].to_numpy()
    time_s = predictor.base["time_s"].to_numpy()
    predicted = predictor.forces("predicted")
    if len(position) != len(predicted) or len(time_s) < 100:
        raise Unusable(f"{recording}: {len(time_s)} rows are too few to follow (100)")
    rate = 1.0 / float(np.median(np.diff(time_s)))
    loads = [predictor.slope([name]) for name in PAYLOAD] if facts.parallel else []
    columns = _columns(friction, predicted, position, loads, facts, rate)
    usable = _away_from_singular(loads, len(predicted))[:, None] & _moving(position, predictor.text, rate)
    quantities = _estimate(predictor.forces("force") - predicted, columns, usable, _noise(predictor.text, facts.axes), _cutoff(predictor.text), rate)
    return quantities, movement_of(rows, facts.axes), predictor.processor_s


def _friction(predictor: Predictor, values: dict[str, float], facts: RobotFacts) -> Array:
    """Friction force that the first day's model predicts, rows x axes."""
    names = [n for n in values if n.startswith("Fc_")], [n for n in values if n.startswith("Fv_")]
    if any(len(group) < facts.axes for group in names):
        raise Unusable("the first day's model has no friction of each actuator")
    per_leg = [group[: facts.axes] for group in names]
    # One run for all legs of a kind: a leg's friction appears in its own force only.
    slopes = [predictor.slope(group) for group in per_leg]
    return np.asarray(sum(s * np.array([max(values[n], 1e-9) for n in group]) for s, group in zip(slopes, per_leg)))


def _columns(friction: Array, predicted: Array, position: Array, loads: list[Array], facts: RobotFacts, rate: float) -> dict[tuple[str, int], Array]:
    """(name, leg) -> rows x axes: what one unit of it does to the forces."""
    phase = 2.0 * np.pi * position / np.array(facts.leads_m)
    own = {"friction": friction, "gain": predicted, "offset": np.ones_like(predicted), "ripple_sine": np.sin(phase), "ripple_cosine": np.cos(phase)}
    out: dict[tuple[str, int], Array] = {}
    for name, column in own.items():
        for leg in range(facts.axes):
            out[name, leg + 1] = column * (np.arange(facts.axes) == leg)
    # An actuator that acts later is commanded earlier.
    out["delay", 0] = np.gradient(predicted, 1.0 / rate, axis=0)
    for name, load in zip(PAYLOAD, loads):
        out[name, 0] = load
    return out


def _away_from_singular(loads: list[Array], rows: int) -> npt.NDArray[np.bool_]:
    """Rows at which the platform's weight is carried as usual."""
    if not loads:
        return np.ones(rows, dtype=bool)
    weight = np.abs(loads[0]).max(axis=1)
    return np.asarray(weight <= STEEP * np.median(weight))


def _moving(position: Array, text: str, rate: float) -> npt.NDArray[np.bool_]:
    """Rows x axes at which an axis moves: a force at rest is whatever friction allows."""
    found = re.search(r"^moving_m_per_s: (.*)$", text, re.M)
    speed = np.gradient(sosfiltfilt(butter(2, MOTION_HZ, fs=rate, output="sos"), position, axis=0), 1.0 / rate, axis=0)
    return np.asarray(np.abs(speed) > (float(found[1]) if found else 0.0015))


def _noise(text: str, axes: int) -> Array:
    """The first day's own residual: what the forces are weighted by, N."""
    found = re.search(r"^residual_rms_N: (\[.*\])$", text, re.M)
    values = np.array(yaml.safe_load(found[1])) if found else np.ones(axes)
    return np.maximum(values, 0.1)


def _cutoff(text: str) -> float:
    found = re.search(r"^cutoff_hz: (.*)$", text, re.M)
    return min(3.0, float(found[1])) if found else 3.0


def _estimate(residual: Array, columns: dict[tuple[str, int], Array], usable: npt.NDArray[np.bool_], noise: Array, cutoff: float,
              rate: float) -> list[Quantity]:
    low = butter(2, cutoff, fs=rate, output="sos")
    smooth = sosfiltfilt(low, residual, axis=0)
    edge = max(1, int(EDGE_S * rate))
    keep = usable[edge:-edge]
    y = np.where(keep, smooth[edge:-edge] / noise, 0.0)
    x = np.stack([np.where(keep, sosfiltfilt(low, c, axis=0)[edge:-edge] / noise, 0.0) for c in columns.values()], axis=-1)
    if keep.sum(axis=0).min() < 50 or not np.isfinite(x).all() or not np.isfinite(y).all():
        raise Unusable("too few rows in motion away from singular poses, or forces or predictions that are not finite")
    value, std = _ridge(x, y, keep, np.array([PRIOR[name] for name, _ in columns]), max(1, int(INDEPENDENT_S * rate)))
    by = {key: (float(v), float(s)) for key, v, s in zip(columns, value, std)}
    return _quantities(by, (y - x @ value) * noise, (residual - smooth)[edge:-edge], keep, INDEPENDENT_S * rate)


def _ridge(x: Array, y: Array, keep: npt.NDArray[np.bool_], prior: Array, block: int) -> tuple[Array, Array]:
    """Most probable change and its standard error: Huber's weights, and errors from blocks of all legs together, so that what goes on for a
    block counts once."""
    rows, axes, count = x.shape
    a, norm, weight, used = x.reshape(rows * axes, count), HuberT(), np.ones(rows * axes), keep.reshape(-1)
    for _ in range(PASSES):
        weighted = a * weight[:, None]
        inverse = np.linalg.inv(a.T @ weighted / block + np.diag(prior**-2.0))
        value = inverse @ (weighted.T @ y.reshape(-1)) / block
        left = y.reshape(-1) - a @ value
        weight = norm.weights(left / max(1e-9, float(np.median(np.abs(left[used]))) / 0.6745))
    starts = np.arange(0, rows, 2 * block)
    scores = np.add.reduceat(np.einsum("tac,ta->tc", x, (weight * left).reshape(rows, axes)), starts, axis=0) / block
    return value, np.sqrt(np.diag(inverse @ (scores.T @ scores) @ inverse))


def _quantities(by: dict[tuple[str, int], tuple[float, float]], left: Array, rough: Array, keep: npt.NDArray[np.bool_], block: float) -> list[Quantity]:
    axes = left.shape[1]
    out = [Quantity(name, leg, *by[name, leg], UNITS[name]) for name in ("friction", "gain", "offset") for leg in range(1, axes + 1)]
    out.append(Quantity("delay", 0, *by["delay", 0], UNITS["delay"]))
    if ("m_M", 0) in by:
        out.append(Quantity("payload", 0, *by["m_M", 0], UNITS["payload"]))
    for leg in range(1, axes + 1):
        (s, s_std), (c, c_std) = by["ripple_sine", leg], by["ripple_cosine", leg]
        out.append(Quantity("ripple", leg, float(np.hypot(s, c)), float(np.hypot(s_std, c_std)), UNITS["ripple"]))
        moving = keep[:, leg - 1]
        for name, rest in (("residual", left), ("roughness", rough)):
            rms = float(np.sqrt(np.mean(rest[moving, leg - 1] ** 2)))
            out.append(Quantity(name, leg, rms, rms / np.sqrt(2.0 * max(1.0, moving.sum() / block)), UNITS[name]))
    return out
