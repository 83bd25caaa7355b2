"""Which robots recorded what on which day: a folder, or a table in CSV or Parquet."""
from __future__ import annotations

import dataclasses
import datetime
import pathlib
import re

import pandas as pd

COLUMNS = ("robot", "day", "recording")
DATES = [(re.compile(r"(?<!\d)(\d{4})[-_](\d{2})[-_](\d{2})(?!\d)"), (1, 2, 3)), (re.compile(r"(?<!\d)(\d{2})[-_](\d{2})[-_](\d{4})(?!\d)"), (3, 2, 1)),
         (re.compile(r"(?<!\d)(20\d{2})(\d{2})(\d{2})(?!\d)"), (1, 2, 3))]
NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]*")


class CatalogueError(ValueError):
    """Bad input; one sentence with file, line and how to mend it."""


@dataclasses.dataclass(frozen=True, order=True)
class Session:
    """One recording of one robot on one day. `events`: the robot's event log (a file, or a folder with its parts), empty without one."""

    robot: str
    day: datetime.date
    recording: str
    robot_file: str
    events: str = ""

    @property
    def name(self) -> str:
        return f"{self.day.isoformat()}_{pathlib.Path(self.recording).stem}"


def read_catalogue(path: pathlib.Path, robot_file: pathlib.Path | None = None) -> list[Session]:
    """Sessions by robot and day. A folder has one folder a robot, with recordings whose names hold their day (2026-01-05, 05_01_2026,
    20260105) and, without `robot_file`, a robot.yaml; with the controller's event log where there is one (`events/`). A table has columns robot, day,
    recording and, without `robot_file`, robot_file, and may have events; its paths are relative to it. CatalogueError."""
    if not path.exists():
        raise CatalogueError(f"{path}: no such folder or catalogue")
    sessions = _folder(path, robot_file) if path.is_dir() else _table(path, robot_file)
    if not sessions:
        raise CatalogueError(f"{path}: holds no recording; give a folder with one folder a robot, or a table with {', '.join(COLUMNS)}")
    seen: dict[tuple[str, str], str] = {}
    for s in sessions:
        other = seen.setdefault((s.robot, s.name), s.recording)
        if other != s.recording:
            raise CatalogueError(f"{s.recording}: robot {s.robot} has another recording of that name on {s.day} ({other}); rename one")
    return sorted(set(sessions))


def day_in(name: str) -> datetime.date | None:
    """The day that a file's name holds, None without one."""
    for pattern, order in DATES:
        for found in pattern.finditer(name):
            try:
                return datetime.date(*(int(found[k]) for k in order))
            except ValueError:
                continue
    return None


def _folder(path: pathlib.Path, robot_file: pathlib.Path | None) -> list[Session]:
    sessions = []
    for folder in sorted(p for p in path.iterdir() if p.is_dir()):
        recordings = sorted(folder.glob("*.csv"))
        if not recordings:
            continue
        robot = robot_file or folder / "robot.yaml"
        if not robot.exists():
            raise CatalogueError(f"{robot}: no such robot file; put one into each robot's folder or give --robot FILE")
        _check_name(folder.name, str(folder))
        events = str((folder / "events").resolve()) if (folder / "events").is_dir() else ""
        for recording in recordings:
            day = day_in(recording.stem)
            if day is None:
                raise CatalogueError(f"{recording}: its name holds no day; call it like robot_2026-01-05.csv, or give a catalogue table")
            sessions.append(Session(folder.name, day, str(recording.resolve()), str(robot.resolve()), events))
    return sessions


def _table(path: pathlib.Path, robot_file: pathlib.Path | None) -> list[Session]:
    try:
        table = pd.read_parquet(path) if path.suffix == ".parquet" else pd.read_csv(path, dtype=str, keep_default_na=False)
    except (ValueError, OSError, ImportError) as error:
        raise CatalogueError(f"{path}: not a table that can be read ({' '.join(str(error).split())})") from error
    wanted = COLUMNS if robot_file else (*COLUMNS, "robot_file")
    lacking = [c for c in wanted if c not in table.columns]
    if lacking:
        raise CatalogueError(f"{path}: has no column {', '.join(lacking)}; needed are {', '.join(wanted)}")
    sessions = []
    for line, row in enumerate(table.to_dict("records"), start=2):
        where = f"{path}:{line}"
        try:
            day = datetime.date.fromisoformat(str(row["day"])[:10])
        except ValueError:
            raise CatalogueError(f"{where}: day '{row['day']}' is no date; write it as 2026-01-05") from None
        _check_name(str(row["robot"]), where)
        robot = robot_file or path.parent / str(row["robot_file"])
        if not robot.exists():
            raise CatalogueError(f"{where}: robot file {robot} does not exist")
        events = str((path.parent / str(row["events"])).resolve()) if isinstance(row.get("events"), str) and row["events"] else ""
        # A recording that is not there (yet) costs itself only, when its turn comes.
        sessions.append(Session(str(row["robot"]), day, str((path.parent / str(row["recording"])).resolve()), str(robot.resolve()), events))
    return sessions


def _check_name(name: str, where: str) -> None:
    if not NAME.fullmatch(name):
        raise CatalogueError(f"{where}: robot name '{name}' must be letters, digits, '.', '_' and '-' and begin with a letter or digit")
