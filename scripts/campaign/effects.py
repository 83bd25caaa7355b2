"""What the injection campaign hides: effects of the simulated robot, effects on the Simbody plant, and effects that trace has no class for.

On the simulated robot effects act in closed loop (src/simulation/effects). On the Simbody plant the motion is prescribed, so that an
effect is a force in addition; it is calculated here, from the reference, in code that shares nothing with simulation or tracing.
"""
import numpy as np

# Entries of a simulation file's `effects`: weak, medium, strong. ACT: drawn actuator; CENTER: a place within its stroke;
# PERIOD: drawn pitch.
ROBOT = {
    "asymmetric_viscous": ["actuators: [ACT], difference_N_s_per_m: " + v for v in ("80", "200", "500")],
    "stribeck": ["actuators: [ACT], excess_N: " + v + ", velocity_m_per_s: 0.012" for v in ("7", "16", "35")],
    "presliding": ["actuators: [ACT], stiffness_N_per_m: " + v for v in ("1.0e+5", "4.0e+4", "1.5e+4")],
    "load_dependent_friction": ["actuators: [ACT], share: " + v for v in ("0.1", "0.22", "0.45")],
    "screw_ripple": ["actuators: [ACT], amplitude_N: " + v + ", period_m: PERIOD, phase_deg: 40" for v in ("4", "9", "18")],
    "position_dependent_friction": ["actuators: [ACT], amplitude_N: " + v + ", center_m: CENTER, width_m: 0.04" for v in ("10", "22", "45")],
    "quadratic_drag": ["actuators: [ACT], drag_N_s2_per_m2: " + v for v in ("2000", "5000", "12000")],
    "reversal_friction": [f"actuators: [ACT], excess_N: {v}, way_m: 0.01, rise_m: 0.001" for v in ("6", "14", "30")],
    "screw_whirl": [f"actuators: [ACT], peak_N: {v}, critical_m_per_s: 0.05, at_length_m: CENTER, width_m_per_s: 0.012" for v in ("8", "18", "40")],
    "thermal_drift": [f"actuators: [ACT], viscous_change: {v}, coulomb_change: {v}, time_constant_s: 30" for v in ("-0.4", "0.8", "1.6")],
    "spring": ["stiffness_N_per_m: " + v + ", anchor_m: [0.2, 0.3, 0], point_m: [0.2, 0.2, 0], free_length_m: 0.5" for v in ("150", "400", "1000")],
    "viscoelastic_link": [f"stiffness_N_per_m: {v}, relaxation_s: 1, anchor_m: [0.2, 0.3, 0], point_m: [0.2, 0.2, 0]" for v in ("400", "1000", "2500")],
    "elastoplastic_link": [f"yield_N: {v}, yield_m: 0.004, anchor_m: [0.2, 0.3, 0], point_m: [0.2, 0.2, 0]" for v in ("10", "22", "45")],
    "line_friction": [f"friction_N: {v}, proportional_below_m_per_s: 0.004, anchor_m: [0, 0.1, 1.8], point_m: [0.1, -0.1, 0]" for v in ("8", "18", "40")],
    "link_between_legs": [f"first_leg: 1, second_leg: 2, between: cylinders, acts_from_m: 0.4, side: longer, stiffness_N_per_m: {v}, damping_N_s_per_m: 20" for v in ("300", "800", "2000")],
    "force_gain": ["actuators: [ACT], factor: " + v for v in ("0.93", "0.85", "0.7")],
    "delay": ["actuators: [ACT], time_s: " + v for v in ("0.004", "0.008", "0.014")],
    "drive_lag": ["actuators: [ACT], time_constant_s: " + v for v in ("0.004", "0.008", "0.014")],
    "external_force": [f"start_s: 45, end_s: 49, force_N: [0, 0, {v}], point_m: [0.1, 0, 0]" for v in ("-15", "-40", "-90")],
    "backlash": ["actuators: [ACT], width_m: " + v for v in ("0.0003", "0.0008", "0.002")],
    "flexible_coupling": ["actuators: [ACT], stiffness_N_per_m: " + v for v in ("2.0e+5", "8.0e+4", "4.0e+4")],
}

