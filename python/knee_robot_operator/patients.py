"""Patient files (docs/safety.md) from the numbers of a form."""
import math
import os

import yaml

from .answer import Refused

LARGEST = 16_384
_MOST_BRACKETS = 50  # a patient file has nine; thousands, nested, would keep the reader busy for half a minute
_RANGES = ("X_m", "Z_m", "theta_deg", "psi_deg")
_SPEEDS = ("linear_mm_per_s", "angular_deg_per_s")


class NoPatientFile(Refused):
    """A file that is sound, and about something else."""


def _number(value, what):
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
        raise Refused(400, f"{what} must be a number")
    return float(value)


def describe_all(folder):
    """All patient files of the folder, with their names; of one that cannot be read the `problem`. Other YAML files may lie there, too."""
    found = []
    for entry in folder.entries():
        try:
            found.append({"name": entry["name"], **describe(folder, entry["name"])})
        except NoPatientFile:
            continue
        except Refused as refused:
            found.append({"name": entry["name"], "problem": str(refused)})
    return found


def describe(folder, name):
    """What a patient file says, for the page: {patient, pose, speed}; Refused when it cannot be read. The controller judges it itself."""
    path = folder.existing(name)
    if path.stat().st_size > LARGEST:
        raise NoPatientFile(400, f"{name} is too large for a patient file")
    try:
        text = path.read_text()
        if text.count("[") + text.count("{") > _MOST_BRACKETS:
            raise NoPatientFile(400, f"{name} is no patient file")
        content = yaml.load(text, Loader=yaml.CSafeLoader)
    except (OSError, UnicodeDecodeError, yaml.YAMLError, RecursionError) as error:
        raise Refused(400, f"{name} cannot be read: {str(error).splitlines()[0]}") from None
    if not isinstance(content, dict) or "patient" not in content:
        raise NoPatientFile(400, f"{name} is no patient file: it has no key 'patient'")
    return {key: content.get(key) for key in ("patient", "pose", "speed")}


def write(folder, name, patient, pose, speed):
    """A new patient file; nothing is ever overwritten. Refused with the value that is wrong."""
    path = folder.new(name)
    if not (isinstance(patient, str) and 0 < len(patient) <= 40 and patient.isprintable()):
        raise Refused(400, "the patient's number or short name has 1 to 40 printable characters")
    if not isinstance(pose, dict) or not isinstance(speed, dict):
        raise Refused(400, "pose and speed are needed")
    ranges = {}
    for key in _RANGES:
        values = pose.get(key)
        if not (isinstance(values, list) and len(values) == 2):
            raise Refused(400, f"{key} needs two numbers")
        low, high = (_number(v, key) for v in values)
        if not low < high:
            raise Refused(400, f"{key}: {low:g} must be less than {high:g}")
        ranges[key] = [low, high]
    speeds = {}
    for key in _SPEEDS:
        speeds[key] = _number(speed.get(key), key)
        if not speeds[key] > 0:
            raise Refused(400, f"{key} must be above 0")
    text = yaml.safe_dump({"patient": patient, "pose": ranges, "speed": speeds}, sort_keys=False, allow_unicode=True)
    try:
        descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o640)
        with os.fdopen(descriptor, "w") as file:
            file.write(text)
    except OSError as error:
        raise Refused(500, f"{name} cannot be written: {error.strerror}") from None
