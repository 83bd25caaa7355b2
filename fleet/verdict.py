"""What the campaign's fleet had, beside what was found night by night: detection, delay, wrong cause, false alarms."""
from __future__ import annotations

import dataclasses

import pandas as pd
from statsmodels.stats.proportion import proportion_confint

from fleet.machines import WEEKS, Machine, day_of

DUE_FRICTION = 0.15
WITHIN_WEEKS = 3
# Of play, a brake that "slips" on that axis is the place and the symptom, in the controller's own words.
RIGHT = {"wear": ("friction",), "gain": ("gain",), "play": ("roughness", "residual", "fault"), "load": ("payload",)}


@dataclasses.dataclass(frozen=True)
class Life:
    """One robot's verdict. Weeks count from the fleet's first; None where there is nothing."""

    machine: Machine
    began: int | None  # the first week in which anything was different
    due: int | None  # the first week in which it was as large as the target says
    found: int | None  # the first night's week at or after `began` on which it was stated
    cause: str
    right: bool
    early: int  # nights' first alarms before it began: false

    @property
    def delay(self) -> int | None:
        return None if self.found is None or self.due is None else self.found - self.due


def truth_of(m: Machine) -> tuple[int | None, int | None]:
    """Weeks in which a machine's change began and became due."""
    if m.kind == "none":
        return None, None
    if m.kind == "load":
        return m.loaded[0], m.loaded[0]
    weeks = [w for w in range(WEEKS) if m.share(w) > 0]
    due = [w for w in weeks if m.kind != "wear" or m.size * m.share(w) >= DUE_FRICTION]
    return weeks[0], due[0] if due else None


def live(m: Machine, alarms: pd.DataFrame, week_of: dict[pd.Timestamp, int]) -> Life:
    """`alarms`: rows of changes.nights of this robot."""
    began, due = truth_of(m)
    alarms = alarms.assign(week=[week_of[n] for n in alarms["night"]])
    early = alarms if began is None else alarms[alarms["week"] < began]
    later = alarms.iloc[0:0] if began is None else alarms[alarms["week"] >= began]
    if not len(later):
        return Life(m, began, due, None, "", False, int(len(early) > 0))
    first = later[(later["week"] == later["week"].min()) & later["leading"]].iloc[0]
    right = first["quantity"] in RIGHT[m.kind] and (m.kind == "load" or int(first["leg"]) == m.leg)
    return Life(m, began, due, int(first["week"]), str(first["cause"]), bool(right), int(len(early) > 0))


def watched_years(lives: list[Life], sessions: pd.DataFrame) -> float:
    """Robot-years in which nothing was different, from the first session of each robot that was followed."""
    followed = set(sessions[sessions["state"] == "done"]["robot"])
    return sum((WEEKS if life.began is None else life.began) for life in lives if life.machine.name in followed) / 52.0


def load_days(m: Machine, alarms: pd.DataFrame, sessions: set[tuple[str, str]], week_of: dict[pd.Timestamp, int]) -> tuple[int, int]:
    """Days with an undeclared load that were recorded, and those that were named on their own night."""
    named = {week_of[n] for n, q in zip(alarms["night"], alarms["quantity"]) if q == "payload"}
    recorded = [w for w in m.loaded if (m.name, day_of(m.number, w).isoformat()) in sessions]
    return len(recorded), sum(w in named for w in recorded)


def share(part: int, whole: int) -> str:
    """A share with its exact 95 % interval."""
    if not whole:
        return "0 of 0"
    low, high = proportion_confint(part, whole, alpha=0.05, method="beta")
    return f"{part} of {whole} ({100 * part / whole:.0f} %, {100 * low:.0f} to {100 * high:.0f} %)"


def report(lives: list[Life], alarms: pd.DataFrame, sessions: pd.DataFrame, week_of: dict[pd.Timestamp, int]) -> str:
    """The campaign's tables in Markdown."""
    followed = set(sessions[sessions["state"] == "done"]["robot"])
    lives = [life for life in lives if life.machine.name in followed]
    lines = ["| kind | robots | due | found | within 3 weeks | delay, weeks: median, longest | cause right at once |", "| --- | --- | --- | --- | --- | --- | --- |"]
    for kind in ("wear", "gain", "play", "load"):
        group = [life for life in lives if life.machine.kind == kind]
        due = [life for life in group if life.due is not None and (life.due + WITHIN_WEEKS < WEEKS or life.found is not None)]
        found = [life for life in due if life.found is not None]
        delays = sorted(life.delay for life in found if life.delay is not None)
        soon = sum(d <= WITHIN_WEEKS for d in delays)
        middle = f"{delays[len(delays) // 2]}, {delays[-1]}" if delays else "-"
        lines.append(f"| {kind} | {len(group)} | {len(due)} | {len(found)} | {share(soon, len(due))} | {middle} | {share(sum(f.right for f in found), len(found))} |")
    years, false = watched_years(lives, sessions), sum(life.early for life in lives)
    lines += ["", f"False alarms: {false} robots in {years:.1f} robot-years without a change: {false / max(years, 1e-9):.3f} a robot-year (target 0.05)"]
    done = set(zip(sessions[sessions["state"] == "done"]["robot"], sessions[sessions["state"] == "done"]["day"]))
    loads = [load_days(life.machine, alarms[alarms["robot"] == life.machine.name], done, week_of) for life in lives if life.machine.kind == "load"]
    lines.append(f"Days with an undeclared load named on their night: {share(sum(n for _, n in loads), sum(r for r, _ in loads))}")
    lines += ["", "| robot | kind | leg | size | weeks of growth | began | due | found | cause stated first |", "| --- | --- | --- | --- | --- | --- | --- | --- | --- |"]
    for life in lives:
        m = life.machine
        if m.kind != "none" or life.early:
            number = {"wear": f"+{100 * m.size:.0f} %", "gain": f"{100 * m.size:+.0f} %", "play": f"{1000 * m.size:.1f} mm", "load": f"{m.size:.1f} kg, weeks {list(m.loaded)}",
                      "none": "-"}[m.kind]
            cells = [m.name, m.kind, m.leg if m.kind not in ("load", "none") else "-", number, m.weeks if m.kind in ("wear", "gain") else "-", life.began, life.due,
                     life.found, life.cause + ("" if life.right or not life.cause else " (wrong)") + (" FALSE ALARM before" if life.early else "")]
            lines.append("| " + " | ".join("-" if c is None else str(c) for c in cells) + " |")
    return "\n".join(lines)
