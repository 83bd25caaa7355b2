"""What a page may ask for once somebody is logged in: orders to the robot, exercises, patients, recordings, reports, jobs, logs."""
import asyncio

from aiohttp import web

from . import patients
from .answer import Answer, Refused
from .folders import plain_name
from .guard import fields, needs
from .playing import FASTEST_PERCENT, MOST_REPETITIONS, SLOWEST_PERCENT

# Services of the controller without arguments, and what the role must be.
PLAIN = {"enable": "operate", "disable": "operate", "approach": "operate", "pause": "operate", "resume": "operate",
         "emergency_stop": "look", "reset_faults": "operate", "home": "operate", "confirm_home": "operate",
         "clear_patient": "operate", "declare_empty": "operate"}
MOTIONS = ("enable", "approach", "resume", "home")
AT_ANY_TIME = ("disable", "pause", "emergency_stop")  # however old the page is that asks for it
# Reports come from recordings, and recordings from anywhere. A report's page draws itself by scripts: in an origin of its own, without this
# page's session, requests, forms, frames or windows. In every other file no script is executed.
_SANDBOX = "sandbox; default-src 'none'; style-src 'unsafe-inline'; img-src data:"
_DRAWING = _SANDBOX.replace("sandbox", "sandbox allow-scripts") + "; script-src 'unsafe-inline'; form-action 'none'; base-uri 'none'"


