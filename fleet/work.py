"""What a worker does: the first day's model of a robot, and every later session. Only this, follow and programs are needed on a worker."""
from __future__ import annotations

import dataclasses
import hashlib
import json
import pathlib
import shutil
import tempfile
import time
from typing import Any

from fleet.follow import Quantity, follow
from fleet.programs import Limits, run
from fleet.store_file import write_whole

Z = 1.96


@dataclasses.dataclass(frozen=True)
class Job:
    """One session, as text and numbers only. `model`: the first day's, empty while it is wanted. `kind`: fingerprint of the robot file."""

    robot: str
    day: str
    session: str
    recording: str
    robot_file: str
    kind: str
    key: str
    stamp: str
    programs: str
    folder: str  # of the robot
    journal: str
    trace: bool
    seconds: float
    memory_bytes: int

    @property
    def limits(self) -> Limits:
        return Limits(self.seconds, self.memory_bytes)


def fingerprint(*parts: str) -> str:
    """One short name for several."""
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()[:20]


def file_fingerprint(path: str | pathlib.Path) -> str:
    """Of a file's content."""
    with open(path, "rb") as source:
        return hashlib.file_digest(source, "sha256").hexdigest()[:20]


def make_baseline(job: Job, key: str) -> dict[str, Any]:
    """`identify` on a first day; the model appears whole or not at all. What to do about failures is the leader's."""
    final = pathlib.Path(job.folder) / "baseline"
    part = final.with_name(f".baseline-{job.session}.part")
    shutil.rmtree(part, ignore_errors=True)
    part.mkdir(parents=True)
    try:
        outcome = run([pathlib.Path(job.programs) / "identify", "--robot", job.robot_file, "--train", job.recording, "--output", part], job.limits)
        if outcome.done:
            said = {"key": key, "session": job.session, "day": job.day, "recording": job.recording, "processor_s": outcome.processor_s}
            write_whole(part / "baseline.json", json.dumps(said))
            shutil.rmtree(final, ignore_errors=True)
            part.rename(final)
            return {"state": "done", "sentence": "", "final": False, "processor_s": outcome.processor_s}
        return {"state": "failed", "sentence": outcome.sentence, "final": outcome.final, "processor_s": outcome.processor_s}
    finally:
        shutil.rmtree(part, ignore_errors=True)


def do_session(job: Job) -> dict[str, Any]:
    """Follows one session, traces it where that is asked for, and writes its journal entry. Returns the entry's `session`."""
    began = time.perf_counter()
    entry: dict[str, Any] = {"robot": job.robot, "day": job.day, "session": job.session, "recording": job.recording, "kind": job.kind, "key": job.key,
                             "stamp": job.stamp, "state": "done", "final": True, "sentence": "", "movement": "", "effects": "", "traced": job.trace,
                             "processor_s": 0.0, "seconds": 0.0, "peak_bytes": 0}
    quantities: list[Quantity] = []
    try:
        quantities, entry["movement"] = _followed(job, entry)
        if job.trace:
            _trace(job, entry)
    except ValueError as error:  # also what pandas says of a table that is none
        entry.update(state="failed", sentence=" ".join(str(error).split()), final=getattr(error, "final", True))
    except OSError as error:
        entry.update(state="failed", sentence=f"{job.recording}: {error.strerror or error}", final=False)
    entry["seconds"] = time.perf_counter() - began
    rows = [_row(job, entry["movement"], q) for q in quantities]
    write_whole(pathlib.Path(job.journal), json.dumps({"session": entry, "quantities": rows if entry["state"] == "done" else []}))
    return entry


def _followed(job: Job, entry: dict[str, Any]) -> tuple[list[Quantity], str]:
    if not pathlib.Path(job.recording).exists():
        raise FileNotFoundError(2, "no such recording", job.recording)
    with tempfile.TemporaryDirectory(prefix="fleet-session-") as scratch:
        quantities, movement, spent = follow(pathlib.Path(job.programs), job.robot_file, str(pathlib.Path(job.folder) / "baseline" / "model.yaml"),
                                             job.recording, pathlib.Path(scratch), job.limits)
    entry["processor_s"] += spent
    return quantities, movement


def _trace(job: Job, entry: dict[str, Any]) -> None:
    """`trace --model` with the first day's model; its report stays beside it."""
    final = pathlib.Path(job.folder) / job.session
    part = final.with_name(f".{job.session}.part")
    shutil.rmtree(part, ignore_errors=True)
    part.mkdir(parents=True)
    try:
        outcome = run([pathlib.Path(job.programs) / "trace", "--robot", job.robot_file, "--model", pathlib.Path(job.folder) / "baseline" / "model.yaml",
                       "--train", job.recording, "--output", part], job.limits)
        entry["processor_s"] += outcome.processor_s
        entry["peak_bytes"] = outcome.peak_bytes
        if not outcome.done:
            entry.update(state="failed", sentence=outcome.sentence, final=outcome.final)
            return
        report = json.loads((part / "report.json").read_text(encoding="utf-8"))
        entry["effects"] = json.dumps([{"name": e["name"], "actuators": e["actuators"], "or": e["indistinguishable_from"]} for e in report["effects"]])
        shutil.rmtree(final, ignore_errors=True)
        part.rename(final)
    finally:
        shutil.rmtree(part, ignore_errors=True)


def _row(job: Job, movement: str, q: Quantity) -> dict[str, Any]:
    return {"robot": job.robot, "day": job.day, "session": job.session, "kind": job.kind, "movement": movement, "quantity": q.name, "leg": q.leg,
            "value": q.value, "low": q.value - Z * q.std, "high": q.value + Z * q.std, "std": q.std, "unit": q.unit}
