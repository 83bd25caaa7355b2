"""What is left of a recording after a fault: whether it can be read, until when, and when the reference left its path."""
import math

import numpy as np

import robot_path


class Recording:
    """The file as it is on the disk. `problem`: why it is not intact, empty otherwise."""

    def __init__(self, path):
        self.problem, self.rows = "", 0
        try:
            text = path.read_text(encoding="ascii")
        except (OSError, UnicodeDecodeError) as error:
            self.problem = f"cannot be read: {error}"
            return
        lines = text.split("\n")
        if lines[-1] != "":
            self.problem = "the last line is not whole"
        names = lines[0].split(",")
        try:
            self.values = np.array([[float(v) for v in line.split(",")] for line in lines[1:-1]])
        except ValueError:
            self.problem = "lines of different length or without numbers"
            return
        if self.values.ndim != 2 or self.values.shape[0] < 2 or self.values.shape[1] != len(names):
            self.problem = "hardly any rows"
            return
        self.rows = len(self.values)
        self.column = {name: i for i, name in enumerate(names)}
        self.time = self.values[:, self.column["time_s"]]
        if not np.all(np.isfinite(self.values)):
            self.problem = "holds what is not a number"
        if not np.all(np.diff(self.time) > 0):
            self.problem = "time does not increase"
        periods = np.rint(np.diff(self.time) / 0.001)
        self.largest_gap_ms = float(np.max(np.diff(self.time)) * 1e3)
        self.skipped = int(np.sum(periods[periods > 1] - 1))

    def four(self, pattern):
        return self.values[:, [self.column[pattern.format(i)] for i in range(1, 5)]]

    def clock_offset(self, truth, until):
        """Monotonic minus recording time (s), by the measured positions before `until`; None when the robot did not move."""
        before = truth[truth["monotonic_s"] < until]
        positions = self.four("position_{}_m")
        moved = np.nonzero(np.max(np.abs(positions - positions[0]), axis=1) > 0.002)[0]
        moved_true = np.nonzero(np.max(np.abs(before["length_m"] - before["length_m"][0]), axis=1) > 0.002)[0]
        if len(moved) == 0 or len(moved_true) == 0:
            return None
        guess = before["monotonic_s"][moved_true[0]] - self.time[moved[0]]
        rows = slice(max(0, moved[0] - 100), min(self.rows, moved[0] + 300))
        step, best = 0.004, guess
        for _ in range(6):
            offers = best + step * np.arange(-6, 7)
            errors = []
            for offset in offers:
                at = self.time[rows] + offset
                use = at < min(until, before["monotonic_s"][-1])
                gap = [np.interp(at[use], before["monotonic_s"], before["length_m"][:, a]) - positions[rows][use, a] for a in range(4)]
                errors.append(np.sum(np.square(gap)) / max(1, np.count_nonzero(use)))
            best = offers[int(np.argmin(errors))]
            step /= 3.0
        return float(best)

    def leaves_path_at(self, points, after):
        """Recording time of the first row after `after` whose reference went less far along the path than time did; None: never."""
        reference = self.four("reference_{}_m")
        first = int(np.searchsorted(self.time, after - 0.03))
        last = int(np.searchsorted(self.time, after + 1.0))
        place, near, found = None, None, []
        for k in range(first, last):
            if near is None:
                near = self.locate(points, reference[k])
            here, distance = robot_path.path_time(points, reference[k], near)
            if distance > 1e-5:
                if self.time[k] > after:
                    return float(self.time[k])  # off the path altogether
                place, near = None, None
                continue
            if place is not None and self.time[k] > after:
                steps = round((self.time[k] - self.time[k - 1]) / 0.001)
                found.append((self.time[k], (here - place) < 0.000995 * min(steps, 1)))
                if len(found) >= 2 and found[-1][1] and found[-2][1]:
                    return float(found[-2][0])
            place = near = here
        return None

    @staticmethod
    def locate(points, reference):
        gaps = np.sum(np.square(points - reference), axis=1)
        return float(np.argmin(gaps)) * robot_path.PERIOD_S


def is_finite(value):
    return value is not None and math.isfinite(value)
