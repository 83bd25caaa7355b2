"""Change, not noise."""
import datetime

import numpy as np
import pandas as pd
import pytest
from scipy import stats

from fleet import changes, scan

WEEKS = 26
OPTIONS = changes.Options(0.05, WEEKS)


def fleet(seed, robots=12, names=("friction",), legs=(1, 2, 3, 4), common=None, spread=0.03, heavy=False):
    """Quantities of a fleet in which nothing changes but what all of it does (`common`, by week); two movements with levels of their own."""
    draw = np.random.default_rng(seed)
    rows = []
    for robot in range(robots):
        for name in names:
            for leg in legs:
                level = draw.normal(0, 0.1, 2)
                for week in range(WEEKS):
                    noise = draw.standard_t(5) if heavy else draw.normal()
                    value = level[week % 2] + spread * noise + (common(week) if common else 0.0)
                    rows.append([f"r{robot}", (datetime.date(2026, 1, 5) + datetime.timedelta(weeks=week)).isoformat(), f"s{week}", "A", f"m{week % 2}", name, leg, value])
    return pd.DataFrame(rows, columns=["robot", "day", "session", "kind", "movement", "quantity", "leg", "value"])


def nights_of(table):
    return sorted(pd.to_datetime(table["day"]).unique())


def add(table, robot, quantity, leg, since, size):
    """`size` more from week `since` on; a function of the week, or a number."""
    out = table.copy()
    week = out["session"].str[1:].astype(int)
    at = (out["robot"] == robot) & (out["quantity"] == quantity) & (out["leg"] == leg) & (week >= since)
    out.loc[at, "value"] += week[at].map(size) if callable(size) else size
    return out


@pytest.mark.parametrize("law", ["normal", "wild", "unequal"])
def test_an_unchanged_series_has_the_p_values_that_it_should(law):
    """The null that a fleet of 100 series makes is checked on 2000 other draws of the same law, within what so many allow."""
    draw, labels, best = np.random.default_rng(5), tuple(k % 2 for k in range(WEEKS)), np.zeros(2000)

    def days(count):
        if law == "wild":
            return draw.standard_t(3, size=(count, WEEKS)) * 0.6745 / 0.7649
        return draw.normal(size=(count, WEEKS)) * (np.exp(0.4 * draw.normal(size=(count, 1))) if law == "unequal" else 1.0)

    fleet_days = days(100)
    usual = float(np.median(scan.scatter(fleet_days, labels)[0]))
    null = scan.null(WEEKS, 0.0, 2, [scan.unexplained(row / usual, labels) for row in fleet_days])
    y = days(2000)
    for night in range(scan.BEFORE + scan.AFTER, WEEKS + 1):
        own, degrees = scan.scatter(y[:, :night], labels[:night])
        np.maximum(best, scan.statistics(y[:, :night] / scan.moderated(own, degrees, 1.0)[:, None], labels[:night]), out=best)
    for level, factor in ((0.2, 1.5), (0.05, 1.3), (0.01, 1.3)):
        below = sum(null.p(b) < level for b in best)
        assert stats.binom.cdf(below, 2000, level / factor) > 0.001 and stats.binom.sf(below - 1, 2000, factor * level) > 0.001, (level, below)


@pytest.mark.parametrize("heavy", [False, True], ids=["normal", "heavy tails"])
def test_drift_free_fleets_raise_alarms_no_more_often_than_stated(heavy):
    """Every discovery in a fleet without changes is false: at most 5 % of such fleets may have any, looked at on every night."""
    false = 0
    for seed in range(20):
        table = fleet(seed, robots=8, legs=(1, 2), heavy=heavy)
        false += len(changes.nights(table, nights_of(table)[5::4], OPTIONS)) > 0
    assert stats.binom.sf(false - 1, 20, 0.05) > 0.001, f"{false} of 20 fleets"


def test_friction_that_grows_by_15_percent_is_found_within_three_weeks_on_its_day():
    found = 0
    for seed in range(10):
        table = add(fleet(100 + seed), "r3", "friction", 2, 13, 0.15)
        alarms = changes.nights(table, nights_of(table)[13:17], OPTIONS)
        mine = alarms[(alarms["robot"] == "r3") & (alarms["leg"] == 2)]
        found += len(mine) > 0 and abs((pd.Timestamp(mine.iloc[-1]["since"]) - pd.Timestamp("2026-04-06")).days) <= 7
    assert found >= 9


