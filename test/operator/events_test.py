#!/usr/bin/python3
"""The controller's event log on its way to the page: nothing twice, nothing missing, whoever was started first or anew."""
import asyncio
import pathlib
import sys
import unittest

import rosunit

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "python"))
from knee_robot_operator import stops  # noqa: E402
from knee_robot_operator.controller_events import ControllerEvents, in_words  # noqa: E402


def event(number, time=None, **more):
    return {"number": number, "time": float(number if time is None else time), "kind": "state", "who": "", "what": f"s{number}", "answer": "", **more}


class Controller:
    """Keeps a log; `delay` long until it answers."""

    def __init__(self, delay=0.0):
        self.log, self.delay, self.answers = [], delay, True

    async def fetch(self, after):
        answer = [e for e in self.log if e["number"] > after] if self.answers else None
        await asyncio.sleep(self.delay)
        return answer


class CatchingUp(unittest.IsolatedAsyncioTestCase):
    def begin(self, controller):
        self.told = []
        self.events = ControllerEvents(controller.fetch, lambda e, is_old: self.told.append((e["what"], is_old)))

    async def say(self, controller, *events):
        for one in events:
            controller.log.append(one)
            self.events.hear(one)
        await asyncio.sleep(0.05)

    async def test_what_was_before_the_page_comes_first_and_counts_as_old(self):
        controller = Controller()
        controller.log = [event(1), event(2)]
        self.begin(controller)
        await self.say(controller, event(3))
        await self.say(controller, event(4))
        self.assertEqual([("s1", True), ("s2", True), ("s3", True), ("s4", False)], self.told)

    async def test_the_latched_entry_that_comes_again_is_told_once(self):
        controller = Controller()
        self.begin(controller)
        await self.say(controller, event(1), event(2))
        self.events.hear(event(2))
        await asyncio.sleep(0.02)
        self.assertEqual(["s1", "s2"], [what for what, _ in self.told])

    async def test_entries_that_were_lost_on_the_way_are_asked_for(self):
        controller = Controller()
        self.begin(controller)
        await self.say(controller, event(1))
        controller.log += [event(2), event(3)]
        await self.say(controller, event(4))
        self.assertEqual(["s1", "s2", "s3", "s4"], [what for what, _ in self.told])

    async def test_entries_that_come_while_it_catches_up_are_neither_lost_nor_told_twice(self):
        controller = Controller(delay=0.02)
        self.begin(controller)
        for number in range(1, 8):
            await self.say(controller, event(number)) if number % 2 else controller.log.append(event(number))
        await self.say(controller, event(8))
        await asyncio.sleep(0.2)
        self.assertEqual([f"s{n}" for n in range(1, 9)], [what for what, _ in self.told])

    async def test_a_controller_that_was_started_anew_begins_from_one(self):
        controller = Controller()
        self.begin(controller)
        await self.say(controller, event(1), event(2), event(3))
        controller.log = [event(1, time=10, what="start")]
        await self.say(controller, event(2, time=11, what="holding"))
        self.assertEqual(["s1", "s2", "s3", "start", "holding"], [what for what, _ in self.told])

    async def test_a_controller_that_was_started_anew_after_the_clock_was_set_back_is_heard_too(self):
        controller = Controller()
        self.begin(controller)
        await self.say(controller, *(event(number, time=5000 + number) for number in range(1, 7)))
        controller.log = [event(1, time=1400, what="start")]
        await self.say(controller, event(2, time=1401, what="holding"))
        await self.say(controller, event(3, time=1402, kind="request", what="stop"))
        self.assertEqual(["s6", "start", "holding", "stop"], [what for what, _ in self.told[5:]])

    async def test_an_entry_of_the_controller_that_ends_while_it_is_asked_is_told_once(self):
        controller = Controller(delay=0.02)
        self.begin(controller)
        await self.say(controller, event(1))
        await asyncio.sleep(0.05)
        controller.log = [event(1, time=50, what="start")]  # of the next one
        self.events.hear(event(5))
        await asyncio.sleep(0.2)
        await self.say(controller, event(2, time=51, what="holding"))
        await asyncio.sleep(0.1)
        self.assertEqual([1, 1, 1], [[what for what, _ in self.told].count(what) for what in ("s1", "s5", "holding")])

    async def test_a_controller_that_does_not_answer_loses_no_entry_that_comes_by_itself(self):
        controller = Controller()
        controller.answers = False
        self.begin(controller)
        await self.say(controller, event(5))
        await self.say(controller, event(6))
        self.assertEqual(["s5", "s6"], [what for what, _ in self.told])


