"""The fleet page: one HTML file that needs nothing else; reports that it links to lie beside it."""
from __future__ import annotations

import json
import math
import pathlib
from typing import Any

import numpy as np
import pandas as pd

from fleet import changes, scan
from fleet.store_file import write_whole

TEMPLATE = pathlib.Path(__file__).resolve().parent / "assets" / "fleet.html"
MOST_TRENDS = 150  # robots whose trends are on the page: those that changed first
MOST_DAYS = 400
MOST_UNLIKE = 20
MOST_FAILED = 200
UNLIKE = 4.0  # robust standard deviations


def page_data(folder: pathlib.Path, quantities: pd.DataFrame, sessions: pd.DataFrame, found: pd.DataFrame, unlike: pd.DataFrame,
              options: changes.Options) -> dict[str, Any]:
    """Everything that the page shows."""
    days = sorted(set(sessions["day"]))[-MOST_DAYS:]
    at = {day: k for k, day in enumerate(days)}
    changed = list(dict.fromkeys(found["robot"]))
    names = changed + [r for r in sorted(set(sessions["robot"])) if r not in set(changed)]
    sigma, own = _judged(quantities, set(names[:MOST_TRENDS]))
    ratio = _over_promise(quantities)
    by_robot = dict(tuple(sessions.groupby("robot")))
    leading = found[found["leading"]].set_index("robot")["since"].to_dict() if len(found) else {}
    robots = [_robot(folder, name, by_robot.get(name, sessions.iloc[:0]), at, ratio, sigma, own, leading.get(name)) for name in names]
    failed = sessions[sessions["state"] == "failed"]
    return {"days": days, "robots": robots, "sessions": int(len(sessions)), "rate": options.false_discovery_rate, "horizon": options.horizon,
            "watched": len(sigma), "changes": [_change(row) for row in found.to_dict("records")], "unlike": _unlike(unlike),
            "failed": failed[["robot", "session", "sentence"]].to_numpy().tolist()[:MOST_FAILED]}


def write_page(folder: pathlib.Path, quantities: pd.DataFrame, sessions: pd.DataFrame, found: pd.DataFrame, unlike: pd.DataFrame,
               options: changes.Options) -> pathlib.Path:
    """Writes fleet.html."""
    data = json.dumps(page_data(folder, quantities, sessions, found, unlike, options), allow_nan=False, separators=(",", ":"))
    path = folder / "fleet.html"
    # "</" inside a script element would end it; names and sentences come from outside.
    write_whole(path, TEMPLATE.read_text(encoding="utf-8").replace("DATA", data.replace("</", "<\\/").replace("<!--", "<\\!--"), 1))
    return path


def _judged(quantities: pd.DataFrame, names: set[str]) -> tuple[dict[tuple[str, str, int], float], dict[tuple[str, str, int], changes.Series]]:
    """Scatter from day to day of every series, and the series of the robots that are shown."""
    sigma: dict[tuple[str, str, int], float] = {}
    own: dict[tuple[str, str, int], changes.Series] = {}
    groups: dict[tuple[str, str, int], list[changes.Series]] = {}
    for s in changes.series_of(quantities):
        groups.setdefault((s.kind, s.quantity, s.leg), []).append(s)
    for group in groups.values():
        spread = [scan.scatter(s.values[None, :], s.movements) for s in group]
        known = [float(x[0][0]) for x in spread if math.isfinite(x[0][0])]
        fleet = float(np.median(known)) if known else 0.0
        for s, (width, degrees) in zip(group, spread):
            sigma[s.robot, s.quantity, s.leg] = float(scan.moderated(width, degrees, fleet)[0])
            if s.robot in names:
                own[s.robot, s.quantity, s.leg] = s
    return sigma, own


