"""What the paper prints in its tables and figures, and the same of a run of scripts/paper_evaluation.

Every table comes as (head, rows); beside it a list of comparisons (what, paper, here, verdict), verdict "missed", "differs" or "met"."""
import csv
import json
import math
import pathlib
import re

import yaml

from curves import panel

ROOT = pathlib.Path(__file__).resolve().parents[2]
MOVEMENTS = ("paper_test", "hip_flexion", "knee_flexion", "knee_rotation", "ankle_flexion")
AMPLITUDES = {"paper_test": (0.2, "m"), "hip_flexion": (0.2, "m"), "knee_flexion": (0.2, "m"), "knee_rotation": (15, "deg"), "ankle_flexion": (30, "deg")}
CAUSES = {"all": "all causes", "noise_and_frame": "noise and frame alone", "play": "noise, frame, play in the joints",
          "lengths_at_home": "noise, frame, wrong lengths at home"}
COORDINATES = (("x", "Xm mm", 1e3), ("z", "Zm mm", 1e3), ("theta", "theta deg", 180.0 / math.pi), ("psi", "psi deg", 180.0 / math.pi))
ACTUATORS = (1.0, 1.0, 1.0, 2.0)     # mm, Fig. 15
POSE = (30.0, 10.0, 2.5, 7.0)        # Fig. 16
K_LIMIT = 300                        # of the excitation, section 2.1.5
ZEIGLER_PERCENT = 5
GEOMETRIES = {"starting": {"R_m": [0.4] * 3, "ds_m": 0, "beta_FD_deg": 50, "beta_FI_deg": 40, "Rm_m": [0.2] * 3, "beta_MD_deg": 40, "beta_MI_deg": 30},
              "final": {"R_m": [0.4] * 3, "ds_m": 0.15, "beta_FD_deg": 90, "beta_FI_deg": 45, "Rm_m": [0.3] * 3, "beta_MD_deg": 50, "beta_MI_deg": 90}}
WITHOUT_EFFECT = ("m_11 m_21 m_31 m_41 IXX_41 IXY_41 IXZ_41 IYY_41 IYZ_41 IXX_42 IXY_42 IXZ_42 IYZ_42 IZZ_42 mY_42 mZ_41").split()
BASE = (34, 56)                      # rigid ones, and with the 22 of friction
ERRORS = {"train": ("Table 3, identification", (0.2918, 0.0957, 0.4196, 0.6259), (1.869, 0.696, 1.457, 0.847)),
          "validate": ("Table 4, verification", (0.5050, 0.1805, 1.1703, 1.4822), (3.458, 4.492, 14.537, 15.806))}
LEGS = ("leg 1", "leg 2", "leg 3", "leg 4")


def verdict(good, bad="missed"):
    return "met" if good else bad


def largest(figures, factor):
    """The largest error of one entry of compare's report, in the table's unit; nan where there is none."""
    return next((factor * v for k, v in figures.items() if k.startswith("max_") and v is not None), math.nan)


def numbers(values, places=2):
    return tuple("-" if math.isnan(v) else f"{v:.{places}f}" for v in values)


def report(folder, movement, cause):
    return json.loads((folder / "compared" / f"{movement}.{cause}" / "report.json").read_text(encoding="utf-8"))


def compared(name, paper, here, places=2):
    """One comparison of largest errors, axis by axis: met where none is larger than the paper's."""
    good = all(a <= b for a, b in zip(here, paper))
    return (name, " / ".join(f"{v:g}" for v in paper), " / ".join(numbers(here, places)), verdict(good))


def actuators(folder):
    figures = {m: [largest(a, 1e3) for a in report(folder, m, "all")["actuators"]] for m in MOVEMENTS}
    rows = [(m, *numbers(values)) for m, values in figures.items()] + [("paper (test movement)", *(f"{v:g}" for v in ACTUATORS))]
    worst = [max(column) for column in zip(*figures.values())]
    return (("largest error, mm", *LEGS), rows), [compared("Fig. 15: largest error of the legs in all movements, mm", ACTUATORS, worst)]


