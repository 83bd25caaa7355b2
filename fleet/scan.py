"""Has a series of days changed, and since when? A scan over steps and growths, with the null of a whole year of nightly looks.

A series is one quantity of one robot, divided by its scatter from day to day. Every night the scan asks for the best step (another level
since some day) and the best growth (a straight line since some day) beside a level of its own for every movement. Its p-value is the
probability that an unchanged series reaches that value on any of the nights of the horizon, so that looking every night costs nothing more.
The null is drawn with the same scatter estimate, the same correlation from day to day, and days as wild as the fleet's own.
"""
from __future__ import annotations

import functools
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy import optimize, stats

Array = npt.NDArray[np.float64]
BEFORE, AFTER = 4, 2  # days needed on either side of a change
MEMORY = 60  # days that a scan looks back
PRIOR_DEGREES = 8.0  # weight of the fleet's scatter against a robot's own, in days
CLIP = 5.0  # standard deviations: a single wild day must not be a change
WINDOW = 5  # days of one movement around a day
DRAWS = 5000
TAIL = 0.97  # quantile from which the null is continued by a normal tail of its own width
NIGHTS = 40  # looked at while the null is drawn, of a longer horizon
ENOUGH_SERIES = 20  # of one quantity, from which on the fleet's own days make its null


class Change(NamedTuple):
    """Best explanation of one series by a change. `first` and its interval are indices of days; sizes in the series' own unit."""

    kind: str  # step or growth
    statistic: float
    first: int
    earliest: int
    latest: int
    size: float
    size_std: float


@functools.lru_cache(maxsize=4096)
def _templates(movements: tuple[int, ...]) -> tuple[Array, list[tuple[str, int]]]:
    """Unit vectors orthogonal to every movement's level, one a row, and what they stand for."""
    n = len(movements)
    labels = np.array(movements)
    levels = np.stack([labels == m for m in np.unique(labels)], axis=1).astype(float)
    basis = np.linalg.qr(levels)[0]
    rows, kinds = [], []
    for first in range(BEFORE, n - AFTER + 1):
        days = np.arange(n)
        for kind, shape in (("step", (days >= first) * 1.0), ("growth", np.maximum(0.0, days - first + 1.0))):
            rest = shape - basis @ (basis.T @ shape)
            length = np.linalg.norm(rest)
            if length > 1e-6 * np.linalg.norm(shape):
                rows.append(rest / length)
                kinds.append((kind, first))
    return (np.array(rows) if rows else np.zeros((0, n))), kinds


def scatter(values: Array, movements: tuple[int, ...]) -> tuple[Array, Array]:
    """Standard deviation from day to day of each row, and its degrees of freedom; robust, blind to rare steps: from successive days of one
    movement. Not finite where there are fewer than three."""
    labels = np.array(movements)
    steps = [np.diff(values[:, labels == m], axis=1) for m in np.unique(labels)]
    differences = np.concatenate(steps, axis=1) if steps else np.zeros((len(values), 0))
    count = differences.shape[1]
    if count < 3:
        return np.full(len(values), np.nan), np.zeros(len(values))
    # 0.6745: median of |N(0, 1)|; the second factor makes small samples unbiased (found by drawing).
    spread = np.median(np.abs(differences), axis=1) / (0.6745 * np.sqrt(2.0)) * (1.0 + 0.5 / count)
    return spread, np.full(len(values), 0.37 * count)  # the median of absolutes is worth 37 % of the samples


def moderated(own: Array, degrees: Array, fleet: float) -> Array:
    """A robot's scatter drawn towards the fleet's by the degrees of freedom that it has."""
    own = np.where(np.isfinite(own), own, fleet)
    return np.sqrt((PRIOR_DEGREES * fleet**2 + degrees * own**2) / (PRIOR_DEGREES + degrees))