def test_a_slow_growth_is_called_one_and_its_size_is_inside_the_interval():
    table = add(fleet(7), "r1", "friction", 4, 10, lambda week: 0.03 * (week - 9))
    row = changes.find_changes(table, OPTIONS).iloc[0]
    assert (row["robot"], row["leg"], row["form"]) == ("r1", 4, "growth")
    assert row["low"] < 0.48 < row["high"]
    assert pd.Timestamp(row["earliest"]) <= pd.Timestamp("2026-03-16") <= pd.Timestamp(row["latest"])


def test_what_the_whole_fleet_does_is_nobodys_change_but_is_told_of_the_fleet():
    table = fleet(8, common=lambda week: 0.01 * week)
    assert changes.find_changes(table, OPTIONS).empty
    moved = changes.population(table)
    assert (moved[moved["robot"] == "fleet"]["deviation"] > 0.15).all()


def test_movements_with_levels_of_their_own_are_no_change():
    """A robot that plays another movement from week 13 on."""
    table = fleet(9)
    mine = table["robot"] == "r2"
    later = mine & (table["session"].str[1:].astype(int) >= 13)
    table.loc[mine, "movement"] = "m0"
    table.loc[later, "movement"] = "other"
    table.loc[later, "value"] += 0.5
    assert "r2" not in set(changes.find_changes(table, OPTIONS)["robot"])


def test_one_wild_day_is_no_change_point():
    table = fleet(10)
    table.loc[(table["robot"] == "r5") & (table["session"] == "s15"), "value"] += 1.0
    assert changes.find_changes(table, OPTIONS).empty
    known = table[table["day"] <= table[table["session"] == "s15"]["day"].iloc[0]]
    assert changes.find_changes(known, OPTIONS).empty, "on its own night"


def test_an_undeclared_load_is_named_on_its_night():
    table = fleet(11, names=("payload",), legs=(0,), spread=0.3)
    table.loc[(table["robot"] == "r4") & (table["session"] == "s20"), "value"] += 5.0
    night = [n for n in nights_of(table) if str(n)[:10] == table[table["session"] == "s20"]["day"].iloc[0]]
    alarms = changes.nights(table, night, OPTIONS)
    assert list(alarms["robot"]) == ["r4"] and alarms.iloc[0]["form"] == "day" and alarms.iloc[0]["low"] < 5.0 < alarms.iloc[0]["high"]


def test_a_handful_of_days_says_nothing():
    table = fleet(12)
    assert changes.find_changes(table[table["session"].isin(["s0", "s1", "s2"])], OPTIONS).empty
    assert changes.find_changes(table.iloc[0:0], OPTIONS).empty


@pytest.mark.parametrize("residual, first", [(0.5, "friction"), (3.0, "residual")])
def test_what_tells_the_cause_goes_before_what_only_says_that_something_is_lacking(residual, first):
    """Friction that grows leaves a residual, too; one that is many times as far from chance is another thing."""
    table = add(add(fleet(7, robots=6, names=("friction", "residual")), "r2", "friction", 3, 13, 0.3), "r2", "residual", 3, 13, residual)
    left = table["quantity"] == "residual"
    table.loc[left, "value"] = np.exp(table.loc[left, "value"])  # judged as ratios
    found = changes.find_changes(table, OPTIONS)
    assert set(zip(found["robot"], found["quantity"], found["leg"])) == {("r2", "friction", 3), ("r2", "residual", 3)}
    assert found.iloc[0]["quantity"] == first and bool(found.iloc[0]["leading"])


def test_roughness_is_stated_on_the_second_night_and_friction_on_the_first():
    table = add(add(fleet(9, robots=6, names=("friction", "roughness")), "r2", "friction", 3, 13, 0.6), "r4", "roughness", 2, 13, 0.6)
    rough = table["quantity"] == "roughness"
    table.loc[rough, "value"] = np.exp(table.loc[rough, "value"])
    found = changes.nights(table, nights_of(table), OPTIONS)
    first = found.groupby("quantity")["night"].min()
    assert first["friction"] < first["roughness"]
