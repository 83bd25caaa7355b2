"""What a careful author would write with numpy, scipy and Pinocchio: the same identification, for scripts/benchmark_identification.

    pinocchio_identify.py lengthen SOURCE.csv TARGET.csv TIMES     repeat a recording, with noise of its own each time
    pinocchio_identify.py identify ROBOT.yaml URDF TRAIN.csv VALIDATE.csv CUTOFF_HZ [GRID]
    pinocchio_identify.py cvxpy FOLDER                             the physically consistent problem that identify_benchmark left

Prints one JSON object; times are CPU time of one thread. Recordings are those of virtual_plant: a row a millisecond, no gaps.
"""
import json
import math
import sys
import time

import numpy as np

LEGS = (1, 2, 3, 4)
GRID = 10  # rows a sample: 100 Hz, as in `identify`; another number on the command line
MOVING = 0.0015


def lengthen(source, target, times):
    with open(source, encoding="utf-8") as file:
        names = file.readline().strip().split(",")
    keep = [i for i, name in enumerate(names) if not name.startswith(("command", "velocity", "reference"))]
    names = [names[i] for i in keep]
    rows = np.loadtxt(source, delimiter=",", skiprows=1, usecols=keep)
    random = np.random.default_rng(1)
    forces = [i for i, name in enumerate(names) if name.startswith("force")]
    with open(target, "w", encoding="utf-8") as file:
        file.write(",".join(names) + "\n")
        for k in range(times):
            piece = rows[:-1].copy()
            piece[:, 0] += k * (rows[-1, 0] - rows[0, 0])
            piece[:, forces] += random.normal(0.0, 0.5, (len(piece), len(forces)))
            np.savetxt(file, piece, delimiter=",", fmt="%.9g")


class Geometry:
    def __init__(self, path):
        import yaml
        with open(path, encoding="utf-8") as file:
            g = yaml.safe_load(file)["geometry"]
        fd, fi, md, mi = (math.radians(g[k]) for k in ("beta_FD_deg", "beta_FI_deg", "beta_MD_deg", "beta_MI_deg"))
        r, m = g["R_m"], g["Rm_m"]
        self.base = np.array([[-r[0], 0, 0], [r[1] * math.cos(fd), r[1] * math.sin(fd), 0],
                              [r[2] * math.cos(fi), -r[2] * math.sin(fi), 0], [g["ds_m"], 0, 0]])
        self.platform = np.array([[-m[0], 0, 0], [m[1] * math.cos(md), m[1] * math.sin(md), 0],
                                  [m[2] * math.cos(mi), -m[2] * math.sin(mi), 0], [0, 0, 0]])

    def joints(self, pose):
        """All 13 joint values of the URDF for poses (n x 4), and their derivatives by the pose (n x 13 x 4)."""
        n = len(pose)
        st, ct, sp, cp = np.sin(pose[:, 2]), np.cos(pose[:, 2]), np.sin(pose[:, 3]), np.cos(pose[:, 3])
        zero = np.zeros(n)
        rotation = np.stack([np.stack([cp * ct, -sp * ct, st], 1), np.stack([sp, cp, zero], 1), np.stack([-cp * st, sp * st, ct], 1)], 1)
        origin = np.stack([pose[:, 0], zero, pose[:, 1]], 1)
        q, slope = np.zeros((n, 13)), np.zeros((n, 13, 4))
        for i in range(4):
            arm = rotation @ self.platform[i]
            span = origin + arm - self.base[i]
            partial = np.zeros((n, 3, 4))
            partial[:, 0, 0] = partial[:, 2, 1] = 1.0
            partial[:, 0, 2], partial[:, 2, 2] = arm[:, 2], -arm[:, 0]
            partial[:, :, 3] = np.cross(rotation[:, :, 2], arm)
            flat = np.hypot(span[:, 0], span[:, 2])
            length = np.linalg.norm(span, axis=1)
            turn = (span[:, :1] * partial[:, 2] - span[:, 2:] * partial[:, 0]) / flat[:, None] ** 2
            stretch = np.einsum("nj,njk->nk", span, partial) / length[:, None]
            if i < 3:
                q[:, 3 * i] = np.arctan2(span[:, 2], span[:, 0])
                q[:, 3 * i + 1] = np.arctan2(span[:, 1], flat)
                q[:, 3 * i + 2] = length
                slope[:, 3 * i] = turn
                slope[:, 3 * i + 1] = (partial[:, 1] - (span[:, 1] / length)[:, None] * stretch) / flat[:, None]
                slope[:, 3 * i + 2] = stretch
            else:
                q[:, 9], slope[:, 9] = np.arctan2(span[:, 2], span[:, 0]), turn
                q[:, 10], slope[:, 10] = length, stretch
        q[:, 11], q[:, 12] = pose[:, 2] + q[:, 9] - math.pi / 2, pose[:, 3]
        slope[:, 11] = slope[:, 9]
        slope[:, 11, 2] += 1.0
        slope[:, 12, 3] = 1.0
        return q, slope

    def newton(self, lengths, pose, steps=50):
        """Poses of these rows by Newton's method from `pose`, a row each; which of them converged."""
        pose = pose.copy()
        for _ in range(steps):
            q, slope = self.joints(pose)
            step = np.linalg.solve(slope[:, ACTUATED], (lengths - q[:, ACTUATED])[:, :, None])[:, :, 0]
            pose += np.clip(step, -0.1, 0.1)
            if np.abs(step).max() < 1e-12:
                break
        return pose, np.abs(step).max(axis=1) < 1e-9

    def poses(self, lengths, stride):
        """Follows the assembly branch: one row in `stride` after the other, then all rows from their nearest neighbours there."""
        guess, knots = np.array([[0.0, lengths[0, 3], 0.0, 0.0]]), []
        for row in range(0, len(lengths), stride):
            guess, converged = self.newton(lengths[row:row + 1], guess)
            if not converged.all():
                raise SystemExit(f"forward kinematics did not converge in row {row}")
            knots.append(guess[0])
        pose, converged = self.newton(lengths, np.repeat(np.array(knots), stride, axis=0)[:len(lengths)])
        if not converged.all():
            raise SystemExit(f"forward kinematics did not converge in row {int(np.argmin(converged))}")
        return pose