def _median(window: list[Array]) -> Array:
    """Median, element by element, of a few arrays, which are overwritten: np.median of the same, many times faster, as most of a campaign is
    spent here."""
    ordered, free = list(window), np.empty_like(window[0])
    for turn in range(len(ordered)):  # odd-even transposition
        for k in range(turn % 2, len(ordered) - 1, 2):
            np.minimum(ordered[k], ordered[k + 1], out=free)
            np.maximum(ordered[k], ordered[k + 1], out=ordered[k + 1])
            ordered[k], free = free, ordered[k]
    half = len(ordered) // 2
    return ordered[half] if len(ordered) % 2 else (ordered[half - 1] + ordered[half]) / 2.0


def _clipped(units: Array, movements: tuple[int, ...]) -> Array:
    """Days further than CLIP from the days around them are drawn in; a lasting change keeps its neighbours and its size."""
    out = units.copy()
    labels = np.array(movements)
    for m in np.unique(labels):
        at = np.flatnonzero(labels == m)
        if len(at) < 3:
            continue
        part = np.ascontiguousarray(units.T[at])  # day by day: a window's days are whole rows
        # At the ends the window stays inside: the newest day is compared with those before it.
        width = min(WINDOW, len(at))
        begin = np.clip(np.arange(len(at)) - width // 2, 0, len(at) - width)
        middle = _median([part[begin + k] for k in range(width)])
        out[:, at] = (middle + np.clip(part - middle, -CLIP, CLIP)).T
    return out


def statistics(units: Array, movements: tuple[int, ...]) -> Array:
    """The scan's value of each row (in standard deviations from day to day); 0 where there are too few days."""
    units, movements = units[:, -MEMORY:], movements[-MEMORY:]
    templates, kinds = _templates(movements)
    if not kinds:
        return np.zeros(len(units))
    return np.asarray(np.abs(_clipped(units, movements) @ templates.T).max(axis=1))


def best_change(values: Array, sigma: float, movements: tuple[int, ...]) -> Change:
    """The change that explains one series best. Its first day's interval holds all days whose likelihood is within that of two standard errors."""
    offset = max(0, len(values) - MEMORY)
    part, recent = values[offset:], movements[-MEMORY:]
    templates, kinds = _templates(recent)
    units = _clipped(part[None, :] / sigma, recent)[0]
    scores = templates @ units
    best = int(np.argmax(np.abs(scores)))
    kind, first = kinds[best]
    likely = [f for (k, f), s in zip(kinds, scores) if k == kind and s * s > scores[best] ** 2 - 4.0]
    size, size_std = _size(part, sigma, recent, kind, first)
    return Change(kind, float(abs(scores[best])), first + offset, min(likely) + offset, max(likely) + offset, size, size_std)


def _size(values: Array, sigma: float, movements: tuple[int, ...], kind: str, first: int) -> tuple[float, float]:
    """How much larger the last day is than the days before the change, by least squares beside the movements' levels."""
    labels = np.array(movements)
    days = np.arange(len(values))
    shape = (days >= first) * 1.0 if kind == "step" else np.maximum(0.0, days - first + 1.0) / (len(values) - first)
    columns = np.column_stack([shape, *[(labels == m) * 1.0 for m in np.unique(labels)]])
    inverse = np.linalg.pinv(columns.T @ columns)
    return float((inverse @ columns.T @ values)[0]), float(sigma * np.sqrt(inverse[0, 0]))


class Null(NamedTuple):
    """Law of the largest value over all nights of a horizon."""

    sorted_maxima: Array
    start: float  # from here on the tail
    width: float  # standard deviation of that tail

    def p(self, statistic: float) -> float:
        """Probability that an unchanged series reaches a value within the horizon."""
        count = len(self.sorted_maxima)
        if statistic <= self.start:
            above = count - int(np.searchsorted(self.sorted_maxima, statistic))
            return min(1.0, (above + 1) / (count + 1))
        return float(np.exp(np.log(1.0 - TAIL) + stats.norm.logsf(statistic / self.width) - stats.norm.logsf(self.start / self.width)))


def null_of(maxima: Array) -> Null:
    """The null of drawn maxima: as many independent looks as they tell, each with a normal tail whose width is the likeliest."""
    ordered = np.sort(maxima)
    start = float(np.quantile(ordered, TAIL))
    above = ordered[ordered > start]

    def unlikelihood(width: float) -> float:
        return float(-np.sum(stats.norm.logpdf(above / width) - np.log(width) - stats.norm.logsf(start / width)))

    return Null(ordered, start, float(optimize.minimize_scalar(unlikelihood, bounds=(0.5, 4.0), method="bounded").x))


def unexplained(units: Array, movements: tuple[int, ...]) -> Array:
    """What the levels of the movements and the best change leave of one series, as wide as its days are: the days that a null is drawn from."""
    units, movements = units[-MEMORY:], movements[-MEMORY:]
    templates, kinds = _templates(movements)
    labels = np.array(movements)
    rest = units.copy()
    if kinds:
        scores = templates @ _clipped(units[None, :], movements)[0]
        best = int(np.argmax(np.abs(scores)))
        rest = rest - scores[best] * templates[best]
    for m in np.unique(labels):
        rest[labels == m] -= np.median(rest[labels == m])
    spent = len(np.unique(labels)) + 2.0
    return rest * np.sqrt(len(rest) / max(1.0, len(rest) - spent))


def innovations(days: list[Array] | None, draw: np.random.Generator, shape: tuple[int, int]) -> Array:
    """Days of unchanged series, one series a row: each row takes the days of one series of the fleet (`days`, in units of the fleet's scatter) in a
    new order. Without enough of them, days of Student's t of five degrees of freedom: wilder than normal, since nobody knows."""
    if days is None or len(days) < ENOUGH_SERIES:
        return np.asarray(draw.standard_t(5, size=shape) * 0.6745 / float(stats.t.ppf(0.75, 5)))
    whose = draw.integers(len(days), size=shape[0])
    return np.stack([days[k][draw.integers(len(days[k]), size=shape[1])] * draw.choice([-1.0, 1.0], size=shape[1]) for k in whose])


def null(horizon: int, correlation: float, movements: int = 1, days: list[Array] | None = None, seed: int = 1) -> Null:
    """The null of a horizon of days, with the given correlation from day to day, and days as `innovations` says."""
    draw = np.random.default_rng([seed, horizon, int(round(100 * correlation)), movements])
    e = innovations(days, draw, (DRAWS, horizon))
    y = np.empty((DRAWS, horizon))
    y[:, 0] = e[:, 0]
    for day in range(1, horizon):
        y[:, day] = correlation * y[:, day - 1] + np.sqrt(1.0 - correlation**2) * e[:, day]
    labels = tuple(day % movements for day in range(horizon))
    largest = np.zeros(DRAWS)
    for night in range(BEFORE + AFTER, horizon + 1, max(1, horizon // NIGHTS)):
        own, degrees = scatter(y[:, :night], labels[:night])
        # Differences of correlated days are too small; the same correction as for real series.
        sigma = moderated(own / np.sqrt(1.0 - correlation), degrees, 1.0)
        np.maximum(largest, statistics(y[:, :night] / sigma[:, None], labels[:night]), out=largest)
    return null_of(largest)


@functools.lru_cache(maxsize=64)
def wild_null(horizon: int, correlation: float) -> Null:
    """The null of a fleet that nothing is known of."""
    return null(horizon, correlation, 2)


def excursion_p(value: float, sigma: float, horizon: int, degrees: float = PRIOR_DEGREES) -> float:
    """Probability that any of a horizon's days lies as far from the median of the others by chance."""
    return float(min(1.0, 2.0 * horizon * stats.t.sf(abs(value) / sigma, degrees)))
