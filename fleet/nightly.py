"""One night's run over a catalogue: what is done is not done again, what fails costs itself only."""
from __future__ import annotations

import dataclasses
import json
import pathlib
import time
from collections.abc import Iterable, Iterator
from typing import Any

import pandas as pd

from fleet import work
from fleet.catalogue import Session
from fleet.engine import Done, Engine, Progress, Task
from fleet.store import Store

FOLD_EVERY_S = 30.0
USED = ("identify", "predict", "trace")  # programs whose content is part of a key
OWN = ("follow.py", "work.py")  # and of this package


@dataclasses.dataclass(frozen=True)
class Options:
    """Of a night's run. trace: every session, or none (`changes` is done afterwards by the caller)."""

    programs: pathlib.Path
    trace: str = "every"
    seconds: float = 600.0
    memory_bytes: int = 4 * 1024**3


@dataclasses.dataclass
class Summary:
    """What a run did."""

    sessions: int = 0
    kept: int = 0
    done: int = 0
    failures: list[tuple[str, str, str]] = dataclasses.field(default_factory=list)  # robot, session, sentence
    seconds: float = 0.0
    in_tasks_s: float = 0.0


@dataclasses.dataclass
class _Robot:
    """A robot's sessions while its first day's model is wanted."""

    jobs: list[work.Job]
    keys: list[str]  # of the baseline that each session would make
    at: int = 0


