"""scripts/fleet_scale: what the engine costs, what a session costs, and what that makes of a thousand robots."""
from __future__ import annotations

import argparse
import dataclasses
import os
import pathlib
import signal
import sys
import tempfile
import threading
import time

from fleet import machines, nightly, work
from fleet.catalogue import Session
from fleet.engine import Engine, Task
from fleet.programs import ROOT, default_programs
from fleet.store import Store

TINY = 2000
SECONDS_A_YEAR = 365
ROBOTS = 6


def leave_a_mark(folder: str, name: str) -> str:
    """The tiny task: a byte in a file of its own, so that what ran twice to its end can be seen."""
    with open(pathlib.Path(folder) / name, "ab") as out:
        out.write(b"x")
    return name


@dataclasses.dataclass(frozen=True)
class Measured:
    """One run on the engine."""

    workers: int
    tasks: int
    seconds: float
    in_tasks_s: float

    @property
    def overhead_s(self) -> float:
        """Of the engine, per task, on a worker's processor."""
        return max(0.0, self.seconds * self.workers - self.in_tasks_s) / self.tasks


def tiny(workers: int, kill_every_s: float | None = None) -> tuple[Measured, int, int, int]:
    """2,000 tiny tasks; also how many were lost, how many were reported twice, and how many workers were killed on the way."""
    with tempfile.TemporaryDirectory() as folder, Engine(workers) as engine:
        list(engine.run(Task(f"warm {k}", leave_a_mark, (folder, "warm")) for k in range(4 * workers)))
        stop, killed = threading.Event(), [0]

        def kill() -> None:
            while kill_every_s is not None and not stop.wait(kill_every_s):
                for process in engine.worker_processes()[:1]:
                    os.kill(process, signal.SIGKILL)
                    killed[0] += 1

        killer = threading.Thread(target=kill)
        killer.start()
        began = time.perf_counter()
        ended = list(engine.run(Task(f"tiny {k}", leave_a_mark, (folder, str(k))) for k in range(TINY)))
        seconds = time.perf_counter() - began
        stop.set()
        killer.join()
        good = [d.value for d in ended if not d.sentence]
        return Measured(workers, TINY, seconds, sum(d.seconds for d in ended)), TINY - len(set(good)), len(good) - len(set(good)), killed[0]


def sessions_of(count: int, programs: pathlib.Path, folder: pathlib.Path) -> list[Session]:
    """Simulated sessions of several robots, for the measurement: a robot's first day goes before its others, so that one robot would make workers
    wait for each other."""
    machines.plan_references(programs, folder)
    out = []
    for k in range(count):
        steady, week = machines.machine(9000 + k % ROBOTS, drift_free=True), k // ROBOTS
        path = machines.write_session(steady, week, str(programs), str(folder))
        out.append(Session(steady.name, machines.day_of(steady.number, week), path, str(ROOT / "config" / "robots" / f"{steady.robot}.yaml")))
    return out


def follow_all(workers: int, sessions: list[Session], programs: pathlib.Path, trace: str) -> tuple[Measured, Store, tempfile.TemporaryDirectory[str]]:
    """A night's run over new sessions; every first day's model counts as one more task."""
    folder = tempfile.TemporaryDirectory()
    store = Store(pathlib.Path(folder.name) / "store")
    store.lead()
    with Engine(workers) as engine:
        list(engine.run(Task(f"warm {k}", work.fingerprint, ("x",)) for k in range(4 * workers)))
        summary = nightly.Night(store, engine, nightly.Options(programs, trace)).run(sessions)
    if summary.failures:
        raise RuntimeError(" ".join(summary.failures[0]))
    return Measured(workers, summary.done + len({s.robot for s in sessions}), summary.seconds, summary.in_tasks_s), store, folder


def bytes_in(folder: pathlib.Path) -> int:
    """Of all files."""
    return sum(p.stat().st_size for p in folder.rglob("*") if p.is_file())


