"""From a goal of the action identify_recordings to a command line, and from the program's files to a result. Knows no ROS."""
import csv
import json
import math
import pathlib
import re

COMMANDS = ("identify", "trace", "compare")
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,99}\Z")
_OPTION = re.compile(r"([a-z][a-z-]{1,40})(?:=([A-Za-z0-9.,+-]{1,40}))?\Z")
_OPTIONS = {
    "identify": {"cutoff-hz", "motion-cutoff-hz", "rate-hz", "moving-m-per-s", "condition-max", "fold-margin-m", "joint-friction",
                 "narrowest-counts", "outliers", "no-physical", "rank"},
    "trace": {"cutoff-hz", "seed", "most", "moving-m-per-s"},
    "compare": {"condition-max"}}
MOST_RECORDINGS = 20

# What the programs say on standard error, in the order in which they say it, and the share of the stages behind each.
_STAGES = {
    "identify": ((r"reading", 0.05), (r"fitting$", 0.3), (r"fitting physically", 0.8)),
    "trace": ((r"reading", 0.03), (r"fitting the baseline", 0.08), (r"simulating .*clean", 0.15), (r"looking at moving", 0.3),
              (r"comparing with", 0.35), (r"found ", 0.4), (r"simulating .*have what", 0.45), (r"looking at all", 0.55),
              (r"looking for what", 0.8), (r"planning", 0.9), (r"pose", 0.93)),
    "compare": ((r"reading", 0.3),)}


class BadGoal(Exception):
    """One sentence: what is wrong with the goal and how to mend it."""


class Share:
    """How much of the stages lies behind; never falls."""

    def __init__(self, command):
        self._stages = _STAGES[command]
        self.value = 0.0

    def hear(self, line):
        for pattern, share in self._stages:
            if re.match(pattern, line):
                self.value = max(self.value, share)
        return self.value


def _recording(folder, name):
    if not _NAME.match(name) or not name.endswith(".csv"):
        raise BadGoal(f"'{name[:60]}' is no name of a recording: letters, digits, '.', '_', '-' and the ending .csv")
    path = (folder / name).resolve()
    if not path.is_relative_to(folder.resolve()) or not path.is_file():
        raise BadGoal(f"there is no recording {name} in {folder}")
    return str(path)


def _options(command, options):
    words = []
    for option in options:
        match = _OPTION.match(option)
        if not match or match[1] not in _OPTIONS[command]:
            raise BadGoal(f"option '{option[:60]}' is not among those of {command}: {', '.join(sorted(_OPTIONS[command]))}")
        words.append(f"--{match[1]}" + (f"={match[2]}" if match[2] is not None else ""))
    return words


def command_line(goal, recordings, default_robot, output):
    """The words after the program's name, for a goal with the fields of the action. BadGoal when it may not be run."""
    if goal.command not in COMMANDS:
        raise BadGoal(f"command '{goal.command[:40]}' is none of {', '.join(COMMANDS)}")
    recordings = pathlib.Path(recordings)
    robot = pathlib.Path(goal.robot or default_robot)
    if robot.suffix not in (".yaml", ".yml") or not robot.is_file():
        raise BadGoal(f"there is no robot file {robot}")
    train = [_recording(recordings, name) for name in goal.train]
    validate = [_recording(recordings, name) for name in goal.validate]
    if len(train) + len(validate) > MOST_RECORDINGS:
        raise BadGoal(f"at most {MOST_RECORDINGS} recordings at a time")
    if not train:
        raise BadGoal("name at least one recording to train with")
    if len(set(train + validate)) != len(train + validate):
        raise BadGoal("a recording is named twice; what a model is fitted to cannot validate it")
    if goal.model and not pathlib.Path(goal.model).is_file():
        raise BadGoal(f"there is no model file {goal.model}")
    words = [goal.command, "--robot", str(robot), "--output", str(output), *_options(goal.command, goal.options)]
    if goal.command == "compare":
        if len(train) != 1 or validate:
            raise BadGoal("compare looks at exactly one recording, under train")
        return [*words, train[0]]
    if goal.start_from_model and not (goal.command == "trace" and goal.model):
        raise BadGoal("start_from_model needs the command trace and a model")
    if goal.start_from_model:
        words += ["--model", goal.model]
    words += ["--train", *train]
    return words + (["--validate", *validate] if validate else [])


def output_name(goal, stamp):
    """The result's folder by name; BadGoal when it is none."""
    name = goal.output or f"{goal.command}_{stamp}"
    if not _NAME.match(name):
        raise BadGoal(f"output '{name[:60]}' is no name: letters, digits, '.', '_' and '-' only")
    return name


def figures(folder):
    """{before, after (rms in N per actuator), effects} of the report.json of a folder; empty lists where it has none."""
    report = json.loads((pathlib.Path(folder) / "report.json").read_text())
    found = {"before": [], "after": [], "effects": []}
    for when in ("before", "after"):
        parts = report.get(when) or {}
        errors = parts.get("validate") or parts.get("train") or {}
        found[when] = [float(v) for v in errors.get("rms_N") or [] if v is not None]
    for effect in report.get("effects") or []:
        actuators = ", ".join(str(a) for a in effect.get("actuators") or [])
        found["effects"].append(effect["name"] + (f" ({actuators})" if actuators else ""))
    return found


def prediction_error(folder, recordings):
    """rms (N) per actuator of force minus prediction over all rows of prediction_NAME.csv of the recordings; [] when one is missing."""
    squares, count = {}, 0
    for recording in recordings:
        file = pathlib.Path(folder) / f"prediction_{pathlib.Path(recording).name}"
        if not file.is_file():
            return []
        with open(file, newline="") as rows:
            for row in csv.DictReader(rows):
                count += 1
                for i in range(1, 5):
                    if f"force_{i}_N" in row:
                        error = float(row[f"force_{i}_N"]) - float(row[f"predicted_{i}_N"])
                        squares[i] = squares.get(i, 0.0) + error * error
    return [math.sqrt(squares[i] / count) for i in sorted(squares)] if count else []
