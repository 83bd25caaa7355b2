"""Cases of the injection campaign on open arms: chains of six joints, one sliding now and then, whose torques Simbody calculates.

Gears rub by laws of their own near rest, four of which trace has no class for; what is hidden is added here, from the motion and Simbody's
torques, in code that shares nothing with identification or tracing. Encoders are rounded and lag nothing; torques are noisy.
"""
import json
import os
import random
import shutil
import time

import numpy as np

from campaign.records import Failed, run

JOINTS = 6
RATES = [100, 200, 125, 500]  # Hz
SECONDS = 40.0
LAWS = ["stop", "tanh", "rational", "lugre", "maxwell_slip"]
STRENGTHS = {1: 0.06, 2: 0.15, 3: 0.35}  # of the rms torque of the joint (rms of what is hidden)
WEIGHTS = ["-", "weak", "medium", "strong"]


class Arm:
    """A random arm with gears, as a URDF and a robot file."""

    def __init__(self, split, number):
        draw = self.draw = random.Random(f"{split} chain {number}")
        self.name = f"{split}-chain-{number}"
        self.rate = RATES[number % len(RATES)]
        self.law = [LAWS[(number + j) % len(LAWS)] for j in range(JOINTS)]
        self.slides = [j == 0 and number % 4 == 3 for j in range(JOINTS)]
        size = 10.0 ** draw.uniform(-0.5, 0.5)  # small and large arms
        self.links = [{"mass": size * draw.uniform(4, 9) * 0.7**j, "length": draw.uniform(0.15, 0.4) * size**0.3} for j in range(JOINTS)]
        self.turns = [draw.choice([(0, 0, 0), (1.5707963, 0, 0), (0, 1.5707963, 0.3), (-1.2, 0, 0.4)]) for _ in range(JOINTS)]
        self.reach = [draw.uniform(0.6, 1.6) for _ in range(JOINTS)]
        self.speed = [draw.uniform(0.5, 1.6) for _ in range(JOINTS)]
        self.step = draw.choice([1e-6, 2e-5, 1e-4])
        self.coulomb = [draw.uniform(0.05, 0.15) for _ in range(JOINTS)]  # of the rms torque
        self.viscous = [draw.uniform(0.05, 0.15) for _ in range(JOINTS)]
        self.width = [draw.uniform(0.002, 0.02) for _ in range(JOINTS)]  # of the joint's reach, or of its speed

    def urdf(self):
        parts = ['<robot name="arm">', '<link name="base"/>']
        for j, link in enumerate(self.links):
            m, length = link["mass"], link["length"]
            i = m * length**2 / 10
            parts.append(f'<link name="link{j + 1}"><inertial><origin xyz="{0.3 * length:.4f} {0.1 * length:.4f} {0.35 * length:.4f}"/><mass value="{m:.5f}"/>'
                         f'<inertia ixx="{i:.6f}" ixy="0" ixz="0" iyy="{1.2 * i:.6f}" iyz="0" izz="{0.8 * i:.6f}"/></inertial></link>')
            kind = "prismatic" if self.slides[j] else "revolute"
            roll, pitch, yaw = self.turns[j]
            before = self.links[j - 1]["length"] if j else 0.2
            parts.append(f'<joint name="joint{j + 1}" type="{kind}"><origin xyz="{0.5 * before:.4f} 0 {0.6 * before:.4f}" rpy="{roll} {pitch} {yaw}"/>'
                         f'<parent link="{f"link{j}" if j else "base"}"/><child link="link{j + 1}"/><axis xyz="0 0 1"/>'
                         f'<limit lower="-2.9" upper="2.9" effort="1000" velocity="3"/></joint>')
        return "\n".join(parts + ["</robot>"]) + "\n"

    def wrong_urdf(self):
        """What the user has: the maker's masses are off by up to 15 %."""
        draw, text = random.Random(self.name + " urdf"), self.urdf()
        for link in self.links:
            text = text.replace(f'mass value="{link["mass"]:.5f}"', f'mass value="{link["mass"] * draw.uniform(0.85, 1.15):.5f}"')
        return text

    def motion(self, which):
        """Exact positions, velocities, accelerations: a Fourier series a joint, from rest to rest."""
        draw = random.Random(f"{self.name} path {which}")
        t = np.arange(0.0, SECONDS, 1.0 / self.rate)
        ramp = np.clip(np.minimum(t, SECONDS - t) / 2.0, 0.0, 1.0)
        window = 10 * ramp**3 - 15 * ramp**4 + 6 * ramp**5
        q = np.empty((len(t), JOINTS))
        for j in range(JOINTS):
            w = 2 * np.pi / (SECONDS - 4.0)
            x = sum(draw.gauss(0, 1) / k**0.5 * np.sin(k * w * t + draw.uniform(0, 6.28)) for k in range(1, 9)) * window
            scale = min(self.reach[j] / np.abs(x).max(), self.speed[j] / np.abs(np.gradient(x, t)).max())
            q[:, j] = scale * x * (0.3 if self.slides[j] else 1.0)
        v = np.gradient(q, t, axis=0)
        return t, q, v, np.gradient(v, t, axis=0)