def poses(folder):
    def of(movement, cause):
        return [largest(report(folder, movement, cause)["camera"]["camera_minus_reference"][k], f) for k, _, f in COORDINATES]

    names = tuple(name for _, name, _ in COORDINATES)
    figures = {m: of(m, "all") for m in MOVEMENTS}
    rows = [(m, *numbers(values)) for m, values in figures.items()] + [("paper (test movement)", *(f"{v:g}" for v in POSE))]
    why = [(words, *numbers(of("paper_test", cause))) for cause, words in CAUSES.items()]
    why.append(("encoders, no camera", *numbers(largest(report(folder, "paper_test", "all")["pose"][k], f) for k, _, f in COORDINATES)))
    worst = [max(column) for column in zip(*figures.values())]
    return (("largest error", *names), rows), (("paper_test seen with", *names), why), [
        compared("Fig. 16: camera against reference, Xm mm / Zm mm / theta deg / psi deg", POSE, worst)]


def amplitudes(folder):
    """Section 2.2's movements beside what fits within the limits of the robot that played them."""
    result = []
    for movement, (paper, unit) in AMPLITUDES.items():
        planned = float(re.search(rf"amplitude ([\d.e-]+) {unit}", (folder / "references" / f"{movement}.plan").read_text(encoding="utf-8"))[1])
        result.append((f"amplitude of {movement} that fits, {unit}", f"{paper:g}", f"{planned:g}", verdict(planned > 0.999 * paper)))
    return result


def geometry():
    """Table 1 beside the robot files."""
    rows, equal = [], True
    for name, paper in GEOMETRIES.items():
        ours = yaml.safe_load((ROOT / "config" / "robots" / f"{name}.yaml").read_text(encoding="utf-8"))["geometry"]
        for key, value in paper.items():
            rows.append((f"{name}, {key}", str(value), str(ours[key]), "equal" if ours[key] == value else "differs"))
            equal &= ours[key] == value
    return (("", "paper", "robot file", ""), rows), [("Table 1: both geometries", "14 entries", f"config/robots, {'equal' if equal else 'not equal'}",
                                                      verdict(equal))]


def parameters(folder):
    """Table 2 and the number of base parameters, from what scripts/paper_findings printed; None when it is not there."""
    file = folder / "findings.txt"
    parts = re.split(r"^4\. Base parameters of the (\w+) geometry", file.read_text(encoding="utf-8") if file.is_file() else "", flags=re.M)[1:]
    rows, comparisons = [("paper", str(len(WITHOUT_EFFECT)), str(BASE[0]), str(BASE[1]), "-")], []
    for name, words in zip(parts[::2], parts[1::2]):
        null = re.search(r"null columns: (\d+): (.*)", words)
        rigid, total = re.search(r"structural number for rich motion: (\d+) rigid \+ 22 friction = (\d+)", words).groups()
        same = set(null[2].split()) == set(WITHOUT_EFFECT)
        rows.append((name, null[1], rigid, total, "the same" if same else " ".join(sorted(set(null[2].split()) ^ set(WITHOUT_EFFECT)))))
        comparisons.append((f"Table 2: parameters without effect, {name}", "16", f"{null[1]}, {'the same' if same else 'others'}", verdict(same)))
        comparisons.append((f"base parameters, {name} (56 are what the paper's slow motion supports)", str(BASE[1]), total,
                            verdict(int(total) == BASE[1], "differs")))
    return (("geometry", "without effect", "rigid", "with friction", "names against Table 2"), rows) if comparisons else None, comparisons


