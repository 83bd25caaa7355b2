"""Movements for the fault campaign: legs' lengths every 10 ms from where the robot stands, all four legs moving, height constant, so
that whatever the platform loses of it is a drop."""
import math

import numpy as np
import yaml

PERIOD_S = 0.01
CYCLES_S = (2.4, 3.0, 2.0)  # of X, theta, psi: the path comes back to itself only at the end
DURATION_S = 12.0
# Where the movement goes to and fro about: X (m), theta, psi (rad).
LARGEST = (0.08, 0.10, 0.12)
HOME = (0.0, 0.0, 0.0)
MARGIN_M = 0.001  # from the ends of the strokes


class Geometry:
    """Inverse kinematics of the robot file's 3UPS+1RPU, as in the paper's section on kinematics."""

    def __init__(self, robot_file):
        with open(robot_file, encoding="utf-8") as file:
            robot = yaml.safe_load(file)
        g = robot["geometry"]
        r, rm = g["R_m"], g["Rm_m"]
        angle = {key: math.radians(g[key + "_deg"]) for key in ("beta_FD", "beta_FI", "beta_MD", "beta_MI")}

        def corners(radius, right, left):
            return np.array([[-radius[0], 0, 0], [radius[1] * math.cos(right), radius[1] * math.sin(right), 0],
                             [radius[2] * math.cos(left), -radius[2] * math.sin(left), 0]])

        self.base = np.vstack([corners(r, angle["beta_FD"], angle["beta_FI"]), [g["ds_m"], 0, 0]])
        self.platform = np.vstack([corners(rm, angle["beta_MD"], angle["beta_MI"]), [0, 0, 0]])
        actuators = robot["actuators"]
        self.actuators = actuators * 4 if len(actuators) == 1 else actuators
        self.shortest = np.array([a["position_min_m"] for a in self.actuators])
        self.longest = np.array([a["position_max_m"] for a in self.actuators])
        self.clamp_V = np.array([min(a.get("voltage_max_V", 10.0), a["force_max_N"] / a["force_per_volt_N"])
                                 if a.get("force_max_N", 0) else a.get("voltage_max_V", 10.0) for a in self.actuators])
        self.metres_per_count = np.array([a["screw_lead_m"] / a["counts_per_revolution"] for a in self.actuators])

    def lengths(self, pose):
        x, z, theta, psi = pose
        about_y = np.array([[math.cos(theta), 0, math.sin(theta)], [0, 1, 0], [-math.sin(theta), 0, math.cos(theta)]])
        about_z = np.array([[math.cos(psi), -math.sin(psi), 0], [math.sin(psi), math.cos(psi), 0], [0, 0, 1]])
        points = np.array([x, 0, z]) + (about_y @ about_z @ self.platform.T).T
        return np.linalg.norm(points - self.base, axis=1)


def fits(geometry, points):
    return bool(np.all(points > geometry.shortest + MARGIN_M) and np.all(points < geometry.longest - MARGIN_M))


def climb(geometry, pose, lengths, rise_m=0.1, duration_s=4.0):
    """Lengths (n x 4) of a way straight up from the measured `lengths`, near `pose`."""
    x, z, theta, psi = pose
    correction = np.asarray(lengths) - geometry.lengths(pose)
    share = [0.5 * (1.0 - math.cos(math.pi * k * PERIOD_S / duration_s)) for k in range(int(round(duration_s / PERIOD_S)) + 1)]
    return np.array([geometry.lengths((x, z + s * rise_m, theta, psi)) + correction for s in share])


def movement(geometry, pose, lengths, most=1.0):
    """Lengths (n x 4) of a movement that begins and ends at the measured `lengths`, near `pose`; towards the middle of the range.
    `most`: of its size."""
    x, z, theta, psi = pose
    amplitude = [-math.copysign(largest, now - home)
                 for largest, now, home in zip(LARGEST, (x, theta, psi), HOME)]
    correction = np.asarray(lengths) - geometry.lengths(pose)

    def with_share(share):
        points = []
        for k in range(int(round(DURATION_S / PERIOD_S)) + 1):
            s = [0.5 * share * (1.0 - math.cos(2.0 * math.pi * k * PERIOD_S / cycle)) for cycle in CYCLES_S]
            at = (x + s[0] * amplitude[0], z, theta + s[1] * amplitude[1], psi + s[2] * amplitude[2])
            points.append(geometry.lengths(at) + correction)
        return np.array(points)

    points = with_share(most)
    for share in most * np.array((0.9, 0.8, 0.7, 0.6, 0.5)):  # a robot with less room
        if fits(geometry, points):
            break
        points = with_share(share)
    return points


def write(path, points):
    with open(path, "w", encoding="utf-8") as file:
        file.write("# space: actuator\n# period_s: 0.01\n")
        for point in points:
            file.write(" ".join(f"{v:.9f}" for v in point) + "\n")


def path_time(points, reference, near_s):
    """Path time (s) at which the path has the lengths `reference`, nearest to `near_s`; the reference lies on the path exactly."""
    centre = int(near_s / PERIOD_S)
    first, last = max(0, centre - 15), min(len(points) - 2, centre + 15)
    start, step = points[first:last + 1], points[first + 1:last + 2] - points[first:last + 1]
    squared = np.maximum(np.sum(step * step, axis=1), 1e-30)
    share = np.clip(np.sum((reference - start) * step, axis=1) / squared, 0.0, 1.0)
    distances = np.linalg.norm(reference - (start + share[:, None] * step), axis=1)
    best = int(np.argmin(distances))
    return (first + best + float(share[best])) * PERIOD_S, float(distances[best])
