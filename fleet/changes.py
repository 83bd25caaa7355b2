"""Which machine changed, since when, in what: change points of all watched quantities of a fleet under a stated false discovery rate.

Every robot is compared with itself (days of the same movement, levels of their own) and with the fleet (what most robots of its kind did
at the same time is the season's or the hall's, and is reported as the fleet's own course). p-values count all nights of the horizon, and
the procedure of Benjamini and Yekutieli counts all robots and quantities, however they depend on each other.
"""
from __future__ import annotations

import dataclasses
import functools
from collections.abc import Iterable

import numpy as np
import numpy.typing as npt
import pandas as pd
from statsmodels.stats.multitest import multipletests

from fleet import faults, scan

Array = npt.NDArray[np.float64]
WATCHED = ("friction", "gain", "ripple", "residual", "roughness", "delay", "payload")
EXCURSIONS = ("payload",)  # what comes for a day and goes
CAUSES = {"friction": "friction", "gain": "force gain", "ripple": "ripple", "residual": "something that the model lacks", "payload": "load",
          "roughness": "play or roughness", "delay": "delay"}
COMPANY = 5  # robots of a kind from which on the fleet's course is told
NEIGHBOUR_DAYS = 10
CHANGED = 1e-3  # p-value below which a series' days do not tell what an unchanged one does
LOGARITHMS = ("residual", "roughness")  # judged as ratios; whatever changes, changes them, too
FLOOR = {"friction": 0.005, "gain": 0.003, "ripple": 0.05, "residual": 0.02, "roughness": 0.02, "delay": 2e-4, "payload": 0.05}  # scatter is at least so much


@dataclasses.dataclass(frozen=True)
class Options:
    """Of the search for changes."""

    false_discovery_rate: float = 0.05
    horizon: int = 60  # sessions of one robot that the p-values count


@dataclasses.dataclass(frozen=True)
class Series:
    """One quantity of one robot, in the order of its days."""

    robot: str
    quantity: str
    leg: int
    kind: str
    days: tuple[pd.Timestamp, ...]
    values: Array
    movements: tuple[int, ...]

    @property
    def name(self) -> str:
        return f"{self.quantity}_{self.leg}" if self.leg else self.quantity


def series_of(quantities: pd.DataFrame) -> list[Series]:
    """All watched series. Residual, roughness and ripple are taken as logarithms: they grow in proportion."""
    watched = quantities[quantities["quantity"].isin(WATCHED)].sort_values(["robot", "quantity", "leg", "day", "session"])
    out = []
    for (robot, quantity, leg), rows in watched.groupby(["robot", "quantity", "leg"], sort=True):
        values = rows["value"].to_numpy(dtype=float)
        if quantity in ("residual", "roughness"):
            values = np.log(np.maximum(values, 1e-6))
        movements, _ = pd.factorize(rows["movement"])
        out.append(Series(str(robot), str(quantity), int(leg), str(rows["kind"].iloc[0]), tuple(pd.to_datetime(rows["day"])), values,
                          tuple(int(m) for m in movements)))
    return out


def levelled(s: Series) -> Array:
    """Values less the level of their movement."""
    labels, out = np.array(s.movements), s.values.copy()
    for m in np.unique(labels):
        out[labels == m] -= np.median(out[labels == m])
    return out


def fleet_course(group: list[Series]) -> list[Array]:
    """What most robots of a kind did around each day of each series; nothing where there are too few of them."""
    if len(group) < COMPANY:
        return [np.zeros(len(s.values)) for s in group]
    days = np.concatenate([[d.toordinal() for d in s.days] for s in group])
    values = np.concatenate([levelled(s) for s in group])
    order = np.argsort(days, kind="stable")
    days, values = days[order], values[order]

    @functools.lru_cache(maxsize=None)
    def at(day: int) -> float:
        near = values[int(np.searchsorted(days, day - NEIGHBOUR_DAYS)): int(np.searchsorted(days, day + NEIGHBOUR_DAYS, side="right"))]
        return float(np.median(near)) if len(near) else 0.0

    return [np.array([at(d.toordinal()) for d in s.days]) for s in group]


def own_course(group: list[Series]) -> list[Array]:
    """Values less the fleet's course."""
    return [s.values - course for s, course in zip(group, fleet_course(group))]


def correlation_of(values: list[Array], group: list[Series]) -> float:
    """Correlation from day to day that most robots of a kind show, in fifths, not below 0."""
    found = []
    for own, s in zip(values, group):
        if len(own) < 8:
            continue
        x = own - np.convolve(np.pad(own, 4, mode="edge"), np.ones(9) / 9, mode="valid") if len(own) >= 20 else levelled(dataclasses.replace(s, values=own))
        low, high = np.percentile(x, [5, 95])
        x = np.clip(x, low, high)
        x = x - x.mean()
        if x @ x > 0:
            # The mean (a moving one of nine days, or the series' own) takes 1/9 or 1/n off the correlation.
            found.append(float(x[1:] @ x[:-1] / (x @ x)) + 1.0 / min(9, len(x)))
    if len(found) < COMPANY:
        return 0.0
    return float(np.clip(0.2 * np.round(np.median(found) / 0.2), 0.0, 0.8))