def harmonics(folder):
    """Figs. 4 and 5: k over the number of harmonics; None without plans."""
    rows, comparisons = [], []
    for file in sorted((folder / "harmonics").glob("*.report"), key=lambda path: int(path.stem)):
        words = file.read_text(encoding="utf-8")
        scaled = {int(m[0]): m[1] for m in re.findall(r"^\s+(\d+)\s+([\d.e+]+)\s+[\d.e+]+\s+[\d.e+]+", words, flags=re.M)}
        seconds = re.search(r"^([\d.]+) s, ", words, flags=re.M)
        rows.append((file.stem, *(scaled.get(r, "no plan") for r in (30, 51, 56)), seconds[1] if seconds else "-"))
        if file.stem == "7":
            k = [float(scaled.get(r, "nan")) for r in (51, 56)]
            comparisons = [(f"k of 20 s with 7 harmonics at r = {r}", f"< {K_LIMIT} (r not stated)", f"{v:.0f}", verdict(v < K_LIMIT))
                           for r, v in zip((51, 56), k)]
    return (("harmonics", "k at r = 30", "k at r = 51", "k at r = 56", "planning, s"), rows) if rows else None, comparisons


def reference_picture(title, file):
    """The four actuators of a reference file, as in Figs. 4 and 5; nothing when there is no such file."""
    if not file.is_file():
        return ""
    rows = [[float(cell) for cell in line.split()] for line in file.read_text(encoding="utf-8").splitlines() if line and line[0] != "#"]
    return panel(title, "m", [0.01 * k for k in range(len(rows))], {name: list(column) for name, column in zip(("q13", "q23", "q33", "q42"), zip(*rows))})


def forces(folder, plant="eq23"):
    """Tables 3 and 4 for both geometries with the friction of eq. (23), all samples; None when there was no compatibility test."""
    tables, comparisons = [], []
    for kind, (title, newtons, percent) in ERRORS.items():
        rows = [("paper, N", *(f"{v:.3f}" for v in newtons)), ("paper, % (of what is not stated)", *(f"{v:.2f}" for v in percent))]
        for name in ("final", "starting"):
            file = folder / "compatibility" / name / plant / "report.json"
            if not file.is_file():
                return None, []
            after = json.loads(file.read_text(encoding="utf-8"))["after"][kind]
            rows += [(f"{name}, rms N", *numbers(after["rms_N"], 3)), (f"{name}, rms / rms(force) %", *numbers(after["rms_percent"])),
                     (f"{name}, rms / range(force) %", *numbers(after["range_percent"]))]
            worst = max(after["rms_percent"])
            comparisons.append((f"{title}, {name} geometry: worst leg, rms / rms(force) %", f"{max(percent):g}; at most {ZEIGLER_PERCENT} wanted",
                                f"{worst:.2f}", verdict(worst <= ZEIGLER_PERCENT)))
        tables.append((title, (("", *LEGS), rows)))
    return tables, comparisons + other_frictions(folder)


def other_frictions(folder):
    """Table 4 for plants whose friction is not the model's: harder than the paper's, which had the same friction in both."""
    comparisons = []
    for plant, words in (("presliding", "friction that builds up over 10 um"), ("spherical", "friction in the spherical joints too")):
        for name in ("final", "starting"):
            after = json.loads((folder / "compatibility" / name / plant / "report.json").read_text(encoding="utf-8"))["after"]["validate"]
            worst = max(after["rms_percent"])
            comparisons.append((f"Table 4, {name} geometry, {words}: worst leg, %", f"not done; at most {ZEIGLER_PERCENT} wanted", f"{worst:.2f}",
                                verdict(worst <= ZEIGLER_PERCENT)))
    return comparisons


def residual_picture(folder, geometry_name, plant="eq23"):
    """Fig. 13: recorded less predicted force over the verification movement."""
    home = folder / "compatibility" / geometry_name
    files = home / f"{plant}_verification.csv", home / plant / f"prediction_{plant}_verification.csv"
    if not all(file.is_file() for file in files):
        return ""
    recorded, predicted = ([*csv.DictReader(file.open(encoding="utf-8"))] for file in files)
    curves = {f"leg {i}": [float(r[f"force_{i}_N"]) - float(p[f"predicted_{i}_N"]) for r, p in zip(recorded, predicted)] for i in (1, 2, 3, 4)}
    return panel(f"{geometry_name} geometry: simulated less modelled force, every row", "N", [float(r["time_s"]) for r in recorded], curves)
