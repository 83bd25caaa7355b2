"""Cases of the injection campaign, in an order in which any beginning is a fair sample."""
import json
import os
import random
import re
import shutil
import time

import numpy as np

from campaign import effects
from campaign.records import Failed, Setting, Workshop, low_passed_forces, run


TRAINED = (0, 2)  # the first path and, where there is one, the third; the second is validated on


class Case:
    def __init__(self, kind, setting, parts, strength):
        self.kind, self.setting, self.parts, self.strength = kind, setting, parts, strength
        self.draw = random.Random(f"{setting.name()} {kind} {parts} {strength}")

    def name(self):
        what = "+".join(self.parts) or "clean"
        return f"{self.kind}-{what}-{self.strength}-{self.setting.name()}"


def all_cases(split, clean, seeds, training_paths=1):
    """Settings are numbered; effects take them in turn, so that every effect meets other machines and controllers."""
    cases = [Case("clean", Setting(split, k, "robot", training_paths), [], 0) for k in range(clean)]
    cases += [Case("clean", Setting(split, k, "simbody", training_paths), [], 0) for k in range(max(1, clean // 6))]
    taken = 0
    for _ in range(seeds):
        groups = [("single", [name], strength, "robot") for name in effects.ROBOT for strength in (1, 2, 3)]
        groups += [("absorbed", [name], 2, "robot") for name in effects.ABSORBED]
        groups += [("pair", list(pair), 3, "robot") for pair in effects.PAIRS]
        groups += [("single", [name], strength, "simbody") for name in effects.SIMBODY for strength in (2, 3)]
        groups += [("unlisted", [name], strength, "simbody") for name in effects.UNLISTED for strength in (2, 3)]
        for kind, parts, strength, plant in groups:
            numbers = clean if plant == "robot" else max(1, clean // 6)
            cases.append(Case(kind, Setting(split, (5 * taken) % numbers, plant, training_paths), parts, strength))
            taken += 1
    random.Random(split).shuffle(cases)
    return cases


def robot_entry(name, strength, actuator, reference, draw):
    text = effects.ABSORBED.get(name) or effects.ROBOT[name][strength - 1]
    q = np.loadtxt(reference)[:, actuator]
    values = {"ACT": str(actuator + 1), "CENTER": f"{q.min() + draw.uniform(0.3, 0.7) * np.ptp(q):.4f}", "PERIOD": f"{draw.uniform(0.006, 0.02):.5f}"}
    for key, value in values.items():
        text = re.sub(rf"\b{key}\b", value, text)
    return text


def make_recordings(case, shop, folder):
    """A recording of each path, and the truth: list of {name, actuator}; actuator 0: all."""
    truth = []
    if case.setting.plant == "simbody":
        entries = []
        for name in case.parts:
            law = effects.SIMBODY.get(name) or effects.UNLISTED[name]
            actuator = case.draw.randrange(4)
            entries.append((law, actuator, effects.SIZES[case.strength - 1]))
            truth.append({"name": name, "actuator": actuator + 1})
        return shop.on_simbody(case.setting, entries, folder), truth
    entries = []
    actuators = case.draw.sample(range(4), max(1, len(case.parts)))
    for name, actuator in zip(case.parts, actuators):
        text = robot_entry(name, case.strength, actuator, shop.reference(case.setting, 0), case.draw)
        entries.append((name, text))
        truth.append({"name": name, "actuator": actuator + 1 if "actuators" in text else 0, "text": text})
    return shop.on_robot(case.setting, entries, folder), truth


def size_of(recording, clean):
    """Rms of the change of force over rms force of the clean record, %, in the leg where it is largest; both low-passed."""
    rows = min(len(recording), len(clean))
    change = np.sqrt(np.mean((recording[:rows] - clean[:rows]) ** 2, axis=0))
    return float(np.max(100 * change / np.sqrt(np.mean(clean[:rows] ** 2, axis=0))))


def clean_forces(case, shop):
    """Of the training record of the same machine without effects; kept, because many cases share it."""
    path = f"{shop.folder}/forces-{case.setting.name()}.npy"
    if not os.path.exists(path):
        folder = f"{shop.folder}/clean-{case.name()}"
        os.makedirs(folder, exist_ok=True)
        recordings, _ = make_recordings(Case("clean", case.setting, [], 0), shop, folder)
        np.save(path, low_passed_forces(recordings[0]))
        shutil.rmtree(folder)
    return np.load(path)


def reachable(case, shop, folder, cutoff_hz):
    """Error on the other path, in the same band, of whoever knows the effect's force at every moment and refits the baseline beside it. A
    ripple's phase on another recording stays unknown: there the effect is left in."""
    unknown = "screw_ripple" in case.parts
    run([shop.program("trace"), "--most", "0", "--cutoff-hz", str(cutoff_hz), "--robot", shop.robot_file(case.setting),
         "--train", *[f"{folder}/ideal_{k + 1}.csv" for k in TRAINED if k < len(case.setting.paths)],
         "--validate", f"{folder}/path_2.csv" if unknown else f"{folder}/ideal_2.csv",
         "--output", folder + "/reachable"], folder + "/log.txt")
    with open(folder + "/reachable/report.json", encoding="utf-8") as source:
        return json.load(source)["before"]["validate"]["rms_N"]


def play(case, shop, keep):
    """Makes the recordings, traces them, and returns what the summary needs."""
    folder = f"{shop.folder}/{case.name()}"
    os.makedirs(folder, exist_ok=True)
    recordings, truth = make_recordings(case, shop, folder)
    result = {"id": case.name(), "kind": case.kind, "setting": case.setting.name(), "machine": case.setting.text(), "strength": case.strength,
              "truth": truth}
    if case.parts:
        result["size_percent"] = size_of(low_passed_forces(recordings[0]), clean_forces(case, shop))
    started = time.time()
    run([shop.program("trace"), "--robot", shop.robot_file(case.setting), "--train",
         *[recordings[k] for k in TRAINED if k < len(recordings)], "--validate", recordings[1], "--output", folder + "/traced",
         "--seed", str(1 + case.draw.randrange(10**6))], folder + "/log.txt")
    result["seconds"] = time.time() - started
    with open(folder + "/traced/report.json", encoding="utf-8") as source:
        report = json.load(source)
    result["effects"] = [{"name": e["name"], "actuators": e["actuators"], "alternatives": e["indistinguishable_from"], "p": e["p"]}
                         for e in report["effects"]]
    for when in ("before", "after"):
        for which in ("train", "validate"):
            result[f"{when}_{which}"] = report[when][which]["rms_N"]
    result["floor"] = report["unexplained"]["noise_floor_N"]
    result["absorbed"] = report["absorbed"]
    if case.parts:
        result["reachable"] = reachable(case, shop, folder, report["data"]["cutoff_hz"])
    if not keep:
        shutil.rmtree(folder)
    return result


def play_one(case, programs, folder, keep):
    """What a worker is given: a chain of programs that ends badly is a result."""
    try:
        return play(case, Workshop(programs, folder), keep)
    except Failed as failure:
        return {"id": case.name(), "kind": case.kind, "setting": case.setting.name(), "failed": str(failure)}