def friction(law, q, v, reach, speed, width, dt):
    """Share of full dry friction."""
    if law == "tanh":
        return np.tanh(v / (width * speed))
    if law == "rational":
        x = v / (width * speed)
        return x / (1.0 + np.abs(x))
    out, distance = np.empty(len(q)), width * 0.1 * reach
    if law == "maxwell_slip":
        state = np.zeros(8)
        yields = np.linspace(0.25, 2.0, 8) * distance
        for n in range(len(q)):
            state = np.clip(state + (q[n] - q[n - 1] if n else 0.0), -yields, yields)
            out[n] = np.mean(state / yields)
        return out
    z = 0.0
    for n in range(len(q)):
        dq = q[n] - q[n - 1] if n else 0.0
        if law == "stop":
            z = np.clip(z + dq / distance, -1.0, 1.0)
        else:  # lugre: bristles with a damping
            z += dq / distance - abs(dq / distance) * z
            z = np.clip(z, -1.0, 1.0)
        out[n] = np.clip(z + (0.3 * width * dq / dt / (width * speed) * np.exp(-(v[n] / (width * speed))**2) if law == "lugre" else 0.0), -1.2, 1.2)
    return out


def hidden(name, t, q, v, load, share, arm, j, draw):
    """An effect of any size; it is scaled afterwards."""
    constants = random.Random(f"{arm.name} {name} {j}")  # of the machine, not of the path
    if name == "load_dependent_friction":
        return share * np.abs(load)
    if name == "asymmetric_viscous":
        return np.abs(v)
    if name == "quadratic_drag":
        return v * np.abs(v)
    if name == "stribeck":
        return share * np.exp(-(v / (0.08 * arm.speed[j]))**2)
    if name == "gear_ripple":
        phase = 2 * np.pi * q / constants.uniform(0.08, 0.4) + constants.uniform(0, 6)
        return np.sin(phase) + 0.7 * np.sin(2 * phase + 1.0) + 0.4 * np.sin(4 * phase + 2.0)
    if name == "torsional_hysteresis":
        out, z, size = np.empty(len(load)), 0.0, 0.1 * np.ptp(load)
        for n in range(len(load)):  # Bouc and Wen's law, n = 2
            d = (load[n] - load[n - 1] if n else 0.0) / size
            z += d - 0.5 * (abs(d) * z * abs(z) + d * z * z)
            out[n] = z
        return out
    if name == "position_dependent_friction":
        return share * np.exp(-((q - constants.uniform(-0.4, 0.4) * arm.reach[j]) / (0.3 * arm.reach[j]))**2)
    if name == "force_gain":
        return load + 0.0
    if name == "thermal_drift":
        return (share + 0.5 * v / arm.speed[j]) * (1.0 - np.exp(-t / 15.0))
    if name == "cogwheel":  # unlisted: a square wave of the angle
        return np.sign(np.sin(2 * np.pi * q / constants.uniform(0.5, 0.9)))
    raise KeyError(name)


EFFECTS = ["load_dependent_friction", "asymmetric_viscous", "quadratic_drag", "stribeck", "gear_ripple", "torsional_hysteresis",
           "position_dependent_friction", "force_gain", "thermal_drift"]