ACTUATED = [2, 5, 8, 10]
NAMES = ["q11", "q12", "q13", "q21", "q22", "q23", "q31", "q32", "q33", "q41", "q42", "theta_4", "psi_4"]


class Filter:
    def __init__(self, cutoff_hz, rate_hz):
        from scipy.signal import butter
        self.sections = butter(4, cutoff_hz, fs=rate_hz, output="sos")
        self.pad = int(6 * rate_hz / cutoff_hz)

    def __call__(self, signals):
        from scipy.signal import sosfiltfilt
        return sosfiltfilt(self.sections, signals, axis=0, padlen=min(self.pad, len(signals) - 1))


def observe(geometry, urdf, path, cutoff_hz):
    """Weighted equations of a recording: filtered regressor, filtered force, used samples."""
    import pinocchio as pin
    with open(path, encoding="utf-8") as file:
        names = file.readline().strip().split(",")
    wanted = [names.index(name) for name in ["time_s"] + [f"position_{i}_m" for i in LEGS] + [f"force_{i}_N" for i in LEGS]]
    rows = np.loadtxt(path, delimiter=",", skiprows=1, usecols=wanted)
    period = (rows[-1, 0] - rows[0, 0]) / (len(rows) - 1)
    position = Filter(3 * cutoff_hz, 1 / period)(rows[:, 1:5])
    velocity = np.gradient(position, period, axis=0)[::GRID]
    acceleration = np.gradient(np.gradient(position, period, axis=0), period, axis=0)[::GRID]
    position = position[::GRID]
    held = np.cumsum(rows[:, 5:9], axis=0)
    middle = np.arange(len(position)) * GRID  # a row's force acts from its time to the next row's
    low, high = np.maximum(middle - GRID // 2 - 1, 0), np.clip(middle + (GRID + 1) // 2 - 1, 1, len(rows) - 1)
    force = (held[high] - held[low]) / (high - low)[:, None]

    step = GRID * period
    pose = geometry.poses(position, max(1, 250 // GRID))  # a quarter of a second
    q, slope = geometry.joints(pose)
    v = np.gradient(q, step, axis=0, edge_order=2)
    a = np.gradient(v, step, axis=0, edge_order=2)
    per_actuator = slope @ np.linalg.inv(slope[:, ACTUATED])

    model = pin.buildModelFromUrdf(urdf)
    data = model.createData()
    place = [model.joints[model.getJointId(name)].idx_v for name in NAMES]
    bodies = [model.getJointId(name) for name in ("q12", "q13", "q22", "q23", "q32", "q33", "q41", "q42", "psi_4")]
    columns = np.concatenate([np.arange(10 * (b - 1), 10 * b) for b in bodies])
    order = np.argsort(place)
    q, v, a, per_actuator = q[:, order], v[:, order], a[:, order], per_actuator[:, order]
    n = len(q)
    regressor = np.zeros((4, n, 90 + 16))
    for k in range(n):
        tree = pin.computeJointTorqueRegressor(model, data, q[k], v[k], a[k])
        regressor[:, k, :90] = per_actuator[k].T @ tree[:, columns]
    for i in range(4):
        regressor[i, :, 90 + i] = velocity[:, i]
        regressor[i, :, 94 + i] = np.sign(velocity[:, i])
        regressor[i, :, 98 + i] = acceleration[:, i]
        regressor[i, :, 102 + i] = 1.0
    low_pass = Filter(cutoff_hz, 1 / step)
    moving = (np.abs(low_pass(velocity)) > MOVING).all(axis=1)
    edge = int(1 / (cutoff_hz * step))
    moving[:edge] = moving[-edge:] = False
    used = np.flatnonzero(moving)[:: max(1, int(1 / (10 * cutoff_hz * step)))]
    return [low_pass(regressor[i])[used] for i in range(4)], [low_pass(force[:, i])[used] for i in range(4)]


def identify(robot, urdf, train, validate, cutoff_hz):
    from scipy.linalg import lstsq
    geometry = Geometry(robot)
    start = time.process_time()
    w, f = observe(geometry, urdf, train, cutoff_hz)
    observe_s = time.process_time() - start
    noise = [np.sqrt(np.mean(force**2)) for force in f]
    for _ in range(2):  # equal weights first, then the residual of each actuator
        rows = np.concatenate([w[i] / noise[i] for i in range(4)])
        right = np.concatenate([f[i] / noise[i] for i in range(4)])
        scale = np.linalg.norm(rows, axis=0)
        scale[scale < 1e-9 * scale.max()] = np.inf
        before = time.process_time()
        z = lstsq(rows / scale, right, cond=1e-4)[0] / scale
        solve_s = time.process_time() - before
        noise = [np.sqrt(np.mean((f[i] - w[i] @ z) ** 2)) for i in range(4)]
    total_s = time.process_time() - start
    # The truncation is chosen in the peer's favour: the best one on the validation recording, not timed.
    w2, f2 = observe(geometry, urdf, validate, cutoff_hz)
    best = None
    for cond in (1e-1, 3e-2, 1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 1e-5, 1e-6):
        z, _, rank, _ = lstsq(rows / scale, right, cond=cond)
        z = z / scale
        error = [float(np.sqrt(np.mean((f2[i] - w2[i] @ z) ** 2))) for i in range(4)]
        if best is None or sum(error) < sum(best[0]):
            best = (error, int(rank))
    import resource
    print(json.dumps({"observe_s": observe_s, "solve_s": solve_s, "total_s": total_s, "held_out_N": best[0], "rank": best[1],
                      "peak_MB": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024}))


def consistent(folder):
    import cvxpy as cp
    read = lambda name: np.loadtxt(f"{folder}/{name}.txt", ndmin=2)
    data, target, pull, mean = read("data"), read("target")[:, 0], read("pull"), read("mean")[:, 0]
    nonnegative = read("nonnegative")[:, 0] > 0
    start = time.process_time()
    # The same sum of squares in few rows, as our own solver does.
    stacked = np.column_stack([np.vstack([data, pull]), np.concatenate([target, pull @ mean])])
    r = np.linalg.qr(stacked, mode="r")
    rows, right = r[:-1, :-1], r[:-1, -1]
    bodies = [cp.Variable((4, 4), PSD=True) for _ in range(9)]
    free = cp.Variable(len(nonnegative))
    upper = [(i, j) for i in range(4) for j in range(i + 1, 4)]
    parts = [cp.hstack([e[i, i] for i in range(4)] + [math.sqrt(2) * e[i, j] for i, j in upper]) for e in bodies]
    # Columns of unit size: friction's own units would spoil the solver's scaling.
    scale = np.linalg.norm(rows[:, 90:], axis=0)
    scale[scale == 0] = 1.0
    residual = rows[:, :90] @ cp.hstack(parts) + (rows[:, 90:] / scale) @ free - right
    problem = cp.Problem(cp.Minimize(cp.sum_squares(residual)), [free[np.flatnonzero(nonnegative)] >= 0])
    problem.solve(solver=cp.CLARABEL)
    total_s = time.process_time() - start
    z = np.concatenate([part.value for part in parts] + [free.value / scale])
    cost = float(np.sum((data @ z - target) ** 2) + np.sum((pull @ (z - mean)) ** 2))
    held = float(np.linalg.norm(read("validation") @ z - read("validation_target")[:, 0]))
    print(json.dumps({"total_s": total_s, "solver_s": problem.solver_stats.solve_time, "cost": cost, "held_out": held,
                      "status": problem.status}))


if __name__ == "__main__":
    task, *rest = sys.argv[1:]
    if task == "lengthen":
        lengthen(rest[0], rest[1], int(rest[2]))
    elif task == "identify":
        if len(rest) > 5:
            GRID = int(rest[5])
        identify(*rest[:4], float(rest[4]))
    else:
        consistent(rest[0])
