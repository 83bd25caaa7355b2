#!/usr/bin/python3
"""Playing, STOP and their races; what pages are told."""
import asyncio
import sys

import rosunit
from page_rig import PageTest, Rig, ToyRobot

from knee_robot_operator.answer import Answer


async def until(condition, seconds=5.0):
    end = asyncio.get_running_loop().time() + seconds
    while not condition():
        if asyncio.get_running_loop().time() > end:
            raise AssertionError("it did not come about")
        await asyncio.sleep(0.01)


START = {"repetitions": 1, "record": False}


class Playing(PageTest):
    async def start(self, browser, **more):
        return (await browser.post("/api/robot/start", {**START, **more}))[1]

    async def test_an_exercise_is_repeated_as_often_as_asked_for(self):
        async with Rig(ToyRobot(play_s=0.1)) as rig, rig.browser() as browser:
            self.assertTrue((await self.start(browser, repetitions=3, record=True))["success"])
            await until(lambda: not rig.server.playing.active)
            self.assertEqual(3, rig.robot.goals)
            self.assertEqual([f"_{k}.csv" for k in (1, 2, 3)], [name[-6:] for name in rig.server.playing.recordings])

    async def test_the_speed_that_others_have_set_is_shown_and_kept(self):
        robot = ToyRobot(play_s=0.1)
        async with Rig(robot) as rig, rig.browser() as browser:
            robot.become("holding", speed_percent=20.0)  # by another client, or before this server began
            self.assertEqual(20.0, rig.server.snapshot()["playing"]["speed_percent"])
            await self.start(browser, repetitions=2)
            await until(lambda: not rig.server.playing.active)
            self.assertEqual([20.0, 20.0], robot.speeds)
            await browser.post("/api/robot/speed", {"percent": 50})
            robot.become("holding", speed_percent=20.0)  # was on its way
            await self.start(browser)
            self.assertEqual([20.0, 20.0, 50.0], robot.speeds)
            rig.server.playing._speed_set -= 2.0
            robot.become("holding", speed_percent=0.0)  # 0 means 100 to a goal
            self.assertEqual(5.0, rig.server.playing.speed_percent)

    async def test_another_exercise_that_somebody_else_loads_is_not_played_as_the_next_repetition(self):
        robot = ToyRobot(play_s=0.1)
        async with Rig(robot) as rig, rig.browser() as browser:
            await self.start(browser, repetitions=3)
            robot._state["reference_file"] = "other.txt"
            await until(lambda: not rig.server.playing.active)
            self.assertEqual(1, robot.goals)
            self.assertEqual("somebody else has loaded other.txt in place of lift.txt meanwhile", rig.server.playing.message)

    async def test_a_start_of_a_page_that_does_not_show_yet_what_another_has_loaded_is_refused(self):
        async with Rig() as rig, rig.browser() as one, rig.browser() as other:
            shown = rig.server.snapshot()["seen"]
            await asyncio.sleep(0.01)
            await other.post("/api/robot/load", {"file": "lift.txt"})
            _, answer = await one.post("/api/robot/start", START, headers={"X-Seen": str(shown)})
            self.assertFalse(answer["success"])
            self.assertIn("changed", answer["message"])

    async def test_what_was_pressed_before_somebody_paused_or_slowed_down_the_robot_moves_nothing(self):
        robot = ToyRobot()
        async with Rig(robot) as rig, rig.browser() as one, rig.browser() as other:
            for calmer, body in (("/api/robot/pause", {}), ("/api/robot/speed", {"percent": 20})):
                robot.become("paused", speed_percent=50.0)
                rig.server.playing.look(robot.state)
                shown = {"X-Seen": str(rig.server.snapshot()["seen"])}
                await asyncio.sleep(0.01)
                self.assertTrue((await other.post(calmer, body))[1]["success"])
                for late, content in (("/api/robot/resume", {}), ("/api/robot/speed", {"percent": 100}), ("/api/robot/approach", {})):
                    _, answer = await one.post(late, content, headers=shown)
                    self.assertFalse(answer["success"], (calmer, late))
                    self.assertIn("paused, or its speed changed", answer["message"])
            robot.become("paused", speed_percent=0.0)  # by another client: the page shows 5 %
            for seen in (rig.server.snapshot()["seen"] - 4.0, rig.server.snapshot()["seen"]):
                robot.tell("request", "set_speed 0", who="/rqt")
                _, answer = await one.post("/api/robot/speed", {"percent": 5}, headers={"X-Seen": str(seen)})
                self.assertFalse(answer["success"], answer)
            await asyncio.sleep(0.01)
            _, answer = await one.post("/api/robot/resume", {}, headers={"X-Seen": str(rig.server.snapshot()["seen"])})
            self.assertTrue(answer["success"], answer)

    async def test_an_order_that_is_not_answered_in_time_moves_nothing_later(self):
        for order in ("enable", "approach", "resume", "home"):
            robot = ToyRobot()
            robot.answers[order] = asyncio.TimeoutError()  # it waits in the controller, behind a disk
            async with Rig(robot) as rig, rig.browser() as browser:
                _, answer = await browser.post(f"/api/robot/{order}")
                self.assertEqual((False, f"the controller did not answer to {order} in time"), (answer["success"], answer["message"]))
                self.assertEqual([(order, {}), ("stop", {})], robot.asked, "a stop ends what waits")

    async def test_start_away_from_the_start_is_refused_and_nothing_is_recorded(self):
        robot = ToyRobot()
        robot.here = False
        async with Rig(robot) as rig, rig.browser() as browser:
            answer = await self.start(browser, record=True)
            self.assertFalse(answer["success"])
            self.assertIn("go to the start", answer["message"])
            self.assertEqual((0, []), (robot.goals, rig.server.playing.recordings))

    async def test_the_second_start_while_one_is_played_is_refused(self):
        async with Rig() as rig, rig.browser() as browser:
            first, second = await asyncio.gather(self.start(browser), self.start(browser))
            self.assertEqual({True, False}, {first["success"], second["success"]})
            self.assertEqual(1, rig.robot.goals)

    async def test_stop_ends_all_repetitions(self):
        async with Rig(ToyRobot(play_s=0.5, stop_s=0.1)) as rig, rig.browser() as browser:
            await self.start(browser, repetitions=5)
            await browser.post("/api/stop")
            await until(lambda: not rig.server.playing.active)
            await asyncio.sleep(0.3)
            self.assertEqual((1, "holding"), (rig.robot.goals, rig.robot.state["state"]))

    async def test_a_pause_that_comes_when_a_repetition_is_ending_begins_no_further_one(self):
        async with Rig() as rig, rig.browser() as browser:
            for said in (Answer(True, "pausing"), Answer(False, "not possible while the robot is holding")):
                rig.robot.answers["pause"] = said  # and the robot plays on to the end
                goals = rig.robot.goals
                await self.start(browser, repetitions=3)
                await browser.post("/api/robot/pause")
                await until(lambda: not rig.server.playing.active)
                self.assertEqual(goals + 1, rig.robot.goals)
                self.assertIn("paused after repetition 1 of 3", rig.server.playing.message)

    async def test_a_pause_that_others_ask_for_when_a_repetition_is_ending_begins_no_further_one(self):
        async with Rig(ToyRobot(play_s=0.2)) as rig, rig.browser() as browser:
            await self.start(browser, repetitions=3)
            rig.robot.tell("refused", "pause", "not possible", who="/rosservice")
            rig.robot.tell("request", "pause", "pausing", who="/rosservice")  # and the robot plays on to the end
            await until(lambda: not rig.server.playing.active)
            self.assertEqual(1, rig.robot.goals)
            await self.start(browser, repetitions=2)
            rig.robot.tell("request", "pause", "pausing", who="/rosservice")
            rig.robot.tell("request", "resume", "going on", who="/rosservice")
            await until(lambda: not rig.server.playing.active)
            self.assertEqual(3, rig.robot.goals)

    async def test_a_speed_of_nothing_that_others_set_begins_no_further_repetition(self):
        robot = ToyRobot(play_s=0.2)
        async with Rig(robot) as rig, rig.browser() as browser:
            await self.start(browser, repetitions=3)
            robot.become("playing", speed_percent=0.0)  # its last point has been sent
            await until(lambda: not rig.server.playing.active)
            self.assertEqual(1, robot.goals)
            self.assertIn("speed to 0 %", rig.server.playing.message)

    async def test_a_pause_that_the_robot_made_and_that_was_ended_changes_nothing(self):
        async with Rig() as rig, rig.browser() as browser:
            await self.start(browser, repetitions=2)
            await browser.post("/api/robot/pause")
            rig.robot.become("paused")
            rig.robot.become("playing")
            await until(lambda: rig.robot.goals == 2)
            await until(lambda: not rig.server.playing.active)
            self.assertIn("to its end", rig.server.playing.message)

    async def test_stop_between_two_repetitions_ends_them(self):
        robot = ToyRobot(play_s=0.1)
        async with Rig(robot) as rig, rig.browser() as browser:
            await self.start(browser, repetitions=2)
            robot.here = False  # it has to go back to the start slowly
            await until(lambda: robot.state["playing"] == "approach")
            await browser.post("/api/stop")
            await until(lambda: not rig.server.playing.active)
            self.assertEqual(1, robot.goals)

    async def test_a_stop_that_others_ask_the_robot_for_ends_the_repetitions_too(self):
        robot = ToyRobot(play_s=0.1)
        async with Rig(robot) as rig, rig.browser() as browser:
            await self.start(browser, repetitions=2)
            robot.here = False  # it has to go back to the start slowly
            await until(lambda: robot.state["playing"] == "approach")
            robot.tell("request", "stop", "the robot is stopping", who="/rosservice")
            robot.here = True  # it stood there already
            await until(lambda: not rig.server.playing.active)
            self.assertEqual(1, robot.goals)

    async def test_stop_that_overtakes_an_order_to_move_stops_it_all_the_same(self):
        robot = ToyRobot(stop_s=0.1)
        async with Rig(robot) as rig, rig.browser() as browser:
            robot.answers["approach"] = 0.3  # s on its way to the controller
            order = asyncio.create_task(browser.post("/api/robot/approach"))
            await until(lambda: ("approach", {}) in robot.asked)
            await browser.post("/api/stop")
            _, answer = await order
            self.assertFalse(answer["success"])
            self.assertIn("stopped", answer["message"])
            await asyncio.sleep(0.15)
            self.assertEqual("holding", robot.state["state"])
            self.assertFalse(robot.arrived)

    async def test_start_while_the_robot_slows_down_is_refused_and_nothing_of_it_stays(self):
        async with Rig(ToyRobot(stop_s=0.3)) as rig, rig.browser() as browser:
            await self.start(browser)
            await browser.post("/api/stop")
            answer = await self.start(browser)
            self.assertEqual((False, "the robot is still slowing down; start again when it holds"), (answer["success"], answer["message"]))
            await until(lambda: rig.robot.state["state"] == "holding")
            await asyncio.sleep(0.3)
            self.assertEqual((1, "holding"), (rig.robot.goals, rig.robot.state["state"]))

    async def test_start_stop_and_start_again_at_any_moment_end_in_what_was_asked_for_last(self):
        for pause in (0.0, 0.01, 0.05, 0.1, 0.2):
            robot = ToyRobot(stop_s=0.05, play_s=0.6)
            async with Rig(robot) as rig, rig.browser() as browser:
                self.assertTrue((await self.start(browser))["success"])
                await asyncio.sleep(pause)
                await browser.post("/api/stop")
                await asyncio.sleep(pause)
                robot.here = True
                answer = await self.start(browser)
                if not answer["success"]:  # by a sentence, and then it works
                    self.assertIn("slowing down", answer["message"])
                    await until(lambda: robot.state["state"] == "holding")
                    await until(lambda: not rig.server.playing.active)
                    robot.here = True
                    answer = await self.start(browser)
                self.assertTrue(answer["success"], answer)
                await until(lambda: not rig.server.playing.active)
                self.assertEqual((2, "holding", True), (robot.goals, robot.state["state"], rig.server.playing.succeeded), pause)

    async def test_stop_and_start_at_once_never_leave_the_robot_moving(self):
        for order in ((0, 1), (1, 0)):
            async with Rig(ToyRobot(stop_s=0.05, play_s=2.0)) as rig, rig.browser() as browser:
                calls = [browser.post("/api/stop"), browser.post("/api/robot/start", START)]
                await asyncio.gather(*(calls[k] for k in order))
                await browser.post("/api/stop")
                await until(lambda: rig.robot.state["state"] == "holding")
                await until(lambda: not rig.server.playing.active)

    async def test_a_controller_that_falls_silent_ends_what_is_played(self):
        robot = ToyRobot()

        async def play(_speed, _recording, on_begin):
            on_begin()
            return Answer(False, "the controller fell silent")

        robot.play = play
        async with Rig(robot) as rig, rig.browser() as browser:
            await self.start(browser, repetitions=3)
            await until(lambda: not rig.server.playing.active)
            self.assertEqual("the controller fell silent", rig.server.playing.message)
            robot.silent = True
            self.assertFalse((await self.start(browser))["success"])
            self.assertIsNone(rig.server.snapshot()["robot"])


