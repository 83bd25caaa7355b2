#!/usr/bin/python3
"""Record and check the model, cancelling, and the model in use; with a robot and an identification that only remember."""
import asyncio
import stat
import sys

import rosunit
from page_rig import PageTest, Rig, ToyRobot

from knee_robot_operator.answer import Answer
from knee_robot_operator.jobs import Jobs


class ToyIdentification:
    def __init__(self, seconds=0.0):
        self.runs, self.seconds, self.cancelled = [], seconds, asyncio.Event()

    def cancel(self):
        self.cancelled.set()

    async def run(self, command, train, validate, output, model, feed):
        self.runs.append((command, train, validate, model))
        feed("fitting", 0.5)
        try:
            await asyncio.wait_for(self.cancelled.wait(), self.seconds)
            return Answer(False, "cancelled; nothing of it was kept"), None
        except asyncio.TimeoutError:
            return Answer(True, f"{command} is done"), {"after_rms_N": [1.0] * 4}


class JobRig(Rig):
    """The rig with the real Jobs; `planner` is a shell script in the place of plan_excitation."""

    def __init__(self, *arguments, identification=None, planner='while [ "$1" != -o ]; do shift; done; echo 0.6 0.6 0.6 0.6 > "$2"', **settings):
        super().__init__(*arguments, **settings)
        self.identification, self._planner = identification or ToyIdentification(), planner

    async def __aenter__(self):
        await super().__aenter__()
        program = self.folder / "plan_excitation"
        program.write_text("#!/bin/sh\n" + self._planner + "\n")
        program.chmod(program.stat().st_mode | stat.S_IXUSR)
        self.server.settings.model_in_use = str(self.folder / "in_use" / "model.yaml")
        self.server.jobs = Jobs(self.server.settings, self.identification, str(program))
        return self

    async def until_done(self, seconds=20.0):
        end = asyncio.get_running_loop().time() + seconds
        while self.server.jobs.active:
            assert asyncio.get_running_loop().time() < end, self.server.jobs.as_dict()
            await asyncio.sleep(0.02)
        return self.server.jobs.as_dict()


CHECK = {"command": "check_model", "train": []}


