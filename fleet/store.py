"""What is kept of a fleet: a journal of finished sessions, and Parquet tables by month.

    OUTPUT/robots/NAME/baseline/        identify's folder of the first day, and baseline.json
    OUTPUT/robots/NAME/SESSION/         trace's folder, where it was asked for
    OUTPUT/journal/KEY.json             a session that ended, until it is in the tables
    OUTPUT/sessions/2026-01.parquet     one row a session: state, sentence, key, cost
    OUTPUT/quantities/2026-01.parquet   one row a robot, day, quantity, with its interval
    OUTPUT/faults.parquet               one row a robot, day and fault of the event logs, read anew every night

Every file appears whole or not at all (written beside, then renamed). A worker writes its session's journal entry itself: what it finished
is kept whatever happens to the run. Entries are folded into the tables by the one process that leads the run, and only then removed.
"""
from __future__ import annotations

import fcntl
import json
import os
import pathlib
from typing import IO, Any

import pandas as pd

from fleet import faults

SESSION_COLUMNS = ["robot", "day", "session", "recording", "kind", "key", "stamp", "state", "final", "sentence", "movement", "effects", "traced", "processor_s",
                   "seconds", "peak_bytes"]
QUANTITY_COLUMNS = ["robot", "day", "session", "kind", "movement", "quantity", "leg", "value", "low", "high", "std", "unit"]


class Busy(RuntimeError):
    """Another run leads this folder."""


class Store:
    """The folder of one fleet."""

    def __init__(self, folder: pathlib.Path) -> None:
        self.folder = folder
        self._lock: IO[str] | None = None

    def lead(self) -> None:
        """Makes the folders and becomes the only leader. Busy when there is one."""
        for part in ("robots", "journal", "sessions", "quantities"):
            (self.folder / part).mkdir(parents=True, exist_ok=True)
        self._lock = open(self.folder / ".lock", "w", encoding="utf-8")
        try:
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise Busy(f"{self.folder}: another run writes there; wait for it or give another --output") from None
        for left in self.folder.glob("*/.*.part"):
            left.unlink()

    def release(self) -> None:
        """Ends the lead."""
        if self._lock:
            self._lock.close()
            self._lock = None

    def robot(self, name: str) -> pathlib.Path:
        """Folder of one robot."""
        return self.folder / "robots" / name

    def journal_file(self, key: str) -> pathlib.Path:
        """Where a session's entry is written."""
        return self.folder / "journal" / f"{key}.json"

    def fold(self) -> int:
        """Moves the journal into the tables; how many entries. A session that was done again replaces its earlier rows."""
        entries: dict[str, list[tuple[pathlib.Path, dict[str, Any]]]] = {}
        for path in sorted((self.folder / "journal").glob("*.json")):
            entry = json.loads(path.read_text(encoding="utf-8"))
            entries.setdefault(entry["session"]["day"][:7], []).append((path, entry))
        for month, group in entries.items():
            sessions = pd.DataFrame([e["session"] for _, e in group], columns=SESSION_COLUMNS)
            quantities = pd.DataFrame([q for _, e in group for q in e["quantities"]], columns=QUANTITY_COLUMNS)
            done = set(zip(sessions["robot"], sessions["session"]))
            self._replace("quantities", month, quantities, done, QUANTITY_COLUMNS)
            self._replace("sessions", month, sessions, done, SESSION_COLUMNS)  # last: it says that the others are there
            for path, _ in group:
                path.unlink()
        return sum(len(group) for group in entries.values())

    def _replace(self, what: str, month: str, rows: pd.DataFrame, done: set[tuple[str, str]], columns: list[str]) -> None:
        path = self.folder / what / f"{month}.parquet"
        if path.exists():
            old = pd.read_parquet(path)
            kept = old[[pair not in done for pair in zip(old["robot"], old["session"])]]
            rows = pd.concat([kept, rows], ignore_index=True) if len(kept) else rows
        rows = rows[columns].drop_duplicates(["robot", "session"] + (["quantity", "leg"] if what == "quantities" else []), keep="last")
        part = path.with_name(f".{path.name}.part")
        try:
            rows.sort_values(["robot", "day", "session"], kind="stable").to_parquet(part, index=False)
            os.replace(part, path)
        except OSError:
            part.unlink(missing_ok=True)
            raise

    def keep_faults(self, rows: pd.DataFrame) -> None:
        """Replaces the table of faults."""
        part = self.folder / ".faults.parquet.part"
        rows.to_parquet(part, index=False)
        os.replace(part, self.folder / "faults.parquet")

    def faults(self) -> pd.DataFrame:
        """Faults of the event logs as they were last read."""
        path = self.folder / "faults.parquet"
        return pd.read_parquet(path) if path.exists() else pd.DataFrame(columns=faults.COLUMNS)

    def table(self, what: str) -> pd.DataFrame:
        """`sessions` or `quantities`, all months."""
        parts = [pd.read_parquet(p) for p in sorted((self.folder / what).glob("*.parquet"))]
        columns = SESSION_COLUMNS if what == "sessions" else QUANTITY_COLUMNS
        return pd.concat(parts, ignore_index=True) if parts else pd.DataFrame(columns=columns)
