"""Faults in which robots' sessions ended, from the controllers' event logs: which robot stops more often than chance has it, by which fault.

A machine whose fault keeps it from recording (a brake that slips, a drive that drops out) shows in no quantity; its controller has said why.
A fault counts once a day. Its rate is that of the other robots but for the tenth of them that has it most (they may be broken in the same way),
and robots differ in it as much as those do.
"""
from __future__ import annotations

import dataclasses
import datetime
import json
import pathlib
import re
from collections.abc import Iterable

import numpy as np
import pandas as pd
from scipy import stats
from statsmodels.stats.proportion import proportion_confint

COLUMNS = ["robot", "day", "fault", "leg", "sentence"]
AXIS = re.compile(r"^axis (\d+): ")
COMPANY = 5  # robots from which on others can be left out or compared
LARGEST = 64 * 1024**2  # bytes of one robot's logs that are read


@dataclasses.dataclass(frozen=True)
class Stopped:
    """A robot that ended in one fault on `days` of its last `used` days, since `since`; `p` as if nobody had looked before."""

    robot: str
    fault: str
    leg: int
    since: pd.Timestamp
    days: int
    used: int
    low: float
    high: float
    p: float

    @property
    def statistic(self) -> float:
        """As standard deviations, to be set beside other changes."""
        return float(stats.norm.isf(max(self.p, 1e-300) / 2.0))


def read_events(path: str | pathlib.Path) -> list[tuple[datetime.date, str, int, str]]:
    """(day in UTC, fault, axis or 0, sentence) of every fault in a robot's event log: the controller's `events/controller.jsonl`, or a folder with it
    and its older files. Lines that are none (a process that died within one) are passed over. OSError."""
    path = pathlib.Path(path)
    files = sorted(path.glob("*.jsonl*")) if path.is_dir() else [path]
    out = []
    for file in files:
        with open(file, "rb") as source:
            lines = source.read(LARGEST).decode(errors="replace").splitlines()
        for line in lines:
            try:
                event = json.loads(line)
                if event["kind"] != "fault":
                    continue
                day = datetime.datetime.fromtimestamp(float(event["time"]), datetime.timezone.utc).date()
                sentence = str(event.get("answer", ""))
            except (ValueError, TypeError, KeyError, OverflowError, OSError, AttributeError, RecursionError):
                continue
            axis = AXIS.match(sentence)
            out.append((day, str(event["what"])[:60], int(axis[1]) if axis and len(axis[1]) < 3 else 0, sentence[:400]))
    return out


def faults_of(logs: Iterable[tuple[str, str]]) -> tuple[pd.DataFrame, list[tuple[str, str]]]:
    """Faults of (robot, event log), one row a robot, day, fault and leg; and (robot, sentence) of logs that cannot be read."""
    rows, unread = [], []
    for robot, path in sorted(set(logs)):
        try:
            rows += [[robot, day.isoformat(), fault, leg, sentence] for day, fault, leg, sentence in read_events(path)]
        except OSError as error:
            unread.append((robot, f"{path}: the event log cannot be read ({error.strerror or error}); this robot's faults are not watched"))
    return pd.DataFrame(rows, columns=COLUMNS).drop_duplicates(["robot", "day", "fault", "leg"], ignore_index=True), unread


def judge_faults(faults: pd.DataFrame, used: pd.DataFrame, horizon: int) -> tuple[list[Stopped], int]:
    """Every robot and fault (with its leg) that occurred, and how many were watched: robots times faults of the fleet. `used`: robot and day of
    every day on which a robot was in use without a fault."""
    if not len(faults):
        return [], 0
    in_use = pd.concat([used[["robot", "day"]], faults[["robot", "day"]]]).drop_duplicates().sort_values("day")
    recent = {robot: list(rows["day"])[-horizon:] for robot, rows in in_use.groupby("robot")}
    out = []
    kinds = list(faults.groupby(["fault", "leg"], sort=True))
    for (fault, leg), rows in kinds:
        days = {robot: sorted(set(mine["day"]) & set(recent[robot])) for robot, mine in rows.groupby("robot")}
        for robot, mine in days.items():
            if not mine:
                continue
            others = [(len(days.get(other, ())), len(recent[other])) for other in recent if other != robot]
            since = [d for d in recent[robot] if d >= mine[0]]
            low, high = proportion_confint(len(mine), len(since), alpha=0.05, method="beta")
            out.append(Stopped(str(robot), str(fault), int(leg), pd.Timestamp(mine[0]), len(mine), len(since), float(low), float(high),
                               _chance(len(mine), max(horizon, len(recent[robot])), others)))
    return out, len(kinds) * len(recent)


def _chance(count: int, horizon: int, others: list[tuple[int, int]]) -> float:
    """Probability of at least `count` days with a fault among a horizon's days (the count only grows: so on any of its nights). Beta-binomial where the
    others' counts scatter more than one common rate allows."""
    others = sorted(others, key=lambda kn: kn[0] / kn[1])[: len(others) - int(np.ceil(len(others) / 10)) if len(others) >= COMPANY else None]
    found, days = sum(k for k, _ in others), sum(n for _, n in others)
    rate = (found + 0.5) / (days + 1.0)
    if found < 3 or len(others) < COMPANY:
        return float(stats.binom.sf(count - 1, horizon, rate))
    k, n = np.array(others, dtype=float).T
    # Method of moments: the variance of counts is n r (1 - r) (1 + (n - 1) c), c the correlation of one robot's days.
    excess = float(np.sum((k - n * rate) ** 2 - n * rate * (1.0 - rate)) / max(1e-12, np.sum(n * (n - 1.0)) * rate * (1.0 - rate)))
    if excess <= 1e-4:
        return float(stats.binom.sf(count - 1, horizon, rate))
    excess = min(excess, 0.99)
    strength = 1.0 / excess - 1.0
    return float(stats.betabinom.sf(count - 1, horizon, rate * strength, (1.0 - rate) * strength))