class Words(unittest.TestCase):
    def test_each_kind_has_what_the_page_shows(self):
        self.assertEqual(("fault", "it stands still", {"time": 1.0, "name": "stalled"}), in_words(event(1, kind="fault", what="stalled", answer="it stands still")))
        self.assertEqual(("request", "load reference a_b.txt", {"time": 1.0, "answer": "loaded", "user": "rqt"}),
                         in_words(event(1, kind="request", what="load_reference a_b.txt", answer="loaded", who="/rqt")))
        kind, text, more = in_words(event(1, kind="log", what="cannot be written"))
        self.assertEqual(("controller", "cannot be written", True), (kind, text, more["warning"]))


class Stops(unittest.TestCase):
    def test_whoever_stops_the_robot_after_a_motion_was_planned_is_named(self):
        log = [event(1, kind="request", what="stop"), event(2, kind="request", what="enable", who="/tablet")]
        self.assertEqual("", stops.objection(log, 1))
        self.assertEqual("", stops.objection(log, 2))
        self.assertEqual("", stops.objection([], 0))
        for what in ("stop", "disable", "emergency_stop"):
            self.assertEqual(f"/rqt has stopped the robot meanwhile ({what})", stops.objection([*log, event(3, kind="request", what=what, who="/rqt")], 1))
        for what in ("load_patient p17.yaml", "clear_patient", "declare_empty"):
            self.assertEqual(f"/rqt has changed who is on the robot meanwhile ({what})",
                             stops.objection([*log, event(3, kind="request", what=what, who="/rqt")], 1, "/me"))
        for what in ("play lift.txt, approach", "approach", "start", "guide", "home"):
            moved = [*log, event(3, kind="request", what=what, who="/rqt")]
            self.assertEqual(f"/rqt has moved the robot meanwhile ({what})", stops.objection(moved, 1, "/me"))
            self.assertEqual("", stops.objection(moved, 1, "/rqt"))
            self.assertEqual("", stops.objection([*log, event(3, kind="refused", what=what, who="/rqt")], 1))
        paused = [*log, event(3, kind="request", what="pause", who="/rqt")]
        self.assertEqual("/rqt has paused the robot meanwhile, and nobody has resumed it", stops.objection(paused, 1))
        self.assertEqual("", stops.objection([*paused, event(4, kind="request", what="resume", who="/rqt")], 1, "/me"))
        self.assertIn("paused", stops.objection([*paused, event(4, kind="refused", what="resume")], 1))
        self.assertIn("fault hand_switch", stops.objection([*log, event(3, kind="fault", what="hand_switch")], 2))

    def test_a_log_that_has_begun_anew_says_nothing_of_what_was_before(self):
        self.assertIn("anew", stops.objection([], 7))
        self.assertIn("anew", stops.objection([event(8)], 7))
        self.assertEqual("", stops.objection([event(7, time=5)], stops.entry(7, 5.0)))
        self.assertIn("anew", stops.objection([event(7, time=90)], stops.entry(7, 5.0)))
        for nonsense in ("", "x", "7@x"):
            self.assertRaises(ValueError, stops.number_of, nonsense)


if __name__ == "__main__":
    rosunit.unitrun("knee_robot", "operator_events", "events_test", sys.argv)