@dataclasses.dataclass(frozen=True)
class Prepared:
    """One series ready to be judged: less the fleet's course, with its scatter and that of its group."""

    series: Series
    own: Array
    sigma: float
    fleet_sigma: float


@dataclasses.dataclass
class Judged:
    """One series with its p-value and scatter."""

    series: Series
    own: Array
    sigma: float
    p: float
    statistic: float
    excursion: bool


def prepare(group: list[Series], correlation: float, values: list[Array]) -> list[Prepared]:
    """The series of one quantity and leg of one kind of robot; those with too few days are left out."""
    spreads = [scan.scatter(v[None, -scan.MEMORY:], s.movements[-scan.MEMORY:]) for v, s in zip(values, group)]
    own_sigma = np.array([spread[0][0] for spread in spreads]) / np.sqrt(1.0 - correlation)
    degrees = np.array([spread[1][0] for spread in spreads])
    known = own_sigma[np.isfinite(own_sigma)]
    if not len(known):
        return []
    floor = FLOOR[group[0].quantity]
    fleet = max(float(np.median(known)), floor)
    sigma = np.maximum(scan.moderated(own_sigma, degrees, fleet), floor)
    return [Prepared(s, v, float(width), fleet) for s, v, width, finite in zip(group, values, sigma, np.isfinite(own_sigma))
            if finite and len(v) >= scan.BEFORE + scan.AFTER]


def judge(quantity: list[list[Series]], options: Options) -> list[Judged]:
    """p-values of all series of one quantity; `quantity`: those of each leg and kind of robot. The null's days are the fleet's own, all legs and
    kinds together."""
    values = [own_course(group) for group in quantity]
    correlation = max((correlation_of(v, group) for v, group in zip(values, quantity)), default=0.0)
    ready = [p for group, v in zip(quantity, values) for p in prepare(group, correlation, v)]
    days = _quiet_days(ready, correlation, options)
    nulls: dict[int, scan.Null] = {}
    out = []
    for p in ready:
        movements = min(2, len(set(p.series.movements)))
        if movements not in nulls:
            nulls[movements] = scan.null(options.horizon, correlation, movements, days)
        out.append(_judged(p, nulls[movements], options))
    return out


def _quiet_days(ready: list[Prepared], correlation: float, options: Options) -> list[Array]:
    """Days of the fleet's series that have hardly changed, in units of the fleet's scatter."""
    first = scan.wild_null(options.horizon, correlation)
    statistic = [float(scan.statistics(p.own[None, :] / p.sigma, p.series.movements)[0]) for p in ready]
    return [scan.unexplained(p.own / p.fleet_sigma, p.series.movements) for p, value in zip(ready, statistic) if first.p(value) > CHANGED]


def _judged(ready: Prepared, null: scan.Null, options: Options) -> Judged:
    s, v, width = ready.series, ready.own, ready.sigma
    statistic = float(scan.statistics(v[None, :] / width, s.movements)[0])
    p = null.p(statistic)
    if s.quantity in LOGARITHMS:  # whatever goes on for a day is in them: they must have stood a night before, too
        before = scan.statistics(v[None, :-1] / width, s.movements[:-1])[0] if len(v) > scan.BEFORE + scan.AFTER else 0.0
        p = max(p, null.p(float(before)))
    away = _excursion(v, s)
    p_day = scan.excursion_p(away, width, options.horizon) if s.quantity in EXCURSIONS else 1.0
    both = 2.0 if s.quantity in EXCURSIONS else 1.0
    return Judged(s, v, width, min(1.0, both * min(p, p_day)), statistic if p <= p_day else abs(away) / width, p_day < p)


def _excursion(values: Array, s: Series) -> float:
    """How far the last day lies from the earlier days of its movement."""
    labels = np.array(s.movements)
    earlier = values[:-1][labels[:-1] == labels[-1]]
    return float(values[-1] - np.median(earlier)) if len(earlier) >= 3 else 0.0