def _over_promise(quantities: pd.DataFrame) -> dict[tuple[str, str], float]:
    """Residual of the worst leg over that of the robot's first days of the same movement, by (robot, session)."""
    rows = quantities[quantities["quantity"] == "residual"].sort_values("day")
    if not len(rows):
        return {}
    first = rows.groupby(["robot", "movement", "leg"])["value"].transform(lambda v: float(v.iloc[:3].median()))
    ratio = (rows["value"] / first.clip(lower=1e-9)).groupby([rows["robot"], rows["session"]]).max()
    return {key: float(value) for key, value in ratio.items()}


def _robot(folder: pathlib.Path, name: str, rows: pd.DataFrame, at: dict[str, int], ratio: dict[tuple[str, str], float],
           sigma: dict[tuple[str, str, int], float], own: dict[tuple[str, str, int], changes.Series], since: str | None) -> dict[str, Any]:
    cells: dict[int, float | None] = {}
    reports = []
    for row in rows.sort_values("day").to_dict("records"):
        if row["day"] not in at:
            continue
        value = ratio.get((name, row["session"]))
        before = cells.get(at[row["day"]])
        cells[at[row["day"]]] = before if value is None and before is not None else None if value is None else round(max(value, before or 0.0), 3)
        report = f"robots/{name}/{row['session']}/report.html"
        if (folder / report).exists():
            reports.append([row["day"], report, _effects(row["effects"])])
    first = f"robots/{name}/baseline/report.html"
    return {"name": name, "changed": since is not None, "since": at.get(since) if since else None, "map": sorted(cells.items()), "reports": reports,
            "report": reports[-1][1] if reports else None, "first": first if (folder / first).exists() else None,
            "series": [_trend(s, sigma[key], at) for key, s in own.items() if key[0] == name]}


def _effects(text: object) -> str:
    found = json.loads(text) if isinstance(text, str) and text else []
    return ", ".join(f"{e['name']} {e['actuators']}" for e in found) or "nothing new"


def _trend(s: changes.Series, sigma: float, at: dict[str, int]) -> dict[str, Any]:
    values, labels = changes.levelled(s), np.array(s.movements)
    if s.quantity not in changes.LOGARITHMS and len(values):
        values = values + float(np.median(s.values[labels == labels[0]]))
    unit = "1" if s.quantity in changes.LOGARITHMS else {"friction": "1", "gain": "1", "ripple": "N", "delay": "s", "payload": "kg"}[s.quantity]
    points = [[at[d.date().isoformat()], float(f"{v:.5g}"), int(m)] for d, v, m in zip(s.days, values, s.movements) if d.date().isoformat() in at]
    return {"quantity": s.quantity, "leg": s.leg, "unit": unit, "sigma": float(f"{sigma:.4g}") if math.isfinite(sigma) else 0.0, "points": points}


def _change(row: dict[str, Any]) -> dict[str, Any]:
    keys = ("robot", "quantity", "leg", "cause", "form", "since", "earliest", "latest", "size", "low", "high", "unit", "leading")
    return {**{k: row[k] for k in keys}, "leading": bool(row["leading"]), "p": float(row["p_adjusted"])}


def _unlike(table: pd.DataFrame) -> list[dict[str, Any]]:
    """The fleet's own course where it is material, then the robots furthest from the others."""
    if not len(table):
        return []
    fleet = table[(table["robot"] == "fleet")]
    moved = fleet[[abs(v) > 2 * changes.FLOOR[q] for v, q in zip(fleet["deviation"], fleet["quantity"])]]
    robots = table[(table["robot"] != "fleet") & (table["deviation"].abs() > UNLIKE)]
    robots = robots.reindex(robots["deviation"].abs().sort_values(ascending=False).index)[:MOST_UNLIKE]
    scale = {"friction": (100, " %"), "gain": (100, " %"), "residual": (100, " %"), "roughness": (100, " %"), "ripple": (1, " N"), "delay": (1000, " ms"),
             "payload": (1, " kg")}
    out = []
    for row in pd.concat([moved, robots]).to_dict("records"):
        factor, unit = scale[row["quantity"]]
        out.append({**row, "text": f"{factor * row['deviation']:+.2g}{unit}"})
    return out