# What the base parameters take up: nothing should be found.
ABSORBED = {
    "asymmetric_coulomb": "actuators: [ACT], difference_N: 20",
    "payload": "mass_kg: 5, center_m: [0, 0, 0.1]",
    "base_tilt": "about_x_deg: 1, about_y_deg: -2",
    "force_offset": "actuators: [ACT], force_N: 10",
    "reflected_inertia": "actuators: [ACT], mass_kg: 6",
}

PAIRS = [("stribeck", "screw_ripple"), ("load_dependent_friction", "position_dependent_friction"),
         ("asymmetric_viscous", "thermal_drift"), ("presliding", "quadratic_drag"), ("force_gain", "screw_ripple"),
         ("stribeck", "external_force")]


class Motion:
    """Exact motion at the middle of every row's interval, and the force of the plant without the effect (rows x 4). `first`: the motion
    of the machine's first recording, whose extremes give a law its constants: they belong to the machine, not to the path."""

    def __init__(self, time, reference, force, coulomb, viscous, first=None):
        period = time[1] - time[0]
        self.t = time - time[0] + 0.5 * period
        self.q = reference + 0.5 * np.gradient(reference, period, axis=0) * period
        self.v = np.gradient(self.q, period, axis=0)
        self.sign = np.tanh(self.v / 2e-4)
        self.force = force
        self.load = force - coulomb * self.sign - viscous * self.v
        self.first = first or self

    def top(self, what, a):
        return np.abs(getattr(self.first, what)[:, a]).max()

    def low(self, a):
        return self.first.q[:, a].min()

    def range(self, a):
        return np.ptp(self.first.q[:, a])

    def middle(self, a):
        return self.low(a) + 0.45 * self.range(a)


# Forces in addition on actuator `a`; `size` is about the force in N that is wanted at its largest.
def _drag(m, a, size):
    return size * m.v[:, a] * np.abs(m.v[:, a]) / m.top("v", a) ** 2


def _thermal(m, a, size):
    return size * (1 - np.exp(-m.t / 20.0)) * m.sign[:, a]


SIMBODY = {
    "asymmetric_viscous": lambda m, a, size: size * np.abs(m.v[:, a]) / m.top("v", a),
    "stribeck": lambda m, a, size: size * m.sign[:, a] * np.exp(-((m.v[:, a] / 0.012) ** 2)),
    "load_dependent_friction": lambda m, a, size: size * m.sign[:, a] * np.abs(m.load[:, a]) / m.top("load", a),
    "screw_ripple": lambda m, a, size: 0.7 * size * np.sin(2 * np.pi * m.q[:, a] / 0.0117 + 0.5),
    "position_dependent_friction": lambda m, a, size: size * m.sign[:, a] * np.exp(-(((m.q[:, a] - m.middle(a)) / 0.04) ** 2)),
    "quadratic_drag": _drag,
    "thermal_drift": _thermal,
    "force_gain": lambda m, a, size: size / m.top("force", a) * m.force[:, a],
}

# Test only: trace has no class for these.
UNLISTED = {
    # a hose between two legs drags with the neighbour's velocity
    "neighbour_drag": lambda m, a, size: size * m.v[:, (a + 1) % 4] / m.top("v", (a + 1) % 4),
    # a cable tray that the neighbour bends
    "neighbour_cable": lambda m, a, size: size * np.tanh((m.q[:, (a + 2) % 4] - m.middle((a + 2) % 4)) / 0.03),
    # a seal that the neighbour's position tightens
    "neighbour_seal": lambda m, a, size: size * m.sign[:, a] * (m.q[:, (a + 1) % 4] - m.low((a + 1) % 4)) / m.range((a + 1) % 4),
    # a bellows that is pressed together below a length
    "bellows": lambda m, a, size: -size * np.maximum(0, m.middle(a) - m.q[:, a]) / (m.middle(a) - m.low(a)),
    # grease that thins with speed
    "thinning_grease": lambda m, a, size: size * m.sign[:, a] * np.sqrt(np.abs(m.v[:, a]) / m.top("v", a)),
    # a nut that binds with load times speed
    "load_viscous": lambda m, a, size: size * m.v[:, a] * np.abs(m.load[:, a]) / np.abs(m.first.v[:, a] * m.first.load[:, a]).max(),
}
# Of these, what trace has a class for since: no name but that is right.
CLASS_SINCE = {"load_viscous": "load_dependent_viscous"}
SIZES = [4.0, 9.0, 18.0]  # N, weak, medium, strong
