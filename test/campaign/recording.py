"""What is left of a recording after a fault: whether it can be read, until when, and when the reference left its path."""

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
        known = [i for i, name in enumerate(names) if not name.startswith("residual_")]  # nan without an identified model
        if not np.all(np.isfinite(self.values[:, known])):
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

    def leaves_path_at(self, points, after, until):
        """Recording time of the row from which on the reference never again went as far along the path as time did, between the
        times `after` and `until`; None when the rows do not show it. A machine that pauses lets the reference wait for a moment,
        too: only what does not come back is a stop."""
        reference = self.four("reference_{}_m")
        first, last = np.searchsorted(self.time, [after - 0.03, until])
        near, places, off_path = None, [], False
        for k in range(first, last):
            if near is None:
                near = self.locate(points, reference[k])
            near, distance = robot_path.path_time(points, reference[k], near)
            if distance > 1e-4:
                last, off_path = k, True  # the Drivers hold where they are, or stop by themselves
                break
            places.append(near)
        cycles = np.floor(self.time[first:last] / 0.001 + 1e-4)  # rows are read a little after their planned time
        rates = np.diff(places) / np.maximum(1.0, np.diff(cycles)) / 0.001
        full = np.nonzero(rates >= 0.995)[0]
        if off_path and (len(full) == 0 or full[-1] + 4 > len(rates)):
            return max(float(self.time[last]), after)
        if len(full) == 0 or full[-1] + 4 > len(rates):
            return None
        begin = float(self.time[first + full[-1] + 2])
        return max(begin, after)

    @staticmethod
    def locate(points, reference):
        # The movement runs back over itself after half of its time, which no run of the campaign reaches.
        gaps = np.sum(np.square(points[:len(points) // 2] - reference), axis=1)
        return float(np.argmin(gaps)) * robot_path.PERIOD_S
