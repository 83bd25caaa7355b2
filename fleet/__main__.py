"""Command line: see scripts/fleet --help."""
from __future__ import annotations

import argparse
import pathlib
import sys
import time

import pandas as pd

from fleet import changes, faults, nightly, page
from fleet.catalogue import CatalogueError, read_catalogue
from fleet.engine import Engine, NoWorkers, clock
from fleet.programs import default_programs
from fleet.store import Busy, Store

BAD_INPUT, REFUSED = 2, 3


def arguments(given: list[str] | None = None) -> argparse.Namespace:
    """Reads the command line."""
    p = argparse.ArgumentParser(prog="fleet", description="Which of many robots changed, since when, and what: identify on each robot's first day, "
                                "follow and trace every later one, change points under a stated false discovery rate, and a page. Stopped at any "
                                "time, the same command goes on where it was.")
    p.add_argument("catalogue", type=pathlib.Path, help="folder with one folder of dated recordings a robot, or a table (CSV, Parquet) with columns "
                   "robot, day, recording, robot_file")
    p.add_argument("--robot", type=pathlib.Path, help="robot file of all (default: robot.yaml in each robot's folder, or the table's column)")
    p.add_argument("--output", type=pathlib.Path, required=True, help="folder for tables, models, reports and fleet.html")
    p.add_argument("--trace", choices=["every", "changes", "never"], default="every", help="trace every later day (default), the last day of robots "
                   "that changed, or none")
    p.add_argument("--workers", type=int, help="processes of the local cluster (default: one a processor)")
    p.add_argument("--scheduler", help="address of a Dask scheduler (tcp://host:8786) instead; its workers must see the same folders")
    p.add_argument("--seconds", type=float, default=600.0, help="limit of one program's run (600)")
    p.add_argument("--memory-mb", type=int, default=4096, help="limit of one program's address space (4096)")
    p.add_argument("--false-discovery-rate", type=float, default=0.05, help="of the changes that are stated (0.05)")
    p.add_argument("--horizon", type=int, default=60, help="sessions of a robot over which looking every night counts (60)")
    p.add_argument("--programs", type=pathlib.Path, default=default_programs(), help="folder of identify, predict and trace (scripts/build)")
    p.add_argument("--page-only", action="store_true", help="only judge what is there again and write the page")
    a = p.parse_args(given)
    if not 0 < a.false_discovery_rate < 1:
        p.error(f"--false-discovery-rate {a.false_discovery_rate}: must lie between 0 and 1")
    if a.seconds <= 0 or a.memory_mb < 64 or a.horizon < 10 or (a.workers is not None and a.workers < 1):
        p.error("--seconds must be above 0, --memory-mb at least 64, --horizon at least 10, --workers at least 1")
    return a


def judge(store: Store, a: argparse.Namespace) -> pd.DataFrame:
    """Changes of what is in the store; writes changes.parquet, population.parquet and fleet.html."""
    quantities, sessions = store.table("quantities"), store.table("sessions")
    options = changes.Options(a.false_discovery_rate, a.horizon)
    found = changes.find_changes(quantities, options, store.faults())
    unlike = changes.population(quantities)
    found.to_parquet(store.folder / "changes.parquet", index=False)
    unlike.to_parquet(store.folder / "population.parquet", index=False)
    page.write_page(store.folder, quantities, sessions, found, unlike, options)
    return found


def tell(found: pd.DataFrame, summary: nightly.Summary | None, folder: pathlib.Path) -> None:
    """Prints what was done and found."""
    if summary:
        print(f"{summary.sessions} sessions: {summary.kept} were done before, {summary.done} done now, {len(summary.failures)} failed, in {clock(summary.seconds)}")
        alike: dict[tuple[str, str], list[str]] = {}
        for robot, session, sentence in summary.failures:
            alike.setdefault((robot, sentence), []).append(session)
        for (robot, sentence), failed in alike.items():
            which = failed[0] if len(failed) == 1 else f"{len(failed)} sessions, {min(failed)} to {max(failed)}"
            print(f"  {robot}, {which}: {sentence}")
    print(f"{found['robot'].nunique()} robots changed")
    for _, row in found[found["leading"]].iterrows() if len(found) else ():
        if row["quantity"] == "fault":
            print(f"  {row['robot']}: {row['cause']}, on {100 * row['size']:.0f} % of its days in use since {row['since']}")
            continue
        unit = "" if row["unit"] == "1" else f" {row['unit']}"
        scale, unit = (100.0, " %") if row["unit"] == "1" else (1.0, unit)
        print(f"  {row['robot']}: {row['cause']}, {row['form']} since {row['since']} ({row['earliest']} to {row['latest']}), "
              f"{scale * row['size']:+.3g}{unit} ({scale * row['low']:+.3g} to {scale * row['high']:+.3g})")
    print(f"written: {folder / 'fleet.html'}")


def main(given: list[str] | None = None) -> int:
    """Exit status 0: done (failed sessions are listed), 2: bad input, 3: nothing could be done."""
    a = arguments(given)
    store = Store(a.output)
    try:
        sessions = [] if a.page_only else read_catalogue(a.catalogue, a.robot)
        store.lead()
    except (CatalogueError, Busy, OSError) as error:
        print(f"fleet: {error}", file=sys.stderr)
        return BAD_INPUT
    summary = None
    began = time.monotonic()
    try:
        if a.page_only:
            store.fold()
            found = judge(store, a)
        else:
            with Engine(a.workers, a.scheduler) as engine:
                stops, unread = faults.faults_of((s.robot, s.events) for s in sessions if s.events)
                store.keep_faults(stops)
                for robot, sentence in unread:
                    print(f"  {robot}: {sentence}", file=sys.stderr)
                night = nightly.Night(store, engine, nightly.Options(a.programs, a.trace, a.seconds, a.memory_mb * 1024**2))
                summary = night.run(sessions)
                found = judge(store, a)
                if a.trace == "changes" and len(found):
                    again = night.run(sessions, nightly.latest_sessions(store.table("sessions"), found))
                    summary.failures += [f for f in again.failures if f not in summary.failures]
                    found = judge(store, a)
            summary.seconds = time.monotonic() - began
    except (NoWorkers, OSError) as error:
        print(f"fleet: {error}", file=sys.stderr)
        return REFUSED
    finally:
        store.release()
    tell(found, summary, a.output)
    return REFUSED if summary and summary.sessions and not summary.done and not summary.kept else 0


if __name__ == "__main__":
    sys.exit(main())