class CheckModel(PageTest):
    async def test_two_excitations_are_planned_played_and_recorded_and_the_second_validates(self):
        async with JobRig(ToyRobot(play_s=0.2)) as rig, rig.browser() as browser:
            self.assertTrue((await browser.post("/api/jobs", CHECK))[1]["success"])
            done = await rig.until_done()
            self.assertEqual("trace is done", done["message"])
            services = [service for service, _ in rig.robot.asked]
            self.assertEqual(["load_reference", "approach"] * 2, services)
            self.assertEqual(2, rig.robot.goals)
            self.assertEqual(["identify", "trace"], [run[0] for run in rig.identification.runs])
            for _, train, validate, _ in rig.identification.runs:
                self.assertEqual((1, 1), (len(train), len(validate)))
                self.assertNotEqual(train, validate)

    async def test_it_needs_a_robot_that_holds(self):
        async with JobRig(ToyRobot("disabled")) as rig, rig.browser() as browser:
            await browser.post("/api/jobs", CHECK)
            self.assertIn("switch the robot on", (await rig.until_done())["message"])
            self.assertEqual([], rig.robot.asked)

    async def test_stop_ends_all_of_it(self):
        async with JobRig(ToyRobot(play_s=5.0, stop_s=0.1)) as rig, rig.browser() as browser:
            await browser.post("/api/jobs", CHECK)
            while rig.robot.goals == 0:
                await asyncio.sleep(0.02)
            await browser.post("/api/stop")
            self.assertIn("stopped", (await rig.until_done())["message"])
            self.assertEqual((1, "holding", []), (rig.robot.goals, rig.robot.state["state"], rig.identification.runs))

    async def test_whoever_stops_the_robot_while_it_is_planned_ends_all_of_it_too(self):
        for kind, what in (("request", "stop"), ("request", "disable"), ("fault", "hand_switch"), ("", "")):
            async with JobRig(ToyRobot(play_s=0.2), planner="sleep 0.5") as rig, rig.browser() as browser:
                await browser.post("/api/jobs", CHECK)
                await asyncio.sleep(0.2)
                if kind:
                    rig.robot.tell(kind, what, who="/rosservice")
                else:  # STOP of this page
                    await browser.post("/api/stop")
                self.assertIn("stopped", (await rig.until_done())["message"])
                self.assertEqual(0, rig.robot.goals)
                self.assertNotIn("approach", [service for service, _ in rig.robot.asked])

    async def test_a_pause_at_the_very_end_of_the_approach_ends_all_of_it(self):
        for by_others in (False, True):
            async with JobRig(ToyRobot(play_s=0.2)) as rig, rig.browser() as browser:
                await browser.post("/api/jobs", CHECK)
                while rig.robot.state["playing"] != "approach":
                    await asyncio.sleep(0.02)
                if by_others:
                    rig.robot.tell("request", "pause", "pausing", who="/rosservice")
                else:
                    await browser.post("/api/robot/pause")  # and the robot is there before it rests
                self.assertIn("paused before", (await rig.until_done())["message"])
                self.assertEqual(0, rig.robot.goals)

    async def test_cancelling_slows_the_robot_down_or_ends_the_planning(self):
        for planner in (None, "sleep 30"):
            more = {"planner": planner} if planner else {}
            async with JobRig(ToyRobot(play_s=5.0, stop_s=0.1), **more) as rig, rig.browser() as browser:
                await browser.post("/api/jobs", CHECK)
                for _ in range(100):
                    if rig.robot.goals or (planner and rig.server.jobs.as_dict()["stage"].startswith("planning")):
                        break
                    await asyncio.sleep(0.02)
                self.assertTrue((await browser.post("/api/jobs/cancel"))[1]["success"])
                await rig.until_done()
                self.assertEqual("holding", rig.robot.state["state"])
                self.assertEqual([], rig.identification.runs)

    async def test_the_kernel_ends_the_planner_before_the_controller_where_memory_runs_out(self):
        async with JobRig(planner="cat /proc/self/oom_score_adj >&2; exit 1") as rig, rig.browser() as browser:
            await browser.post("/api/jobs", CHECK)
            self.assertEqual("1000", (await rig.until_done())["message"])

    async def test_a_planner_that_refuses_is_quoted(self):
        async with JobRig(planner="echo plan_excitation: no feasible series >&2; exit 3") as rig, rig.browser() as browser:
            await browser.post("/api/jobs", CHECK)
            self.assertEqual("plan_excitation: no feasible series", (await rig.until_done())["message"])


class OneJob(PageTest):
    async def test_a_second_job_is_refused_and_the_first_can_be_cancelled(self):
        async with JobRig(identification=ToyIdentification(30.0)) as rig, rig.browser() as browser:
            (rig.folder / "recordings" / "run.csv").write_text("time_s\n")
            job = {"command": "trace", "train": ["run.csv"]}
            self.assertTrue((await browser.post("/api/jobs", job))[1]["success"])
            self.assertFalse((await browser.post("/api/jobs", job))[1]["success"])
            self.assertTrue((await browser.post("/api/jobs/cancel"))[1]["success"])
            self.assertIn("cancelled", (await rig.until_done())["message"])
            self.assertFalse((await browser.post("/api/jobs/cancel"))[1]["success"])

    async def test_the_model_in_use_is_replaced_whole_and_the_one_before_is_kept(self):
        async with JobRig() as rig, rig.browser() as browser:
            for name, text in (("first", "a: 1\n"), ("second", "a: 2\n")):
                (rig.folder / "reports" / name).mkdir()
                (rig.folder / "reports" / name / "model.yaml").write_text(text)
                (rig.folder / "reports" / name / "report.html").write_text("")
                self.assertTrue((await browser.post("/api/model", {"report": name}))[1]["success"])
            place = rig.folder / "in_use" / "model.yaml"
            self.assertEqual(("a: 2\n", "a: 1\n"), (place.read_text(), place.with_name("model.yaml.before").read_text()))
            self.assertEqual(404, (await browser.post("/api/model", {"report": "third"}))[0])
            (rig.folder / "recordings" / "run.csv").write_text("time_s\n")
            await browser.post("/api/jobs", {"command": "identify", "train": ["run.csv"]})
            await rig.until_done()
            self.assertEqual(str(place), rig.identification.runs[-1][3], "the model in use is set beside the new one")


if __name__ == "__main__":
    rosunit.unitrun("knee_robot", "operator_jobs", "jobs_test", sys.argv)
