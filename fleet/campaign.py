"""scripts/fleet_campaign: a fleet of simulated robots with known lives, judged night by night."""
from __future__ import annotations

import argparse
import datetime
import pathlib
import sys
import time
from collections.abc import Iterator

import pandas as pd

from fleet import changes, faults, machines, nightly, page, verdict
from fleet.catalogue import Session, read_catalogue
from fleet.engine import Engine, Progress, Task, clock
from fleet.programs import ROOT, default_programs
from fleet.store import Store


def arguments(given: list[str] | None = None) -> argparse.Namespace:
    """Reads the command line."""
    p = argparse.ArgumentParser(prog="fleet_campaign", description="Simulates a fleet (a session a week for 26 weeks, some robots wear, drift, loosen or carry "
                                "undeclared loads), runs the fleet's nightly work on the recordings and judges what it states. Goes on where it was.")
    p.add_argument("--robots", type=int, default=100, help="how many; every 50 hold 10 that wear, 3 with gain, 3 with play, 4 with loads, 30 with nothing")
    p.add_argument("--first", type=int, default=0, help="number of the first robot (another number is another fleet)")
    p.add_argument("--drift-free", action="store_true", help="nothing happens to any of them: what is stated is false")
    p.add_argument("--output", type=pathlib.Path, default=ROOT / "output" / "fleet_campaign")
    p.add_argument("--workers", type=int)
    p.add_argument("--scheduler")
    p.add_argument("--minutes", type=float, default=1e9, help="simulate no new session after this time")
    p.add_argument("--false-discovery-rate", type=float, default=0.05)
    p.add_argument("--trace", choices=["changes", "never"], default="never", help="trace the last day of robots that changed")
    p.add_argument("--summary", action="store_true", help="only judge what is there")
    p.add_argument("--programs", type=pathlib.Path, default=default_programs())
    return p.parse_args(given)


def simulate(engine: Engine, fleet: list[machines.Machine], a: argparse.Namespace) -> list[str]:
    """Makes the recordings that are lacking; sentences of those that could not be made."""
    machines.plan_references(a.programs, a.output)
    progress, failed, began = Progress(len(fleet) * machines.WEEKS, "simulated"), [], time.monotonic()

    def tasks() -> Iterator[Task]:
        for m in fleet:
            for week in range(machines.WEEKS):
                if time.monotonic() - began < 60 * a.minutes:
                    yield Task(f"simulate-{m.number}-{week}", machines.write_session, (m, week, str(a.programs), str(a.output)))

    for done in engine.run(tasks()):
        progress.add(done)
        if done.sentence:
            failed.append(f"{done.task.name}: {done.sentence}")
    return failed


def write_catalogue(fleet: list[machines.Machine], a: argparse.Namespace) -> list[Session]:
    """catalogue.csv of the recordings that are there, of robots whose weeks were all tried."""
    rows = []
    for m in fleet:
        for week in range(machines.WEEKS):
            day = machines.day_of(m.number, week).isoformat()
            path = a.output / "recordings" / m.name / f"{m.name}_{day}.csv"
            if path.exists():
                log = path.parent / "events.jsonl"
                rows.append([m.name, day, path.relative_to(a.output), ROOT / "config" / "robots" / f"{m.robot}.yaml",
                             log.relative_to(a.output) if log.exists() else ""])
    table = a.output / "catalogue.csv"
    pd.DataFrame(rows, columns=["robot", "day", "recording", "robot_file", "events"]).to_csv(table, index=False)
    return read_catalogue(table)


def judge(store: Store, fleet: list[machines.Machine], a: argparse.Namespace) -> str:
    """Replays the nights on which the fleet was looked at, once a week, and sets them beside the truth."""
    names = {m.name for m in fleet}
    quantities, sessions = store.table("quantities"), store.table("sessions")
    quantities, sessions = quantities[quantities["robot"].isin(names)], sessions[sessions["robot"].isin(names)]
    options = changes.Options(a.false_discovery_rate, machines.WEEKS)
    week_of = {pd.Timestamp(machines.FIRST_DAY + datetime.timedelta(days=7 * w + 6)): w for w in range(machines.WEEKS)}
    stops = store.faults()
    alarms = changes.nights(quantities, week_of, options, stops)
    lives = [verdict.live(m, alarms[alarms["robot"] == m.name], week_of) for m in fleet]
    found, unlike = changes.find_changes(quantities, options, stops), changes.population(quantities)
    page.write_page(store.folder, quantities, sessions, found, unlike, options)
    alarms.to_parquet(store.folder / "alarms.parquet", index=False)
    done = sessions[sessions["state"] == "done"]
    cost = (f"{len(done)} sessions of {done['robot'].nunique()} robots followed; per session {done['seconds'].mean():.2f} s in the task, "
            f"{done['processor_s'].mean():.2f} s of processor time in programs; {len(sessions) - len(done)} failed")
    return cost + "\n\n" + verdict.report(lives, alarms, sessions, week_of)


def main(given: list[str] | None = None) -> int:
    """Exit status 0 when the campaign ran, whatever it found."""
    a = arguments(given)
    a.output.mkdir(parents=True, exist_ok=True)
    fleet = [machines.machine(number, a.drift_free) for number in range(a.first, a.first + a.robots)]
    store = Store(a.output / "fleet")
    store.lead()
    try:
        if not a.summary:
            with Engine(a.workers, a.scheduler) as engine:
                failed = simulate(engine, fleet, a)
                sessions = write_catalogue(fleet, a)
                store.keep_faults(faults.faults_of((s.robot, s.events) for s in sessions if s.events)[0])
                night = nightly.Night(store, engine, nightly.Options(a.programs, "never"))
                summary = night.run(sessions)
                if a.trace == "changes":
                    found = changes.find_changes(store.table("quantities"), changes.Options(a.false_discovery_rate, machines.WEEKS))
                    night.run(sessions, nightly.latest_sessions(store.table("sessions"), found))
            print(f"{len(failed)} of {len(fleet) * machines.WEEKS} sessions could not be simulated")
            for text in sorted({f.split(": ", 1)[1] for f in failed}):
                print(f"  {sum(text in f for f in failed)} times: {text}")
            print(f"{summary.done} sessions followed now, {summary.kept} before, {len(summary.failures)} failed, in {clock(summary.seconds)}")
            for failure in summary.failures:
                print("  " + " ".join(failure))
        print(judge(store, fleet, a))
        print(f"\npage: {store.folder / 'fleet.html'}")
    finally:
        store.release()
    return 0


if __name__ == "__main__":
    sys.exit(main())