class Requests:
    def __init__(self, server):
        self._server = server
        self._robot = server.robot

    def add_to(self, app):
        def get(path, handler, role="look"):
            app.router.add_get(path, needs(role)(handler))

        def post(path, handler, role="operate"):
            app.router.add_post(path, needs(role)(handler))

        for name, role in PLAIN.items():
            post(f"/api/robot/{name}", self._plain(name), role)
        post("/api/robot/start", self.start)
        post("/api/robot/speed", self.speed)
        post("/api/robot/load", self.load)
        post("/api/robot/patient", self.patient)
        get("/api/exercises", self.exercises)
        get("/api/exercises/{name}", self.exercise)
        get("/api/patients", self.list_patients)
        post("/api/patients", self.new_patient)
        get("/api/recordings", self.recordings)
        get("/api/recordings/{name}", self.recording, "operate")
        get("/api/reports/{name}/{file}", self.report)
        post("/api/jobs", self.begin_job, "operate")
        post("/api/jobs/cancel", self.cancel_job, "operate")
        post("/api/model", self.use_model, "engineer")
        get("/api/events", self.events)
        get("/api/audit", self.audit, "engineer")

    def _plain(self, name):
        async def handler(request, session):
            await fields(request)
            if name not in AT_ANY_TIME and (why := self._server.freshness.objection(request)):
                return self._refused(request, session, name.replace("_", " "), why)
            if name in ("emergency_stop", "disable"):
                await self._server.playing.stop()
            return self._server.note(request, session, name.replace("_", " "), await self._in_time(name, self._asked(name)))
        return handler

    def _refused(self, request, session, what, why):
        return self._server.note(request, session, what, Answer(False, why))

    def _asked(self, name):
        playing = self._server.playing
        if name == "pause":
            return playing.pause()
        return playing.ask_motion(name, playing.stops) if name in MOTIONS else self._robot.ask(name)

    async def _ask(self, name, **arguments):
        return await self._in_time(name, self._robot.ask(name, **arguments))

    @staticmethod
    async def _in_time(name, asked):
        try:
            return await asked
        except asyncio.TimeoutError:
            return Answer(False, f"the controller did not answer to {name.replace('_', ' ')} in time")

    async def start(self, request, session):
        asked = await fields(request, repetitions=int, record=bool)
        if not 1 <= asked["repetitions"] <= MOST_REPETITIONS:
            raise Refused(400, f"the exercise can be repeated 1 to {MOST_REPETITIONS} times")
        if why := self._server.freshness.objection(request):
            return self._refused(request, session, "start", why)
        answer = await self._server.playing.start(asked["repetitions"], asked["record"])
        return self._server.note(request, session, "start, once" if asked["repetitions"] == 1 else f"start, {asked['repetitions']} times", answer)

    async def speed(self, request, session):
        percent = (await fields(request, percent=float))["percent"]
        if not SLOWEST_PERCENT <= percent <= FASTEST_PERCENT:
            raise Refused(400, f"the speed lies between {SLOWEST_PERCENT:g} and {FASTEST_PERCENT:g} %")
        # What the page shows is 5 % at least, and late: a robot that somebody has slowed down to 0 % stands.
        now = min(self._server.playing.speed_percent, (self._robot.state or {}).get("speed_percent", FASTEST_PERCENT))
        if percent > now and (why := self._server.freshness.objection(request)):
            return self._refused(request, session, f"speed {percent:g} %", why)
        answer = await self._ask("set_speed", percent=percent)
        if answer.success:
            if percent < now:
                self._server.freshness.calm()
            self._server.playing.set_speed(percent)
        return self._server.note(request, session, f"speed {percent:g} %", answer)

    async def load(self, request, session):
        name = (await fields(request, file=str))["file"]
        self._server.references.existing(name)
        if why := self._server.freshness.objection(request):
            return self._refused(request, session, f"load {name}", why)
        if self._server.playing.active:
            return self._server.note(request, session, f"load {name}", Answer(False, "an exercise is being played; stop it first"))
        answer = await self._ask("load_reference", file=name, space="")
        self._server.freshness.change()
        return self._server.note(request, session, f"load {name}", answer)

    async def patient(self, request, session):
        name = (await fields(request, file=str))["file"]
        self._server.patients.existing(name)
        if why := self._server.freshness.objection(request):
            return self._refused(request, session, f"patient file {name}", why)
        answer = await self._ask("load_patient", file=name)
        self._server.freshness.change()
        return self._server.note(request, session, f"patient file {name}", answer)

    async def exercises(self, _request, _session):
        return web.json_response({"exercises": await asyncio.to_thread(self._server.references.entries)})

    async def exercise(self, request, _session):
        return web.json_response(await self._server.exercises.picture(request.match_info["name"]))

    async def list_patients(self, _request, _session):
        return web.json_response({"patients": await asyncio.to_thread(patients.describe_all, self._server.patients)})

    async def new_patient(self, request, session):
        asked = await fields(request, name=str, patient=str, pose=dict, speed=dict)
        patients.write(self._server.patients, asked["name"], asked["patient"], asked["pose"], asked["speed"])
        return self._server.note(request, session, f"new patient file {asked['name']}", Answer(True, f"{asked['name']} is written"))

    async def recordings(self, _request, _session):
        (recordings, older), reports = await asyncio.to_thread(lambda: (self._server.recordings.listing(), self._server.reports.entries()))
        return web.json_response({"recordings": recordings, "older": older, "reports": reports})

    async def recording(self, request, session):
        path = self._server.recordings.existing(request.match_info["name"])
        self._server.audit.add("request", f"fetch {path.name}", user=session.user, role=session.role, address=request.remote)
        return web.FileResponse(path, headers={"Content-Disposition": f'attachment; filename="{path.name}"', "Content-Type": "text/csv"})

    async def report(self, request, _session):
        path = self._server.reports.existing(request.match_info["name"], request.match_info["file"])
        headers = {"Content-Security-Policy": _DRAWING if path.name == "report.html" else _SANDBOX, "X-Frame-Options": "SAMEORIGIN"}
        if path.suffix not in (".html", ".svg", ".json"):
            headers["Content-Disposition"] = f'attachment; filename="{path.name}"'
        return web.FileResponse(path, headers=headers)

    async def begin_job(self, request, session):
        asked = await fields(request, command=str, train=list, validate=(list, []))
        names = [self._server.recordings.existing(plain_name(name)).name for name in asked["train"] + asked["validate"]]
        if len(names) > 20:
            raise Refused(400, "at most 20 recordings at a time")
        role = {"compare": "operate", "identify": "engineer", "trace": "engineer", "check_model": "engineer"}.get(asked["command"])
        if role is None:
            raise Refused(400, "the command is none of compare, identify, trace, check_model")
        if role == "engineer" and session.role != "engineer":
            raise Refused(403, f"this needs the role 'engineer'; you are logged in as '{session.role}'")
        if asked["command"] == "check_model" and (why := self._server.freshness.objection(request)):  # the one that moves the robot
            return self._refused(request, session, "check_model", why)
        count = len(asked["train"])
        answer = await self._server.jobs.begin(self._server, asked["command"], names[:count], names[count:])
        return self._server.note(request, session, " ".join([asked["command"], *names]), answer)

    async def cancel_job(self, request, session):
        await fields(request)
        return self._server.note(request, session, "cancel the job", await self._server.jobs.cancel())

    async def use_model(self, request, session):
        report = (await fields(request, report=str))["report"]
        path = self._server.reports.existing(report, "model.yaml")
        return self._server.note(request, session, f"use the model of {report}", self._server.jobs.use_model(path))

    async def events(self, _request, _session):
        return web.json_response({"events": self._server.events.entries()})

    async def audit(self, _request, _session):
        return web.json_response({"audit": self._server.audit.entries()})