class Night:
    """Plans and leads one run."""

    def __init__(self, store: Store, engine: Engine, options: Options) -> None:
        self._store, self._engine, self._options = store, engine, options
        self._programs = work.fingerprint(*[_program(options.programs / name) for name in USED],
                                          *[work.file_fingerprint(pathlib.Path(work.__file__).parent / name) for name in OWN])
        self._identify = _program(options.programs / "identify")
        self._kinds: dict[str, str] = {}
        self._known: dict[tuple[str, str], dict[str, Any]] = {}
        self.summary = Summary()

    def run(self, sessions: list[Session], traced: Iterable[tuple[str, str]] = ()) -> Summary:
        """Does what is not done. `traced`: (robot, session) that want a trace although options say none."""
        began = time.monotonic()
        self._store.fold()
        self._known = {(r["robot"], r["session"]): r for r in self._store.table("sessions").to_dict("records")}
        robots, wanted = self._plan(sessions, set(traced))
        self.summary = Summary(sessions=len(sessions), kept=len(sessions) - sum(len(jobs) for jobs in wanted.values()))
        progress = Progress(sum(len(jobs) for jobs in wanted.values()), "sessions")
        folded = time.monotonic()
        for done in self._engine.run(self._first(robots, wanted), lambda d: self._then(d, robots, wanted)):
            self.summary.in_tasks_s += done.seconds
            if done.task.function is work.do_session:
                self._ended(done, progress)
            elif robots[done.task.arguments[0].robot].at < 0:
                self._lost(done, wanted, progress)
            if time.monotonic() - folded > FOLD_EVERY_S:
                self._store.fold()
                folded = time.monotonic()
        self._store.fold()
        self.summary.seconds = time.monotonic() - began
        return self.summary

    # -- plan

    def _plan(self, sessions: list[Session], traced: set[tuple[str, str]]) -> tuple[dict[str, _Robot], dict[str, list[work.Job]]]:
        """All robots with their sessions in order, and the sessions that are to be done."""
        robots: dict[str, _Robot] = {}
        wanted: dict[str, list[work.Job]] = {}
        for s in sessions:
            kind = self._kind(s.robot_file)
            stamp, content = self._content(s)
            baseline = work.fingerprint(content, kind, self._identify)
            trace = self._options.trace == "every" or (s.robot, s.name) in traced or bool(self._known.get((s.robot, s.name), {}).get("traced"))
            job = work.Job(s.robot, s.day.isoformat(), s.name, s.recording, s.robot_file, kind, "", stamp, str(self._options.programs),
                           str(self._store.robot(s.robot)), "", trace, self._options.seconds, self._options.memory_bytes)
            robot = robots.setdefault(s.robot, _Robot([], []))
            robot.jobs.append(job)
            robot.keys.append(baseline)
        for name, robot in robots.items():
            base = self._baseline(name)
            if base is None or base["key"] not in robot.keys:
                wanted[name] = robot.jobs
                continue
            robot.at = -1
            wanted[name] = [job for job in (self._keyed(j, base["key"]) for j in robot.jobs) if not self._is_done(job)]
        return robots, wanted

    def _kind(self, robot_file: str) -> str:
        if robot_file not in self._kinds:
            self._kinds[robot_file] = f"{pathlib.Path(robot_file).stem}-{work.file_fingerprint(robot_file)[:8]}"
        return self._kinds[robot_file]

    def _content(self, s: Session) -> tuple[str, str]:
        """Stamp (size, time of change, content) and fingerprint of a recording. An unchanged size and time stand for an unchanged content."""
        try:
            stat = pathlib.Path(s.recording).stat()
        except OSError:
            return "", "absent"
        quick = f"{stat.st_size} {stat.st_mtime_ns}"
        known = str(self._known.get((s.robot, s.name), {}).get("stamp", "")).rsplit(" ", 1)
        content = known[1] if len(known) == 2 and known[0] == quick else work.file_fingerprint(s.recording)
        return f"{quick} {content}", content

    def _baseline(self, robot: str) -> dict[str, Any] | None:
        try:
            said: dict[str, Any] = json.loads((self._store.robot(robot) / "baseline" / "baseline.json").read_text(encoding="utf-8"))
            return said
        except (OSError, ValueError):
            return None

    def _keyed(self, job: work.Job, baseline: str) -> work.Job:
        content = job.stamp.rsplit(" ", 1)[-1] if job.stamp else "absent"
        key = work.fingerprint(job.robot, job.session, content, job.kind, self._programs, baseline, str(job.trace))
        return dataclasses.replace(job, key=key, journal=str(self._store.journal_file(key)))

    def _is_done(self, job: work.Job) -> bool:
        known = self._known.get((job.robot, job.session))
        return known is not None and known["key"] == job.key and bool(known["final"])

    # -- run

    def _first(self, robots: dict[str, _Robot], wanted: dict[str, list[work.Job]]) -> Iterator[Task]:
        """Robots without a model begin with it, the others with their sessions."""
        for name, robot in robots.items():
            if robot.at >= 0:
                yield self._baseline_task(robot)
            else:
                yield from self._session_tasks(wanted[name])

    def _baseline_task(self, robot: _Robot) -> Task:
        job = robot.jobs[robot.at]
        return Task(f"first-{job.robot}-{job.session}", work.make_baseline, (job, robot.keys[robot.at]))

    @staticmethod
    def _session_tasks(jobs: list[work.Job]) -> Iterator[Task]:
        for job in jobs:
            yield Task(f"{job.robot}-{job.session}", work.do_session, (job,))

    def _then(self, done: Done, robots: dict[str, _Robot], wanted: dict[str, list[work.Job]]) -> list[Task]:
        """After a first day's model: the robot's sessions; after a first day that failed: the next day."""
        if done.task.function is not work.make_baseline:
            return []
        job: work.Job = done.task.arguments[0]
        robot = robots[job.robot]
        if not done.sentence and done.value["state"] == "done":
            key, robot.at = robot.keys[robot.at], -1
            wanted[job.robot] = [self._keyed(j, key) for j in robot.jobs]
            # A day that made no model has failed already, and is not tried against another day's.
            return list(self._session_tasks(wanted[job.robot]))
        if robot.at + 1 < len(robot.jobs):
            robot.at += 1
            return [self._baseline_task(robot)]
        robot.at = -1
        return []

    def _ended(self, done: Done, progress: Progress) -> None:
        job: work.Job = done.task.arguments[0]
        sentence = done.sentence or done.value["sentence"]
        if sentence:
            self.summary.failures.append((job.robot, job.session, sentence))
        else:
            self.summary.done += 1
        progress.add(done, bool(sentence))

    def _lost(self, done: Done, wanted: dict[str, list[work.Job]], progress: Progress) -> None:
        """No day of this robot made a model."""
        job: work.Job = done.task.arguments[0]
        if not done.sentence and done.value["state"] == "done":
            return
        sentence = done.sentence or done.value["sentence"]
        for one in wanted[job.robot]:
            self.summary.failures.append((one.robot, one.session, f"robot {one.robot} has no day that makes a model; the last one said: {sentence}"))
            progress.add(done, True)


def _program(path: pathlib.Path) -> str:
    return work.file_fingerprint(path) if path.exists() else "absent"


def latest_sessions(sessions: pd.DataFrame, changes: pd.DataFrame) -> list[tuple[str, str]]:
    """(robot, session) of the last day that was done of every robot that changed: where `trace` has most to find."""
    done = sessions[sessions["state"] == "done"].sort_values("day")
    last = done.groupby("robot")["session"].last()
    return [(robot, str(last[robot])) for robot in sorted(set(changes["robot"])) if robot in last.index]