class Stop(PageTest):
    def services(self, rig):
        return [service for service, _ in rig.robot.asked]

    async def test_stop_does_not_wait_behind_an_order_that_hangs(self):
        robot = ToyRobot()
        robot.answers["enable"] = 30.0
        async with Rig(robot) as rig, rig.browser() as browser, rig.browser() as other:
            hanging = asyncio.create_task(other.post("/api/robot/enable"))
            await until(lambda: "enable" in self.services(rig))
            self.assertTrue((await asyncio.wait_for(browser.post("/api/stop"), 2))[1]["success"])
            hanging.cancel()

    async def test_stop_that_is_refused_unanswered_or_pressed_again_becomes_the_safe_stop(self):
        for state, answer in (("playing", Answer(False, "no")), ("playing", 30.0), ("enabling", None), ("homing", None)):
            robot = ToyRobot(state)
            if answer is not None:
                robot.answers["stop"] = answer
            async with Rig(robot) as rig, rig.browser() as browser:
                await browser.post("/api/stop")
                self.assertEqual("emergency_stop", self.services(rig)[-1], (state, answer))
        robot = ToyRobot("playing", stop_s=5.0)
        async with Rig(robot) as rig, rig.browser() as browser:
            await browser.post("/api/stop")
            self.assertEqual(["stop"], self.services(rig))
            await asyncio.sleep(0.6)
            await browser.post("/api/stop")
            self.assertEqual("emergency_stop", self.services(rig)[-1])

    async def test_stop_of_what_was_started_after_a_stop_is_a_first_one_again(self):
        robot = ToyRobot("playing", stop_s=0.1)
        async with Rig(robot) as rig, rig.browser() as browser:
            await browser.post("/api/stop")
            await until(lambda: robot.state["state"] == "holding")
            await asyncio.sleep(0.8)
            robot.become("playing", playing="lift.txt")
            await browser.post("/api/stop")
            await until(lambda: robot.state["state"] == "holding")
            self.assertNotIn("emergency_stop", self.services(rig))

    async def test_a_robot_that_does_not_come_to_rest_is_stopped_safely(self):
        async with Rig(ToyRobot("playing", stop_s=30.0)) as rig, rig.browser() as browser:
            await browser.post("/api/stop")
            await until(lambda: "emergency_stop" in self.services(rig), 8.0)

    async def test_a_robot_whose_state_is_not_heard_may_move(self):
        for more, times in (({}, 1), ({"stop": Answer(False, "not possible while the robot is enabling")}, 1), ({}, 2)):
            robot = ToyRobot("playing", stop_s=30.0)
            robot.answers.update(more)
            robot.silent = True
            async with Rig(robot) as rig, rig.browser() as browser:
                await browser.post("/api/stop")
                if times == 2:
                    await asyncio.sleep(0.6)
                    await browser.post("/api/stop")
                await until(lambda: "emergency_stop" in self.services(rig), 0.1 if more or times == 2 else 8.0)

    async def test_a_finger_that_trembles_stops_once(self):
        async with Rig(ToyRobot("playing", stop_s=0.2)) as rig, rig.browser() as browser:
            await asyncio.gather(*(browser.post("/api/stop") for _ in range(5)))
            await until(lambda: rig.robot.state["state"] == "holding")
            self.assertNotIn("emergency_stop", self.services(rig))

    async def test_nobody_who_answers_is_said(self):
        robot = ToyRobot("playing")
        robot.answers.update(stop=30.0, emergency_stop=30.0)
        async with Rig(robot) as rig, rig.browser() as browser:
            answer = (await browser.post("/api/stop"))[1]
            self.assertFalse(answer["success"])
            self.assertIn("hand switch", answer["message"])

    async def test_stop_works_as_a_plain_form_too(self):
        async with Rig() as rig, rig.browser() as browser:
            async with browser.session.post(rig.url + "/api/stop", data={}) as answer:
                self.assertEqual(200, answer.status)
            self.assertEqual(["stop"], self.services(rig))


