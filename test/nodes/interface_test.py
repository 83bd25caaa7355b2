#!/usr/bin/python3
"""What the controller and the monitor nodes publish, from another process: topics, frames, diagnostics, gains, bag."""
import math
import os
import pathlib
import sys
import time
import unittest
import xmlrpc.client

import rosgraph
import rospy
import rostest
import tf2_ros
from diagnostic_msgs.msg import DiagnosticArray
from dynamic_reconfigure.client import Client
from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import Path
from sensor_msgs.msg import JointState
from visualization_msgs.msg import MarkerArray

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import movements  # noqa: E402
from knee_robot.msg import ControllerState, Forces, Margins, Residual, Timing, TimingHistograms, Tracking  # noqa: E402
from knee_robot.srv import ListComponents, SetProperty  # noqa: E402
from robot_client import Player, RobotClient, run_program  # noqa: E402

COORDINATES = "q11 q12 q13 q21 q22 q23 q31 q32 q33 q41 q42 Xm Zm theta psi".split()


def hear(topic, kind, seconds=10):
    return rospy.wait_for_message(topic, kind, seconds)


class Interface(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.robot = RobotClient()
        cls.folder = pathlib.Path(cls.robot.parameter("references"))
        movements.write(cls.folder, "rise.txt", movements.rise(4.0, height=0.05))
        cls.buffer = tf2_ros.Buffer()
        cls.listener = tf2_ros.TransformListener(cls.buffer)

    def translation(self, parent, child, at=rospy.Time(0)):
        t = self.buffer.lookup_transform(parent, child, at, rospy.Duration(10)).transform.translation
        return t.x, t.y, t.z

    def test_the_state_is_latched(self):
        state = hear("/controller/state", ControllerState)
        self.assertEqual("", state.fault)
        self.assertEqual([True] * 4, list(state.homed))

    def test_what_was_measured_bears_the_time_at_which_it_was(self):
        for topic, kind in (("/controller/tracking", Tracking), ("/controller/pose", PoseStamped), ("/joint_states", JointState),
                            ("/controller/margins", Margins), ("/controller/forces", Forces)):
            stamp = hear(topic, kind).header.stamp
            age_s = (rospy.Time.now() - stamp).to_sec()
            self.assertTrue(0.0 <= age_s < 2.0, f"{topic}: {age_s} s old")

    def test_joint_states_are_the_papers_15_coordinates(self):
        joints = hear("/joint_states", JointState)
        self.assertEqual(COORDINATES, joints.name)
        for values in (joints.position, joints.velocity, joints.effort):
            self.assertEqual(15, len(values))
            self.assertTrue(all(math.isfinite(v) for v in values))
        tracking = self.robot.tracking()
        lengths = [joints.position[COORDINATES.index(n)] for n in ("q13", "q23", "q33", "q42")]
        self.assertLess(max(abs(a - b) for a, b in zip(lengths, tracking.position_m)), 1e-3)

    def test_the_frames_close_the_loops_also_in_motion(self):
        self.robot.bring_to("holding")
        player = Player(self.robot).send("rise.txt", approach=True, approach_speed=0.05)
        self.assertTrue(player.wait_for_phase("playing", path_time_s=0.8))
        gaps = []
        for leg in (1, 2, 3):
            # One message of joint states makes both frames, so they belong to the same instant.
            at = self.buffer.lookup_transform("base", f"leg_{leg}_rod", rospy.Time(0), rospy.Duration(10)).header.stamp
            rod, joint = self.translation("base", f"leg_{leg}_rod", at), self.translation("base", f"platform_point_{leg}", at)
            gaps.append(math.dist(rod, joint))
        print("largest gap of a loop, m:", max(gaps))
        self.assertLess(max(gaps), 1e-6)
        platform, ghost = self.translation("base", "platform"), self.translation("base", "platform_reference")
        self.assertLess(math.dist(platform, ghost), 0.02)
        self.assertGreater(platform[2], 0.602)
        self.assertEqual("SUCCEEDED", player.end()[0])

    def test_residual_is_published_and_not_judged_without_a_model(self):
        residual = hear("/controller/residual", Residual)
        self.assertFalse(residual.identified)
        self.assertEqual([], residual.warnings)
        self.assertTrue(all(band > 0 for band in residual.band_N))

    def test_margins_forces_and_timing_are_published_with_their_limits(self):
        margins = hear("/controller/margins", Margins)
        self.assertTrue(margins.pose_known)
        for value, low, high in zip(margins.length_m, margins.length_min_m, margins.length_max_m):
            self.assertTrue(low < value < high)
        self.assertTrue(all(0 <= a < limit for a, limit in zip(margins.base_angle_rad, margins.base_angle_limit_rad)))
        self.assertTrue(1 < margins.condition < margins.condition_limit)
        self.assertTrue(0 < margins.nearest_left < 1)
        forces = hear("/controller/forces", Forces)
        self.assertTrue(all(limit > 0 for limit in forces.peak_limit_N))
        timing = hear("/controller/timing", Timing)
        self.assertAlmostEqual(1.0, timing.window_s, delta=0.5)
        servo = timing.activities[0]
        self.assertEqual(0.001, servo.period_s)
        self.assertGreater(servo.cycles, 100)
        self.assertTrue(0 < servo.execution_mean_s < servo.execution_max_s)

    def test_every_component_has_its_histograms(self):
        histograms = rospy.wait_for_message("/controller/timing_histograms", TimingHistograms, 15).histograms
        servo = [h for h in histograms if h.activity == histograms[0].activity]
        self.assertEqual("", servo[0].component)
        self.assertTrue({"Sync", "Driver1", "Driver4", "Supervisor"} <= {h.component for h in histograms}, servo)
        for one in servo:
            self.assertGreater(one.updates, 100)
            self.assertAlmostEqual(one.updates, sum(one.execution), delta=20)
            self.assertLess(2.0 ** max(b for b in range(40) if one.execution[b]), 1e9 * one.execution_max_s + 1)

    def test_diagnostics_name_every_part(self):
        names, end = {}, time.monotonic() + 10
        while len(names) < 9 and time.monotonic() < end:
            for status in hear("/diagnostics", DiagnosticArray).status:
                names[status.name] = status
        self.assertEqual({f"controller: {part}" for part in ("machine", "tracking", "limits", "motors", "residual", "timing", "guardian",
                                                             "recording", "real time")}, set(names))
        self.assertEqual("on guard", names["controller: guardian"].message)

    def test_the_path_of_the_loaded_reference_and_the_markers_are_published(self):
        self.robot.bring_to("holding")
        loaded = self.robot.load("rise.txt")
        self.assertTrue(loaded.success, loaded.message)
        path = hear("/controller/path", Path)
        self.assertEqual("base", path.header.frame_id)
        self.assertAlmostEqual(4.0, path.poses[-1].header.stamp.to_sec(), places=6)
        self.assertAlmostEqual(0.65, max(p.pose.position.z for p in path.poses), places=4)
        time.sleep(0.5)
        markers = hear("/markers", MarkerArray).markers
        self.assertEqual({"reference", "path", "errors", "margins", "text"}, {m.ns for m in markers})
        self.assertEqual(len(markers), len({(m.ns, m.id) for m in markers}))

    def test_the_feedforward_carries_the_robot_and_its_share_changes_without_a_bump(self):
        self.robot.bring_to("holding")
        client = Client("/controller/feedforward", timeout=10)
        before = client.get_configuration()
        self.assertEqual((1.0, 0.0), (before["share_gravity"], before["payload_kg"]))
        time.sleep(1.0)
        forces = hear("/controller/forces", Forces)
        print("leg 4: feedforward", forces.feedforward_N[3], "N of", forces.force_N[3], "N")
        self.assertGreater(forces.feedforward_N[3], 20.0)
        rows = []
        subscriber = rospy.Subscriber("/controller/tracking", Tracking, rows.append, queue_size=1000)
        time.sleep(0.3)
        client.update_configuration({"share_gravity": 0.0, "payload_kg": 10.0})
        time.sleep(1.0)
        self.assertAlmostEqual(0.0, hear("/controller/forces", Forces).feedforward_N[3], delta=1e-6)
        client.update_configuration({"share_gravity": 1.0, "payload_kg": 0.0})
        time.sleep(1.0)
        subscriber.unregister()
        positions, sums = [row.position_m[3] for row in rows], [row.force_N[3] for row in rows]
        self.assertLess(max(positions) - min(positions), 2e-4)
        self.assertLess(max(sums) - min(sums), 0.2 * forces.feedforward_N[3])
        self.assertAlmostEqual(forces.feedforward_N[3], hear("/controller/forces", Forces).feedforward_N[3], delta=1.0)
        self.assertEqual("holding", self.robot.state().state)

    def test_every_component_shows_its_state_ports_properties_and_operations_while_it_runs(self):
        list_components = self.robot.service("list_components", ListComponents)
        components = {c.name: c for c in list_components("").components}
        self.assertTrue({"AxesInput", "Sync", "Driver1", "Driver4", "Supervisor", "AxesOutput"} <= set(components), components.keys())
        self.assertEqual({"Running"}, {c.state for c in components.values()})
        driver = list_components("Driver4").components[0]
        self.assertTrue(any(p.output and p.connected for p in driver.ports))
        self.assertTrue(all(p.description and p.type for p in driver.ports))
        proportional = next(p for p in driver.properties if p.name == "proportional_N_per_m")
        self.assertTrue(proportional.at_run_time and float(proportional.value) > 0 and proportional.range, proportional)
        self.assertTrue(components["Sync"].operations or components["Recorder"].operations or components["Supervisor"].operations)
        self.assertFalse(list_components("Driver9").success)

    def test_properties_change_within_their_range_only(self):
        set_property = self.robot.service("set_property", SetProperty)
        value = lambda: next(p.value for p in self.robot.service("list_components", ListComponents)("Driver1").components[0].properties
                             if p.name == "proportional_N_per_m")
        before = value()
        changed = set_property("Driver1", "proportional_N_per_m", "31000")
        self.assertTrue(changed.success, changed.message)
        self.assertEqual(31000.0, float(value()))
        for component, name, wrong in (("Driver1", "proportional_N_per_m", "-1"), ("Driver1", "proportional_N_per_m", "1e12"),
                                       ("Driver1", "proportional_N_per_m", "nan"), ("Driver1", "proportional_N_per_m", "1\n2"),
                                       ("Driver1", "axis", "2"), ("Driver1", "no_such", "1"), ("Driver9", "axis", "1"), ("", "", "")):
            answer = set_property(component, name, wrong)
            self.assertFalse(answer.success, (component, name, wrong))
            self.assertTrue(answer.message)
        self.assertEqual(31000.0, float(value()))
        self.assertTrue(set_property("Driver1", "proportional_N_per_m", before).success)

    def test_gains_change_within_their_bounds_and_without_a_bump(self):
        self.robot.bring_to("holding")
        client = Client("/controller/gains", timeout=10)
        before = client.get_configuration()["proportional_4"]
        self.assertEqual(60000.0, before, "the deployment file's, not cfg's default")
        time.sleep(2.0)  # the holding brakes have just let go: until the integrals carry the platform
        rows = []
        subscriber = rospy.Subscriber("/controller/tracking", Tracking, rows.append, queue_size=1000)
        time.sleep(0.3)
        changed = client.update_configuration({"proportional_4": 40000.0, "integral_4": 100000.0})
        self.assertEqual((40000.0, 100000.0), (changed["proportional_4"], changed["integral_4"]))
        time.sleep(0.5)
        subscriber.unregister()
        positions, forces = [row.position_m[3] for row in rows], [row.force_N[3] for row in rows]
        print(f"leg 4 while P and I changed: position within {1e6 * (max(positions) - min(positions)):.0f} um, "
              f"force within {max(forces) - min(forces):.2f} N of {forces[0]:.1f} N")
        self.assertLess(max(positions) - min(positions), 2e-4)
        # The integral carries the leg's share of the platform: taken over without care it would be a third of that at once.
        self.assertLess(max(forces) - min(forces), 0.1 * abs(forces[0]))
        self.assertEqual(1e6, client.update_configuration({"proportional_4": 1e9})["proportional_4"], "beyond its bound")
        changed = client.update_configuration({"proportional_4": before, "integral_4": 300000.0})
        self.assertEqual(before, changed["proportional_4"])
        self.assertEqual("holding", self.robot.state().state)

    def test_the_terminal_monitor_says_it_all_and_is_plain_in_a_pipe(self):
        once = run_program("monitor", "--once")
        self.assertEqual(0, once.returncode, once.stderr)
        for words in ("/controller: ", "fault        none", "lateness", "tracking", "limits", "guardian"):
            self.assertIn(words, once.stdout)
        self.assertNotIn("\x1b", once.stdout)
        silent = run_program("monitor", "--once", "controller:=nobody")
        self.assertEqual(1, silent.returncode)
        self.assertIn("SILENT", silent.stdout)

    def test_the_controller_listens_on_the_loopback_interface_only(self):
        node = xmlrpc.client.ServerProxy(rosgraph.Master("/interface_test").lookupNode("/controller"))
        pid = node.getPid("/interface_test")[2]
        own = {os.readlink(link) for link in pathlib.Path(f"/proc/{pid}/fd").iterdir() if link.is_symlink()}
        listening = []
        for line in pathlib.Path(f"/proc/{pid}/net/tcp").read_text().splitlines()[1:]:
            words = line.split()
            if words[3] == "0A" and f"socket:[{words[9]}]" in own:
                listening.append(words[1].split(":")[0])
        self.assertEqual(["0100007F"] * 2, listening, "127.0.0.1 for the node itself, and for its topics and services")

    def test_a_bag_is_being_recorded(self):
        bags = list(pathlib.Path(self.robot.parameter("recordings")).glob("simulation_*.bag.active"))
        self.assertEqual(1, len(bags))


if __name__ == "__main__":
    rospy.init_node("interface_test")
    rostest.rosrun("knee_robot", "interface", Interface)
