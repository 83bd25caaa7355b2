#!/usr/bin/python3
"""Looking into the running controller: any port as a topic on demand, and the event log as topic, service and file."""
import json
import math
import pathlib
import statistics
import subprocess
import sys
import time
import unittest

import rospy
import rostest

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import movements  # noqa: E402
from knee_robot.msg import Event, PortValues  # noqa: E402
from knee_robot.srv import GetEvents, ListComponents, SetProperty, WatchPort  # noqa: E402
from robot_client import Player, RobotClient  # noqa: E402


def until(true_at_last, seconds=20):
    end = time.monotonic() + seconds
    while not true_at_last():
        if time.monotonic() > end:
            return False
        time.sleep(0.05)
    return True


class Introspection(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.robot = RobotClient()
        cls.watch = cls.robot.service("watch_port", WatchPort)
        cls.events = cls.robot.service("get_events", GetEvents)
        cls.folder = pathlib.Path(cls.robot.parameter("references"))
        movements.write(cls.folder, "rise.txt", movements.rise(2.0, height=0.03))

    def tearDown(self):
        for component in self.robot.service("list_components", ListComponents)("").components:
            for port in component.ports:
                self.watch(f"{component.name}.{port.name}", False, 0.0)

    def newest(self):
        events = self.events(0).events
        return events[-1].number if events else 0

    def entries_after(self, number):
        return self.events(number).events

    def hear(self, topic, count):
        rows = []
        subscriber = rospy.Subscriber(topic, PortValues, rows.append, queue_size=5000)
        self.assertTrue(until(lambda: len(rows) >= count), f"{len(rows)} of {count} messages on {topic}")
        subscriber.unregister()
        return rows

    def test_every_port_of_every_component_can_be_watched(self):
        watched = unconnected = 0
        for component in self.robot.service("list_components", ListComponents)("").components:
            for port in component.ports:
                name = f"{component.name}.{port.name}"
                answer = self.watch(name, True, 20.0)
                if not port.connected and not port.output:
                    unconnected += 1
                    self.assertFalse(answer.success, name)
                    self.assertIn("connected to nothing", answer.message)
                    continue
                self.assertTrue(answer.success, answer.message)
                self.assertTrue(answer.topic.startswith("/controller/ports/"), answer.topic)
                self.assertTrue(answer.names)
                self.assertTrue(self.watch(name, False, 0.0).success)
                watched += 1
        print(watched, "ports watched,", unconnected, "unconnected")
        self.assertGreater(watched, 50)

    def test_every_value_of_the_servo_cycle_arrives_with_its_stamp(self):
        answer = self.watch("AxesInput.measurement", True, 0.0)
        rows = self.hear(answer.topic, 2000)
        self.assertEqual(list(answer.names), rows[0].names)
        sequence, position = answer.names.index("sequence"), answer.names.index("position_m_1")
        counted = [row.value[sequence] for row in rows]
        steps = [b - a for a, b in zip(counted, counted[1:])]
        if rows[-1].lost == rows[0].lost:
            self.assertEqual({1.0}, set(steps))
        self.assertTrue(all(0.5 < row.value[position] < 0.8 for row in rows))
        stamps = [row.header.stamp.to_sec() for row in rows]
        self.assertTrue(all(b > a for a, b in zip(stamps, stamps[1:])))
        self.assertLess(abs(stamps[-1] - time.time()), 2.0)

    def test_a_slower_rate_takes_some_of_them(self):
        answer = self.watch("Driver1.command", True, 50.0)
        sequence = answer.names.index("sequence")
        counted = [row.value[sequence] for row in self.hear(answer.topic, 40)]
        # The median: a machine that is late skips cycles in between, which do not count.
        self.assertGreaterEqual(statistics.median(b - a for a, b in zip(counted, counted[1:])), 19)

    def test_what_rqt_plot_and_rostopic_ask_for_is_a_plain_number(self):
        answer = self.watch("Driver4.command", True, 0.0)
        index = answer.names.index("force_N")
        told = subprocess.run(["rostopic", "echo", "-n", "1", f"{answer.topic}/value[{index}]"], capture_output=True, text=True, timeout=30)
        self.assertTrue(math.isfinite(float(told.stdout.split()[0])), told)

    def test_an_input_is_watched_at_the_output_behind_it(self):
        answer = self.watch("AxesOutput.command_3", True, 10.0)
        self.assertEqual("/controller/ports/Driver3/command", answer.topic)
        self.assertIn("comes from Driver3.command", answer.message)

    def test_what_is_no_port_is_refused_with_those_that_there_are(self):
        for port, said in (("Driver9.command", "Supervisor"), ("Driver1.force", "set_point"), ("", "Driver1"), ("Driver1", "Driver2"),
                           (".", "Sync"), ("x" * 5000, "Sync"), ("Driver1.", "orders"), ("Driver1.command.volts", "measurement")):
            answer = self.watch(port, True, 0.0)
            self.assertFalse(answer.success, port)
            self.assertIn(said, answer.message)
            self.assertLess(len(answer.message), 600)
            self.assertNotIn("\n", answer.message)
        for rate in (-1.0, math.nan, math.inf, 1e9):
            self.assertFalse(self.watch("Driver1.command", True, rate).success, rate)
        self.assertFalse(self.watch("Driver1.command", False, 0.0).success, "nobody watches it")

    def test_no_more_than_eight_at_once(self):
        ports = [f"Driver{i}.command" for i in (1, 2, 3, 4)] + ["AxesInput.measurement", "Sync.set_point", "Supervisor.orders", "Supervisor.status"]
        for port in ports:
            self.assertTrue(self.watch(port, True, 5.0).success, port)
        self.assertTrue(self.watch("Driver1.command", True, 10.0).success, "again, at another rate")
        answer = self.watch("Monitors.verdict", True, 5.0)
        self.assertFalse(answer.success)
        self.assertIn("end one of them first", answer.message)
        self.assertTrue(self.watch("Sync.set_point", False, 0.0).success)
        self.assertTrue(self.watch("Monitors.verdict", True, 5.0).success)

    def test_a_watch_ends_when_nobody_listens_any_more(self):
        before = self.newest()
        answer = self.watch("Sync.set_point", True, 0.0)
        self.hear(answer.topic, 5)
        ended = lambda: [e for e in self.entries_after(before) if "nobody listened" in e.what]
        self.assertTrue(until(ended), "ten seconds after the last subscriber has gone")
        self.assertNotIn(answer.topic, dict(rospy.get_published_topics("/controller/ports")))

    def test_the_log_says_who_asked_for_what_and_what_was_answered(self):
        self.robot.bring_to("disabled")
        before = self.newest()
        self.robot.load("no_such_file.txt")
        self.robot.bring_to("holding")
        self.robot.set_speed(50.0)
        self.robot.service("set_property", SetProperty)("Driver1", "axis", "7")
        subprocess.run(["rosservice", "call", "/controller/pause"], capture_output=True, timeout=30)
        events = self.entries_after(before)
        me = rospy.get_name()
        for kind, what in (("refused", "load_reference no_such_file.txt"), ("request", "enable"), ("request", "set_speed 50 %"),
                           ("refused", "set_property Driver1.axis 7")):
            found = [e for e in events if e.kind == kind and e.what == what]
            self.assertEqual([me], [e.who for e in found], (kind, what, events))
            self.assertTrue(found[0].answer)
        stranger = [e for e in events if e.what == "pause"]
        self.assertTrue(stranger and stranger[0].who.startswith("/rosservice"), stranger)
        states = [e.what for e in events if e.kind == "state"]
        self.assertEqual("holding", states[-1])
        self.assertEqual(list(range(before + 1, before + 1 + len(events))), [e.number for e in events])

    def test_goals_have_their_beginning_and_end_in_it(self):
        self.robot.bring_to("holding")
        before = self.newest()
        self.assertEqual("SUCCEEDED", Player(self.robot).send("rise.txt", approach=True, approach_speed=0.05).end()[0])
        Player(self.robot).send("no_such_file.txt").end()
        goals = [e for e in self.entries_after(before) if e.what.startswith("play ")]
        self.assertEqual([("request", "play rise.txt, approach"), ("ended", "play rise.txt, approach"), ("refused", "play no_such_file.txt")],
                         [(e.kind, e.what) for e in goals])
        self.assertEqual({rospy.get_name()}, {e.who for e in goals})
        self.assertIn("played to its end", goals[1].answer)

    def test_faults_and_states_are_on_the_topic_and_in_the_file(self):
        self.robot.bring_to("holding")
        heard = []
        subscriber = rospy.Subscriber("/controller/events", Event, heard.append, queue_size=100)
        self.assertTrue(until(lambda: heard), "the newest is latched")
        before = heard[-1].number
        self.robot.trigger("emergency_stop")
        self.assertTrue(until(lambda: [e for e in heard if e.kind == "state" and e.what == "faulted"]))
        subscriber.unregister()
        fault = next(e for e in heard if e.kind == "fault" and e.number > before)
        self.assertEqual("emergency_stop", fault.what)
        self.assertTrue(fault.answer)
        file = pathlib.Path(self.robot.parameter("recordings")) / "events" / "controller.jsonl"
        lines = lambda: [json.loads(line) for line in file.read_text().splitlines()]
        self.assertTrue(until(lambda: any(e["kind"] == "state" and e["what"] == "faulted" and e["time"] > 0 for e in lines()[-20:])))
        self.robot.bring_to("disabled")


if __name__ == "__main__":
    rospy.init_node("introspection_test")
    rostest.rosrun("knee_robot", "introspection", Introspection)
