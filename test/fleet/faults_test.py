"""Faults of the event logs: robots that stop more often than the others."""
import datetime
import json

import pandas as pd
import pytest

from changes_test import OPTIONS, WEEKS, add, fleet, nights_of
from fleet import changes, faults

SLIPS = "axis 4: the holding brake does not hold its axis; mend the brake"


def line(day, what="hold_device_slips", answer=SLIPS, kind="fault"):
    noon = datetime.datetime.combine(datetime.date.fromisoformat(day), datetime.time(12), datetime.timezone.utc).timestamp()
    return json.dumps({"number": 1, "time": noon, "kind": kind, "who": "", "what": what, "answer": answer})


def stops(table, robot, weeks, fault="hold_device_slips", leg=4):
    days = dict(zip(table["session"], table["day"]))
    return pd.DataFrame([[robot, days[f"s{w}"], fault, leg, SLIPS] for w in weeks], columns=faults.COLUMNS)


def test_faults_of_a_log_are_read_with_day_name_and_axis(tmp_path):
    log = tmp_path / "controller.jsonl"
    log.write_text("\n".join([line("2026-03-01"), line("2026-03-01"), line("2026-03-02", "emergency_stop", "emergency stop; release it"),
                              line("2026-03-03", "holding", "", "state")]))
    (tmp_path / "controller.jsonl.1").write_text(line("2026-02-01"))
    table, unread = faults.faults_of([("r1", str(tmp_path)), ("r2", str(tmp_path / "absent"))])
    assert [robot for robot, _ in unread] == ["r2"] and "absent: the event log cannot be read" in unread[0][1]
    assert table[["robot", "day", "fault", "leg"]].to_numpy().tolist() == [
        ["r1", "2026-03-01", "hold_device_slips", 4], ["r1", "2026-03-02", "emergency_stop", 0], ["r1", "2026-02-01", "hold_device_slips", 4]]


@pytest.mark.parametrize("garbage", ["{", "[]", "null", "1", '{"kind": "fault"}', '{"kind": "fault", "time": "x", "what": "a"}', '{"kind": "fault", "time": 1e300, "what": 3}',
                                     '{"kind": "fault", "time": NaN, "what": "a"}', "\x00\xff", "[" * 100000, '{"kind": ["fault"], "time": 1}'])
def test_lines_that_are_no_events_are_passed_over(tmp_path, garbage):
    log = tmp_path / "controller.jsonl"
    log.write_text(garbage + "\n" + line("2026-03-01") + "\n" + line("2026-03-02")[:40])
    assert [row[0] for row in faults.read_events(log)] == [datetime.date(2026, 3, 1)]


def test_a_robot_that_cannot_start_any_more_is_found_on_the_third_day_and_names_the_fault():
    table = fleet(21, robots=30)
    week = table["session"].str[1:].astype(int)
    table = table[~((table["robot"] == "r3") & (week >= 10))]  # it records nothing any more
    found = changes.nights(table, nights_of(table)[9:14], OPTIONS, stops(fleet(21), "r3", range(10, WEEKS)))
    assert set(found["robot"]) == {"r3"} and found["night"].min() <= nights_of(table)[12]
    row = found.iloc[-1]
    assert (row["quantity"], row["leg"], row["cause"]) == ("fault", 4, "fault hold_device_slips, axis 4") and row["leading"]
    assert row["since"] == sorted(set(table["day"]))[10] and row["size"] == 1.0


def test_faults_that_the_whole_fleet_has_now_and_then_are_nobodys_change():
    table = fleet(22, robots=20)
    every = pd.concat([stops(table, f"r{k}", [(3 * k) % WEEKS, (7 * k + 5) % WEEKS], "emergency_stop", 0) for k in range(20)])
    assert changes.find_changes(table, OPTIONS, every).empty


def test_robots_whose_users_differ_are_compared_with_users_who_differ():
    """Half of the robots are stopped by hand on every fourth day, the others never: one more such robot is nothing new."""
    table = fleet(23, robots=20)
    every = pd.concat([stops(table, f"r{k}", range(k % 4, WEEKS, 4), "emergency_stop", 0) for k in range(10)])
    assert changes.find_changes(table, OPTIONS, every).empty


def test_a_stop_does_not_take_the_lead_from_friction_that_has_grown_much_further():
    table = add(fleet(24, robots=12), "r3", "friction", 2, 12, 0.6)
    found = changes.find_changes(table, OPTIONS, stops(table, "r3", [20, 22, 24], "position_stalled", 2))
    assert found.iloc[0]["quantity"] == "friction" and "fault" in set(found["quantity"])


def test_two_robots_with_the_same_fault_do_not_excuse_each_other():
    table = fleet(25, robots=30)
    both = pd.concat([stops(table, "r3", range(12, WEEKS)), stops(table, "r7", range(14, WEEKS))])
    assert set(changes.find_changes(table, OPTIONS, both)["robot"]) == {"r3", "r7"}