class Telling(PageTest):
    async def test_a_fault_is_told_at_once_and_stands_in_the_log(self):
        async with Rig() as rig, rig.browser() as browser:
            async with browser.session.ws_connect(rig.url + "/api/live") as socket:
                rig.robot.become("faulted", fault="stalled", cause="leg 2: the drive pushes and the axis stands still; look")
                events, state = [], ""
                while len(events) < 2 or state != "faulted":
                    message = await socket.receive_json(timeout=3)
                    if message["type"] == "event":
                        events.append(message["content"])
                    elif message["type"] == "state":
                        state = message["content"]["robot"]["state"]
                self.assertEqual([("fault", "stalled"), ("state", None)], [(e["kind"], e.get("name")) for e in events])

    async def test_what_others_ask_is_in_the_log_and_what_we_ask_only_once(self):
        async with Rig() as rig, rig.browser() as browser:
            rig.robot.tell("refused", "start", "no reference is loaded", who="/rqt_console")
            rig.robot.say("start refused: no reference is loaded")
            rig.robot.say("no platform pose belongs to the measured lengths")
            rig.robot.answers["enable"] = Answer(False, "the axes do not know where they are")
            await browser.post("/api/robot/enable")
            rig.robot.tell("refused", "enable", "the axes do not know where they are", who="/operator_page", is_ours=True)
            rig.robot.say("enable refused: the axes do not know where they are")
            await until(lambda: any("no platform pose" in e["text"] for e in rig.server.events.entries()))
            await asyncio.sleep(0.2)
            told = [(e["text"], e.get("answer"), e.get("user")) for e in (await browser.get("/api/events"))[1]["events"]]
            self.assertIn(("start", "no reference is loaded", "rqt_console"), told)
            self.assertEqual([], [t for t in told if "refused" in t[0]], "what only repeats an answer")
            self.assertEqual(1, sum("enable" in t[0] for t in told))

    async def test_a_lost_page_pauses_only_where_configured(self):
        for patience, expected in ((0.0, False), (0.2, True)):
            async with Rig(ToyRobot("playing"), lost_page_pause_s=patience) as rig, rig.browser() as browser:
                async with browser.session.ws_connect(rig.url + "/api/live"):
                    await asyncio.sleep(0.6)
                    self.assertNotIn(("pause", {}), rig.robot.asked)
                await asyncio.sleep(0.8)
                self.assertEqual(expected, ("pause", {}) in rig.robot.asked)


if __name__ == "__main__":
    rosunit.unitrun("knee_robot", "operator_page", "page_test", sys.argv)