def model(robots: int, per_session_s: float, trace_s: float, recording: int, row_bytes: float, report: int) -> str:
    """Cores, hours and storage for a robot's session a day."""
    lines = [f"| {robots} robots, a session of that length a day | follow only | trace every day |", "| --- | --- | --- |"]
    follow, both = robots * per_session_s / 3600.0, robots * (per_session_s + trace_s) / 3600.0
    lines.append(f"| processor hours a night | {follow:.2f} | {both:.2f} |")
    lines.append(f"| hours on 2 cores | {follow / 2:.2f} | {both / 2:.2f} |")
    lines.append(f"| cores for a night of 8 h | {max(1, -int(-follow // 8))} | {max(1, -int(-both // 8))} |")
    year = robots * SECONDS_A_YEAR
    lines.append(f"| recordings a year | {year * recording / 1e9:.1f} GB | {year * recording / 1e9:.1f} GB |")
    lines.append(f"| tables a year | {year * row_bytes / 1e9:.2f} GB | {year * row_bytes / 1e9:.2f} GB |")
    lines.append(f"| reports a year | - | {year * report / 1e9:.1f} GB |")
    return "\n".join(lines)


def main(given: list[str] | None = None) -> int:
    """Prints the tables of docs/results/fleet.md."""
    p = argparse.ArgumentParser(prog="fleet_scale", description=__doc__)
    p.add_argument("--sessions", type=int, default=48, help=f"simulated sessions of {ROBOTS} robots for the measurement (48)")
    p.add_argument("--robots", type=int, default=1000)
    p.add_argument("--without-trace", action="store_true", help="do not measure traces")
    p.add_argument("--programs", type=pathlib.Path, default=default_programs())
    a = p.parse_args(given)
    load = os.getloadavg()[0]
    print(f"{os.cpu_count()} processors, load {load:.1f} at the beginning\n")
    print("| engine | tasks | s | tasks a second | overhead a task, ms | lost | reported twice | workers killed |\n| --- | --- | --- | --- | --- | --- | --- | --- |")
    for workers, kill in ((1, None), (2, None), (2, 1.0)):
        m, lost, twice, killed = tiny(workers, kill)
        print(f"| {workers} worker{'s' if workers > 1 else ''} | {m.tasks} | {m.seconds:.1f} | {m.tasks / m.seconds:.0f} | {1e3 * m.overhead_s:.1f} | {lost} | {twice} | {killed} |",
              flush=True)
    with tempfile.TemporaryDirectory() as made:
        sessions = sessions_of(a.sessions, a.programs, pathlib.Path(made))
        recording = pathlib.Path(sessions[0].recording).stat().st_size
        print("\n| sessions of 12 s | tasks | s | sessions a second | in tasks, s a session | overhead, % of a task |\n| --- | --- | --- | --- | --- | --- |")
        row_bytes = report = 0.0
        per_session = trace_s = 0.0
        for workers, trace in ((1, "never"), (2, "never")) + (() if a.without_trace else ((2, "every"),)):
            some = sessions if trace == "never" else sessions[:2 * ROBOTS]
            m, store, folder = follow_all(workers, some, a.programs, trace)
            table = store.table("sessions")
            if trace == "never":
                per_session, row_bytes = float(table["seconds"].mean()), bytes_in(store.folder / "quantities") / len(some)
            else:
                trace_s = float(table["seconds"].mean()) - per_session
                report = float((bytes_in(store.folder / "robots") - sum(bytes_in(store.robot(r) / "baseline") for r in {s.robot for s in some})) / len(some))
            print(f"| {workers} workers, trace {trace} | {m.tasks} | {m.seconds:.1f} | {len(some) / m.seconds:.2f} | {m.in_tasks_s / m.tasks:.2f} | "
                  f"{100 * m.overhead_s * m.tasks / max(m.in_tasks_s, 1e-9):.1f} |", flush=True)
            store.release()
            folder.cleanup()
        print("\n" + model(a.robots, per_session, trace_s, recording, row_bytes, int(report)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