UNLISTED = ["cogwheel"]  # no class of trace describes it


class ChainCase:
    def __init__(self, kind, split, number, name, strength):
        self.kind, self.arm, self.effect, self.strength = kind, Arm(split, number), name, strength
        self.joint = random.Random(f"{split} {number} {name} {strength}").randrange(JOINTS)

    def name(self):
        return f"{self.kind}-{self.effect or 'clean'}-{self.strength}-{self.arm.name}"


def chain_cases(split, clean, seeds):
    cases = [ChainCase("clean", split, k, None, 0) for k in range(clean)]
    taken = 0
    for _ in range(seeds):
        for name in [*EFFECTS, *UNLISTED]:
            for strength in STRENGTHS:
                cases.append(ChainCase("unlisted" if name in UNLISTED else "single", split, (5 * taken) % max(1, clean), name, strength))
                taken += 1
    random.Random(split).shuffle(cases)
    return cases


def record(case, which, folder, plant):
    arm = case.arm
    t, q, v, a = arm.motion(which)
    motion, torques = f"{folder}/motion.txt", f"{folder}/torques.txt"
    np.savetxt(motion, np.column_stack([q, v, a]), fmt="%.10g")
    run([plant, f"{folder}/true.yaml", motion, torques], f"{folder}/log.txt")
    load = np.loadtxt(torques)
    size = np.sqrt(np.mean(load**2, axis=0))
    tau = load.copy()
    first = np.load(f"{folder}/scale.npz") if which else None
    rms = first["rms"] if which else np.maximum(size, 0.05 * size.max())
    noise = np.random.default_rng(1000 + which)
    gain = float(first["gain"]) if which else 0.0
    for j in range(JOINTS):
        share = friction(arm.law[j], q[:, j], v[:, j], arm.reach[j], arm.speed[j], arm.width[j], 1.0 / arm.rate)
        tau[:, j] += rms[j] * (arm.coulomb[j] * share + arm.viscous[j] * v[:, j] / arm.speed[j])
        if case.effect and j == case.joint:
            extra = hidden(case.effect, t, q[:, j], v[:, j], load[:, j], share, arm, j, noise)
            if not which:
                gain = STRENGTHS[case.strength] * rms[j] / np.sqrt(np.mean(extra**2))
            tau[:, j] += gain * extra
    if not which:
        np.savez(f"{folder}/scale.npz", rms=rms, gain=gain)
    tau += noise.normal(0.0, 0.01, tau.shape) * rms
    seen = np.round(q / arm.step) * arm.step
    path = f"{folder}/path_{which + 1}.csv"
    header = ["time_s"] + [f"position_{j + 1}_{'m' if arm.slides[j] else 'rad'}" for j in range(JOINTS)]
    header += [f"force_{j + 1}_N" if arm.slides[j] else f"torque_{j + 1}_Nm" for j in range(JOINTS)]
    np.savetxt(path, np.column_stack([t, seen, tau]), delimiter=",", fmt="%.8g", comments="", header=",".join(header))
    return path


def robot_file(arm, folder, urdf, name):
    with open(f"{folder}/{name}.urdf", "w", encoding="utf-8") as out:
        out.write(urdf)
    with open(f"{folder}/{name}.yaml", "w", encoding="utf-8") as out:
        out.write(f"mechanism: chain\nurdf: {name}.urdf\nbase_link: base\ntip_link: link{JOINTS}\n")
    return f"{folder}/{name}.yaml"


def in_any_unit(values, name):
    """Reports name the unit where all joints share one (rms_Nm), and no unit where they do not (rms)."""
    return next(values[key] for key in (name, name + "_N", name + "_Nm", name + "_A") if key in values)


