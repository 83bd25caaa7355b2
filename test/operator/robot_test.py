#!/usr/bin/python3
"""The page's end of the action: a goal that STOP overtakes while it is being sent moves nothing."""
import asyncio
import sys
import threading
import unittest
import unittest.mock
import xmlrpc.server

import rospy
import rosunit
from page_rig import PageTest
from std_srvs.srv import TriggerResponse

from knee_robot.msg import ControllerState
from knee_robot_operator import same_name
from knee_robot_operator.robot import RosRobot


class SlowActionServer:
    """Stands for actionlib's client: the server is found when the test lets it be, and a goal is played for ever."""

    def __init__(self):
        self.found = threading.Event()
        self.goals, self.cancelled = 0, threading.Event()

    def wait_for_server(self, _patience):
        return self.found.wait(5.0)

    def send_goal(self, _goal, **_callbacks):
        self.goals += 1
        return self

    def cancel(self):
        self.cancelled.set()


def robot_with(client):
    """Without subscribers: those need a master."""
    robot = RosRobot.__new__(RosRobot)
    robot._loop, robot._name = asyncio.get_running_loop(), "/controller"
    robot._threads = threading.BoundedSemaphore(4)
    robot._client, robot._goal, robot._cancels, robot._heard = client, None, 0, float("inf")
    return robot


class GoalTest(PageTest):
    async def test_stop_while_the_action_server_is_looked_for_sends_no_goal(self):
        client = SlowActionServer()
        robot = robot_with(client)
        playing = asyncio.create_task(robot.play(100.0, "", lambda: None))
        await asyncio.sleep(0.05)
        robot.cancel_play()
        client.found.set()
        answer = await asyncio.wait_for(playing, 5.0)
        self.assertEqual((False, "stopped before it began", 0), (answer.success, answer.message, client.goals))

    async def test_stop_while_the_goal_is_being_sent_cancels_it(self):
        client = SlowActionServer()
        client.found.set()
        robot = robot_with(client)
        send = client.send_goal

        def sent_too_late(goal, **callbacks):
            robot.cancel_play()
            return send(goal, **callbacks)

        client.send_goal = sent_too_late
        playing = asyncio.create_task(robot.play(100.0, "", lambda: None))
        self.assertTrue(await asyncio.to_thread(client.cancelled.wait, 5.0))
        playing.cancel()


class BrokenConnection:
    """Stands for rospy's proxy: the first call breaks off in the given way."""

    def __init__(self, error):
        self.error, self.calls = error, 0

    def __call__(self, name, kind):
        def call(**_fields):
            self.calls += 1
            if self.calls == 1:
                raise rospy.ServiceException(self.error)
            return TriggerResponse(True, f"{name} done")
        return call


class CallTest(PageTest):
    LOST = "transport error completing service call: unable to receive data from sender, check sender's logs for details"

    async def ask(self, service, error):
        connection = BrokenConnection(error)
        with unittest.mock.patch("rospy.ServiceProxy", connection):
            return await robot_with(None).ask(service), connection.calls

    async def test_a_stop_whose_connection_breaks_off_is_asked_for_again(self):
        for service in ("stop", "pause", "disable", "emergency_stop"):
            answer, calls = await self.ask(service, self.LOST)
            self.assertEqual((True, f"/controller/{service} done", 2), (answer.success, answer.message, calls))

    async def test_what_moves_the_robot_is_never_asked_for_a_second_time_by_itself(self):
        for service in ("enable", "approach", "start", "resume", "home"):
            answer, calls = await self.ask(service, self.LOST)
            self.assertEqual((False, 1), (answer.success, calls))

    async def test_a_controller_that_refuses_is_not_asked_again(self):
        answer, calls = await self.ask("stop", "service [/controller/stop] unavailable")
        self.assertEqual((False, 1), (answer.success, calls))


class ForgedStateTest(PageTest):
    async def test_a_state_of_another_node_is_not_shown(self):
        robot = robot_with(None)
        robot._listeners, robot._state, robot._warned_of_others = [], None, False
        for sender, state in (("/controller", "holding"), ("/play_1", "disabled")):
            message = ControllerState(state=state, homed=[True] * 4)
            message._connection_header = {"callerid": sender}
            robot._on_state(message)
        self.assertEqual("holding", robot._state["state"])


class SameNameTest(unittest.TestCase):
    """A node's XML-RPC side stands for the other page."""

    def found(self, answer):
        server = xmlrpc.server.SimpleXMLRPCServer(("127.0.0.1", 0), logRequests=False)
        server.register_function(answer, "getPublications")
        threading.Thread(target=server.serve_forever, daemon=True).start()
        address = f"http://127.0.0.1:{server.server_address[1]}/"
        with unittest.mock.patch("rosgraph.Master") as master:
            master.return_value.lookupNode.return_value = address
            found = same_name.address_of("/operator_page")
        server.shutdown()
        server.server_close()
        return found == address

    def test_a_page_that_answers_is_found(self):
        self.assertTrue(self.found(lambda _caller: [1, "", [["/operator_page/events", "knee_robot/Event"]]]))

    def test_another_process_at_the_port_of_one_that_is_gone_is_not(self):
        self.assertFalse(self.found(lambda _caller: [1, "", [["/rosout", "rosgraph_msgs/Log"]]]))
        self.assertFalse(self.found(lambda: 0))

    def test_names_are_those_of_the_node(self):
        self.assertEqual("/left/page", same_name.own_name("operator_page", ["page", "__name:=page", "__ns:=left"]))
        self.assertEqual("/operator_page", same_name.own_name("operator_page", ["page"]))


if __name__ == "__main__":
    rosunit.unitrun("knee_robot", "operator_robot", "robot_test", sys.argv)