def find_changes(quantities: pd.DataFrame, options: Options = Options(), stops: pd.DataFrame | None = None) -> pd.DataFrame:
    """Changes that stand tonight: one row a robot and quantity that passes, with day, interval, size and adjusted p; the first row of a robot
    names the likeliest cause. `quantities` as in the store; `stops`: faults as of faults.faults_of."""
    by_quantity: dict[str, list[list[Series]]] = {}
    for group in _groups(series_of(quantities)):
        by_quantity.setdefault(group[0].quantity, []).append(group)
    judged: list[Judged | faults.Stopped] = [j for groups in by_quantity.values() for j in judge(groups, options)]
    stopped, watched = faults.judge_faults(stops, quantities, options.horizon) if stops is not None else ([], 0)
    judged += stopped
    if not judged:
        return pd.DataFrame(columns=COLUMNS)
    chances = [j.p for j in judged] + [1.0] * (watched - len(stopped))
    passed, adjusted = multipletests(chances, alpha=options.false_discovery_rate, method="fdr_by")[:2]
    rows = [_stopped_row(j, q) if isinstance(j, faults.Stopped) else _row(j, q) for j, ok, q in zip(judged, passed, adjusted) if ok]
    table = pd.DataFrame(rows, columns=COLUMNS)
    # Whatever changes leaves a residual, too: what only says that the model lacks something must be twice as far from chance.
    telling = table["statistic"] * np.where(table["quantity"].isin(LOGARITHMS), 0.5, 1.0)
    table = table.assign(telling=telling).sort_values(["robot", "telling"], ascending=[True, False], ignore_index=True).drop(columns="telling")
    table["leading"] = ~table["robot"].duplicated()
    return table


COLUMNS = ["robot", "quantity", "leg", "cause", "form", "since", "earliest", "latest", "size", "low", "high", "unit", "statistic", "p_adjusted", "watched"]


def _row(j: Judged, adjusted: float) -> list[object]:
    s = j.series
    cause = CAUSES[s.quantity] + (f", leg {s.leg}" if s.leg else "")
    if j.excursion:
        at = len(s.days) - 1
        change = scan.Change("day", j.statistic, at, at, at, _excursion(j.own, s), j.sigma)
    else:
        change = scan.best_change(j.own, j.sigma, s.movements)
    size, low, high = change.size, change.size - 1.96 * change.size_std, change.size + 1.96 * change.size_std
    unit = {"friction": "1", "gain": "1", "ripple": "N", "delay": "s", "payload": "kg"}.get(s.quantity, "1")
    if s.quantity in LOGARITHMS:
        size, low, high = (float(np.expm1(v)) for v in (size, low, high))
    iso = [s.days[k].date().isoformat() for k in (change.first, change.earliest, change.latest)]
    return [s.robot, s.quantity, s.leg, cause, change.kind, *iso, size, low, high, unit, j.statistic, adjusted, len(s.days)]


def _stopped_row(j: faults.Stopped, adjusted: float) -> list[object]:
    """A fault's row: its size is the share of the days in use since then on which it came."""
    day = j.since.date().isoformat()
    cause = f"fault {j.fault}" + (f", axis {j.leg}" if j.leg else "")
    return [j.robot, "fault", j.leg, cause, "days", day, day, day, j.days / j.used, j.low, j.high, "1", j.statistic, adjusted, j.used]


def _groups(series: Iterable[Series]) -> list[list[Series]]:
    """Series that are compared with each other: one quantity and leg of one kind of robot."""
    groups: dict[tuple[str, str, int], list[Series]] = {}
    for s in series:
        groups.setdefault((s.kind, s.quantity, s.leg), []).append(s)
    return [groups[key] for key in sorted(groups)]


def nights(quantities: pd.DataFrame, dates: Iterable[pd.Timestamp], options: Options = Options(), stops: pd.DataFrame | None = None) -> pd.DataFrame:
    """What would have been found night by night: `find_changes` of what was known then, with its `night`."""
    found = []
    days = pd.to_datetime(quantities["day"])
    for night in dates:
        known = stops[pd.to_datetime(stops["day"]) <= night] if stops is not None else None
        table = find_changes(quantities[days <= night], options, known)
        table["night"] = night
        found.append(table)
    return pd.concat(found, ignore_index=True) if found else pd.DataFrame(columns=[*COLUMNS, "leading", "night"])


def population(quantities: pd.DataFrame) -> pd.DataFrame:
    """How each robot's latest level lies among the robots of its kind, in robust standard deviations, and how the fleet moved: one row a robot
    and quantity with `deviation`; robot "fleet" has the change of the fleet's course between the first and the last fifth of its days."""
    rows = []
    for group in _groups(series_of(quantities)):
        latest = np.array([np.median(s.values[-4:]) for s in group])
        spread = float(np.median(np.abs(latest - np.median(latest)))) / 0.6745
        if len(group) >= COMPANY and spread > 0:
            for s, value in zip(group, latest):
                rows.append([s.kind, s.robot, s.quantity, s.leg, float((value - np.median(latest)) / max(spread, FLOOR[s.quantity]))])
            courses = fleet_course(group)
            change = [float(np.median(c[-max(1, len(c) // 5):]) - np.median(c[: max(1, len(c) // 5)])) for c in courses]
            rows.append([group[0].kind, "fleet", group[0].quantity, group[0].leg, float(np.median(change))])
    return pd.DataFrame(rows, columns=["kind", "robot", "quantity", "leg", "deviation"])