def play(case, programs, shop, keep):
    folder = f"{shop}/{case.name()}"
    os.makedirs(folder, exist_ok=True)
    plant = os.path.join(os.path.dirname(os.path.dirname(os.path.dirname(programs))), "campaign", "chain_plant")
    robot_file(case.arm, folder, case.arm.urdf(), "true")
    robot = robot_file(case.arm, folder, case.arm.wrong_urdf(), "arm")
    recordings = [record(case, which, folder, plant) for which in (0, 1)]
    started = time.time()
    run([os.path.join(programs, "trace"), "--robot", robot, "--train", recordings[0], "--validate", recordings[1], "--output", folder + "/traced"],
        folder + "/log.txt")
    with open(folder + "/traced/report.json", encoding="utf-8") as source:
        report = json.load(source)
    truth = [{"name": case.effect, "actuator": case.joint + 1}] if case.effect else []
    result = {"id": case.name(), "kind": case.kind, "setting": case.arm.name, "strength": case.strength, "truth": truth,
              "machine": f"chain {case.arm.rate} Hz {case.arm.law[case.joint]}", "seconds": time.time() - started,
              "effects": [{"name": e["name"], "actuators": e["actuators"], "alternatives": e["indistinguishable_from"], "p": e["p"]}
                          for e in report["effects"]]}
    for when in ("before", "after"):
        for which in ("train", "validate"):
            side = report[when][which]
            result[f"{when}_{which}"] = in_any_unit(side, "rms")
    result["floor"] = in_any_unit(report["unexplained"], "noise_floor")
    if not keep:
        shutil.rmtree(folder)
    return result


def play_chain(case, programs, folder, keep):
    try:
        return play(case, programs, folder, keep)
    except Failed as failure:
        return {"id": case.name(), "kind": case.kind, "setting": case.arm.name, "failed": str(failure)}


def excess_left(result, clean):
    """Of the squared error over that of the clean recording on the other path, what is left, %; "-" where there was hardly any."""
    same_clean, i = clean.get(result["setting"]), result["truth"][0]["actuator"] - 1
    if not same_clean:
        return "-"
    before, after, free = (x[i]**2 for x in (result["before_validate"], result["after_validate"], same_clean["before_validate"]))
    return f"{100 * max(0.0, after - free) / (before - free):.0f}" if before > 1.2 * free else "-"


def chain_summary(results):
    """Detections by effect, false additions on clean recordings, and what of the excess over the clean recording is left elsewhere."""
    done = [r for r in results if "failed" not in r]
    clean = {r["setting"]: r for r in done if r["kind"] == "clean"}
    touched = [r for r in clean.values() if r["effects"]]
    print(f"{len(done)} records of chains, {len(results) - len(done)} failed; clean {len(clean)}, touched {len(touched)}")
    for r in touched:
        print(f"  {r['setting']}: " + ", ".join(f"{e['name']}{e['actuators']}" for e in r["effects"]))
    print(f"{'effect':30}{'records':>8}{'named':>7}{'pair':>6}{'other':>7}{'none':>6}{'extra':>7}   other path: excess left of that before, %")
    totals = {"exact": 0, "pair": 0, "wrong": 0, "none": 0}
    for name in EFFECTS:
        group = [r for r in done if r["kind"] == "single" and r["truth"][0]["name"] == name]
        counts, extra, left = {"exact": 0, "pair": 0, "wrong": 0, "none": 0}, 0, []
        for r in group:
            at = r["truth"][0]["actuator"]
            here = [e for e in r["effects"] if at in e["actuators"]]
            exact = [e for e in here if e["name"] == name and not e["alternatives"]]
            pair = [e for e in here if e not in exact and (e["name"] == name or name in e["alternatives"])]
            what = "exact" if exact else "pair" if pair else "wrong" if here else "none"
            counts[what] += 1
            totals[what] += 1
            extra += sum(1 for e in r["effects"] if e not in exact and e not in pair)
            left.append(excess_left(r, clean))
        text = ", ".join(left)
        print(f"{name:30}{len(group):8}{counts['exact']:7}{counts['pair']:6}{counts['wrong']:7}{counts['none']:6}{extra:7}   {text}")
    print("all: " + ", ".join(f"{k} {v}" for k, v in totals.items()))
    for r in (r for r in done if r["kind"] == "unlisted"):
        named = ", ".join(f"{e['name']} {e['actuators']}" for e in r["effects"]) or "nothing"
        print(f"unlisted {r['truth'][0]['name']} on {r['truth'][0]['actuator']}, strength {r['strength']}: {named}; "
              f"other path: excess left of that before, {excess_left(r, clean)} %")
